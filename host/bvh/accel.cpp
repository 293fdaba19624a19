#include "host/bvh/accel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/bvh/accel_memory.hpp"
#include "shared/features.h"

namespace hemiray {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

// Codes of 11 bits an axis sort in three passes. More bits tell apart what lies close together in large scenes, which
// clustering makes up for.
constexpr unsigned kMortonBits = 33;

// Times that every node of the top may move: what is best for one changes as others move, so a sweep takes every third
// node, three times.
constexpr std::uint32_t kTopSweeps = 2, kTopShares = 3;

void grow(shared::float4& lo, shared::float4& hi, const shared::float4& part_lo, const shared::float4& part_hi) {
  lo = {std::min(lo.x, part_lo.x), std::min(lo.y, part_lo.y), std::min(lo.z, part_lo.z), 0.0F};
  hi = {std::max(hi.x, part_hi.x), std::max(hi.y, part_hi.y), std::max(hi.z, part_hi.z), 0.0F};
}

// Morton cells per metre along an axis; 0 where all centres agree.
float cells_per_metre(float lo, float hi, unsigned axis_bits) {
  const float extent = hi - lo;
  if (!(extent > 0.0F)) return 0.0F;
  return std::min(std::ldexp(1.0F, static_cast<int>(axis_bits)) / extent, std::numeric_limits<float>::max());
}

// For a lattice of cubes: the scale of the longest axis for all three.
shared::float4 cubic_scale(const shared::float4& scale) {
  float least = 0.0F;
  for (const float s : {scale.x, scale.y, scale.z}) least = s > 0.0F && (least == 0.0F || s < least) ? s : least;
  return {least, least, least, 0.0F};
}

// What bvh/binary_node.h weighs boxes by. A scene without extent along some axis has no volume to weigh, one without
// two of them nothing at all.
shared::float4 entry_metric(const shared::float4& lo, const shared::float4& hi) {
  constexpr double kLeast = 1e-20;     // of what is divided by
  constexpr float kLaneCost = 1e-20F;  // more than nothing, next to nothing beside boxes that rays meet
  const double x = double{hi.x} - lo.x, y = double{hi.y} - lo.y, z = double{hi.z} - lo.z;
  const double longest = std::max({x, y, z});
  if (!(longest > 0.0)) return {0.0F, 0.0F, 0.0F, kLaneCost};
  const double area = (x * y + (x + y) * z) / (longest * longest), volume = x * y * z / (longest * longest * longest);
  const auto inverse = [](double d) { return d > kLeast ? static_cast<float>(1.0 / d) : 0.0F; };
  return {inverse(longest), inverse(area), inverse(volume), kLaneCost};
}

}  // namespace

AccelBuilder::AccelBuilder(Context& context, Parallel& parallel, bool keep_scratch)
    : context_(&context),
      parallel_(&parallel),
      keep_scratch_(keep_scratch),
      program_(context, "bvh", {"bvh/morton.cl", "bvh/radix_tree.cl", "bvh/agglomerate.cl"},
               ProgramOptions{0, false, context.profile().explicit_vectors != 0 ? "" : "-DHR_EXPLICIT_VECTORS=0"}) {}

std::vector<const Program*> AccelBuilder::programs() const {
  std::vector<const Program*> all = {&program_};
  if (top_program_) all.push_back(&*top_program_);
  if (copy_program_) all.push_back(&*copy_program_);
  for (const auto& [defines, program] : layout_programs_) all.push_back(&program);
  for (const auto& [defines, program] : cell_programs_) all.push_back(&program);
  for (const auto& [defines, program] : instance_programs_) all.push_back(&program);
  return all;
}

std::uint64_t AccelBuilder::scratch_bytes() const {
  const Scratch& s = scratch_;
  return s.boxes.bytes() + s.keys.bytes() + s.keys_other.bytes() + s.binary.bytes() + s.arenas.bytes() +
         s.join_arena.bytes() + s.draft.bytes() + s.top.bytes() + s.pending.bytes() + s.node_ranges.bytes() +
         s.pending_count.bytes() + s.totals.bytes() + s.root.bytes();
}

