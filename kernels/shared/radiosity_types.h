// Radiosity: patches are the triangles of a mesh of their own. Side 2 i is the front of triangle i, 2 i + 1 its back.
#ifndef HR_SHARED_RADIOSITY_TYPES_H
#define HR_SHARED_RADIOSITY_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

#define HR_NO_SIDE 0xffffffffu

// Cells' form factors are summed as integers, 2^36 to 1: exactly, in whatever order.
#define HR_CELL_UNITS_LOG2 36

// How hemicubes are laid over sides. A cube has a top of n x n cells and four side faces of n x n / 2. Its cells are
// numbered: top y n + x; then the faces +t, -t, +b, -b of the frame (t, b, normal), each z n + along.
typedef struct HemicubeParams {
  uint resolution;  // n: cells along an edge of the top, even
  uint divisions;   // a side has divisions^2 sample points, the centroids of congruent parts
  uint turned;      // 1: each cube is turned about the normal by an angle of its own
  uint jittered;    // 1: rays go through random points of their cells, not their middles
  uint seed_key;
  uint row_count;  // sides in this batch
  uint side_count;
  uint pad;
} HemicubeParams;

HR_SHARED_END

#endif
