// Form factors of an occluded room: how long they take and how far off rows are, beside rays from each patch (uniform
// Monte Carlo and quasi-Monte Carlo) in equal time. Usage: factor_accuracy [PATCHES] [ROWS] [RAYS] [ACCURACY] [FEW]
//
// The oracle of a sample of rows: the exchange of a pair with nothing in the way times its visibility by 256 points of
// a four-dimensional sequence, and 16384 where these disagree. Its kernel without obstacles is checked against
// cubature by the tests.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "host/base/clock.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/radiosity/form_factors.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kOracleFew = 256, kOracleMany = 16384;
constexpr float kRayEnds = 1e-5F;

struct Room {
  FlatScene flat;

  std::uint32_t vertex(Vec3 p) {
    flat.positions.insert(flat.positions.end(), {p.x, p.y, p.z});
    return static_cast<std::uint32_t>(flat.positions.size() / 3 - 1);
  }
  void quad(Vec3 corner, Vec3 u, Vec3 v) {
    const std::uint32_t a = vertex(corner), b = vertex(corner + u), c = vertex(corner + u + v), d = vertex(corner + v);
    flat.triangles.push_back({a, b, c, 0});
    flat.triangles.push_back({a, c, d, 0});
    flat.triangle_objects.insert(flat.triangle_objects.end(), 2, 0);
  }
  // Six faces, turned by `angle` about the vertical through the middle; seen from outside, or from inside.
  void box(Vec3 middle, Vec3 half, float angle, bool inside) {
    const float c = std::cos(angle), s = std::sin(angle);
    const Vec3 x = Vec3(c, 0, s) * (2 * half.x), y(0, 2 * half.y, 0), z = Vec3(-s, 0, c) * (2 * half.z);
    const Vec3 o = middle - (x + y + z) * 0.5F;
    const auto face = [&](Vec3 corner, Vec3 u, Vec3 v) { inside ? quad(corner, v, u) : quad(corner, u, v); };
    face(o, z, y);
    face(o + x, y, z);
    face(o, x, z);
    face(o + y, z, x);
    face(o, y, x);
    face(o + z, x, y);
  }
};

// 5 x 3 x 4 m with a table top on a pillar, two cupboards and a hanging box, none touching another.
FlatScene occluded_room() {
  Room room;
  shared::Material grey{};
  grey.kd = {0.5F, 0.5F, 0.5F, 0.0F};
  grey.kd_texture = grey.metallic_roughness_texture = grey.emission_texture = grey.normal_texture = HR_NO_TEXTURE;
  room.flat.materials.push_back(grey);
  room.box(Vec3(2.5F, 1.5F, 2.0F), Vec3(2.5F, 1.5F, 2.0F), 0.0F, true);
  room.box(Vec3(2.31F, 0.78F, 1.87F), Vec3(0.7F, 0.03F, 0.45F), 0.3F, false);
  room.box(Vec3(2.31F, 0.37F, 1.87F), Vec3(0.12F, 0.33F, 0.12F), 0.3F, false);
  room.box(Vec3(0.52F, 1.05F, 3.11F), Vec3(0.3F, 0.93F, 0.5F), 0.1F, false);
  room.box(Vec3(4.21F, 0.61F, 0.83F), Vec3(0.45F, 0.5F, 0.4F), -0.4F, false);
  room.box(Vec3(3.43F, 2.37F, 2.71F), Vec3(0.25F, 0.2F, 0.25F), 0.7F, false);
  return room.flat;
}

struct Tracer {
  const PatchMesh& mesh;
  RayQueries queries;

  [[nodiscard]] DVec3 corner(std::uint32_t side, int k) const {
    const shared::uint4 t = mesh.flat.triangles[side / 2];
    const float* p = &mesh.flat.positions[std::size_t{3} * (k == 0 ? t.x : (k == 1 ? t.y : t.z))];
    return {p[0], p[1], p[2]};
  }
  [[nodiscard]] DVec3 normal(std::uint32_t side) const {
    const shared::float4& n = mesh.normals[side / 2];
    return DVec3(n.x, n.y, n.z) * (side % 2 == 0 ? 1.0 : -1.0);
  }
  [[nodiscard]] DVec3 point(std::uint32_t side, double u, double v) const {
    const double r = std::sqrt(u);
    return corner(side, 0) * (1.0 - r) + corner(side, 1) * (r * (1.0 - v)) + corner(side, 2) * (r * v);
  }
};

shared::QueryRay ray_to(const DVec3& from, const DVec3& d, float end) {
  return {{static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(from.z), kRayEnds},
          {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), end}};
}