Program& AccelBuilder::top_program() {
  if (!top_program_) {
    top_program_ = Program(*context_, "bvh_top", {"bvh/top_tree.cl", "bvh/reinsert.cl"}, ProgramOptions{});
  }
  return *top_program_;
}

Kernel& AccelBuilder::copy_words() {
  if (!copy_program_) copy_program_ = Program(*context_, "bvh_copy", {"bvh/copy_words.cl"}, ProgramOptions{});
  return copy_program_->kernel("bvh_copy_words");
}

Program& AccelBuilder::layout_program(const AccelConfig& config) {
  const std::string defines = config.defines();
  const auto found = layout_programs_.find(defines);
  if (found != layout_programs_.end()) return found->second;
  return layout_programs_
      .emplace(defines,
               Program(*context_, "bvh_layout", {"bvh/cut.cl", "bvh/collapse.cl", "bvh/emit_wide.cl", "bvh/refit.cl"},
                       ProgramOptions{0, false, defines}))
      .first->second;
}

Accel::Accel(AccelBuilder& builder, const DeviceScene& scene, const AccelOptions& given) : builder_(&builder) {
  Context& context = *builder.context_;
  const AccelOptions options = complete_options(given, context.profile());
  config_ = config_of(options);
  options_ = options;
  const double start = steady_ms();
  const double compile_start = context.launch_compile_ms();
  input_ = scene.world();
  if (options.kind != AccelKind::bvh) {
    if (scene.instance_count() > 0) throw InputError("--accel", "a tree of cells cannot hold instances; take bvh");
    bound_primitives(scene);
    build_cells(scene, options);
  } else if ((scene.features() & HR_FEATURE_INSTANCES) != 0) {
    build_with_instances(scene, options);
  } else {
    build_tree(scene, options, input_);
  }
  statistics_.build_ms = steady_ms() - start - (context.launch_compile_ms() - compile_start);
}

void Accel::build_tree(const DeviceScene& scene, const AccelOptions& options, const TreeInput& input) {
  input_ = input;
  statistics_ = {};
  config_.stack = AccelConfig{}.stack;
  config_.node_chunks = config_.block_chunks = {};
  if (of_instances_) {
    bound_instances(scene);
  } else {
    bound_primitives(scene);
  }
  if (statistics_.primitives == 0) return make_empty();
  sort_primitives(options);
  cluster(options);
  improve_top();
  collapse(scene, options);
}

void Accel::bound_primitives(const DeviceScene& scene) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  const std::uint32_t chunks = context.profile().chunks;
  const Buffer<shared::BoundsPartial> partials(context, "bounds", chunks);
  ensure_boxes(input_.primitive_count);
  launch(context, builder_->program_.kernel("bvh_bound_primitives"), chunks,
         arguments(scene.geometry_arguments(input_), arg("primitive_count", input_.primitive_count),
                   arg("boxes", scratch.boxes), arg("partials", partials)));
  take_bounds(partials);
}

// Room for the boxes, and for the costs that collapse() puts in their place.
void Accel::ensure_boxes(std::uint32_t count) {
  const DeviceProfile& profile = builder_->context_->profile();
  const std::uint32_t nodes = binary_tree_sizes(count, options_.builder, profile).nodes;
  builder_->ensure(builder_->scratch_.boxes, "boxes", nodes);
}

void Accel::take_bounds(const Buffer<shared::BoundsPartial>& partials) {
  statistics_.lo = centroid_lo_ = {kInf, kInf, kInf, 0.0F};
  statistics_.hi = centroid_hi_ = {-kInf, -kInf, -kInf, 0.0F};
  for (const shared::BoundsPartial& part : partials.read()) {
    statistics_.primitives += part.valid;
    statistics_.non_finite += part.non_finite;
    statistics_.degenerate += part.degenerate;
    grow(statistics_.lo, statistics_.hi, part.lo, part.hi);
    grow(centroid_lo_, centroid_hi_, part.centroid_lo, part.centroid_hi);
  }
}

