// Two levels: a tree for each mesh that instances share, by the same steps as the world's own, and one over the
// instances. All lie in the same two arrays, one behind the other: world, shared meshes, instances.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "host/base/error.hpp"
#include "host/bvh/accel.hpp"

namespace hemiray {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kMaxNodes = std::uint64_t{1} << 31U;   // a child's reference, shared/bvh_types.h
constexpr std::uint64_t kMaxBlocks = std::uint64_t{1} << 27U;  // in a leaf's reference

bool is_empty(const AccelStatistics& s) { return !(s.lo.x <= s.hi.x); }

void include(AccelStatistics& all, const AccelStatistics& part) {
  if (is_empty(part)) return;
  if (is_empty(all)) {
    all.lo = part.lo;
    all.hi = part.hi;
    return;
  }
  all.lo = {std::min(all.lo.x, part.lo.x), std::min(all.lo.y, part.lo.y), std::min(all.lo.z, part.lo.z), 0.0F};
  all.hi = {std::max(all.hi.x, part.hi.x), std::max(all.hi.y, part.hi.y), std::max(all.hi.z, part.hi.z), 0.0F};
}

// Largest coordinates along each axis, without sign.
shared::float4 reach_of(const AccelStatistics& s) {
  if (is_empty(s)) return {0.0F, 0.0F, 0.0F, 0.0F};
  return {std::max(std::abs(s.lo.x), std::abs(s.hi.x)), std::max(std::abs(s.lo.y), std::abs(s.hi.y)),
          std::max(std::abs(s.lo.z), std::abs(s.hi.z)), 0.0F};
}

}  // namespace

Program& AccelBuilder::instance_program(const AccelConfig& config) {
  const std::string defines = config.defines();
  const auto found = instance_programs_.find(defines);
  if (found != instance_programs_.end()) return found->second;
  return instance_programs_
      .emplace(defines, Program(*context_, "bvh_instances", {"bvh/instances.cl"}, ProgramOptions{0, false, defines}))
      .first->second;
}

void Accel::build_with_instances(const DeviceScene& scene, const AccelOptions& options) {
  const std::vector<SharedMesh>& meshes = scene.shared_meshes();
  mesh_boxes_ = Buffer<shared::Box>(*builder_->context_, "mesh boxes", meshes.size());
  build_tree(scene, options, scene.world());
  keep_tree();
  for (std::uint32_t m = 0; m < meshes.size(); m++) {
    build_tree(scene, options, {meshes[m].first_triangle, meshes[m].triangle_count, meshes[m].triangle_count});
    bound_mesh(0, m);
    keep_tree();
  }
  of_instances_ = true;
  AccelOptions single = options;
  single.max_leaf = 1;
  build_tree(scene, single, {0, 0, scene.instance_count()});
  keep_tree();
  of_instances_ = false;
  join_trees();
}

void Accel::bound_mesh(std::uint32_t root, std::uint32_t mesh) {
  launch(*builder_->context_, builder_->instance_program(layout_config()).kernel("bvh_bound_tree"), 1,
         arguments(nodes_.arguments(), arg("root", root), arg("mesh", mesh), arg("mesh_boxes", mesh_boxes_)));
}

// Twice: how much a box must be padded depends on how far away rays can start, which is known when all boxes are.
void Accel::bound_instances(const DeviceScene& scene) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  Kernel& kernel = builder_->instance_program(layout_config()).kernel("bvh_bound_instances");
  const std::uint32_t chunks = context.profile().chunks;
  const Buffer<shared::BoundsPartial> partials(context, "bounds", chunks);
  ensure_boxes(scene.instance_count());
  AccelStatistics all = trees_.front().statistics;
  for (int round = 0; round < 2; round++) {
    launch(context, kernel, chunks,
           arguments(arg("instances", scene.instances()), arg("mesh_boxes", mesh_boxes_),
                     arg("instance_count", scene.instance_count()), arg("reach", reach_of(all)),
                     arg("boxes", scratch.boxes), arg("partials", partials)));
    statistics_ = {};
    take_bounds(partials);
    include(all, statistics_);
  }
}

