// The table of sides that pairs are made of, and what pairs are told apart by.
#ifndef HR_SHARED_PAIR_TYPES_H
#define HR_SHARED_PAIR_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

// Rows of the table, `stride` floats each.
#define HR_SIDE_CENTER 0u   // x, y, z [m]
#define HR_SIDE_CORNERS 3u  // three times x, y, z from the center [m]
#define HR_SIDE_NORMAL 12u  // x, y, z, to the front of the side
#define HR_SIDE_AREA 15u    // [m^2]; 0: padding
#define HR_SIDE_RADIUS 16u  // of the corners about the center [m]
#define HR_SIDE_SLOPE 17u   // how much rounding may tilt the normal
#define HR_SIDE_ROWS 18u
// The stride is a multiple of this; bit matrices have a row of stride bits a side.
#define HR_SIDE_PADDING 64u

// In place of a factor: this pair is too close, or cut by a plane, for the plain rules.
#define HR_PAIR_IS_NEAR -1.0f

// Distance of the centers over the sum of the radii beyond which 3 x 3 points, and 7 x 7, are enough. The largest
// relative error measured over whole pairs is HR_PAIR_FAR_ERROR (tests/radiosity/test_pair_factors.cpp).
#define HR_PAIR_FAR 10.0f
#define HR_PAIR_MIDDLE 3.0f
#define HR_PAIR_FAR_ERROR 2e-5f

HR_SHARED_END

#endif