// frac(start + k phi^-(d+1)), phi^(dimensions + 1) = phi + 1 (Roberts 2018).
double sequence(double start, std::uint64_t k, int dimension, double phi) {
  const double x = start + static_cast<double>(k + 1) * std::pow(phi, -(dimension + 1));
  return x - std::floor(x);
}

constexpr double kPhi4 = 1.1673039782614187;

// What of the exchange between i and each of `js` gets through, by `rays` rays each.
std::vector<double> shares_of(Tracer& tracer, std::uint32_t i, const std::vector<std::uint32_t>& js, std::uint32_t rays,
                              std::mt19937_64& random) {
  constexpr std::size_t kRaysAtOnce = 1U << 20U;
  const std::size_t step = std::max<std::size_t>(1, kRaysAtOnce / rays);
  std::vector<double> shares;
  std::uniform_real_distribution<double> unit;
  const DVec3 ni = tracer.normal(i);
  for (std::size_t first = 0; first < js.size(); first += step) {
    const std::size_t count = std::min(step, js.size() - first);
    std::vector<shared::QueryRay> all;
    std::vector<double> weights;
    for (std::size_t n = 0; n < count; n++) {
      const std::uint32_t j = js[first + n];
      const DVec3 nj = tracer.normal(j);
      double start[4];
      for (double& s : start) s = unit(random);
      for (std::uint32_t k = 0; k < rays; k++) {
        double x[4];
        for (int d = 0; d < 4; d++) x[d] = sequence(start[d], k, d, kPhi4);
        const DVec3 p = tracer.point(i, x[0], x[1]), d = tracer.point(j, x[2], x[3]) - p;
        const double r2 = glm::dot(d, d);
        weights.push_back(std::max(0.0, glm::dot(ni, d)) * std::max(0.0, -glm::dot(nj, d)) / (r2 * r2));
        all.push_back(ray_to(p, d, 1.0F - kRayEnds));
      }
    }
    const std::vector<std::uint32_t> blocked = tracer.queries.occluded(all);
    for (std::size_t n = 0; n < count; n++) {
      double sum = 0.0, through = 0.0;
      for (std::size_t k = n * rays; k < (n + 1) * rays; k++) {
        sum += weights[k];
        through += blocked[k] != 0 ? 0.0 : weights[k];
      }
      shares.push_back(sum > 0.0 ? through / sum : 0.0);
    }
  }
  return shares;
}

using Row = std::vector<double>;  // F by side

Row oracle_row(Tracer& tracer, std::uint32_t i, const FactorRow& open, std::mt19937_64& random) {
  std::vector<std::uint32_t> js, mixed;
  for (const auto& [j, exchange] : open) js.push_back(j);
  std::vector<double> shares = shares_of(tracer, i, js, kOracleFew, random);
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < js.size(); n++) {
    if (shares[n] > 0.0 && shares[n] < 1.0) {
      mixed.push_back(js[n]);
      places.push_back(n);
    }
  }
  const std::vector<double> better = shares_of(tracer, i, mixed, kOracleMany, random);
  for (std::size_t n = 0; n < mixed.size(); n++) shares[places[n]] = better[n];
  Row row(tracer.mesh.side_count(), 0.0);
  const auto area = static_cast<double>(tracer.mesh.normals[i / 2].w);
  for (std::size_t n = 0; n < js.size(); n++) row[js[n]] = static_cast<double>(open[n].second) * shares[n] / area;
  return row;
}

// Rays leave i with the cosine's density; each brings the side it meets 1 / rays.
Row ray_row(Tracer& tracer, std::uint32_t i, std::uint64_t rays, bool quasi, std::mt19937_64& random, double& ms) {
  Row row(tracer.mesh.side_count(), 0.0);
  std::uniform_real_distribution<double> unit;
  const DVec3 n = tracer.normal(i), t = glm::normalize(tracer.corner(i, 1) - tracer.corner(i, 0)), b = glm::cross(n, t);
  double start[4];
  for (double& s : start) s = unit(random);
  std::vector<shared::QueryRay> all;
  for (std::uint64_t k = 0; k < rays; k++) {
    double x[4];
    for (int d = 0; d < 4; d++) x[d] = quasi ? sequence(start[d], k, d, kPhi4) : unit(random);
    const double r = std::sqrt(x[2]), a = 2.0 * std::numbers::pi * x[3];
    const DVec3 d = t * (r * std::cos(a)) + b * (r * std::sin(a)) + n * std::sqrt(1.0 - x[2]);
    all.push_back(ray_to(tracer.point(i, x[0], x[1]), d, INFINITY));
  }
  const double begin = steady_ms();
  const std::vector<shared::QueryHit> hits = tracer.queries.intersect(all);
  ms += steady_ms() - begin;
  for (std::uint64_t k = 0; k < rays; k++) {
    if (hits[k].primitive == HR_NO_PRIMITIVE) continue;
    const std::uint32_t front = 2 * hits[k].primitive;
    const DVec3 d(all[k].direction.x, all[k].direction.y, all[k].direction.z);
    row[front + (glm::dot(d, tracer.normal(front)) < 0.0 ? 0 : 1)] += 1.0 / static_cast<double>(rays);
  }
  return row;
}

