// One step down a k-d tree: the side that the ray meets first, then the other, by the ray's direction along the axis.
// Part of lib/traverse_cells.h.
#ifndef HR_LIB_TRAVERSE_KDTREE_H
#define HR_LIB_TRAVERSE_KDTREE_H

// Makes *visit the nearer child's and puts the farther one's on the stack; false if the ray meets neither.
static inline bool descend_cell(const SceneView* view, const Ray* ray, CellVisit* visit, CellVisit* stack, uint* size) {
  global const float* node = cell_node(view, visit->reference);
  global const int* words = (global const int*)node;
  const int axis = words[3];
  const real inverse = pick(ray->inverse, axis);
  const real t = meet_plane(node[0], pick(ray->origin, axis), inverse);
  const int nearer = inverse < 0 ? words[2] : words[1], farther = inverse < 0 ? words[1] : words[2];
  const bool enters_nearer = nearer != HR_NO_CHILD && visit->t_in <= t * HR_SLAB_PAD;
  const bool enters_farther = farther != HR_NO_CHILD && t <= visit->t_out * HR_SLAB_PAD;
  const CellVisit far_visit = {max(visit->t_in, t), visit->t_out, farther};
  if (!enters_nearer) {
    *visit = far_visit;
    return enters_farther;
  }
  if (enters_farther) stack[(*size)++] = far_visit;
  visit->t_out = min(visit->t_out, t);
  visit->reference = nearer;
  return true;
}

#endif
