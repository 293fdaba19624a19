// How many nodes and leaf blocks rays come to on their way through a wide BVH: what a tree is worth, free of the noise
// of times. The traversals are those of the queries, compiled with a counter.
#define HR_COUNT_VISITS
#include "lib/chunk.h"
#include "lib/query_ray.h"

// visits[g] = nodes and blocks that the rays of chunk g visit, asking for the closest hit or for any. Launch: G items.
kernel void query_count_visits(HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global uint2* restrict visits,
                               const uint count, const uint any_hit, const RenderParams params) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  HR_MAKE_SCENE_VIEW(params)
  uint counts[2] = {0, 0};
  view.visits = counts;
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    if (any_hit) {
      query_any(&view, rays[i]);
    } else {
      query_closest(&view, rays[i]);
    }
  }
  visits[g] = (uint2)(counts[0], counts[1]);
}
