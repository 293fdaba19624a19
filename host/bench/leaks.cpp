#include "host/bench/leaks.hpp"

namespace hemiray::bench {
namespace {

constexpr std::uint32_t kSeed = 4;

LeakResult count_for(Tracer& tracer, const std::vector<shared::QueryRay>& rays) {
  tracer.load_rays(rays);
  tracer.intersect();
  tracer.occluded();
  LeakResult result;
  result.tracer = tracer.name();
  result.rays = rays.size();
  result.closest_hit_leaks = count_leaks(tracer.hits());
  result.any_hit_leaks = count_leaks(tracer.occlusions());
  return result;
}

}  // namespace

void run_leaks(const Tracers& tracers, std::uint32_t cells, std::uint32_t rays, std::vector<LeakResult>& results,
               const Tick& tick) {
  for (const LeakMesh& mesh : leak_meshes(cells)) {
    for (const auto& tracer : tracers) tracer->build(mesh.flat);
    for (const LeakTarget target : {LeakTarget::edges, LeakTarget::vertices}) {
      const std::vector<shared::QueryRay> aimed = leak_rays(mesh, target, rays, kSeed);
      for (const auto& tracer : tracers) {
        LeakResult result = count_for(*tracer, aimed);
        result.mesh = mesh.name;
        result.target = to_string(target);
        results.push_back(std::move(result));
        if (tick) tick();
      }
    }
  }
}

}  // namespace hemiray::bench
