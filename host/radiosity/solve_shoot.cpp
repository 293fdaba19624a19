// Southwell: progressive shooting, with rows of the matrix or rows on demand.
#include <algorithm>
#include <cmath>

#include "host/radiosity/solve_system.hpp"

namespace hemiray {
namespace {

// Chunks that look for sides to shoot; the host merges what they find.
constexpr std::uint32_t kMostPickChunks = 256;
// w need not be solved well, only so that s = 1 - its residual stays clear of 0: further shots for it gain less than
// what they cost.
constexpr double kGoodEnough = 0.5;

struct Pick {
  std::uint32_t side;
  float score;
};

template <typename Real>
class Shooting final : public SolveMethod {
 public:
  Shooting(Context& context, const PatchMesh& mesh, const FactorMatrix* matrix, RowsOnDemand rows,
           const SolveOptions& options)
      : context_(context),
        mesh_(mesh),
        options_(options),
        matrix_(matrix),
        rows_on_demand_(std::move(rows)),
        program_(
            context, "radiosity shooting", {"radiosity/shoot.cl"},
            solver_program_options(matrix != nullptr ? matrix->precision() : FactorPrecision::single, is_double<Real>)),
        materials_(context, mesh),
        normals_(context, "patch normals", std::span(mesh.normals)),
        radiosity_(context, "radiosity", mesh.side_count()),
        unshot_(context, "unshot radiosity", mesh.side_count()),
        incident_(context, "incident", mesh.side_count()),
        reached_(context, "sides that light reached", mesh.side_count()),
        shot_(context, "shots", options.shots) {
    const std::uint32_t chunks = std::min(kMostPickChunks, context.profile().chunks);
    best_sides_ = Buffer<std::uint32_t>(context, "sides to shoot", std::size_t{chunks} * options.shots);
    best_scores_ = Buffer<float>(context, "their unshot light", std::size_t{chunks} * options.shots);
    if (matrix != nullptr) place_rows();
    start();
  }

  void exchange(Archive& archive) override {
    for (Buffer<WideSum<Real>>* sums : {&radiosity_, &unshot_}) hemiray::exchange(archive, *sums);
    hemiray::exchange(archive, incident_);
    hemiray::exchange(archive, reached_);
    archive.value(shots_);
    archive.value(picks_weight_);
  }

  void step() override {
    const std::vector<std::uint32_t> sides = pick();
    if (sides.empty()) return;
    shots_ += sides.size();
    if (matrix_ == nullptr) {
      const FactorMatrix rows = rows_on_demand_(sides);
      for (const FactorBlock& block : rows.blocks) {
        std::vector<std::uint32_t> all(block.row_count);
        for (std::uint32_t k = 0; k < block.row_count; k++) all[k] = k;
        shoot(block, all);
      }
      context_.finish();  // before the rows go
      return;
    }
    std::vector<std::vector<std::uint32_t>> in_block(matrix_->blocks.size() + 1);
    for (const std::uint32_t side : sides) in_block[places_[side].first].push_back(places_[side].second);
    for (std::size_t b = 0; b < in_block.size(); b++) {
      if (!in_block[b].empty()) shoot(b < matrix_->blocks.size() ? matrix_->blocks[b] : rowless_, in_block[b]);
    }
  }

  SolverState state() override {
    SolverState state;
    state.radiosity = columns(radiosity_.read());
    state.residual = columns(unshot_.read());
    state.reached = reached_.read();
    // All terms are positive, so no sum on the way was above B + e. A side gets two of them a shot at most (tau), and
    // two more when it is shot itself; factors and products are rounded before.
    state.rounding = 4.0 * (static_cast<double>(shots_) + 2.0) * sum_rounding<Real>() +
                     6.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    choose_columns(state);
    return state;
  }

  std::vector<std::array<double, 3>> irradiance() override {
    std::vector<std::array<double, 3>> result;
    for (const Real4<Real>& h : incident_.read()) {
      result.push_back({static_cast<double>(h.v[0]), static_cast<double>(h.v[1]), static_cast<double>(h.v[2])});
    }
    return result;
  }
  [[nodiscard]] bool is_progressive() const override { return true; }

