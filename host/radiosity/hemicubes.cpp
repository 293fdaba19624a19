#include "host/radiosity/hemicubes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/radiosity/hemicube_cells.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kTileWidth = 8;  // HR_TILE_WIDTH of radiosity/hemicube.cl
constexpr std::uint32_t kTileCellsWithoutPackets = 64;
constexpr std::uint32_t kPacketGroup = 16;
constexpr std::uint64_t kSumBytes = std::uint64_t{256} << 20U;  // for dense rows, at most
constexpr std::uint32_t kMostRowsABatch = 4096;

std::uint32_t tiles_of(std::uint32_t width, std::uint32_t height, std::uint32_t tile_height) {
  return ((width + kTileWidth - 1) / kTileWidth) * ((height + tile_height - 1) / tile_height);
}

ProgramOptions trace_options(const Context& context, const DeviceScene& scene, const Accel& accel) {
  ProgramOptions options = accel.program_options(scene.features(), false);
  options.defines += fmt::format(" -DHR_PACKET_GROUPS={}", context.profile().packet_groups);
  return options;
}

}  // namespace

void check_hemicube_options(const HemicubeOptions& options) {
  if (options.resolution < 8 || options.resolution > 1024 || options.resolution % 2 != 0) {
    throw InputError("hemicube", fmt::format("a resolution of {} cannot be had; take an even number from 8 to 1024",
                                             options.resolution));
  }
  if (options.view == CubeView::raster && options.jittered) {
    throw InputError(
        "hemicube",
        "what is drawn is seen through the middles of cells, which cannot be jittered; take rays, or cubes "
        "that are turned");
  }
  if (options.divisions < 1 || options.divisions > 16) {
    throw InputError("hemicube", fmt::format("{} divisions of a patch cannot be had; take 1 to 16", options.divisions));
  }
}

Hemicubes::Hemicubes(Context& context, Parallel& parallel, AccelBuilder& builder, const PatchMesh& mesh,
                     const HemicubeOptions& options)
    : context_(&context),
      parallel_(&parallel),
      mesh_(&mesh),
      options_(options),
      scene_(context, mesh.flat, HR_FEATURE_TRIANGLES),
      accel_(builder, scene_),
      rows_(context, "factor rows", {"radiosity/rows.cl"}, {}),
      normals_(context, "patch normals", std::span(mesh.normals)),
      reached_(context, "sides reached", mesh.side_count()) {
  check_hemicube_options(options);
  if (options.view == CubeView::raster) {
    raster_.emplace(context, mesh, options.resolution);
  } else {
    trace_.emplace(context, "hemicubes", std::vector<std::string>{"radiosity/hemicube.cl"},
                   trace_options(context, scene_, accel_));
  }
  std::vector<std::uint32_t> delta;
  for (const double cell : hemicube_cells(options.resolution)) {
    delta.push_back(static_cast<std::uint32_t>(std::llround(std::ldexp(cell, HR_CELL_UNITS_LOG2))));
  }
  delta_ = Buffer<std::uint32_t>(context, "hemicube cells", std::span<const std::uint32_t>(delta));
  reached_.clear();
  const std::uint64_t row_bytes = std::uint64_t{mesh.side_count()} * sizeof(std::uint64_t);
  const std::uint64_t most =
      std::max<std::uint64_t>(1, std::min(kSumBytes, context.device().max_allocation_bytes) / row_bytes);
  items_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, context.profile().chunks));
  sums_ = Buffer<std::uint64_t>(context, "dense rows", std::size_t{items_} * mesh.side_count());
  sums_.clear();
}

std::uint64_t Hemicubes::cells() const {
  return std::uint64_t{3} * options_.resolution * options_.resolution * options_.divisions * options_.divisions;
}

std::uint32_t Hemicubes::rows_a_batch() const {
  const std::uint64_t bytes = std::min(options_.batch_bytes, context_->device().max_allocation_bytes);
  const std::uint64_t rows = std::max<std::uint64_t>(1, bytes / (cells() * sizeof(std::uint32_t)));
  // A batch's entries fit one allocation even if every ray meets another side.
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(rows, kMostRowsABatch));
}

shared::HemicubeParams Hemicubes::params(std::size_t rows) const {
  shared::HemicubeParams cube{};
  cube.resolution = options_.resolution;
  cube.divisions = options_.divisions;
  cube.turned = options_.turned ? 1 : 0;
  cube.jittered = options_.jittered ? 1 : 0;
  cube.seed_key = options_.seed * 0x9E3779B9U;
  cube.row_count = static_cast<std::uint32_t>(rows);
  cube.side_count = mesh_->side_count();
  return cube;
}

void Hemicubes::trace(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube) {
  const std::uint32_t tile_height = accel_.config().has_packets()
                                        ? kPacketGroup * context_->profile().packet_groups / kTileWidth
                                        : kTileCellsWithoutPackets / kTileWidth;
  const std::uint32_t n = cube.resolution;
  const std::uint32_t tiles = tiles_of(n, n, tile_height) + 4 * tiles_of(n, n / 2, tile_height);
  const std::uint64_t cubes = std::uint64_t{cube.row_count} * cube.divisions * cube.divisions;
  launch(*context_, trace_->kernel("radiosity_trace_hemicubes"), cubes * tiles,
         arguments(scene_.shading_arguments(), accel_.tree_arguments(), arg("patch_normals", normals_),
                   arg("rows", rows), arg("seen", seen_), arg("cube", cube), arg("params", query_params(scene_))));
}

