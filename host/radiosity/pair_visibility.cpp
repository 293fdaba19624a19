#include "host/radiosity/pair_visibility.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/bvh/ray_queries.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kBlockColumns = 64;          // HR_BLOCK_COLUMNS of radiosity/visibility.cl
constexpr std::uint32_t kMostSidesByShafts = 92681;  // whose pairs have numbers of 32 bits
constexpr std::uint32_t kItemsALaunch = 1U << 18U;   // so that progress shows and Ctrl-C is heard

std::uint64_t sum_of(const std::vector<std::uint32_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

FlatScene blockers_of(const PatchMesh& mesh) {
  FlatScene flat;
  flat.positions = mesh.flat.positions;
  flat.materials = mesh.flat.materials;
  flat.triangles = mesh.blockers;
  flat.triangle_objects.assign(flat.triangles.size(), 0);
  return flat;
}

class Finder {
 public:
  Finder(Context& context, Parallel& parallel, const PatchMesh& mesh, const PairSides& sides)
      : context_(context),
        parallel_(parallel),
        sides_(sides),
        scene_(context, blockers_of(mesh), HR_FEATURE_TRIANGLES),
        builder_(context, parallel),
        accel_(builder_, scene_),
        words_(sides.stride / 32),
        bits_(context, "visibility bits", {"radiosity/visibility_bits.cl"}, {}) {
    ProgramOptions options = accel_.program_options(scene_.features(), false);
    options.defines += fmt::format(" -DHR_PACKET_GROUPS={}", context.profile().packet_groups);
    trace_.emplace(context, "visibility", std::vector<std::string>{"radiosity/visibility.cl"}, options);
    sample_.emplace(context, "partly hidden pairs", std::vector<std::string>{"radiosity/pair_partial.cl"}, options);
  }

  PairVisibility find(const VisibilityOptions& options, const std::function<bool(double)>& on_progress) {
    if (options.search == PairSearch::shafts && sides_.count > kMostSidesByShafts) {
      throw InputError("--pair-search", fmt::format("shafts of {} sides cannot be numbered, {} at most; take rays",
                                                    sides_.count, kMostSidesByShafts));
    }
    double start = steady_ms();
    PairVisibility found;
    found.visible = matrix("pairs visible");
    Buffer<std::uint32_t> hidden = matrix("pairs hidden"), cut = matrix("pairs cut");
    const bool whole = trace(found, hidden, cut, on_progress);
    tell(found, hidden, cut, options.search == PairSearch::shafts);
    context_.finish();
    found.trace_ms = steady_ms() - start;
    start = steady_ms();
    sample(
        found, options, whole ? on_progress : [](double) { return false; });
    if (options.search == PairSearch::shafts) settle(found);
    found.misses_some = options.search != PairSearch::shafts;
    context_.finish();
    found.sample_ms = steady_ms() - start;
    return found;
  }

 private:
  Buffer<std::uint32_t> matrix(const char* name) {
    return Buffer<std::uint32_t>(context_, name, std::size_t{words_} * sides_.stride);
  }

  Arguments scene_arguments() const { return arguments(scene_.shading_arguments(), accel_.tree_arguments()); }

  bool trace(PairVisibility& found, Buffer<std::uint32_t>& hidden, Buffer<std::uint32_t>& cut,
             const std::function<bool(double)>& on_progress) {
    found.visible.clear();
    hidden.clear();
    cut.clear();
    const std::uint32_t blocks = sides_.stride / kBlockColumns;
    const auto step = static_cast<std::uint32_t>(std::max(1U, kItemsALaunch / blocks));
    const Buffer<std::uint32_t> rays(context_, "rays of pairs", std::size_t{step} * blocks);
    // Row i has rays to those after it.
    const auto done = [this](std::uint32_t rows) {
      const double left = 1.0 - static_cast<double>(rows) / sides_.count;
      return 1.0 - left * left;
    };
    for (std::uint32_t first = 0; first < sides_.traced; first += step) {
      const std::uint32_t rows = std::min(step, sides_.traced - first);
      launch(context_, trace_->kernel("radiosity_trace_pairs"), std::uint64_t{rows} * blocks,
             arguments(scene_arguments(), arg("sides", sides_.table), arg("own_blockers", sides_.blockers),
                       arg("stride", sides_.stride), arg("count", sides_.count), arg("flatness", sides_.flatness),
                       arg("first", first), arg("row_count", rows), arg("visible", found.visible),
                       arg("hidden", hidden), arg("cut", cut), arg("rays", rays), arg("params", query_params(scene_))));
      found.pair_rays += sum_of(rays.read(0, std::size_t{rows} * blocks));
      if (on_progress && !on_progress(0.5 * done(first + rows) / done(sides_.traced))) return false;
    }
    found.rays = found.pair_rays;
    return true;
  }

  void grow(const Buffer<std::uint32_t>& from, const Buffer<std::uint32_t>& to) {
    launch(context_, bits_.kernel("radiosity_grow_bits"), std::uint64_t{words_} * words_,
           arguments(arg("bits", from), arg("neighbours", sides_.neighbours), arg("count", sides_.count),
                     arg("words", words_), arg("grown", to)));
  }

  void mirror(const Buffer<std::uint32_t>& bits) {
    launch(context_, bits_.kernel("radiosity_mirror_bits"), std::uint64_t{words_} * words_,
           arguments(arg("bits", bits), arg("words", words_)));
  }

  void tell(PairVisibility& found, Buffer<std::uint32_t>& hidden, Buffer<std::uint32_t>& cut, bool every) {
    for (const Buffer<std::uint32_t>* bits : {&found.visible, &hidden, &cut}) mirror(*bits);
    Buffer<std::uint32_t> half = matrix("bits half grown"), seen = matrix("visible grown");
    found.partial = matrix("pairs partly visible");
    grow(found.visible, half);
    grow(half, seen);
    grow(hidden, half);
    grow(half, found.partial);
    found.starts = Buffer<std::uint32_t>(context_, "partial starts", sides_.count + std::size_t{1});
    found.starts.clear();
    launch(context_, bits_.kernel("radiosity_tell_pairs"), sides_.rows,
           arguments(arg("grown_visible", seen), arg("hidden", hidden), arg("cut", cut), arg("every", every ? 1U : 0U),
                     arg("count", sides_.rows), arg("words", words_), arg("visible", found.visible),
                     arg("partial", found.partial), arg("counts", found.starts)));
    parallel_.exclusive_scan(found.starts, sides_.count);
    found.pairs = found.starts.read(sides_.count, 1).front();
    found.columns = Buffer<std::uint32_t>(context_, "partial columns", found.pairs);
    launch(context_, bits_.kernel("radiosity_list_partial"), sides_.rows,
           arguments(arg("partial", found.partial), arg("starts", found.starts), arg("count", sides_.rows),
                     arg("words", words_), arg("columns", found.columns)));
  }

  void sample(PairVisibility& found, const VisibilityOptions& options, const std::function<bool(double)>& on_progress) {
    found.shares = Buffer<float>(context_, "shares visible", found.pairs);
    found.errors = Buffer<float>(context_, "errors of shares", found.pairs);
    found.shares.clear();
    found.errors.clear();
    const Buffer<std::uint32_t> rays(context_, "rays of partial pairs", kItemsALaunch);
    for (std::uint32_t first = 0; first < found.pairs; first += kItemsALaunch) {
      const std::uint32_t count = std::min(kItemsALaunch, found.pairs - first);
      launch(context_, sample_->kernel("radiosity_sample_partial"), count,
             arguments(scene_.shading_arguments(), accel_.tree_arguments(), arg("sides", sides_.table),
                       arg("own_blockers", sides_.blockers), arg("stride", sides_.stride), arg("count", sides_.count),
                       arg("flatness", sides_.flatness), arg("starts", found.starts), arg("columns", found.columns),
                       arg("first", first), arg("end", first + count), arg("few", options.few),
                       arg("many", options.many), arg("accuracy", static_cast<float>(options.accuracy / sides_.count)),
                       arg("seed_key", options.seed * 0x9E3779B9U), arg("shares", found.shares),
                       arg("errors", found.errors), arg("rays", rays), arg("params", query_params(scene_))));
      const std::vector<std::uint32_t> numbers = rays.read(0, count);
      found.rays += sum_of(numbers);
      found.partly_hidden +=
          static_cast<std::uint32_t>(numbers.size() - std::count(numbers.begin(), numbers.end(), 0U));
      const double done = static_cast<double>(first + count) / static_cast<double>(found.pairs);
      if (on_progress && !on_progress(0.5 + 0.5 * done)) return;
    }
  }

  void settle(PairVisibility& found) {
    launch(context_, bits_.kernel("radiosity_settle_pairs"), sides_.rows,
           arguments(arg("starts", found.starts), arg("columns", found.columns), arg("shares", found.shares),
                     arg("count", sides_.rows), arg("words", words_), arg("visible", found.visible),
                     arg("partial", found.partial)));
    mirror(found.visible);
    mirror(found.partial);
  }

  Context& context_;
  Parallel& parallel_;
  const PairSides& sides_;
  DeviceScene scene_;
  AccelBuilder builder_;
  Accel accel_;
  std::uint32_t words_;
  Program bits_;
  std::optional<Program> trace_, sample_;
};

}  // namespace

PairVisibility find_visibility(Context& context, Parallel& parallel, const PatchMesh& mesh, const PairSides& sides,
                               const VisibilityOptions& options, const std::function<bool(double)>& on_progress) {
  return Finder(context, parallel, mesh, sides).find(options, on_progress);
}

}  // namespace hemiray
