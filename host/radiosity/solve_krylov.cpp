// Conjugate gradients and restarted GMRES. Both work on T = I - rho F - tau F' and on corrections: the residual of
// radiosity_residual is where they start anew, so that its precision is theirs.
#include <cmath>

#include "host/radiosity/solve_system.hpp"

namespace hemiray {
namespace {

using Scalars = std::array<double, 4>;  // of the columns

Scalars operator-(const Scalars& a) { return {-a[0], -a[1], -a[2], -a[3]}; }
constexpr Scalars kOne = {1.0, 1.0, 1.0, 1.0};

template <typename Real>
class Krylov : public SolveMethod {
 public:
  using Vector = Buffer<Real4<Real>>;

  Krylov(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, const SolveOptions& options)
      : system_(context, mesh, matrix),
        restart_(options.restart),
        context_(context),
        weights_(context, "weights", mesh.side_count()),
        partials_(context, "partial sums", context.profile().chunks) {}

  std::vector<std::array<double, 3>> irradiance() override { return system_.irradiance(); }

 protected:
  void set_weights(const std::vector<Real4<Real>>& weights) { weights_.write(weights); }

  Vector make_vector(const char* name) {
    Vector vector(context_, name, system_.count());
    vector.clear();
    return vector;
  }

  // y = T x.
  void apply(const Vector& x, const Vector& y) {
    system_.gather(x);
    launch(context_, system_.kernel("radiosity_apply"), system_.count(),
           arguments(arg("reflectance", system_.materials.reflectance),
                     arg("transmittance", system_.materials.transmittance), arg("incident", system_.incident),
                     arg("x", x), arg("count", system_.count()), arg("y", y)));
  }

  // Sums over the sides, in one order.
  Scalars dot(const Vector& x, const Vector& y) {
    launch(context_, system_.kernel("radiosity_dot"), partials_.size(),
           arguments(arg("x", x), arg("y", y), arg("weights", weights_), arg("count", system_.count()),
                     arg("partials", partials_)));
    Scalars sum{};
    for (const Real4<Real>& part : partials_.read()) {
      for (std::size_t c = 0; c < 4; c++) sum[c] += static_cast<double>(part.v[c]);
    }
    return sum;
  }

  // y = a x + b y.
  void combine(const Scalars& a, const Vector& x, const Scalars& b, const Vector& y) {
    launch(
        context_, system_.kernel("radiosity_combine"), system_.count(),
        arguments(arg("a", device(a)), arg("x", x), arg("b", device(b)), arg("y", y), arg("count", system_.count())));
  }

  SolveSystem<Real> system_;
  std::uint32_t restart_;

 private:
  static Real4<Real> device(const Scalars& a) {
    return {{static_cast<Real>(a[0]), static_cast<Real>(a[1]), static_cast<Real>(a[2]), static_cast<Real>(a[3])}};
  }

  Context& context_;
  Vector weights_;
  Vector partials_;
};

// Shewchuk 1994, "An Introduction to the Conjugate Gradient Method Without the Agonizing Pain", B3. Preconditioned by
// A / rho, the residual of the symmetric form is A / rho r and the preconditioned one r itself: so all vectors are
// radiosities, in the inner product with weights A / rho. Weight 0 leaves out sides with rho = 0: there B = E from the
// start, r = 0, and no direction moves it.
template <typename Real>
class ConjugateGradients final : public Krylov<Real> {
  using Base = Krylov<Real>;

 public:
  ConjugateGradients(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, const SolveOptions& options)
      : Base(context, mesh, matrix, options),
        residual_(Base::make_vector("residual of cg")),
        direction_(Base::make_vector("direction of cg")),
        applied_(Base::make_vector("applied direction")) {
    std::vector<Real4<Real>> weights(mesh.side_count());
    const std::vector<shared::float4> rho = SideMaterials::with_largest(mesh.reflectance);
    for (std::size_t s = 0; s < weights.size(); s++) {
      const Real area = Real(mesh.normals[s / 2].w);
      const std::array<float, 4> columns = {rho[s].x, rho[s].y, rho[s].z, rho[s].w};
      for (std::size_t c = 0; c < 4; c++) weights[s].v[c] = columns[c] > 0.0F ? area / Real(columns[c]) : Real(0);
    }
    Base::set_weights(weights);
  }

