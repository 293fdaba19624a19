#include "host/radiosity/solve_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/radiosity/solve_method.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kMostShots = 256, kMostRestart = 1000;

std::array<double, 3> rgb(const shared::float4& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

std::string name_of(const PatchMesh& mesh, std::uint32_t side) {
  return fmt::format("patch {} ({}) of object {}", side / 2, side % 2 == 0 ? "front" : "back",
                     mesh.flat.triangle_objects.empty() ? 0 : mesh.flat.triangle_objects[side / 2]);
}

void check_range(const char* option, std::uint32_t value, std::uint32_t most) {
  if (value < 1 || value > most) {
    throw InputError("radiosity", fmt::format("{} of {} cannot be had; take 1 to {}", option, value, most));
  }
}

}  // namespace

void check_solver_input(const PatchMesh& mesh, const SolveOptions& options) {
  check_range("shots an iteration", options.shots, kMostShots);
  check_range("restart", options.restart, kMostRestart);
  check_range("group", options.group, std::numeric_limits<std::uint32_t>::max());
  if (!(options.tolerance > 0.0) || !std::isfinite(options.tolerance)) {
    throw InputError("radiosity",
                     fmt::format("a tolerance of {} cannot be met; give a positive one", options.tolerance));
  }
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const auto rho = rgb(mesh.reflectance[s]), tau = rgb(mesh.transmittance[s]),
               other = rgb(mesh.transmittance[s ^ 1U]), e = rgb(mesh.emission[s]);
    for (std::size_t c = 0; c < 3; c++) {
      if (!(rho[c] >= 0.0 && tau[c] >= 0.0 && e[c] >= 0.0) || !std::isfinite(e[c])) {
        throw InputError("radiosity", fmt::format("{} reflects {}, transmits {}, emits {}: no number below 0 can be",
                                                  name_of(mesh, s), rho[c], tau[c], e[c]));
      }
      // Of what comes to a side, it reflects rho and passes the other side's tau; what it sends is rho and tau of two.
      if (!(rho[c] + std::max(tau[c], other[c]) < 1.0)) {
        throw InputError("radiosity", fmt::format("{} reflects {} and transmits {} of the light; below 1 is solvable",
                                                  name_of(mesh, s), rho[c], std::max(tau[c], other[c])));
      }
    }
  }
}

void check_rows(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix) {
  Program program = solver_program(context, matrix.precision(), context.device().has_fp64);
  Buffer<float> own(context, "own factors", mesh.side_count()), sums(context, "row sums", mesh.side_count()),
      least(context, "least factors", mesh.side_count());
  sums.clear();
  least.clear();
  for (const FactorBlock& block : matrix.blocks) {
    launch(context, program.kernel("radiosity_find_row_facts"), block.row_count,
           arguments(row_arguments(block), arg("row_count", block.row_count), arg("own", own), arg("sums", sums),
                     arg("least", least)));
  }
  const std::vector<float> sum = sums.read(), smallest = least.read();
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    if (!(smallest[s] >= 0.0F) || !std::isfinite(sum[s])) {
      throw InputError("radiosity", fmt::format("a form factor from {} is {}; factors are 0 or more", name_of(mesh, s),
                                                smallest[s] < 0.0F ? smallest[s] : sum[s]));
    }
    const auto rho = rgb(mesh.reflectance[s]), tau = rgb(mesh.transmittance[s]);
    for (std::size_t c = 0; c < 3; c++) {
      const double back = rho[c] * static_cast<double>(sum[s]) + tau[c] * static_cast<double>(sum[s ^ 1U]);
      if (back < 1.0) continue;
      throw InputError("radiosity",
                       fmt::format("the form factors of {} sum to {}, which with reflectance {} makes {} of the light "
                                   "come back: 1 or more has no solution",
                                   name_of(mesh, s), sum[s], rho[c], back));
    }
  }
}

double find_asymmetry(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, double enough) {
  Program program = solver_program(context, matrix.precision(), context.device().has_fp64);
  const Buffer<shared::float4> normals(context, "patch normals", std::span(mesh.normals));
  Buffer<shared::float2> largest(context, "largest exchange factors", context.profile().chunks);
  largest.clear();
  double asymmetry = 0.0;
  for (const FactorBlock& other : matrix.blocks) {
    std::vector<std::uint32_t> place(mesh.side_count(), HR_NO_SIDE);
    std::uint32_t first = mesh.side_count(), end = 0, k = 0;
    for (const std::uint32_t side : other.rows.read()) {
      place[side] = k++;
      first = std::min(first, side);
      end = std::max(end, side + 1);
    }
    const Buffer<std::uint32_t> places(context, "places of rows", std::span<const std::uint32_t>(place));
    for (const FactorBlock& block : matrix.blocks) {
      launch(context, program.kernel("radiosity_compare_transpose"), largest.size(),
             arguments(row_arguments(block), arg("row_count", block.row_count), arg("other_starts", other.starts),
                       arg("other_columns", other.columns), value_arguments(other, "other_values"),
                       arg("place", places), arg("other_first", first), arg("other_end", end), arg("normals", normals),
                       arg("largest", largest)));
    }
    double most = 0.0, apart = 0.0;
    for (const shared::float2& part : largest.read()) {
      most = std::max(most, static_cast<double>(part.x));
      apart = std::max(apart, static_cast<double>(part.y));
    }
    asymmetry = most > 0.0 ? apart / most : 0.0;
    if (asymmetry > enough) break;
  }
  return asymmetry;
}

bool is_translucent(const PatchMesh& mesh) {
  return std::any_of(mesh.transmittance.begin(), mesh.transmittance.end(),
                     [](const shared::float4& t) { return t.x > 0.0F || t.y > 0.0F || t.z > 0.0F; });
}

}  // namespace hemiray