struct Errors {
  double l1 = 0.0, p95 = 0.0;
};

// L1 of the rows on average; 95th percentile of the relative error of the pairs that carry 99 % of the energy.
Errors errors_of(const std::vector<Row>& got, const std::vector<Row>& exact) {
  Errors errors;
  std::vector<double> relative;
  for (std::size_t r = 0; r < got.size(); r++) {
    std::vector<std::size_t> order;
    double sum = 0.0;
    for (std::size_t j = 0; j < exact[r].size(); j++) {
      errors.l1 += std::abs(got[r][j] - exact[r][j]) / static_cast<double>(got.size());
      if (exact[r][j] > 0.0) order.push_back(j);
      sum += exact[r][j];
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return exact[r][a] > exact[r][b]; });
    double carried = 0.0;
    for (const std::size_t j : order) {
      if (carried >= 0.99 * sum) break;
      carried += exact[r][j];
      relative.push_back(std::abs(got[r][j] - exact[r][j]) / exact[r][j]);
    }
  }
  std::sort(relative.begin(), relative.end());
  if (!relative.empty()) errors.p95 = relative[relative.size() * 95 / 100];
  return errors;
}

void print(const std::string& name, double seconds, const Errors& e) {
  fmt::print("{:<28} {:8.2f} s   row error L1 {:.2e}   p95 {:6.2f} %\n", name, seconds, e.l1, 100.0 * e.p95);
}

std::vector<Row> rows_of(const FactorMatrix& matrix, const std::vector<std::uint32_t>& sample) {
  std::vector<Row> rows(sample.size(), Row(matrix.side_count, 0.0));
  for (const FactorBlock& block : matrix.blocks) {
    const std::vector<std::uint32_t> sides = block.rows.read(), starts = block.starts.read();
    for (std::uint32_t k = 0; k < sides.size(); k++) {
      const auto at = std::find(sample.begin(), sample.end(), sides[k]);
      if (at == sample.end()) continue;
      const std::vector<std::uint32_t> columns = block.columns.read(starts[k], starts[k + 1] - starts[k]);
      const std::vector<float> values = block.values.read(starts[k], starts[k + 1] - starts[k]);
      Row& row = rows[static_cast<std::size_t>(at - sample.begin())];
      for (std::size_t e = 0; e < columns.size(); e++) row[columns[e]] = static_cast<double>(values[e]);
    }
  }
  return rows;
}

// Exchange of the sampled sides with all others, nothing in the way.
std::vector<FactorRow> open_rows(Context& context, Parallel& parallel, const PairSides& sides,
                                 const std::vector<std::uint32_t>& sample) {
  PairVisibility all;
  const std::vector<std::uint32_t> ones(std::size_t{sides.stride} * sides.stride / 32, 0xFFFFFFFFU);
  all.visible = Buffer<std::uint32_t>(context, "visible", std::span<const std::uint32_t>(ones));
  all.partial = Buffer<std::uint32_t>(context, "partial", ones.size());
  all.partial.clear();
  all.starts = Buffer<std::uint32_t>(context, "starts", sides.count + std::size_t{1});
  all.starts.clear();
  all.columns = Buffer<std::uint32_t>(context, "columns", 1);
  all.shares = Buffer<float>(context, "shares", 1);
  all.errors = Buffer<float>(context, "errors", 1);
  const FactorMatrix matrix = make_pair_factors(context, parallel, sides, all).matrix;
  std::vector<FactorRow> rows;
  for (const Row& row : rows_of(matrix, sample)) {
    FactorRow entries;
    for (std::uint32_t j = 0; j < row.size(); j++) {
      if (row[j] > 0.0) entries.emplace_back(j, static_cast<float>(row[j]));
    }
    rows.push_back(std::move(entries));
  }
  return rows;
}

// Since the program began, which compiled for a small room.
void print_kernels(Context& context) {
  context.profiler().collect();
  std::vector<StageTime> stages = context.profiler().stages();
  std::sort(stages.begin(), stages.end(),
            [](const StageTime& a, const StageTime& b) { return a.milliseconds > b.milliseconds; });
  stages.resize(std::min<std::size_t>(stages.size(), 10));
  for (const StageTime& s : stages) fmt::print("  {:<32} {:8.2f} s\n", s.name, 1e-3 * s.milliseconds);
}