void Accel::sort_primitives(const AccelOptions& options) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  const std::uint32_t count = input_.primitive_count;
  index_bits_ = static_cast<unsigned>(std::bit_width(std::max(count, 2U) - 1));
  const unsigned spare_bits = 63 - index_bits_;  // one bit more sorts dropped primitives behind all others
  statistics_.morton_bits = std::min(options.morton_bits != 0 ? options.morton_bits : kMortonBits, spare_bits) / 3 * 3;
  const std::uint32_t axis_bits = statistics_.morton_bits / 3;
  shared::float4 scale = {cells_per_metre(centroid_lo_.x, centroid_hi_.x, axis_bits),
                          cells_per_metre(centroid_lo_.y, centroid_hi_.y, axis_bits),
                          cells_per_metre(centroid_lo_.z, centroid_hi_.z, axis_bits), 0.0F};
  if (options.kind != AccelKind::bvh) scale = cubic_scale(scale);
  // Either may be the one that the sort leaves over, which collapse() then works in.
  const std::uint32_t slots = binary_tree_sizes(count, options.builder, context.profile()).nodes;
  const std::size_t room = std::max(count, slots / 2 + 1);
  builder_->ensure(scratch.keys, "Morton codes", room);
  builder_->ensure(scratch.keys_other, "Morton codes", room);
  launch(context, builder_->program_.kernel("bvh_code_primitives"), context.profile().chunks,
         arguments(arg("boxes", scratch.boxes), arg("primitive_count", count), arg("centroid_lo", centroid_lo_),
                   arg("scale", scale), arg("axis_bits", axis_bits), arg("index_bits", std::uint32_t{index_bits_}),
                   arg("keys", scratch.keys)));
  const bool some_dropped = statistics_.primitives < count;
  builder_->parallel_->sort(scratch.keys, scratch.keys_other, count, index_bits_,
                            statistics_.morton_bits + (some_dropped ? 1 : 0));
}

void Accel::cluster(const AccelOptions& options) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  const DeviceProfile& profile = context.profile();
  const std::uint32_t count = statistics_.primitives;
  const BinaryTreeSizes sizes = binary_tree_sizes(count, options.builder, profile);
  builder_->ensure(scratch.binary, "binary tree", sizes.nodes);
  builder_->ensure(scratch.node_ranges, "node ranges", sizes.groups + 2);
  builder_->ensure(scratch.arenas, "cluster arenas", sizes.arena_words);
  builder_->ensure(scratch.join_arena, "cluster arenas", sizes.join_arena_words);
  builder_->ensure(scratch.pending, "pending ranges", std::size_t{sizes.groups} * kSweepDepth);
  builder_->ensure(scratch.pending_count, "pending ranges", sizes.groups);
  builder_->ensure(scratch.root, "root", 1);
  const Arguments common =
      arguments(arg("count", count), arg("nodes", scratch.binary), arg("arenas", scratch.arenas),
                arg("arena_capacity", sizes.arena_capacity), arg("pending", scratch.pending),
                arg("pending_count", scratch.pending_count), arg("node_ranges", scratch.node_ranges));
  const Arguments sorted = arguments(common, arg("keys", scratch.keys), arg("index_bits", std::uint32_t{index_bits_}),
                                     arg("boxes", scratch.boxes));
  const Arguments limits = arguments(arg("limit", sizes.limit), arg("keep", sizes.keep));
  if (options.builder == TreeBuilder::quality) {
    launch(context, builder_->program_.kernel("bvh_cluster_chunks"), sizes.groups, arguments(sorted, limits));
  } else {
    launch(context, builder_->program_.kernel("bvh_radix_chunks"), sizes.groups, sorted);
  }
  launch(context, builder_->program_.kernel("bvh_join_chunks"), 1,
         arguments(common, limits, arg("join_arena", scratch.join_arena), arg("join_capacity", sizes.join_capacity),
                   arg("groups", sizes.groups), arg("root", scratch.root)));
  context.finish();
  builder_->release(scratch.keys);
  builder_->release(scratch.arenas);
  builder_->release(scratch.join_arena);
}

