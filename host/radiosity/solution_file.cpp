#include "host/radiosity/solution_file.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/base/archive.hpp"
#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/base/section_file.hpp"
#include "host/radiosity/solution_key.hpp"

namespace hemiray {
namespace {

constexpr SectionFileKind kKind{"solution", 2};
constexpr double kRestShare = 10.0;  // times what a write took passes at least before the next

// Places, what patches are cut from, and what their sides reflect, pass and send.
std::vector<std::uint8_t> mesh_bytes(PatchMesh mesh) {
  Archive archive;
  archive.list(mesh.flat.positions);
  archive.list(mesh.flat.triangles);
  archive.list(mesh.faces);
  archive.list(mesh.normals);
  for (auto* columns : {&mesh.reflectance, &mesh.transmittance, &mesh.emission}) archive.list(*columns);
  return archive.take();
}

std::vector<std::uint8_t> block_bytes(const FactorBlock& block) {
  Archive archive;
  const auto add = [&archive](const auto& buffer) {
    auto elements = buffer.read();
    archive.list(elements);
  };
  add(block.rows);
  add(block.starts);
  add(block.columns);
  add(block.row_scales);
  if (block.is_rounded()) {
    add(block.halves);
  } else {
    add(block.values);
  }
  auto changes = block.changes;
  archive.list(changes);
  return archive.take();
}

FactorBlock block_from(Context& context, std::span<const std::uint8_t> bytes) {
  Archive archive(bytes);
  FactorBlock block;
  const auto take = [&](const char* name, auto& buffer) {
    auto elements = buffer.read(0, 0);
    archive.list(elements);
    buffer = {context, name, std::span(std::as_const(elements))};
  };
  take("factor rows", block.rows);
  take("factor starts", block.starts);
  take("factor columns", block.columns);
  take("factor scales", block.row_scales);
  if (block.is_rounded()) {
    take("factor values", block.halves);
  } else {
    take("factor values", block.values);
    block.row_scales = {};
  }
  archive.list(block.changes);
  archive.end();
  block.row_count = static_cast<std::uint32_t>(block.rows.size());
  block.entries = static_cast<std::uint32_t>(block.columns.size());
  const std::size_t rounded = block.is_rounded() ? block.rows.size() : 0;
  if (block.starts.size() != block.rows.size() + 1 || block.values.size() + block.halves.size() != block.entries ||
      block.row_scales.size() != rounded || block.changes.size() != rounded) {
    Archive::fail();
  }
  return block;
}

}  // namespace

SolutionFile::SolutionFile(Context& context, const KeepOptions& options, std::string key, const PatchMesh& mesh)
    : options_(options), key_(std::move(key)) {
  state_.factors.side_count = mesh.side_count();
  if (options_.file.empty()) return;
  mesh_ = mesh_bytes(mesh);
  if (!options_.resume) {
    offer(true, state_.stage, 0, state_.factors, {});
    return;
  }
  try {
    read(context);
  } catch (const InputError& error) {
    throw InputError(options_.file,
                     fmt::format("{}; it is left as it is, and --save with another name starts anew", error.what()));
  }
  next_ms_ = steady_ms() + 1e3 * options_.every_s;
}

void SolutionFile::read(Context& context) {
  SectionReader reader(options_.file, kKind);
  const auto expect = [&reader](const char* name) {
    SectionReader::Section section = reader.next();
    if (section.name != name) Archive::fail();
    return std::move(section.bytes);
  };
  const std::vector<std::uint8_t> key = expect("key");
  const std::string difference = difference_of_keys({key.begin(), key.end()}, key_);
  if (!difference.empty()) {
    throw InputError(
        fmt::format("was saved with other input, so that other bits would come out: {}; give the same to "
                    "go on",
                    difference));
  }
  if (expect("mesh") != mesh_) throw InputError("has another mesh than the scene gives here");
  const std::vector<std::uint8_t> head = expect("factors");
  Archive archive(head);
  std::uint64_t blocks = 0;
  archive.value(state_.stage);
  archive.value(state_.expected_factor_bytes);
  archive.value(blocks);
  archive.end();
  for (std::uint64_t b = 0; b < blocks; b++) {
    state_.factors.blocks.push_back(block_from(context, expect("block")));
  }
  state_.solver = expect("solver");
  expect("end");
}

void SolutionFile::offer(bool must, FactorStage stage, std::uint64_t expected_factor_bytes, const FactorMatrix& factors,
                         const std::function<std::vector<std::uint8_t>()>& solver) {
  const double start = steady_ms();
  if (options_.file.empty() || (!must && start < next_ms_)) return;
  SectionWriter writer(options_.file, kKind);
  writer.add("key", {reinterpret_cast<const std::uint8_t*>(key_.data()), key_.size()});
  writer.add("mesh", mesh_);
  Archive head;
  std::uint64_t blocks = factors.blocks.size();
  head.value(stage);
  head.value(expected_factor_bytes);
  head.value(blocks);
  writer.add("factors", head.take());
  for (const FactorBlock& block : factors.blocks) writer.add("block", block_bytes(block));
  writer.add("solver", solver ? solver() : std::vector<std::uint8_t>{});
  writer.commit();
  const double end = steady_ms();
  next_ms_ = end + std::max(1e3 * options_.every_s, kRestShare * (end - start));
}

}  // namespace hemiray
