// Numbers of twice the digits: float-float (df_) for devices without double, double-double (dd_) for double builds.
#ifndef HR_LIB_PAIR_H
#define HR_LIB_PAIR_H

#include "lib/divide.h"

#ifdef HR_DOUBLE
#define HR_PAIR(name) dd_##name
#define HR_HALF double
#define HR_TWO double2
#include "lib/pair.def"
#else
#define HR_PAIR(name) df_##name
#define HR_HALF float
#define HR_TWO float2
#include "lib/pair.def"
#endif

#endif
