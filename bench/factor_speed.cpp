// How fast hemicubes see: rays through their cells beside Embree's packets of 16 on the same rays, in the room of the
// bars (`trace`); and patches drawn on their faces beside those rays, over patches and resolutions (`draw SCENE`). What
// each contender sees is compared before it counts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/program.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/build_info.hpp"
#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/bench/procedural_scenes.hpp"
#include "host/bench/processor.hpp"
#include "host/bench/report.hpp"
#include "host/bench/run.hpp"
#include "host/radiosity/hemicubes.hpp"
#include "host/scene/load.hpp"
#ifdef HR_HAS_EMBREE
#include "bench/peers/embree_peer.hpp"
#endif

namespace hemiray {
namespace {

using Json = nlohmann::ordered_json;
using Sides = std::vector<std::uint32_t>;

constexpr std::uint32_t kPacketEdge = 4;  // Embree's 16 rays are 4 x 4 cells
constexpr float kStart = 1e-7F;  // Embree takes denormal heights for none, and ROBUST then meets the ray's own patch
constexpr std::uint64_t kCellsAtOnce = 1'500'000;

/// Whoever says what the cells of hemicubes show.
struct Contender {
  std::string name;
  std::function<void()> look;
  std::function<Sides()> seen;
  std::vector<double> ms = {};
};

struct Result {
  std::string name;
  bench::Spread ms;
  double mrays = 0.0;   ///< cells per microsecond
  double differ = 0.0;  ///< share of cells that show another side than the first contender's
};

// Turns about, one before them to warm up; answers of the last are compared.
std::vector<Result> run(std::vector<Contender>& contenders, std::uint64_t cells, int rounds) {
  for (int round = 0; round <= rounds; round++) {
    for (Contender& one : contenders) {
      const double start = steady_ms();
      one.look();
      if (round > 0) one.ms.push_back(steady_ms() - start);
    }
  }
  std::vector<Result> results;
  const Sides reference = contenders.front().seen();
  for (const Contender& one : contenders) {
    const Sides seen = one.seen();
    if (seen.size() != cells || reference.size() != cells) throw std::logic_error("answers for other cells");
    std::size_t differ = 0;
    for (std::size_t i = 0; i < seen.size(); i++) differ += seen[i] != reference[i] ? 1 : 0;
    const bench::Spread ms = bench::spread_of(one.ms);
    results.push_back({one.name, ms, static_cast<double>(cells) / (1e3 * ms.median),
                       static_cast<double>(differ) / static_cast<double>(cells)});
  }
  return results;
}

Json to_json(const std::vector<Result>& results) {
  Json all;
  for (const Result& r : results) {
    all.push_back({{"name", r.name},
                   {"ms", {{"median", r.ms.median}, {"least", r.ms.least}, {"most", r.ms.most}, {"runs", r.ms.runs}}},
                   {"mcells_per_s", r.mrays},
                   {"differ", r.differ},
                   {"valid", r.differ <= bench::kMaxDisagreement}});
  }
  return all;
}

struct Device {
  explicit Device(const std::string& name)
      : context(choose_device(name)), parallel(context), builder(context, parallel) {}
  Context context;
  Parallel parallel;
  AccelBuilder builder;
};

/// A way of looking from `sides`, which must outlive it.
Contender hemicubes_of(Device& device, const PatchMesh& mesh, const HemicubeOptions& options, const Sides& sides) {
  const auto cubes = std::make_shared<Hemicubes>(device.context, device.parallel, device.builder, mesh, options);
  return {options.view == CubeView::raster ? "raster" : "rays", [cubes, &sides] { cubes->look_from(sides); },
          [cubes, &sides] { return cubes->look_from(sides).read(0, sides.size() * cubes->cells()); }};
}

// Fronts from all over the mesh.
Sides fronts_of(const PatchMesh& mesh, std::uint32_t resolution) {
  const std::uint64_t count = std::clamp<std::uint64_t>(kCellsAtOnce / (std::uint64_t{3} * resolution * resolution), 8,
                                                        std::uint64_t{mesh.patch_count()});
  Sides sides;
  for (std::uint64_t k = 0; k < count; k++) {
    sides.push_back(2 * static_cast<std::uint32_t>(k * mesh.patch_count() / count));
  }
  return sides;
}

#ifdef HR_HAS_EMBREE

DVec3 corner(const PatchMesh& mesh, std::uint32_t vertex) {
  const float* p = &mesh.flat.positions[std::size_t{3} * vertex];
  return {p[0], p[1], p[2]};
}

// Calls ray(cell, direction) for the cells of a hemicube over a front's middle, in tiles of 4 x 4; aligned with the
// first edge.
template <typename Ray>
void for_cells(const PatchMesh& mesh, std::uint32_t side, std::uint32_t n, const Ray& ray) {
  const shared::uint4 t = mesh.flat.triangles[side / 2];
  const shared::float4 front = mesh.normals[side / 2];
  const DVec3 normal(front.x, front.y, front.z), tangent = glm::normalize(corner(mesh, t.y) - corner(mesh, t.x)),
                                                 bitangent = glm::cross(normal, tangent);
  std::uint32_t first = 0;
  for (std::uint32_t face = 0; face < 5; face++) {
    const bool top = face == 0;
    const DVec3 out = top ? normal : (face < 3 ? tangent : bitangent) * (face % 2 == 1 ? 1.0 : -1.0),
                along = top || face > 2 ? tangent : bitangent, up = top ? bitangent : normal;
    const std::uint32_t rows = top ? n : n / 2;
    for (std::uint32_t i = 0; i < rows * n; i++) {
      const std::uint32_t tile = i / (kPacketEdge * kPacketEdge), at = i % (kPacketEdge * kPacketEdge),
                          across = n / kPacketEdge;
      const std::uint32_t x = tile % across * kPacketEdge + at % kPacketEdge,
                          y = tile / across * kPacketEdge + at / kPacketEdge;
      const double p = (x + 0.5) * 2.0 / n - 1.0, q = (y + 0.5) * 2.0 / n - (top ? 1.0 : 0.0);
      ray(first + y * n + x, along * p + up * q + out);
    }
    first += rows * n;
  }
}

// Where the device's rays start: off the patch by the bound of its middle's rounding (lib/offset.h).
DVec3 start_of(const PatchMesh& mesh, std::uint32_t side) {
  constexpr double kHalfUlp = 5.9604644775390625e-8;
  const shared::uint4 t = mesh.flat.triangles[side / 2];
  const DVec3 a = corner(mesh, t.x) / 3.0, b = corner(mesh, t.y) / 3.0, c = corner(mesh, t.z) / 3.0;
  const shared::float4 n = mesh.normals[side / 2];
  const DVec3 normal(n.x, n.y, n.z);
  const DVec3 error = (glm::abs(a) + glm::abs(b) + glm::abs(c)) * (7.0 * kHalfUlp);
  return a + b + c + normal * glm::dot(glm::abs(normal), error);
}

/// Embree's default tree, or its ROBUST form, in packets of 16 with the coherent hint.
Contender embree_of(const PatchMesh& mesh, const Sides& sides, std::uint32_t n, bool robust, unsigned threads) {
  struct Peer {
    std::unique_ptr<bench::Tracer> tracer;
    std::vector<std::size_t> cells;  ///< of the rays
    std::vector<DVec3> directions;
  };
  const auto peer = std::make_shared<Peer>();
  peer->tracer = bench::make_embree_peer({bench::EmbreeQuality::medium, robust, bench::EmbreeMode::sixteen, threads});
  peer->tracer->build(mesh.flat);
  std::vector<shared::QueryRay> rays;
  for (const std::uint32_t side : sides) {
    const DVec3 o = start_of(mesh, side);
    const std::size_t first = rays.size();
    for_cells(mesh, side, n, [&](std::uint32_t cell, const DVec3& d) {
      peer->cells.push_back(first + cell);
      peer->directions.push_back(d);
      rays.push_back({{static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z), kStart},
                      {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), INFINITY}});
    });
  }
  peer->tracer->load_rays(rays);
  return {peer->tracer->name(), [peer] { peer->tracer->intersect(); },
          [peer, &mesh] {
            const std::vector<shared::QueryHit> hits = peer->tracer->hits();
            Sides seen(hits.size(), HR_NO_SIDE);
            for (std::size_t i = 0; i < hits.size(); i++) {
              if (hits[i].primitive == HR_NO_PRIMITIVE) continue;
              const shared::float4 normal = mesh.normals[hits[i].primitive];
              const bool front = glm::dot(DVec3(normal.x, normal.y, normal.z), peer->directions[i]) < 0.0;
              seen[peer->cells[i]] = 2 * hits[i].primitive + (front ? 0U : 1U);
            }
            return seen;
          }};
}