 private:
  static SideColumns columns(const std::vector<WideSum<Real>>& from) {
    SideColumns to(from.size());
    for (std::size_t s = 0; s < from.size(); s++) {
      for (std::size_t c = 0; c < 4; c++) to[s][c] = from[s].value(c);
    }
    return to;
  }

  // Sides without a row, which send nothing to others, get empty ones.
  void place_rows() {
    const auto none = static_cast<std::uint32_t>(matrix_->blocks.size());
    places_.assign(mesh_.side_count(), {none, 0});
    for (std::uint32_t b = 0; b < none; b++) {
      const std::vector<std::uint32_t> rows = matrix_->blocks[b].rows.read();
      for (std::uint32_t k = 0; k < rows.size(); k++) places_[rows[k]] = {b, k};
    }
    std::vector<std::uint32_t> rowless;
    for (std::uint32_t s = 0; s < mesh_.side_count(); s++) {
      if (places_[s].first != none) continue;
      places_[s].second = static_cast<std::uint32_t>(rowless.size());
      rowless.push_back(s);
    }
    rowless_.row_count = static_cast<std::uint32_t>(rowless.size());
    rowless_.rows = Buffer<std::uint32_t>(context_, "sides without rows", std::span<const std::uint32_t>(rowless));
    rowless_.starts = Buffer<std::uint32_t>(context_, "their starts", rowless.size() + 1);
    rowless_.columns = Buffer<std::uint32_t>(context_, "their columns", 0);
    if (matrix_->precision() == FactorPrecision::half) {
      rowless_.halves = Buffer<std::uint16_t>(context_, "their values", 0);
      rowless_.row_scales = Buffer<float>(context_, "their scales", rowless.size());
    } else {
      rowless_.values = Buffer<float>(context_, "their values", 0);
    }
    rowless_.starts.clear();
  }

  // B = 0, e = E.
  void start() {
    std::vector<WideSum<Real>> unshot(mesh_.side_count());
    std::vector<std::uint32_t> reached(mesh_.side_count(), 0);
    for (std::uint32_t s = 0; s < mesh_.side_count(); s++) {
      const shared::float4& e = mesh_.emission[s];
      if (!(e.x > 0.0F || e.y > 0.0F || e.z > 0.0F)) continue;
      reached[s] = 1;
      set_high(unshot[s], {e.x, e.y, e.z, 1.0F});
    }
    unshot_.write(unshot);
    reached_.write(reached);
    radiosity_.clear();
    incident_.clear();
  }

  static void set_high(WideSum<double>& to, const std::array<float, 4>& from) {
    for (std::size_t c = 0; c < 4; c++) to.v[c] = static_cast<double>(from[c]);
  }
  static void set_high(WideSum<float>& to, const std::array<float, 4>& from) {
    std::copy(from.begin(), from.end(), to.high);
  }

  // The sides with most unshot light.
  std::vector<std::uint32_t> pick() {
    const shared::float4 of_column =
        picks_weight_ ? shared::float4{0.0F, 0.0F, 0.0F, 1.0F} : shared::float4{1.0F, 1.0F, 1.0F, 0.0F};
    const std::uint32_t by_power = options_.pick == ShotPick::power ? 1 : 0;
    launch(context_, program_.kernel("radiosity_pick"), best_sides_.size() / options_.shots,
           arguments(arg("unshot", unshot_), arg("normals", normals_), arg("count", mesh_.side_count()),
                     arg("shots", options_.shots), arg("of_column", of_column), arg("by_power", by_power),
                     arg("best_sides", best_sides_), arg("best_scores", best_scores_)));
    const std::vector<std::uint32_t> sides = best_sides_.read();
    const std::vector<float> scores = best_scores_.read();
    std::vector<Pick> picks;
    for (std::size_t i = 0; i < sides.size(); i++) {
      if (sides[i] != HR_NO_SIDE) picks.push_back({sides[i], scores[i]});
    }
    const std::size_t most = std::min<std::size_t>(picks.size(), options_.shots);
    std::partial_sort(
        picks.begin(), picks.begin() + static_cast<std::ptrdiff_t>(most), picks.end(),
        [](const Pick& a, const Pick& b) { return a.score != b.score ? a.score > b.score : a.side < b.side; });
    std::vector<std::uint32_t> best;
    for (std::size_t i = 0; i < most; i++) best.push_back(picks[i].side);
    return best;
  }