// The top is where clustering errs most, and where most rays pass.
void Accel::improve_top() {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  const BinaryTreeSizes sizes = binary_tree_sizes(statistics_.primitives, options_.builder, context.profile());
  if (sizes.top_nodes == 0) return;
  Program& program = builder_->top_program();
  const std::uint32_t capacity = 2 * sizes.top_nodes + 1;  // with the subtrees below them
  builder_->ensure(scratch.top, "top of the tree", capacity);
  builder_->ensure(scratch.totals, "tree totals", 4);
  const Arguments top = arguments(arg("top", scratch.top));
  const Arguments counted =
      arguments(top, arg("count", scratch.totals), arg("scale", entry_metric(statistics_.lo, statistics_.hi).x));
  const Arguments tree = arguments(arg("binary", scratch.binary), arg("root", scratch.root));
  launch(context, program.kernel("bvh_open_top"), 1,
         arguments(counted, tree, arg("primitives", statistics_.primitives), arg("lo", statistics_.lo),
                   arg("hi", statistics_.hi), arg("capacity", capacity)));
  for (std::uint32_t pass = 0; pass < kTopSweeps * kTopShares; pass++) {
    const Arguments share = arguments(counted, arg("first", pass % kTopShares), arg("stride", kTopShares));
    launch(context, program.kernel("bvh_find_places"), context.profile().chunks, share);
    launch(context, program.kernel("bvh_move_nodes"), 1, share);
  }
  launch(context, program.kernel("bvh_close_top"), 1,
         arguments(top, tree, arg("first", sizes.top_first), arg("node_ranges", scratch.node_ranges),
                   arg("range", sizes.groups + 1)));
}

void Accel::collapse(const DeviceScene& scene, const AccelOptions& options) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  Program& program = builder_->layout_program(layout_config());  // neither stack nor chunks are known yet
  const std::uint32_t count = statistics_.primitives;
  const BinaryTreeSizes sizes = binary_tree_sizes(count, options.builder, context.profile());
  const std::uint32_t target = std::clamp(count / kSmallChunk, 2U, context.profile().collapse_regions);
  const std::uint32_t most_regions = target + config_.width + 1;
  builder_->ensure(scratch.draft, "top of the tree", target * config_.node_words());
  builder_->ensure(scratch.totals, "tree totals", 4);
  regions_ = Buffer<shared::CollapseRegion>(context, "regions", most_regions);
  // The sorted order has become the binary tree: its memory holds the cut, and that of the boxes the costs.
  const Arguments tree = arguments(arg("binary", scratch.binary), arg("cuts", scratch.keys_other));
  const auto cut = [&](std::uint32_t first, std::uint32_t items) {
    launch(context, program.kernel("bvh_cut_ranges"), items,
           arguments(tree, arg("ranges", scratch.node_ranges), arg("first", first), arg("costs", scratch.boxes),
                     arg("metric", entry_metric(statistics_.lo, statistics_.hi)),
                     arg("max_leaf", std::uint32_t{options.max_leaf})));
  };
  cut(0, sizes.groups);
  cut(sizes.groups, 1);
  if (sizes.top_nodes > 0) cut(sizes.groups + 1, 1);
  const Arguments regions = arguments(tree, arg("regions", regions_));
  launch(context, program.kernel("bvh_collapse_top"), 1,
         arguments(regions, arg("draft_nodes", scratch.draft), arg("totals", scratch.totals), arg("root", scratch.root),
                   arg("primitives", count), arg("lo", statistics_.lo), arg("hi", statistics_.hi),
                   arg("target", target), arg("min_primitives", kSmallChunk), arg("most_nodes", target)));
  launch(context, program.kernel("bvh_count_regions"), most_regions, arguments(regions, arg("totals", scratch.totals)));
  launch(context, program.kernel("bvh_place_regions"), 1,
         arguments(arg("regions", regions_), arg("totals", scratch.totals), arg("first_node", first_node_),
                   arg("first_block", first_block_)));
  const std::vector<std::uint32_t> totals = scratch.totals.read(0, 4);
  builder_->release(scratch.boxes);
  region_count_ = totals[0];
  statistics_.nodes = totals[1];
  statistics_.blocks = totals[2];
  statistics_.references = count;
  statistics_.stack_depth = totals[3];
  config_.stack = stack_size_for(totals[3]);
  if (of_instances_) statistics_.blocks = 0;
  make_nodes(statistics_.nodes);
  make_blocks(statistics_.blocks);
  launch(context, builder_->layout_program(layout_config()).kernel("bvh_emit_regions"), region_count_,
         arguments(regions, scene.geometry_arguments(input_), arg("region_count", region_count_),
                   arg("of_instances", std::uint32_t{of_instances_}), arg("first_node", first_node_),
                   arg("first_block", first_block_), arg("draft_nodes", scratch.draft), nodes_.arguments(),
                   blocks_.arguments()));
  repeat_blocks();
  context.finish();
  builder_->release(scratch.binary);
  builder_->release(scratch.top);
  builder_->release(scratch.keys_other);
  builder_->release(scratch.draft);
}