#endif

std::string peer_name() {
#ifdef HR_HAS_EMBREE
  return "Embree " + bench::embree_version();
#else
  return "";
#endif
}

unsigned threads_of(const Context& context) { return static_cast<unsigned>(context.device().compute_units); }

bench::Machine machine_of(const Context& context, int rounds) {
  const bench::Processor processor = bench::this_processor();
  return {context.device().name,
          context.device().platform,
          context.device().driver,
          processor.name,
          processor.vector_class,
          threads_of(context),
          kVersion,
          kCommit,
          peer_name(),
          rounds};
}

void print(const std::vector<Result>& results) {
  for (const Result& r : results) {
    fmt::print("  {:<26}{:>9.1f} ms ({:.1f} to {:.1f}) {:>8.2f} Mcells/s {:>6.2f}  {}\n", r.name, r.ms.median,
               r.ms.least, r.ms.most, r.mrays, r.mrays / results.front().mrays,
               r.differ <= bench::kMaxDisagreement ? fmt::format("differs on {:.1e}", r.differ)
                                                   : fmt::format("INVALID: differs on {:.1e}", r.differ));
  }
  std::fflush(stdout);
}

Json measure(std::vector<Contender>& contenders, const PatchMesh& mesh, std::uint32_t n, std::size_t cubes,
             int rounds) {
  const std::vector<Result> results = run(contenders, std::uint64_t{3} * n * n * cubes, rounds);
  fmt::print("\n{} patches, {} hemicubes of {} x {}\n", mesh.patch_count(), cubes, n, n);
  print(results);
  return {{"patches", mesh.patch_count()}, {"resolution", n}, {"hemicubes", cubes}, {"results", to_json(results)}};
}