// Puts the tree just built aside.
void Accel::keep_tree() {
  Tree tree;
  tree.input = input_;
  tree.regions = std::move(regions_);
  tree.region_count = statistics_.primitives > 0 ? region_count_ : 0;
  tree.first_node = first_node_;
  tree.statistics = statistics_;
  tree.nodes = std::move(nodes_);
  tree.blocks = std::move(blocks_);
  first_node_ += statistics_.nodes;
  first_block_ += statistics_.blocks;
  trees_.push_back(std::move(tree));
}

// One array of nodes and one of blocks for all trees, which are there twice meanwhile: first the nodes, then the
// blocks.
void Accel::join_trees() {
  Context& context = *builder_->context_;
  std::uint64_t nodes = 0, blocks = 0;
  std::uint32_t deepest_mesh = 0;
  std::vector<std::int32_t> roots = {static_cast<std::int32_t>(trees_.back().first_node)};
  AccelStatistics all;
  all.lo = {kInf, kInf, kInf, 0.0F};
  all.hi = {-kInf, -kInf, -kInf, 0.0F};
  for (const Tree& tree : trees_) {
    const AccelStatistics& part = tree.statistics;
    const bool is_mesh = &tree != &trees_.front() && &tree != &trees_.back();
    nodes += part.nodes;
    blocks += part.blocks;
    (&tree == &trees_.back() ? all.instances : all.primitives) += part.primitives;
    all.non_finite += part.non_finite;
    all.degenerate += part.degenerate;
    all.morton_bits = std::max(all.morton_bits, part.morton_bits);
    if (is_mesh) {
      deepest_mesh = std::max(deepest_mesh, part.stack_depth);
      roots.push_back(static_cast<std::int32_t>(tree.first_node));
    } else {
      include(all, part);
    }
  }
  if (nodes > kMaxNodes || blocks > kMaxBlocks) {
    throw DeviceError("the trees of the shared meshes have more than 2^31 nodes or 2^27 blocks; split the scene");
  }
  const auto join = [&](TreeChunks& whole, TreeChunks Tree::*part, std::uint32_t AccelStatistics::*count) {
    std::uint64_t first = 0;
    for (Tree& tree : trees_) {
      whole.copy_from(context, builder_->copy_words(), tree.*part, tree.statistics.*count, first);
      first += tree.statistics.*count;
    }
    context.finish();
    for (Tree& tree : trees_) tree.*part = TreeChunks();
  };
  make_nodes(nodes);
  join(nodes_, &Tree::nodes, &AccelStatistics::nodes);
  make_blocks(blocks);
  join(blocks_, &Tree::blocks, &AccelStatistics::blocks);
  repeat_blocks();
  tree_roots_ = Buffer<std::int32_t>(context, "tree_roots", std::span<const std::int32_t>(roots));
  // The root of the instances waits below the world's tree; a shared tree is walked above what waits of the instances.
  all.nodes = static_cast<std::uint32_t>(nodes);
  all.blocks = static_cast<std::uint32_t>(blocks);
  all.references = all.primitives;
  all.stack_depth =
      1 + std::max(trees_.front().statistics.stack_depth, trees_.back().statistics.stack_depth + deepest_mesh);
  config_.stack = stack_size_for(all.stack_depth);
  statistics_ = all;
}

void Accel::refit_with_instances(const DeviceScene& scene) {
  const AccelStatistics built = statistics_;
  for (Tree& tree : trees_) {
    if (&tree != &trees_.back() && tree.region_count > 0) {
      refit_tree(scene, tree.input, tree.regions, tree.region_count);
    }
  }
  for (std::uint32_t m = 0; m < scene.shared_meshes().size(); m++) bound_mesh(trees_[m + 1].first_node, m);
  input_ = scene.world();
  bound_primitives(scene);
  trees_.front().statistics = statistics_;
  bound_instances(scene);
  statistics_ = built;
  const Tree& last = trees_.back();
  Context& context = *builder_->context_;
  Kernel& kernel = builder_->instance_program(layout_config()).kernel("bvh_refit_instances");
  const auto run = [&](std::uint32_t first, std::uint32_t count) {
    launch(context, kernel, count,
           arguments(arg("boxes", builder_->scratch_.boxes), arg("regions", last.regions), arg("first_region", first),
                     arg("region_count", first + count), nodes_.arguments()));
  };
  if (last.region_count > 1) run(1, last.region_count - 1);
  if (last.region_count > 0) run(0, 1);
  context.finish();
  builder_->release(builder_->scratch_.boxes);
}

}  // namespace hemiray
