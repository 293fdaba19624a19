// Rays that go on from what others hit, as the path kernels send them: how well surfaces are left is measured by them.
#include "lib/offset.h"
#include "lib/query_ray.h"
#include "lib/surface.h"

// For each ray: hits[i], its closest hit; leaving[i], the ray that goes on from there into wanted[i].xyz, turned round
// the surface where that is not on the side wanted[i].w: positive where the ray came from, negative beyond; next[i],
// its closest hit, without the primitive that it leaves if that is flat. A miss has neither. Launch: count items.
kernel void query_leave_surface(HR_SCENE_PARAMETERS global const QueryRay* restrict rays,
                                global const float4* restrict wanted, global QueryHit* restrict hits,
                                global QueryRay* restrict leaving, global QueryHit* restrict next, const uint count,
                                const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  const QueryHit found = query_closest(&view, rays[i]);
  hits[i] = found;
  const QueryHit none = {0, 0, 0, HR_NO_PRIMITIVE};
  next[i] = none;
  leaving[i] = rays[i];
  if (found.primitive == HR_NO_PRIMITIVE) return;
  const Ray ray = query_ray(rays[i]);
  const Hit hit = {found.t, found.u, found.v, found.primitive};
  const Surface surface = surface_at(&view, ray.origin, ray.direction, &hit);
  real3 direction = (real3)(wanted[i].x, wanted[i].y, wanted[i].z);
  const real cosine = dot3(direction, surface.normal);
  if (cosine * wanted[i].w < 0) direction -= surface.normal * (2 * cosine);
  const real3 origin = offset_origin(surface.position, surface.error, surface.normal, direction);
  const bool is_sphere =
      hit.primitive >= view.triangle_count && hit.primitive < view.triangle_count + view.sphere_count;
  const Ray onward = make_ray(origin, direction, 0, INFINITY);
  const Skip skip = {HR_HAS(SPHERES) && is_sphere ? HR_NO_PRIMITIVE : hit.primitive, 1, 0};
  const Hit second = traverse_closest(&view, &onward, &skip);
  const QueryRay left = {(float4)(origin.x, origin.y, origin.z, 0),
                         (float4)(direction.x, direction.y, direction.z, INFINITY)};
  const QueryHit result = {(float)second.t, (float)second.u, (float)second.v, second.primitive};
  leaving[i] = left;
  next[i] = result;
}
