// The radiosity system's buffers on the device, and what solvers that have the matrix do with them.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "host/radiosity/solve_method.hpp"

namespace hemiray {

template <typename Real>
constexpr bool is_double = sizeof(Real) == sizeof(double);

/// Four columns of the device's `real`.
template <typename Real>
struct alignas(4 * sizeof(Real)) Real4 {
  Real v[4];
};

/// A sum of the device (radiosity/wide_sum.h): four doubles, or four floats and what they lack.
template <typename Real>
struct WideSum;
template <>
struct WideSum<double> {
  double v[4];
  [[nodiscard]] double value(std::size_t c) const { return v[c]; }
};
template <>
struct WideSum<float> {
  float high[4], low[4];
  [[nodiscard]] double value(std::size_t c) const { return static_cast<double>(high[c]) + static_cast<double>(low[c]); }
};

/// What one addition of a product to a sum of the device may be off by, relative to the sum of absolute terms.
template <typename Real>
constexpr double sum_rounding() {
  return is_double<Real> ? 0x1p-52 : 0x1p-46;
}

/// A buffer's elements.
template <typename T>
void exchange(Archive& archive, Buffer<T>& buffer) {
  std::vector<T> elements;
  if (!archive.reads()) elements = buffer.read();
  archive.list(elements);
  if (!archive.reads()) return;
  if (elements.size() != buffer.size()) Archive::fail();
  buffer.write(elements);
}

/// The mesh's materials and areas as the solvers read them; w = the largest of the three colours.
struct SideMaterials {
  SideMaterials(Context& context, const PatchMesh& mesh)
      : emission(context, "emission", std::span(mesh.emission)),
        reflectance(context, "reflectance", std::span<const shared::float4>(with_largest(mesh.reflectance))),
        transmittance(context, "transmittance", std::span<const shared::float4>(with_largest(mesh.transmittance))) {}

  static std::vector<shared::float4> with_largest(std::vector<shared::float4> columns) {
    for (shared::float4& c : columns) c.w = std::max({c.x, c.y, c.z});
    return columns;
  }

  Buffer<shared::float4> emission, reflectance, transmittance;
};

/// B, F B and the residual, for a matrix that outlives it.
template <typename Real>
class SolveSystem {
 public:
  SolveSystem(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix)
      : radiosity(context, "radiosity", mesh.side_count()),
        incident(context, "incident", mesh.side_count()),
        residual(context, "residual", mesh.side_count()),
        materials(context, mesh),
        context_(&context),
        matrix_(&matrix),
        program_(solver_program(context, matrix.precision(), is_double<Real>)) {
    incident.clear();
    std::vector<Real4<Real>> start(mesh.side_count());
    for (std::size_t s = 0; s < start.size(); s++) {
      const shared::float4& e = mesh.emission[s];
      start[s] = {{Real(e.x), Real(e.y), Real(e.z), Real(e.w)}};
    }
    radiosity.write(start);
    for (const FactorBlock& block : matrix.blocks) {
      const std::vector<std::uint32_t> starts = block.starts.read();
      for (std::uint32_t k = 0; k < block.row_count; k++) {
        longest_row_ = std::max(longest_row_, starts[k + 1] - starts[k]);
      }
    }
  }

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(radiosity.size()); }
  [[nodiscard]] const FactorMatrix& matrix() const { return *matrix_; }
  Kernel& kernel(const std::string& name) { return program_.kernel(name); }

  /// incident = F x for some rows of a block, or all of the matrix.
  void gather(const FactorBlock& block, std::uint32_t first, std::uint32_t rows, const Buffer<Real4<Real>>& x) {
    launch(*context_, kernel("radiosity_gather"), rows,
           arguments(row_arguments(block), arg("first", first), arg("count", rows), arg("radiosity", x),
                     arg("incident", incident)));
  }
  void gather(const Buffer<Real4<Real>>& x) {
    for (const FactorBlock& block : matrix_->blocks) gather(block, 0, block.row_count, x);
  }

  /// residual = E + rho H(B) + tau H' - B.
  void find_residual() {
    if (residual_is_fresh) return;
    residual_is_fresh = true;
    gather(radiosity);
    launch(*context_, kernel("radiosity_residual"), count(),
           arguments(arg("emission", materials.emission), arg("reflectance", materials.reflectance),
                     arg("transmittance", materials.transmittance), arg("incident", incident),
                     arg("radiosity", radiosity), arg("count", count()), arg("residual", residual)));
  }

  /// With a fresh residual.
  SolverState state() {
    find_residual();
    SolverState state;
    state.radiosity = columns(radiosity.read());
    state.residual = columns(residual.read());
    state.rounding = (static_cast<double>(longest_row_) + 8.0) * sum_rounding<Real>();
    state.residual_rounding = static_cast<double>(std::numeric_limits<Real>::epsilon());
    return state;
  }

  [[nodiscard]] std::vector<std::array<double, 3>> irradiance() const {
    std::vector<std::array<double, 3>> result;
    for (const WideSum<Real>& h : incident.read()) result.push_back({h.value(0), h.value(1), h.value(2)});
    return result;
  }

  static SideColumns columns(const std::vector<Real4<Real>>& from) {
    SideColumns to(from.size());
    for (std::size_t s = 0; s < from.size(); s++) {
      for (std::size_t c = 0; c < 4; c++) to[s][c] = static_cast<double>(from[s].v[c]);
    }
    return to;
  }

  Buffer<Real4<Real>> radiosity;
  Buffer<WideSum<Real>> incident;
  Buffer<Real4<Real>> residual;
  SideMaterials materials;
  bool residual_is_fresh = false;  ///< it is that of the present radiosity: who changes that says so

 private:
  Context* context_;
  const FactorMatrix* matrix_;
  Program program_;
  std::uint32_t longest_row_ = 0;
};

}  // namespace hemiray
