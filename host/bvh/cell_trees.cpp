#include "host/bvh/cell_trees.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "host/bvh/accel.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kCellWords = 24;     // sizeof(SpaceCell) and
constexpr std::size_t kVerdictWords = 12;  // sizeof(CellVerdict) of lib/space_cell.h
constexpr std::size_t kHeaderWords = 8;    // HR_CELL_HEADER_WORDS of lib/cell_layout.h
constexpr std::size_t kSums = 7;           // HR_CELL_SUMS
enum Sum : std::size_t { kNodes, kCells, kReferences, kLeafReferences, kBlocks, kRecords, kLeaves };

// 16 bits an axis tell 65,536 cells apart; with octants seven of which may wait at each, 128 entries are a stack.
constexpr unsigned kCellMortonBits = 48;
// A cell of at most max_leaf / kOwnShare box centres is not cut further: what else is in it comes from outside.
constexpr unsigned kOwnShare = 4;
// References a primitive from which on no cut may add any.
constexpr std::uint64_t kMostReferences = 10;
// Cells are taken as larger by this share of the scene's extent and of its largest coordinate (32 and 4 ulps), which
// covers what rounding does to rays, hits and overlap tests: a hit lies in a cell that lists its primitive.
constexpr float kExtentPad = 1.0F / (1U << 19U);
constexpr float kMagnitudePad = 1.0F / (1U << 22U);

float extent_of(const shared::float4& lo, const shared::float4& hi) {
  return std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
}