void Accel::make_nodes(std::uint64_t count) {
  nodes_ = TreeChunks(*builder_->context_, "accel_nodes", count, {config_.node_words(), 0});
  config_.node_chunks = nodes_.layout();
}

void Accel::make_blocks(std::uint64_t count) {
  const unsigned blocks_a_leaf = (options_.max_leaf + options_.leaf_lanes - 1) / options_.leaf_lanes;
  blocks_ = TreeChunks(*builder_->context_, "accel_blocks", count, {config_.block_words(), blocks_a_leaf - 1});
  config_.block_chunks = blocks_.layout();
}

void Accel::repeat_blocks() {
  if (blocks_.has_repeats()) blocks_.repeat_first(*builder_->context_, builder_->copy_words());
}

// A tree without primitives: one node without children.
void Accel::make_empty() {
  Context& context = *builder_->context_;
  std::vector<float> node(config_.node_words(), 0.0F);
  const unsigned w = config_.width;
  for (unsigned i = 0; i < w; i++) {
    for (unsigned axis = 0; axis < 3; axis++) {
      node[(2 * axis) * w + i] = kInf;
      node[(2 * axis + 1) * w + i] = -kInf;
    }
    node[HR_NODE_CHILD_ROW * w + i] = std::bit_cast<float>(-1);
  }
  nodes_ = TreeChunks(Buffer<float>(context, "accel_nodes", std::span<const float>(node)));
  blocks_ = TreeChunks(Buffer<float>(context, "accel_blocks", config_.block_words()));
  statistics_.nodes = 1;
  statistics_.stack_depth = 1;
  config_.stack = stack_size_for(1);
}

void Accel::refit(const DeviceScene& scene) {
  if (config_.kind != AccelKind::bvh) {
    statistics_ = {};
    bound_primitives(scene);
    return build_cells(scene, options_);
  }
  if (!trees_.empty()) return refit_with_instances(scene);
  if (statistics_.primitives == 0) return;
  refit_tree(scene, input_, regions_, region_count_);
}

void Accel::refit_tree(const DeviceScene& scene, const TreeInput& input, const Buffer<shared::CollapseRegion>& regions,
                       std::uint32_t region_count) {
  Context& context = *builder_->context_;
  Kernel& kernel = builder_->layout_program(layout_config()).kernel("bvh_refit_regions");
  const auto run = [&](std::uint32_t first, std::uint32_t count) {
    launch(context, kernel, count,
           arguments(scene.geometry_arguments(input), arg("regions", regions), arg("first_region", first),
                     arg("region_count", first + count), nodes_.arguments(), blocks_.arguments()));
  };
  if (region_count > 1) run(1, region_count - 1);
  run(0, 1);
  repeat_blocks();
  context.finish();
}

AccelConfig Accel::layout_config() const {
  AccelConfig config = config_;
  config.stack = AccelConfig{}.stack;
  return config;
}

Arguments Accel::tree_arguments() const {
  Arguments all = arguments(nodes_.arguments(), blocks_.arguments());
  if (!trees_.empty()) all.push_back(arg("tree_roots", tree_roots_));
  return all;
}

ProgramOptions Accel::program_options(std::uint32_t features, bool strict, bool double_precision) const {
  AccelConfig config = config_;
  if (double_precision) config.explicit_vectors = false;
  return {features, strict, config.defines(), double_precision};
}

}  // namespace hemiray
