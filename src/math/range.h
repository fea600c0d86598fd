/* Ranges of numbers.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_RANGE_H
#define PMS_MATH_RANGE_H

#include <math.h>

/* All numbers from lo to hi. */
typedef struct Range {
    double lo, hi;
} Range;

#define RANGE_ALL ((Range){-INFINITY, INFINITY})

#endif