int run(std::uint32_t patches, std::uint32_t row_count, const VisibilityOptions& rays) {
  Context context(choose_device(""));
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const PatchMesh mesh = make_patch_mesh(occluded_room(), {0.0, patches, 0.0});
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) fronts.push_back(2 * i);
  FactorOptions options;
  options.hemicube.resolution = kReachResolution;
  options.visibility = rays;
  const auto compute = [&](FactorReport& report, double& seconds, double& cpu) {
    Hemicubes hemicubes(context, parallel, builder, mesh, options.hemicube);
    const double begin = steady_ms();
    const std::clock_t cpu_begin = std::clock();
    FactorMatrix matrix = make_form_factors_of(context, parallel, mesh, hemicubes, fronts, options, report);
    context.finish();
    seconds = 1e-3 * (steady_ms() - begin);
    cpu = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
    return matrix;
  };
  {  // compiles the kernels
    const PatchMesh small = make_patch_mesh(occluded_room(), {0.0, 300, 0.0});
    Hemicubes hemicubes(context, parallel, builder, small, options.hemicube);
    FactorReport report;
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < small.patch_count(); i++) some.push_back(2 * i);
    make_form_factors_of(context, parallel, small, hemicubes, some, options, report);
  }
  std::mt19937_64 random(1);
  std::vector<std::uint32_t> sample;
  for (std::uint32_t r = 0; r < row_count; r++) {
    sample.push_back(2 * static_cast<std::uint32_t>(random() % mesh.patch_count()));
  }
  FactorReport report;
  double seconds = 0.0, cpu = 0.0;
  std::vector<Row> hybrid, exact;
  {
    const FactorMatrix matrix = compute(report, seconds, cpu);
    hybrid = rows_of(matrix, sample);
  }
  fmt::print("{} patches, {} pairs exchange light, {} partly hidden, {} close or cut; {} + {} + {} rays\n",
             mesh.patch_count(), report.pairs, report.partial_pairs, report.near_pairs, report.cube_rays,
             report.pair_rays, report.sample_rays);
  fmt::print("seconds: hemicubes {:.2f}, visibility {:.2f}, partly hidden {:.2f}, factors {:.2f}, rows {:.2f}\n",
             1e-3 * report.cubes_ms, 1e-3 * report.visibility_ms, 1e-3 * report.sample_ms, 1e-3 * report.pairs_ms,
             1e-3 * report.enforce_ms);
  fmt::print("processor time {:.2f} s: what a machine without other work takes, times its cores\n", cpu);
  fmt::print("stated: geometry {:.1e}, sampling {:.1e}, closure {:.1e} before and {:.1e} after {} sweeps\n",
             report.row_errors.geometry, report.row_errors.sampling, report.enforcement->mean_before,
             report.enforcement->mean_after, report.enforcement->sweeps);
  print_kernels(context);
  Hemicubes hemicubes(context, parallel, builder, mesh, options.hemicube);
  Tracer tracer{mesh, RayQueries(context, hemicubes.scene(), hemicubes.accel())};
  const std::vector<FactorRow> open = open_rows(context, parallel, PairSides(context, mesh, fronts), sample);
  for (std::size_t r = 0; r < sample.size(); r++) exact.push_back(oracle_row(tracer, sample[r], open[r], random));
  print("hybrid", seconds, errors_of(hybrid, exact));
  for (const bool quasi : {false, true}) {
    double probe_ms = 0.0;
    constexpr std::uint64_t kProbe = 1U << 18U;
    ray_row(tracer, sample[0], kProbe, quasi, random, probe_ms);
    probe_ms = 0.0;
    ray_row(tracer, sample[0], kProbe, quasi, random, probe_ms);
    const auto rays_a_patch =
        static_cast<std::uint64_t>(1e3 * seconds / mesh.patch_count() * static_cast<double>(kProbe) / probe_ms);
    std::vector<Row> rows;
    double ms = 0.0;
    for (const std::uint32_t i : sample) rows.push_back(ray_row(tracer, i, rays_a_patch, quasi, random, ms));
    print(fmt::format("{} {} rays", quasi ? "quasi-Monte Carlo" : "Monte Carlo", rays_a_patch),
          1e-3 * ms * mesh.patch_count() / static_cast<double>(sample.size()), errors_of(rows, exact));
  }
  return 0;
}

}  // namespace
}  // namespace hemiray

int main(int argc, char** argv) {
  const auto number = [&](int k, std::uint32_t otherwise) {
    return argc > k ? static_cast<std::uint32_t>(std::strtoul(argv[k], nullptr, 10)) : otherwise;
  };
  try {
    return hemiray::run(number(1, 14000), number(2, 8),
                        {number(5, 16), number(3, 1024), argc > 4 ? std::strtod(argv[4], nullptr) : 0.001, 0});
  } catch (const std::exception& error) {
    std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
    return 1;
  }
}