  void exchange(Archive& archive) override {
    for (auto* vector : {&system_.radiosity, &residual_, &direction_}) hemiray::exchange(archive, *vector);
    archive.value(square_);
    archive.value(since_start_);
  }

  void step() override {
    if (since_start_ == 0) {
      system_.find_residual();
      Base::combine(kOne, system_.residual, Scalars{}, residual_);
      Base::combine(kOne, residual_, Scalars{}, direction_);
      square_ = Base::dot(residual_, residual_);
    }
    system_.residual_is_fresh = false;
    Base::apply(direction_, applied_);
    const Scalars curvature = Base::dot(direction_, applied_);
    Scalars alpha{}, beta{};
    // Of a column that is solved, or that rounding has got hold of, nothing moves until the next start.
    for (std::size_t c = 0; c < 4; c++) alpha[c] = curvature[c] > 0.0 ? square_[c] / curvature[c] : 0.0;
    Base::combine(alpha, direction_, kOne, system_.radiosity);
    Base::combine(-alpha, applied_, kOne, residual_);
    const Scalars square = Base::dot(residual_, residual_);
    for (std::size_t c = 0; c < 4; c++) beta[c] = square_[c] > 0.0 ? square[c] / square_[c] : 0.0;
    Base::combine(kOne, residual_, beta, direction_);
    square_ = square;
    since_start_ = (since_start_ + 1) % Base::restart_;
  }
  SolverState state() override { return system_.state(); }

 private:
  using Base::system_;
  typename Base::Vector residual_, direction_, applied_;
  Scalars square_{};
  std::uint32_t since_start_ = 0;
};

// Saad 2003, "Iterative Methods for Sparse Linear Systems", algorithms 6.9 (modified Gram-Schmidt) and 6.5.3 (plane
// rotations), in the inner product with weights A. Columns have Hessenberg matrices of their own.
template <typename Real>
class Gmres final : public Krylov<Real> {
  using Base = Krylov<Real>;

 public:
  Gmres(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix, const SolveOptions& options)
      : Base(context, mesh, matrix, options), start_(Base::make_vector("start of gmres")) {
    std::vector<Real4<Real>> weights(mesh.side_count());
    for (std::size_t s = 0; s < weights.size(); s++) weights[s].v[0] = Real(mesh.normals[s / 2].w);
    for (Real4<Real>& w : weights) w = {{w.v[0], w.v[0], w.v[0], w.v[0]}};
    Base::set_weights(weights);
  }

  void exchange(Archive& archive) override {
    for (auto* vector : {&system_.radiosity, &start_}) hemiray::exchange(archive, *vector);
    archive.value(is_formed_);
    archive.value(size_);
    if (size_ >= Base::restart_) Archive::fail();
    if (size_ == 0) return;
    basis(size_);
    for (std::size_t k = 0; k <= size_; k++) hemiray::exchange(archive, basis_[k]);
    triangle_.resize(size_);
    for (auto* scalars : {&right_, &cosines_, &sines_}) archive.list(*scalars);
    for (std::vector<Scalars>& column : triangle_) archive.list(column);
    if (right_.size() != size_ + 1 || cosines_.size() != size_ || sines_.size() != size_) Archive::fail();
  }

  void step() override {
    if (size_ == 0) begin();
    basis(size_ + 1);
    Base::apply(basis_[size_], basis_[size_ + 1]);
    std::vector<Scalars> column(size_ + 2);
    for (std::size_t k = 0; k <= size_; k++) {
      column[k] = Base::dot(basis_[k], basis_[size_ + 1]);
      Base::combine(-column[k], basis_[k], kOne, basis_[size_ + 1]);
    }
    column[size_ + 1] = normalize(basis_[size_ + 1]);
    rotate(std::move(column));
    size_++;
    is_formed_ = false;
    if (size_ == Base::restart_) {
      form();
      size_ = 0;
    }
  }
  SolverState state() override {
    form();
    return system_.state();
  }

