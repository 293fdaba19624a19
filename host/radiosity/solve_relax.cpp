// Jacobi and Gauss-Seidel: gathering.
#include "host/radiosity/solve_system.hpp"

namespace hemiray {
namespace {

template <typename Real>
class Relaxation final : public SolveMethod {
 public:
  Relaxation(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, const SolveOptions& options)
      : context_(context),
        system_(context, mesh, matrix),
        own_(context, "own factors", mesh.side_count()),
        group_(options.group),
        jacobi_(options.kind == SolverKind::jacobi) {
    own_.clear();
    if (jacobi_) return;
    const Buffer<float> sums(context, "row sums", mesh.side_count()), least(context, "least", mesh.side_count());
    for (const FactorBlock& block : matrix.blocks) {
      launch(context, system_.kernel("radiosity_find_row_facts"), block.row_count,
             arguments(row_arguments(block), arg("row_count", block.row_count), arg("own", own_), arg("sums", sums),
                       arg("least", least)));
    }
    context.finish();
  }

  void exchange(Archive& archive) override {
    hemiray::exchange(archive, system_.radiosity);
    hemiray::exchange(archive, system_.incident);
  }

  void step() override {
    if (jacobi_) {
      jacobi();
    } else {
      gauss_seidel();
    }
    system_.residual_is_fresh = false;
  }
  SolverState state() override { return system_.state(); }
  std::vector<std::array<double, 3>> irradiance() override { return system_.irradiance(); }

 private:
  void jacobi() {
    system_.find_residual();
    launch(context_, system_.kernel("radiosity_add"), system_.count(),
           arguments(arg("radiosity", system_.radiosity), arg("residual", system_.residual),
                     arg("count", system_.count())));
  }

  void gauss_seidel() {
    for (const FactorBlock& block : system_.matrix().blocks) {
      for (std::uint32_t first = 0; first < block.row_count; first += group_) {
        const std::uint32_t count = std::min(group_, block.row_count - first);
        system_.gather(block, first, count, system_.radiosity);
        launch(context_, system_.kernel("radiosity_relax"), count,
               arguments(arg("rows", block.rows), arg("first", first), arg("count", count),
                         arg("emission", system_.materials.emission), arg("reflectance", system_.materials.reflectance),
                         arg("transmittance", system_.materials.transmittance), arg("incident", system_.incident),
                         arg("own", own_), arg("radiosity", system_.radiosity)));
      }
    }
  }

  Context& context_;
  SolveSystem<Real> system_;
  Buffer<float> own_;
  std::uint32_t group_;
  bool jacobi_;
};

}  // namespace

std::unique_ptr<SolveMethod> make_relaxation(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                                             const SolveOptions& options) {
  if (solves_in_double(context, options)) {
    return std::make_unique<Relaxation<double>>(context, mesh, matrix, options);
  }
  return std::make_unique<Relaxation<float>>(context, mesh, matrix, options);
}

}  // namespace hemiray