float magnitude_of(const shared::float4& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

std::size_t cell_node_words(AccelKind kind) { return kind == AccelKind::octree ? 12 : 4; }  // HR_CELL_NODE_WORDS

std::uint32_t total_of(const std::vector<std::uint32_t>& scanned, std::size_t counter, std::uint32_t groups) {
  return scanned[(counter + 1) * groups] - scanned[counter * groups];
}

// What a level leaves behind until everything is put in its place.
struct Level {
  Buffer<std::int32_t> results;  // what each cell became
  Buffer<float> draft_nodes;
  Buffer<shared::uint4> leaves;
  Buffer<std::uint32_t> leaf_references;
  Buffer<shared::uint2> records;
  std::uint32_t cells = 0, nodes = 0, leaf_count = 0, record_count = 0;
  std::uint32_t node_base = 0, record_base = 0;
};

class CellTreeBuild {
 public:
  CellTreeBuild(Context& context, Parallel& parallel, Program& program, const AccelConfig& config,
                const CellTreeInput& input)
      : context_(context),
        parallel_(parallel),
        program_(program),
        config_(config),
        input_(input),
        groups_(context.profile().chunks),
        parts_(config.kind == AccelKind::octree ? 8 : 2),
        unit_(extent_of(input.lo, input.hi)),
        pad_(unit_ * kExtentPad + std::max(magnitude_of(input.lo), magnitude_of(input.hi)) * kMagnitudePad),
        cells_(context, "cells", kCellWords),
        references_(context, "references", input.count),
        offsets_(context, "cell counts", 9 * std::size_t{groups_} + 1),
        sums_(context, "cell sums", kSums * groups_ + 1),
        depths_(context, "cell depths", groups_) {
    lo_ = {input.lo.x - pad_, input.lo.y - pad_, input.lo.z - pad_, 0.0F};
    hi_ = {input.hi.x + pad_, input.hi.y + pad_, input.hi.z + pad_, 0.0F};
  }

  CellTree run() {
    reference_count_ = input_.count;
    cell_count_ = 1;
    launch(context_, program_.kernel("bvh_start_cells"), groups_,
           arguments(arg("cells", cells_), arg("references", references_), arg("count", input_.count), arg("lo", lo_),
                     arg("hi", hi_)));
    while (cell_count_ > 0) {
      choose_planes();
      cut_cells();
    }
    return place();
  }

 private:
  Arguments keys() const {
    return arguments(arg("keys", input_.keys), arg("index_bits", std::uint32_t{input_.index_bits}),
                     arg("boxes", input_.boxes));
  }
  Arguments cells() const { return arguments(arg("cells", cells_), arg("cell_count", cell_count_)); }
  Arguments references() const {
    return arguments(arg("references", references_), arg("reference_count", reference_count_));
  }

  void choose_planes() {
    if (config_.kind == AccelKind::kdtree_median) return choose_medians();
    const shared::float4 grid_lo = {
        input_.centre_lo.x, input_.centre_lo.y, input_.centre_lo.z,
        std::ldexp(extent_of(input_.centre_lo, input_.centre_hi), -static_cast<int>(input_.axis_bits))};
    launch(context_, program_.kernel("bvh_choose_planes"), groups_,
           arguments(cells(), arg("grid_lo", grid_lo), arg("axis_bits", std::uint32_t{input_.axis_bits})));
  }

  void choose_medians() {
    launch(context_, program_.kernel("bvh_choose_longest_axes"), groups_, cells());
    launch(context_, program_.kernel("bvh_count_owned"), groups_, arguments(references(), arg("totals", offsets_)));
    parallel_.exclusive_scan(offsets_, groups_);
    const std::uint32_t owned = offsets_.read(groups_, 1).front();
    const Buffer<std::uint32_t> owned_first(context_, "owned references", std::size_t{cell_count_} + 1);
    const Buffer<std::uint32_t> place_cell(context_, "cells of primitives", input_.count);
    Buffer<std::uint64_t> centre_keys(context_, "box centres", owned), scratch(context_, "box centres", owned);
    launch(context_, program_.kernel("bvh_key_centres"), groups_,
           arguments(cells(), references(), keys(), arg("offsets", offsets_), arg("owned_first", owned_first),
                     arg("place_cell", place_cell), arg("centre_keys", centre_keys)));
    parallel_.sort(centre_keys, scratch, owned, input_.index_bits, 32);
    launch(context_, program_.kernel("bvh_key_cells"), groups_,
           arguments(arg("centre_keys", centre_keys), arg("count", owned),
                     arg("index_bits", std::uint32_t{input_.index_bits}), arg("place_cell", place_cell)));
    parallel_.sort(centre_keys, scratch, owned, input_.index_bits,
                   static_cast<unsigned>(std::bit_width(cell_count_ - 1)));
    launch(context_, program_.kernel("bvh_choose_medians"), groups_,
           arguments(cells(), keys(), arg("owned_first", owned_first), arg("centre_keys", centre_keys)));
    context_.finish();
  }

  // One level: marks, verdicts, and the next level's cells and references.
  void cut_cells() {
    const Buffer<std::uint8_t> marks(context_, "touched parts", reference_count_);
    const Buffer<std::uint32_t> prefix(context_, "cell counts", std::size_t{cell_count_} * (parts_ + 2));
    const Buffer<std::uint32_t> verdicts(context_, "verdicts", cell_count_ * kVerdictWords);
    launch(context_, program_.kernel("bvh_mark_references"), groups_,
           arguments(input_.scene.geometry_arguments(), keys(), cells(), references(), arg("pad", pad_),
                     arg("unit", unit_), arg("marks", marks), arg("prefix", prefix), arg("totals", offsets_)));
    parallel_.exclusive_scan(offsets_, (parts_ + 1) * groups_);
    const Arguments counts = arguments(arg("prefix", prefix), arg("offsets", offsets_));
    std::vector<std::uint32_t> sums = judge(counts, verdicts);
    const std::uint64_t most = kMostReferences * input_.count;
    if (!frugal_ && std::uint64_t{total_of(sums, kReferences, groups_)} + total_of(sums, kLeafReferences, groups_) +
                            leaf_references_ >
                        most) {
      frugal_ = true;
      sums = judge(counts, verdicts);
    }
    Level level = make_level(sums);
    const std::uint32_t next_count = total_of(sums, kCells, groups_);
    Buffer<std::uint32_t> next_cells(context_, "cells", next_count * kCellWords);
    Buffer<std::uint32_t> next_references(context_, "references", total_of(sums, kReferences, groups_));
    const Argument axis_bits = arg("axis_bits", std::uint32_t{input_.axis_bits});
    launch(context_, program_.kernel("bvh_emit_cells"), groups_,
           arguments(cells(), counts, arg("sums", sums_), arg("verdicts", verdicts), arg("next_cells", next_cells),
                     arg("draft_nodes", level.draft_nodes), arg("results", level.results), arg("leaves", level.leaves),
                     arg("records", level.records), axis_bits, arg("node_base", level.node_base),
                     arg("block_base", block_count_), arg("record_base", level.record_base)));
    launch(context_, program_.kernel("bvh_emit_references"), groups_,
           arguments(keys(), cells(), references(), arg("marks", marks), counts, arg("verdicts", verdicts), axis_bits,
                     arg("next_references", next_references), arg("leaf_references", level.leaf_references)));
    context_.finish();
    block_count_ += total_of(sums, kBlocks, groups_);
    leaf_references_ += total_of(sums, kLeafReferences, groups_);
    node_count_ += level.nodes;
    record_count_ += level.record_count;
    const std::vector<std::uint32_t> depths = depths_.read();
    depth_ = std::max(depth_, *std::max_element(depths.begin(), depths.end()));
    levels_.push_back(std::move(level));
    cells_ = std::move(next_cells);
    references_ = std::move(next_references);
    cell_count_ = next_count;
    reference_count_ = total_of(sums, kReferences, groups_);
  }

  std::vector<std::uint32_t> judge(const Arguments& counts, const Buffer<std::uint32_t>& verdicts) {
    launch(context_, program_.kernel("bvh_judge_cells"), groups_,
           arguments(cells(), counts, arg("max_leaf", std::uint32_t{input_.max_leaf}),
                     arg("max_owned", std::uint32_t{input_.max_leaf / kOwnShare}),
                     arg("frugal", std::uint32_t{frugal_ ? 1U : 0U}), arg("verdicts", verdicts), arg("sums", sums_),
                     arg("depths", depths_)));
    parallel_.exclusive_scan(sums_, static_cast<std::uint32_t>(kSums) * groups_);
    return sums_.read();
  }

  Level make_level(const std::vector<std::uint32_t>& sums) {
    Level level;
    level.cells = cell_count_;
    level.nodes = total_of(sums, kNodes, groups_);
    level.leaf_count = total_of(sums, kLeaves, groups_);
    level.record_count = total_of(sums, kRecords, groups_);
    level.node_base = node_count_;
    level.record_base = record_count_;
    level.results = Buffer<std::int32_t>(context_, "cell results", cell_count_);
    level.draft_nodes = Buffer<float>(context_, "draft nodes", level.nodes * cell_node_words(config_.kind));
    level.leaves = Buffer<shared::uint4>(context_, "leaves", level.leaf_count);
    level.leaf_references =
        Buffer<std::uint32_t>(context_, "leaf references", total_of(sums, kLeafReferences, groups_));
    level.records = Buffer<shared::uint2>(context_, "leaf records", level.record_count);
    return level;
  }

  CellTree place() {
    CellTree tree;
    tree.node_count = node_count_;
    tree.block_count = block_count_;
    tree.references = leaf_references_;
    tree.depth = depth_;
    const std::size_t records_at = kHeaderWords + node_count_ * cell_node_words(config_.kind);
    tree.nodes = Buffer<float>(context_, "accel_nodes", records_at + 2 * std::size_t{record_count_});
    tree.blocks = Buffer<float>(context_, "accel_blocks", block_count_ * config_.block_words());
    const Buffer<std::int32_t> none(context_, "cell results", 0);
    for (std::size_t i = levels_.size(); i-- > 0;) {
      const Level& level = levels_[i];
      const Buffer<std::int32_t>& next = i + 1 < levels_.size() ? levels_[i + 1].results : none;
      launch(context_, program_.kernel("bvh_place_cells"), groups_,
             arguments(arg("results", level.results), arg("cell_count", level.cells), arg("next_results", next),
                       arg("draft_nodes", level.draft_nodes), arg("node_count", level.nodes),
                       arg("node_base", level.node_base), arg("accel_nodes", tree.nodes)));
      launch(context_, program_.kernel("bvh_copy_records"), 1,
             arguments(arg("records", level.records), arg("count", level.record_count),
                       arg("at", static_cast<std::uint32_t>(records_at + 2 * std::size_t{level.record_base})),
                       arg("accel_nodes", tree.nodes)));
      launch(context_, program_.kernel("bvh_fill_leaves"), groups_,
             arguments(input_.scene.geometry_arguments(), arg("keys", input_.keys),
                       arg("index_bits", std::uint32_t{input_.index_bits}), arg("leaves", level.leaves),
                       arg("leaf_count", level.leaf_count), arg("leaf_references", level.leaf_references),
                       arg("accel_blocks", tree.blocks)));
    }
    launch(context_, program_.kernel("bvh_write_header"), 1,
           arguments(arg("accel_nodes", tree.nodes), arg("root", levels_.front().results), arg("lo", lo_),
                     arg("hi", hi_), arg("records_at", static_cast<std::uint32_t>(records_at))));
    context_.finish();
    return tree;
  }

  Context& context_;
  Parallel& parallel_;
  Program& program_;
  const AccelConfig& config_;
  const CellTreeInput& input_;
  std::uint32_t groups_, parts_;
  float unit_, pad_;  // [m]
  shared::float4 lo_{}, hi_{};
  Buffer<std::uint32_t> cells_, references_;  // of the level at hand
  Buffer<std::uint32_t> offsets_, sums_, depths_;
  std::vector<Level> levels_;
  std::uint32_t cell_count_ = 0, reference_count_ = 0;
  std::uint32_t node_count_ = 0, block_count_ = 0, record_count_ = 0, leaf_references_ = 0, depth_ = 0;
  bool frugal_ = false;
};

}  // namespace

