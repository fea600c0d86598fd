/* Newton's method towards a convex solid from outside.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/convex_line.h"

#include <math.h>

/* Near a tangency the steps halve the way. */
enum { STEPS_MAX = 80 };

/* Come from s, forwards (way 1) or back (-1); false when the line goes by. */
static bool approach(ConvexDistance distance, const void *line, double way, double precision,
                     double *s)
{
    for (int i = 0; i < STEPS_MAX; i++) {
        double slope, over = distance(line, *s, &slope);
        if (over <= 0)
            return true;
        if (!(way * slope < 0))
            return false;
        double step = over / slope;
        *s -= step;
        if (fabs(step) <= precision)
            return true;
    }
    return true;
}

bool convex_line_cross(ConvexDistance distance, const void *line, double lo, double hi,
                       double precision, double *in, double *out)
{
    *in = lo;
    *out = hi;
    return approach(distance, line, 1, precision, in) && *in < hi &&
           approach(distance, line, -1, precision, out) && *in < *out;
}

bool convex_line_first(ConvexDistance distance, const void *line, double lo, double hi, double end,
                       double precision, double *out, bool *is_entry)
{
    double slope;
    *is_entry = distance(line, lo, &slope) > 0;
    *out = *is_entry ? lo : end;
    if (!approach(distance, line, *is_entry ? 1 : -1, precision, out))
        return false;
    return *out > lo && *out < hi;
}
