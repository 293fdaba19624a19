// The sides whose factors are computed pair by pair, by number in a table of rows (HR_SIDE_...), HR_P columns at once.
// What a pair gives does not depend on which of the two is the row: every sum is symmetric, term by term.
#ifndef HR_RADIOSITY_PAIR_SIDES_H
#define HR_RADIOSITY_PAIR_SIDES_H

#include "lib/vec.h"
#include "radiosity/wide.h"
#include "shared/pair_types.h"

#pragma OPENCL FP_CONTRACT OFF

#define HR_SIDE_VALUE(row, side) sides[(row)*stride + (side)]
#define HR_SIDE_VALUES(row, first) load_lanes(sides + (row)*stride + (first))

// Side i as a row sees it, and HR_P columns from `first` on.
typedef struct PairRow {
  float center[3], corner[3][3], normal[3];  // corners from the center
  float area, radius, slope;
} PairRow;

typedef struct PairColumns {
  floatp away[3];                     // from the row's center to theirs
  floatp corner[3][3];                // from their centers
  floatp row_heights[3], heights[3];  // of the corners of the row over the columns' planes, of theirs over the row's
  floatp row_height, height;          // the same of the centers
  floatp distance2;                   // of the centers [m^2]
  intp facing;                        // some of each is in front of the other
  intp whole;                         // and all of it
} PairColumns;

static inline PairRow load_pair_row(global const float* sides, uint stride, uint i) {
  PairRow row;
  for (uint c = 0; c < 3; c++) {
    row.center[c] = HR_SIDE_VALUE(HR_SIDE_CENTER + c, i);
    row.normal[c] = HR_SIDE_VALUE(HR_SIDE_NORMAL + c, i);
    for (uint k = 0; k < 3; k++) row.corner[k][c] = HR_SIDE_VALUE(HR_SIDE_CORNERS + 3 * k + c, i);
  }
  row.area = HR_SIDE_VALUE(HR_SIDE_AREA, i);
  row.radius = HR_SIDE_VALUE(HR_SIDE_RADIUS, i);
  row.slope = HR_SIDE_VALUE(HR_SIDE_SLOPE, i);
  return row;
}

// `flatness`: how far rounding moves a vertex [m]; a normal it turns by that over the triangle's height (slope).
static inline PairColumns load_pair_columns(global const float* sides, uint stride, const PairRow* row, uint first,
                                            float flatness) {
  PairColumns p;
  floatp n[3];
  for (uint c = 0; c < 3; c++) {
    p.away[c] = HR_SIDE_VALUES(HR_SIDE_CENTER + c, first) - row->center[c];
    n[c] = HR_SIDE_VALUES(HR_SIDE_NORMAL + c, first);
    for (uint k = 0; k < 3; k++) p.corner[k][c] = HR_SIDE_VALUES(HR_SIDE_CORNERS + 3 * k + c, first);
  }
  const floatp rx = (floatp)(row->normal[0]), ry = (floatp)(row->normal[1]), rz = (floatp)(row->normal[2]);
  p.height = dot_lanes(rx, ry, rz, p.away[0], p.away[1], p.away[2]);
  p.row_height = -dot_lanes(n[0], n[1], n[2], p.away[0], p.away[1], p.away[2]);
  floatp least = (floatp)(INFINITY), most = (floatp)(-INFINITY), row_least = least, row_most = most;
  for (uint k = 0; k < 3; k++) {
    p.heights[k] = dot_lanes(rx, ry, rz, p.corner[k][0], p.corner[k][1], p.corner[k][2]);
    p.row_heights[k] = dot_lanes(n[0], n[1], n[2], (floatp)(row->corner[k][0]), (floatp)(row->corner[k][1]),
                                 (floatp)(row->corner[k][2]));
    const floatp h = p.height + p.heights[k], g = p.row_height + p.row_heights[k];
    least = min(least, h);
    most = max(most, h);
    row_least = min(row_least, g);
    row_most = max(row_most, g);
  }
  p.distance2 = dot_lanes(p.away[0], p.away[1], p.away[2], p.away[0], p.away[1], p.away[2]);
  const floatp distance = sqrt(p.distance2);
  const floatp slack = fma((floatp)(row->slope), distance, (floatp)(flatness)),
               row_slack = fma(HR_SIDE_VALUES(HR_SIDE_SLOPE, first), distance, (floatp)(flatness));
  p.facing = (most > slack) & (row_most > row_slack);
  p.whole = p.facing & (least >= -slack) & (row_least >= -row_slack);
  return p;
}

#endif
