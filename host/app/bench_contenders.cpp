#include "host/app/bench_contenders.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"
#include "host/bench/device_tracer.hpp"
#ifdef HR_HAS_EMBREE
#include "bench/peers/embree_peer.hpp"
#endif

namespace hemiray::app {
namespace {

// Each tree takes about a gigabyte at ten million triangles: above this only what matters most is compared.
constexpr std::size_t kMostTrianglesOfAll = 3'000'000;
// Trees of cells take several times as long to build and to trace.
constexpr std::size_t kMostTrianglesOfCells = 1'000'000;

using bench::TraceMode;
using Workshop = std::shared_ptr<bench::DeviceWorkshop>;

void add_device(const Workshop& workshop, bench::Tracers& tracers, TreeBuilder tree, TriangleTest triangles,
                TraceMode mode) {
  tracers.push_back(bench::make_device_tracer(workshop, {tree, triangles, mode, AccelKind::bvh}));
}

void add_quality_tree(const Workshop& workshop, bench::Tracers& tracers) {
  for (const TraceMode mode : {TraceMode::single, TraceMode::packet}) {
    for (const TriangleTest triangles : {TriangleTest::watertight, TriangleTest::fast}) {
      add_device(workshop, tracers, TreeBuilder::quality, triangles, mode);
    }
  }
}

void add_trees_of_cells(const Workshop& workshop, bench::Tracers& tracers) {
  for (const AccelKind kind : {AccelKind::octree, AccelKind::kdtree, AccelKind::kdtree_median}) {
    bench::DeviceTracerSettings settings;
    settings.kind = kind;
    tracers.push_back(bench::make_device_tracer(workshop, settings));
  }
}

bool is_ours(const bench::Tracer& tracer) { return tracer.name().starts_with("device/"); }

// Where lanes are no vectors, packets are single rays by another name.
bool has_packets(const Context& context) { return config_of(complete_options({}, context.profile())).has_packets(); }

std::vector<std::string> names_of(const bench::Tracers& tracers) {
  std::vector<std::string> names;
  for (const auto& tracer : tracers) names.push_back(tracer->name());
  return names;
}

// Leaves those whose names have `part` in them, and of ours in packets only what the device has.
void keep_only(bench::Tracers& tracers, const std::string& part, const Context& context) {
  const std::vector<std::string> names = names_of(tracers);
  std::erase_if(tracers, [&](const auto& tracer) { return tracer->name().find(part) == std::string::npos; });
  if (tracers.empty()) {
    throw InputError("--tracers", "no tracer measured here has " + in_quotes(part) + " in its name" +
                                      spelling_hint(part, std::vector<std::string_view>(names.begin(), names.end())));
  }
  if (has_packets(context)) return;
  const auto any_of_ours = [&] {
    return std::any_of(tracers.begin(), tracers.end(), [](const auto& tracer) { return is_ours(*tracer); });
  };
  const bool had_ours = any_of_ours();
  std::erase_if(tracers, [](const auto& tracer) { return is_ours(*tracer) && tracer->in_packets(); });
  if (had_ours && !any_of_ours()) {
    throw InputError("--tracers", in_quotes(part) + " asks for packets, which " + context.device().name +
                                      " has not: its profile says explicit_vectors 0 or leaf_lanes 1; take single");
  }
}

#ifdef HR_HAS_EMBREE

using bench::EmbreeMode;
using bench::EmbreeQuality;

constexpr std::array kEmbreeModes{EmbreeMode::single, EmbreeMode::eight, EmbreeMode::sixteen, EmbreeMode::stream};

void add_embree(bench::Tracers& tracers, const ContenderOptions& options, EmbreeQuality quality, bool robust,
                EmbreeMode mode) {
  tracers.push_back(bench::make_embree_peer({quality, robust, mode, options.threads}));
}

void add_peers(bench::Tracers& tracers, const ContenderOptions& options, std::size_t triangles) {
  const auto add = [&](EmbreeQuality quality, bool robust, EmbreeMode mode) {
    add_embree(tracers, options, quality, robust, mode);
  };
  for (const EmbreeMode mode : kEmbreeModes) add(EmbreeQuality::medium, false, mode);
  add(EmbreeQuality::medium, true, EmbreeMode::single);
  add(EmbreeQuality::low, false, EmbreeMode::single);
  if (options.quick) return;
  for (const EmbreeMode mode : {EmbreeMode::eight, EmbreeMode::sixteen, EmbreeMode::stream}) {
    add(EmbreeQuality::medium, true, mode);
  }
  if (triangles <= kMostTrianglesOfAll) add(EmbreeQuality::high, false, EmbreeMode::single);
}

void add_leak_peers(bench::Tracers& tracers, const ContenderOptions& options) {
  for (const bool robust : {false, true}) {
    for (const EmbreeMode mode : kEmbreeModes) add_embree(tracers, options, EmbreeQuality::medium, robust, mode);
  }
}

#else

void add_peers(bench::Tracers& /*tracers*/, const ContenderOptions& /*options*/, std::size_t /*triangles*/) {
  peer_name();  // throws
}
void add_leak_peers(bench::Tracers& /*tracers*/, const ContenderOptions& /*options*/) { peer_name(); }

#endif

// The reference first.
bench::Tracers all_tracers(Context& context, const ContenderOptions& options, std::size_t triangles) {
  bench::Tracers tracers;
  if (options.peers) add_peers(tracers, options, triangles);
  const auto workshop = std::make_shared<bench::DeviceWorkshop>(context);
  add_quality_tree(workshop, tracers);
  add_device(workshop, tracers, TreeBuilder::fast, TriangleTest::fast, TraceMode::single);
  if (!options.quick && context.device().has_fp64) {
    add_device(workshop, tracers, TreeBuilder::quality, TriangleTest::watertight, TraceMode::double_precision);
  }
  if (!options.quick && triangles <= kMostTrianglesOfAll) {
    add_device(workshop, tracers, TreeBuilder::fast, TriangleTest::watertight, TraceMode::single);
  }
  if (!options.quick && triangles <= kMostTrianglesOfCells) add_trees_of_cells(workshop, tracers);
  return tracers;
}

bench::Tracers all_leak_tracers(Context& context, const ContenderOptions& options) {
  bench::Tracers tracers;
  add_quality_tree(std::make_shared<bench::DeviceWorkshop>(context), tracers);
  if (options.peers) add_leak_peers(tracers, options);
  return tracers;
}

}  // namespace

std::string peer_name() {
#ifdef HR_HAS_EMBREE
  return "Embree " + bench::embree_version();
#else
  throw InputError("--peers", "this build has no Embree; install libembree-dev, configure and build again");
#endif
}

bench::Tracers make_tracers(Context& context, const ContenderOptions& options, std::size_t triangles) {
  bench::Tracers tracers = all_tracers(context, options, triangles);
  keep_only(tracers, options.only, context);
  return tracers;
}

bench::Tracers make_leak_tracers(Context& context, const ContenderOptions& options) {
  bench::Tracers tracers = all_leak_tracers(context, options);
  keep_only(tracers, options.only, context);
  return tracers;
}

bench::BarNames contender_names(Context& context, bool peers) {
  ContenderOptions everything;
  everything.peers = peers;
  bench::BarNames names;
  for (const auto& tracer : all_tracers(context, everything, 0)) {
    names.tracers.insert(tracer->name());
    names.trees.insert(tracer->build_name());
  }
  for (const auto& tracer : all_leak_tracers(context, everything)) names.leak_tracers.insert(tracer->name());
  return names;
}

}  // namespace hemiray::app