  void shoot(const FactorBlock& block, const std::vector<std::uint32_t>& rows) {
    const Buffer<std::uint32_t> picks(context_, "picked rows", std::span(rows));
    const auto count = static_cast<std::uint32_t>(rows.size());
    const Arguments shared_arguments =
        arguments(row_arguments(block), arg("picks", picks), arg("count", count), arg("shot", shot_),
                  arg("reflectance", materials_.reflectance), arg("unshot", unshot_));
    launch(context_, program_.kernel("radiosity_take_unshot"), count,
           arguments(shared_arguments, arg("radiosity", radiosity_)));
    const std::uint32_t items = std::min(mesh_.patch_count(), context_.profile().chunks);
    launch(context_, program_.kernel("radiosity_spread"), items,
           arguments(shared_arguments, arg("normals", normals_), arg("patch_count", mesh_.patch_count()),
                     arg("transmittance", materials_.transmittance), arg("incident", incident_),
                     arg("reached", reached_)));
    context_.finish();  // before the picks go
  }

  // Shots follow the colours until what is left of them is within the tolerance whatever w will be; then w, which tells
  // how far off they are, until it is good enough.
  void choose_columns(const SolverState& state) {
    double unshot = 0.0, weight = 0.0, largest = 0.0, reflectance = 0.0;
    for (std::uint32_t s = 0; s < mesh_.side_count(); s++) {
      if (state.reached[s] == 0) continue;
      for (std::size_t c = 0; c < 3; c++) {
        unshot = std::max(unshot, state.residual[s][c]);
        largest = std::max(largest, state.radiosity[s][c]);
      }
      weight = std::max(weight, state.residual[s][3]);
      const shared::float4 &rho = mesh_.reflectance[s], &tau = mesh_.transmittance[s];
      reflectance = std::max({reflectance, static_cast<double>(rho.x + tau.x), static_cast<double>(rho.y + tau.y),
                              static_cast<double>(rho.z + tau.z)});
    }
    const double amplification = 1.0 / (1.0 - reflectance);
    picks_weight_ = weight > kGoodEnough && unshot * amplification <= kGoodEnough * options_.tolerance * largest;
  }

  Context& context_;
  const PatchMesh& mesh_;
  SolveOptions options_;
  const FactorMatrix* matrix_;
  FactorBlock rowless_;
  RowsOnDemand rows_on_demand_;
  Program program_;
  SideMaterials materials_;
  Buffer<shared::float4> normals_;
  Buffer<WideSum<Real>> radiosity_, unshot_;
  Buffer<Real4<Real>> incident_;
  Buffer<std::uint32_t> reached_;
  Buffer<Real4<Real>> shot_;
  Buffer<std::uint32_t> best_sides_;
  Buffer<float> best_scores_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places_;  ///< of the sides: block and row in it
  std::uint64_t shots_ = 0;
  bool picks_weight_ = false;
};

}  // namespace

std::unique_ptr<SolveMethod> make_shooting(Context& context, const PatchMesh& mesh, const FactorMatrix* matrix,
                                           const RowsOnDemand& rows, const SolveOptions& options) {
  if (solves_in_double(context, options)) {
    return std::make_unique<Shooting<double>>(context, mesh, matrix, rows, options);
  }
  return std::make_unique<Shooting<float>>(context, mesh, matrix, rows, options);
}

}  // namespace hemiray
