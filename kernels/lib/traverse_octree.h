// One step down an octree: the octants in an order in which the ray can meet them. Numbered from the corner that the
// ray comes from, bit a set for the farther half along axis a, every octant comes after those in front of it.
// Part of lib/traverse_cells.h.
#ifndef HR_LIB_TRAVERSE_OCTREE_H
#define HR_LIB_TRAVERSE_OCTREE_H

// Puts the octants that the ray meets on the stack and makes *visit the nearest one's; false if there is none.
static inline bool descend_cell(const SceneView* view, const Ray* ray, CellVisit* visit, CellVisit* stack, uint* size) {
  global const float* node = cell_node(view, visit->reference);
  global const int* child = (global const int*)node + HR_CELL_FIRST_CHILD;
  const real x = meet_plane(node[0], ray->origin.x, ray->inverse.x);
  const real y = meet_plane(node[1], ray->origin.y, ray->inverse.y);
  const real z = meet_plane(node[2], ray->origin.z, ray->inverse.z);
  const uint mirror = (ray->inverse.x < 0 ? 1u : 0u) | (ray->inverse.y < 0 ? 2u : 0u) | (ray->inverse.z < 0 ? 4u : 0u);
  const real t_in = visit->t_in, t_out = visit->t_out;
  const uint bottom = *size;
  for (uint octant = 8; octant-- > 0;) {
    CellVisit one;
    one.reference = child[octant ^ mirror];
    if (one.reference == HR_NO_CHILD) continue;
    const real in = max(octant & 1 ? max(x, t_in) : t_in, max(octant & 2 ? y : t_in, octant & 4 ? z : t_in));
    const real out = min(octant & 1 ? t_out : min(x, t_out), min(octant & 2 ? t_out : y, octant & 4 ? t_out : z));
    if (!(in <= out * HR_SLAB_PAD)) continue;
    one.t_in = in;
    one.t_out = out;
    stack[(*size)++] = one;
  }
  if (*size == bottom) return false;
  *visit = stack[--*size];
  return true;
}

#endif