 private:
  using Base::system_;

  void basis(std::size_t last) {
    while (basis_.size() <= last) basis_.push_back(Base::make_vector("basis of gmres"));
  }

  // Divides by its length and gives that; where it is zero, the vector is, too.
  Scalars normalize(const typename Base::Vector& vector) {
    Scalars length = Base::dot(vector, vector), inverse{};
    for (std::size_t c = 0; c < 4; c++) {
      length[c] = std::sqrt(length[c]);
      inverse[c] = length[c] > 0.0 ? 1.0 / length[c] : 0.0;
    }
    Base::combine(Scalars{}, vector, inverse, vector);
    return length;
  }

  void begin() {
    system_.find_residual();
    basis(0);
    Base::combine(kOne, system_.radiosity, Scalars{}, start_);
    Base::combine(kOne, system_.residual, Scalars{}, basis_[0]);
    right_ = {normalize(basis_[0])};
    triangle_.clear();
    cosines_.clear();
    sines_.clear();
  }

  // The rotations so far on a new column of the Hessenberg matrix, then one that takes its last entry away.
  void rotate(std::vector<Scalars> column) {
    const std::size_t j = size_;
    Scalars cosine{}, sine{}, next{};
    for (std::size_t c = 0; c < 4; c++) {
      for (std::size_t k = 0; k < j; k++) {
        const double a = column[k][c], b = column[k + 1][c];
        column[k][c] = cosines_[k][c] * a + sines_[k][c] * b;
        column[k + 1][c] = cosines_[k][c] * b - sines_[k][c] * a;
      }
      const double length = std::hypot(column[j][c], column[j + 1][c]);
      cosine[c] = length > 0.0 ? column[j][c] / length : 1.0;
      sine[c] = length > 0.0 ? column[j + 1][c] / length : 0.0;
      column[j][c] = length;
      next[c] = -sine[c] * right_[j][c];
      right_[j][c] *= cosine[c];
    }
    cosines_.push_back(cosine);
    sines_.push_back(sine);
    right_.push_back(next);
    triangle_.push_back(std::move(column));
  }

  // B = start + basis y, y solving the triangle.
  void form() {
    if (is_formed_) return;
    is_formed_ = true;
    system_.residual_is_fresh = false;
    std::vector<Scalars> y(size_);
    for (std::size_t c = 0; c < 4; c++) {
      for (std::size_t k = size_; k-- > 0;) {
        double sum = right_[k][c];
        for (std::size_t j = k + 1; j < size_; j++) sum -= triangle_[j][k][c] * y[j][c];
        y[k][c] = triangle_[k][k][c] > 0.0 ? sum / triangle_[k][k][c] : 0.0;
      }
    }
    Base::combine(kOne, start_, Scalars{}, system_.radiosity);
    for (std::size_t k = 0; k < size_; k++) Base::combine(y[k], basis_[k], kOne, system_.radiosity);
  }

  typename Base::Vector start_;
  std::vector<typename Base::Vector> basis_;
  std::vector<Scalars> right_, cosines_, sines_;
  std::vector<std::vector<Scalars>> triangle_;  ///< by column
  std::size_t size_ = 0;                        ///< steps since the start
  bool is_formed_ = true;                       ///< the system's B is that of the last step
};

template <typename Real>
std::unique_ptr<SolveMethod> make(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                                  const SolveOptions& options) {
  if (options.kind == SolverKind::cg) {
    return std::make_unique<ConjugateGradients<Real>>(context, mesh, matrix, options);
  }
  return std::make_unique<Gmres<Real>>(context, mesh, matrix, options);
}

}  // namespace

std::unique_ptr<SolveMethod> make_krylov(Context& context, const PatchMesh& mesh, const FactorMatrix& matrix,
                                         const SolveOptions& options) {
  if (solves_in_double(context, options)) return make<double>(context, mesh, matrix, options);
  return make<float>(context, mesh, matrix, options);
}

}  // namespace hemiray