Json trace(Device& device, int rounds) {
  Json all;
  for (const std::uint32_t triangles : {250'000U, 1'000'000U}) {
    const bench::BenchScene scene = bench::procedural_scene("interior", triangles);
    PatchOptions uncut;
    uncut.edge_m = 1e6;
    const PatchMesh mesh = make_patch_mesh(scene.flat, uncut);
    for (const std::uint32_t n : {64U, 256U}) {
      const Sides sides = fronts_of(mesh, n);
      HemicubeOptions options;
      options.resolution = n;
      options.turned = false;
      std::vector<Contender> contenders;
#ifdef HR_HAS_EMBREE
      for (const bool robust : {false, true}) {
        contenders.push_back(embree_of(mesh, sides, n, robust, threads_of(device.context)));
      }
#endif
      contenders.push_back(hemicubes_of(device, mesh, options, sides));
      all.push_back(measure(contenders, mesh, n, sides.size(), rounds));
    }
  }
  return all;
}

Json draw(Device& device, const FlatScene& flat, int rounds) {
  Json all;
  for (const std::uint32_t patches : {300U, 1'000U, 4'000U, 16'000U, 64'000U}) {
    const PatchMesh mesh = make_patch_mesh(flat, {0.0, patches, 0.0});
    for (const std::uint32_t n : {16U, 64U, 256U}) {
      HemicubeOptions options;
      options.resolution = n;
      const Sides sides = fronts_of(mesh, n);
      options.batch_bytes = std::uint64_t{1} << 30U;  // all of them at once
      std::vector<Contender> contenders = {hemicubes_of(device, mesh, options, sides)};
      options.view = CubeView::raster;
      contenders.push_back(hemicubes_of(device, mesh, options, sides));
      all.push_back(measure(contenders, mesh, n, sides.size(), rounds));
    }
  }
  return all;
}

}  // namespace
}  // namespace hemiray

int main(int argc, char** argv) {
  using namespace hemiray;
  CLI::App app("How fast hemicubes see");
  app.require_subcommand(1);
  int rounds = 7;
  std::string json, device_name, scene;
  app.add_option("--rounds", rounds, "Timed rounds")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--json", json, "Write all figures as JSON")->type_name("FILE");
  app.add_option("--device", device_name, "Index, part of a name, cpu or gpu");
  CLI::App* tracing = app.add_subcommand("trace", "Rays beside Embree, in the room of 250k and 1M triangles");
  CLI::App* drawing = app.add_subcommand("draw", "Rasterised beside ray-cast, from 300 to 64,000 patches");
  drawing->add_option("SCENE", scene, "Such as bench/occluded_room.json")->required();
  return bench::run_program(app, argc, argv, [&] {
    if (!json.empty()) check_writable(json);
    FlatScene flat;
    if (drawing->parsed()) flat = flatten_scene(load_scene(scene));
    Device device(device_name);
    fmt::print("{}", bench::machine_table(machine_of(device.context, rounds)));
    Json report = {{"device", device.context.device().name}, {"commit", kCommit}, {"peer", peer_name()}};
    report["hemicubes"] = tracing->parsed() ? trace(device, rounds) : draw(device, flat, rounds);
    if (!json.empty()) write_file_atomically(json, report.dump(2) + "\n");
  });
}