void Hemicubes::look(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube) {
  if (seen_.size() < cube.row_count * cells()) {
    seen_ = Buffer<std::uint32_t>();
    seen_ = Buffer<std::uint32_t>(*context_, "what hemicubes see", cube.row_count * cells());
  }
  if (raster_) {
    raster_->draw(rows, cube, seen_);
  } else {
    trace(rows, cube);
  }
  rays_ += cube.row_count * cells();
}

const Buffer<std::uint32_t>& Hemicubes::look_from(std::span<const std::uint32_t> sides) {
  if (sides.size() > rows_a_batch()) throw std::logic_error("more hemicubes than a batch holds");
  look(Buffer<std::uint32_t>(*context_, "sides", sides), params(sides.size()));
  context_->finish();  // before the list of sides goes
  return seen_;
}

void Hemicubes::add_rows(std::span<const std::uint32_t> sides, FactorMatrix& matrix,
                         const std::function<bool(std::uint64_t)>& on_batch) {
  matrix.side_count = mesh_->side_count();
  const std::uint32_t batch = rows_a_batch();
  for (std::size_t first = 0; first < sides.size(); first += batch) {
    const auto part = sides.subspan(first, std::min<std::size_t>(batch, sides.size() - first));
    FactorBlock block;
    block.row_count = static_cast<std::uint32_t>(part.size());
    block.rows = Buffer<std::uint32_t>(*context_, "factor rows", part);
    block.starts = Buffer<std::uint32_t>(*context_, "factor starts", part.size() + 1);
    const shared::HemicubeParams cube = params(part.size());
    look(block.rows, cube);
    launch(*context_, rows_.kernel("radiosity_count_row"), items_,
           arguments(arg("seen", seen_), arg("sums", sums_), arg("counts", block.starts), arg("reached", reached_),
                     arg("cube", cube)));
    parallel_->exclusive_scan(block.starts, block.row_count);
    block.entries = block.starts.read(block.row_count, 1).front();
    block.columns = Buffer<std::uint32_t>(*context_, "factor columns", block.entries);
    block.values = Buffer<float>(*context_, "factor values", block.entries);
    launch(*context_, rows_.kernel("radiosity_emit_row"), items_,
           arguments(arg("seen", seen_), arg("sums", sums_), arg("starts", block.starts), arg("delta", delta_),
                     arg("columns", block.columns), arg("values", block.values), arg("cube", cube)));
    rows_made_ += block.row_count;
    entries_ += block.entries;
    matrix.blocks.push_back(std::move(block));
    if (on_batch && !on_batch(first + part.size())) return;
  }
}

// As add_rows(), for rows that are there.
void Hemicubes::take_rows(std::span<const std::uint32_t> sides, const FactorBlock& block) {
  if (!std::ranges::equal(sides, block.rows.read())) throw InputError("form factors are of other sides");
  std::vector<std::uint32_t> reached = reached_.read();
  for (const std::uint32_t side : block.columns.read()) reached.at(side) = 1;
  reached_.write(reached);
  rows_made_ += block.row_count;
  entries_ += block.entries;
}

FactorMatrix Hemicubes::rows_reached_from(std::span<const std::uint32_t> sources,
                                          const std::function<bool(std::uint64_t, std::uint64_t)>& on_progress) {
  FactorMatrix matrix;
  add_rows_reached_from(sources, matrix, on_progress);
  return matrix;
}

void Hemicubes::add_rows_reached_from(std::span<const std::uint32_t> sources, FactorMatrix& matrix,
                                      const std::function<bool(std::uint64_t, std::uint64_t)>& on_progress) {
  const std::size_t kept = matrix.blocks.size();
  std::size_t block = 0;
  matrix.side_count = mesh_->side_count();
  // By face and side of it: a face is taken whole.
  std::vector<std::array<bool, 2>> wanted(mesh_->face_count, {false, false}), done = wanted;
  for (const std::uint32_t side : sources) wanted[mesh_->faces[side / 2]][side % 2] = true;
  std::uint64_t rows_done = 0;
  for (;;) {
    std::vector<std::uint32_t> next;
    for (std::uint32_t side = 0; side < mesh_->side_count(); side++) {
      const std::uint32_t face = mesh_->faces[side / 2];
      if (wanted[face][side % 2] && !done[face][side % 2]) next.push_back(side);
    }
    if (next.empty()) break;
    done = wanted;
    const std::uint32_t step = rows_a_batch();
    for (std::size_t first = 0; first < next.size(); first += step) {
      const std::size_t count = std::min<std::size_t>(step, next.size() - first);
      const auto part = std::span(next).subspan(first, count);
      if (block < kept) {
        take_rows(part, matrix.blocks[block]);
      } else {
        add_rows(part, matrix);
      }
      block++;
      rows_done += count;
      if (on_progress && !on_progress(rows_done, rows_done + next.size() - first - count)) return;
    }
    const std::vector<std::uint32_t> reached = reached_.read();
    for (std::uint32_t side = 0; side < mesh_->side_count(); side++) {
      if (reached[side] != 0) wanted[mesh_->faces[side / 2]][side % 2] = true;
    }
  }
}

}  // namespace hemiray