CellTree build_cell_tree(Context& context, Parallel& parallel, Program& program, const AccelConfig& config,
                         const CellTreeInput& input) {
  return CellTreeBuild(context, parallel, program, config, input).run();
}

CellTree empty_cell_tree(Context& context, const AccelConfig& config) {
  std::array<float, kHeaderWords> header{};
  header[6] = std::bit_cast<float>(-1);  // HR_HEADER_ROOT: no child
  CellTree tree;
  tree.nodes = Buffer<float>(context, "accel_nodes", std::span<const float>(header));
  tree.blocks = Buffer<float>(context, "accel_blocks", config.block_words());
  return tree;
}

Program& AccelBuilder::cell_program(const AccelConfig& config) {
  const std::string defines = config.defines();
  const auto found = cell_programs_.find(defines);
  if (found != cell_programs_.end()) return found->second;
  return cell_programs_
      .emplace(defines, Program(*context_, "cells", {"bvh/cell_planes.cl", "bvh/cell_marks.cl", "bvh/cell_emit.cl"},
                                ProgramOptions{0, false, defines}))
      .first->second;
}

void Accel::build_cells(const DeviceScene& scene, const AccelOptions& options) {
  Context& context = *builder_->context_;
  AccelBuilder::Scratch& scratch = builder_->scratch_;
  config_.stack = AccelConfig{}.stack;
  CellTree tree;
  if (statistics_.primitives == 0) {
    tree = empty_cell_tree(context, config_);
  } else {
    AccelOptions finer = options;
    finer.morton_bits = std::min(options.morton_bits != 0 ? options.morton_bits : kCellMortonBits, kCellMortonBits);
    sort_primitives(finer);
    const CellTreeInput input = {scene,           scratch.boxes,
                                 scratch.keys,    statistics_.primitives,
                                 index_bits_,     statistics_.morton_bits / 3,
                                 statistics_.lo,  statistics_.hi,
                                 centroid_lo_,    centroid_hi_,
                                 options.max_leaf};
    tree = build_cell_tree(context, *builder_->parallel_, builder_->cell_program(config_), config_, input);
    builder_->release(scratch.keys);
    builder_->release(scratch.keys_other);
    builder_->release(scratch.boxes);
  }
  nodes_ = TreeChunks(std::move(tree.nodes));
  blocks_ = TreeChunks(std::move(tree.blocks));
  statistics_.nodes = tree.node_count;
  statistics_.blocks = tree.block_count;
  statistics_.references = tree.references;
  statistics_.depth = tree.depth;
  statistics_.stack_depth = (options.kind == AccelKind::octree ? 7 : 1) * tree.depth + 1;
}

}  // namespace hemiray
