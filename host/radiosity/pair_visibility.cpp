#include "host/radiosity/pair_visibility.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "host/base/clock.hpp"
#include "host/bvh/ray_queries.hpp"

namespace hemiray {
namespace {

constexpr std::uint32_t kBlockColumns = 64;         // HR_BLOCK_COLUMNS of radiosity/visibility.cl
constexpr std::uint64_t kItemsALaunch = 1U << 18U;  // so that progress shows and Ctrl-C is heard
constexpr std::uint32_t kSampleGroups = 1;  // partly hidden pairs lie along silhouettes: few share a part of the tree
constexpr std::uint32_t kRaysAlone = 64;    // HR_AIMED of radiosity/aimed_rays.h without packets

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
    const auto with_groups = [&](std::uint32_t groups) {
      ProgramOptions options = accel_.program_options(scene_.features(), false);
      options.defines += fmt::format(" -DHR_PACKET_GROUPS={}", groups);
      return options;
    };
    trace_.emplace(context, "visibility", std::vector<std::string>{"radiosity/visibility.cl"},
                   with_groups(context.profile().packet_groups));
    sample_.emplace(context, "partly hidden pairs", std::vector<std::string>{"radiosity/pair_partial.cl"},
                    with_groups(kSampleGroups));
  }

  PairVisibility find(const VisibilityOptions& options, const std::function<bool(double)>& on_progress) {
    double start = steady_ms();
    PairVisibility found;
    found.visible = matrix("pairs visible");
    Buffer<std::uint32_t> hidden = matrix("pairs hidden"), cut = matrix("pairs cut");
    const bool whole = trace(found, hidden, cut, on_progress);
    tell(found, hidden, cut);
    context_.finish();
    found.trace_ms = steady_ms() - start;
    start = steady_ms();
    sample(
        found, options, whole ? on_progress : [](double) { return false; });
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
    const auto step = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, kItemsALaunch / blocks));
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

  void tell(PairVisibility& found, Buffer<std::uint32_t>& hidden, Buffer<std::uint32_t>& cut) {
    for (const Buffer<std::uint32_t>* bits : {&found.visible, &hidden, &cut}) {
      launch(context_, bits_.kernel("radiosity_mirror_bits"), std::uint64_t{words_} * words_,
             arguments(arg("bits", *bits), arg("words", words_)));
    }
    Buffer<std::uint32_t> half = matrix("bits half grown"), seen = matrix("visible grown");
    found.partial = matrix("pairs partly visible");
    grow(found.visible, half);
    grow(half, seen);
    grow(hidden, half);
    grow(half, found.partial);
    found.starts = Buffer<std::uint32_t>(context_, "partial starts", sides_.count + std::size_t{1});
    found.starts.clear();
    launch(context_, bits_.kernel("radiosity_tell_pairs"), sides_.rows,
           arguments(arg("grown_visible", seen), arg("hidden", hidden), arg("cut", cut), arg("count", sides_.rows),
                     arg("words", words_), arg("visible", found.visible), arg("partial", found.partial),
                     arg("counts", found.starts)));
    parallel_.exclusive_scan(found.starts, sides_.count);
    found.pairs = found.starts.read(sides_.count, 1).front();
    found.columns = Buffer<std::uint32_t>(context_, "partial columns", found.pairs);
    launch(context_, bits_.kernel("radiosity_list_partial"), sides_.rows,
           arguments(arg("partial", found.partial), arg("starts", found.starts), arg("count", sides_.rows),
                     arg("words", words_), arg("columns", found.columns)));
  }

  // Those pairs that are worth it, in rounds that are each three times as long as all before.
  void sample(PairVisibility& found, const VisibilityOptions& options, const std::function<bool(double)>& on_progress) {
    found.shares = Buffer<float>(context_, "shares visible", found.pairs);
    found.errors = Buffer<float>(context_, "errors of shares", found.pairs);
    Buffer<float> all(context_, "exchange sampled", found.pairs), through(context_, "exchange seen", found.pairs);
    for (Buffer<float>* buffer : {&found.shares, &found.errors, &all, &through}) buffer->clear();
    std::vector<std::uint32_t> list(found.pairs), starts = found.starts.read();
    std::iota(list.begin(), list.end(), 0U);
    std::uint32_t begin = 0, end = options.few;
    while (!list.empty()) {
      const std::vector<std::uint32_t> again =
          sample_round(found, list, starts, begin, end, options, all, through, on_progress);
      found.rays += std::uint64_t{list.size()} * (end - begin);
      if (again.empty() || end == options.many) return;
      std::vector<std::uint32_t> next;
      for (std::uint32_t i = 0, n = 0; i < sides_.count; i++) {
        const std::uint32_t row_end = starts[i + 1];
        starts[i] = static_cast<std::uint32_t>(next.size());
        for (; n < row_end; n++) {
          if (again[n] != 0) next.push_back(list[n]);
        }
      }
      starts[sides_.count] = static_cast<std::uint32_t>(next.size());
      list = std::move(next);
      begin = end;
      end = std::min(4 * end, options.many);
    }
  }

  // Rays [begin, end) of the listed pairs, by row from `starts` on; who is worth more. Empty: interrupted.
  std::vector<std::uint32_t> sample_round(const PairVisibility& found, const std::vector<std::uint32_t>& list,
                                          const std::vector<std::uint32_t>& starts, std::uint32_t begin,
                                          std::uint32_t end, const VisibilityOptions& options, const Buffer<float>& all,
                                          const Buffer<float>& through,
                                          const std::function<bool(double)>& on_progress) {
    const std::uint32_t size = accel_.config().has_packets() ? 16 * kSampleGroups : kRaysAlone;
    std::vector<std::uint32_t> rows, firsts;
    for (std::uint32_t i = 0; i < sides_.count; i++) {
      for (std::uint32_t first = starts[i]; first < starts[i + 1]; first += size) {
        rows.push_back(i);
        firsts.push_back(first);
      }
    }
    firsts.push_back(starts[sides_.count]);
    const Buffer<std::uint32_t> pairs(context_, "pairs to sample", std::span<const std::uint32_t>(list)),
        again(context_, "pairs to sample again", list.size());
    constexpr std::size_t kPackets = 1U << 14U;  // a launch
    Buffer<std::uint32_t> packet_rows(context_, "packet rows", kPackets),
        packet_firsts(context_, "packet firsts", kPackets + 1);
    for (std::size_t at = 0; at < rows.size(); at += kPackets) {
      const auto count = static_cast<std::uint32_t>(std::min(kPackets, rows.size() - at));
      packet_rows.write(std::span<const std::uint32_t>(rows).subspan(at, count));
      packet_firsts.write(std::span<const std::uint32_t>(firsts).subspan(at, count + 1));
      launch(context_, sample_->kernel("radiosity_sample_partial"), count,
             arguments(scene_arguments(), arg("sides", sides_.table), arg("own_blockers", sides_.blockers),
                       arg("stride", sides_.stride), arg("flatness", sides_.flatness), arg("columns", found.columns),
                       arg("list", pairs), arg("packet_rows", packet_rows), arg("firsts", packet_firsts),
                       arg("packet_count", count), arg("begin", begin), arg("end", end),
                       arg("accuracy", static_cast<float>(options.accuracy / sides_.count)),
                       arg("seed_key", options.seed * 0x9E3779B9U), arg("exchanged", all), arg("through", through),
                       arg("shares", found.shares), arg("errors", found.errors), arg("again", again),
                       arg("params", query_params(scene_))));
      context_.finish();
      const double done = static_cast<double>(at + count) / static_cast<double>(rows.size());
      if (on_progress && !on_progress(0.5 + 0.5 * done)) return {};
    }
    return again.read();
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
