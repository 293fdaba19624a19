#include "host/radiosity/form_factors.hpp"

#include <algorithm>
#include <utility>

#include "host/base/clock.hpp"
#include "host/radiosity/factor_rounding.hpp"
#include "host/radiosity/hemicube_cells.hpp"

namespace hemiray {
namespace {

// Of the time that form factors take, the hemicubes' and the visibility's.
constexpr double kCubesShare = 0.2, kVisibilityShare = 0.6;

// How far a closed row may be off: of what partly hidden pairs exchange, a share for such pairs that were not found
// out, which lie beside them; and what a row without any may lose to the rounding of planes.
constexpr double kMissedRowShare = 0.05, kLeastSlack = 1e-3;

class Maker {
 public:
  Maker(Context& context, Parallel& parallel, const PatchMesh& mesh, Hemicubes& hemicubes, const FactorOptions& options,
        FactorReport& report, const std::function<bool(double)>& on_progress, const FactorGroups* areas)
      : context_(context),
        parallel_(parallel),
        mesh_(mesh),
        hemicubes_(hemicubes),
        options_(options),
        report_(report),
        on_progress_(on_progress),
        areas_(areas) {}

  bool go_on(double fraction) {
    report_.interrupted |= on_progress_ && !on_progress_(fraction);
    return !report_.interrupted;
  }

  double lap() {
    context_.finish();
    const double before = std::exchange(start_, steady_ms());
    return start_ - before;
  }

  FactorMatrix finish(FactorMatrix raw) {
    report_.cubes_ms = lap();
    report_.cube_rays = hemicubes_.rays_traced();
    if (options_.method == FormFactors::hemicube) {
      report_.pairs = raw.entries() / 2;
      if (options_.precision == FactorPrecision::half) {
        FactorRounder rounder(context_, mesh_);
        for (FactorBlock& block : raw.blocks) rounder.round(block, false);
      }
      return raw;
    }
    std::vector<std::uint32_t> active;
    for (const FactorBlock& block : raw.blocks) {
      const std::vector<std::uint32_t> rows = block.rows.read();
      active.insert(active.end(), rows.begin(), rows.end());
    }
    std::sort(active.begin(), active.end());
    const std::vector<bool> closed = closed_rows(raw);
    if (options_.method == FormFactors::analytic) raw.blocks.clear();
    const PairSides sides(context_, mesh_, active);
    const PairVisibility visibility =
        find_visibility(context_, parallel_, mesh_, sides, options_.visibility,
                        [this](double f) { return go_on(kCubesShare + kVisibilityShare * f); });
    report_.visibility_ms = visibility.trace_ms;
    report_.sample_ms = visibility.sample_ms;
    report_.pair_rays = visibility.pair_rays;
    report_.sample_rays = visibility.rays - visibility.pair_rays;
    report_.partial_pairs = visibility.misses_some ? visibility.pairs : visibility.partly_hidden;
    lap();
    PairFactors factors = watched(raw, sides, visibility);
    report_.near_pairs = factors.near_pairs;
    report_.pairs = factors.matrix.entries() / 2;
    report_.pairs_ms = lap();
    report_.enforcement = scale_pairs(context_, mesh_, factors.matrix, closed_slack(closed, factors, sides),
                                      options_.method == FormFactors::hybrid, options_.precision);
    sum_errors(factors, sides);
    report_.enforce_ms = lap();
    return std::move(factors.matrix);
  }

 private:
  PairFactors watched(const FactorMatrix& raw, const PairSides& sides, const PairVisibility& visibility) {
    const auto progress = [this](double f) {
      return go_on(kCubesShare + kVisibilityShare + (1.0 - kCubesShare - kVisibilityShare) * f);
    };
    PairWatcher watcher;
    std::optional<Guards> guards;
    if (options_.method == FormFactors::hybrid) {
      const std::vector<double> cells = hemicube_cells(options_.hemicube.resolution);
      const auto finest = static_cast<float>(*std::max_element(cells.begin(), cells.end()) /
                                             (options_.hemicube.divisions * options_.hemicube.divisions));
      guards.emplace(context_, mesh_, raw, sides, visibility, finest);
      watcher = guards->watcher();
    }
    std::optional<AreaErrors> errors;
    if (areas_ != nullptr) {
      errors.emplace(context_, *areas_, sides, visibility);
      watcher.unobstructed = [&errors, guard = watcher.unobstructed](const PairBatch& batch) {
        if (guard) guard(batch);
        errors->add(batch);
      };
    }
    PairFactors factors = make_pair_factors(context_, parallel_, sides, visibility, watcher, progress);
    if (guards) report_.violations = guards->violations();
    if (errors) report_.exchange_errors = errors->exchange_errors();
    return factors;
  }

  // A row counts as closed by what its side's middle sees. A side that another surface stands on may look out of the
  // room elsewhere: then its sum differs by more than its pairs are uncertain by.
  [[nodiscard]] std::vector<double> closed_slack(const std::vector<bool>& closed, const PairFactors& factors,
                                                 const PairSides& sides) const {
    std::vector<double> slack(closed.size(), -1.0);
    for (std::uint32_t i = 0; i < sides.count; i++) {
      const std::uint32_t side = sides.ids[i];
      const RowSums& sums = factors.sums[i];
      const double uncertain = sums.geometry + sums.sampling + kMissedRowShare * sums.visibility;
      if (closed[side]) slack[side] = kLeastSlack + uncertain / static_cast<double>(mesh_.normals[side / 2].w);
    }
    return slack;
  }

  void sum_errors(const PairFactors& factors, const PairSides& sides) {
    FactorErrors& errors = report_.row_errors;
    for (std::uint32_t i = 0; i < sides.count; i++) {
      const double area = static_cast<double>(mesh_.normals[sides.ids[i] / 2].w) * sides.count;
      errors.geometry += factors.sums[i].geometry / area;
      errors.sampling += factors.sums[i].sampling / area;
      errors.partial += factors.sums[i].visibility / area;
    }
    errors.closure = report_.enforcement->mean_before;
  }

  Context& context_;
  Parallel& parallel_;
  const PatchMesh& mesh_;
  Hemicubes& hemicubes_;
  const FactorOptions& options_;
  FactorReport& report_;
  const std::function<bool(double)>& on_progress_;
  const FactorGroups* areas_;
  double start_ = steady_ms();
};

}  // namespace

FactorMatrix make_form_factors(Context& context, Parallel& parallel, const PatchMesh& mesh, Hemicubes& hemicubes,
                               std::span<const std::uint32_t> sources, const FactorOptions& options,
                               FactorReport& report, const std::function<bool(double)>& on_progress) {
  Maker maker(context, parallel, mesh, hemicubes, options, report, on_progress, nullptr);
  const double share = options.method == FormFactors::hemicube ? 1.0 : kCubesShare;
  return maker.finish(hemicubes.rows_reached_from(sources, [&](std::uint64_t done, std::uint64_t known) {
    return maker.go_on(share * static_cast<double>(done) / static_cast<double>(known));
  }));
}

FactorMatrix make_form_factors_of(Context& context, Parallel& parallel, const PatchMesh& mesh, Hemicubes& hemicubes,
                                  std::span<const std::uint32_t> sides, const FactorOptions& options,
                                  FactorReport& report, const std::function<bool(double)>& on_progress,
                                  const FactorGroups* areas) {
  Maker maker(context, parallel, mesh, hemicubes, options, report, on_progress, areas);
  FactorMatrix raw;
  hemicubes.add_rows(sides, raw);
  return maker.finish(std::move(raw));
}

}  // namespace hemiray
