/* Axis-parallel boxes.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bound.h"

Bound bound_transform(Bound b, const Xform *x)
{
    if (bound_is_empty(b))
        return b;
    if (!bound_is_finite(b))
        return BOUND_ALL;
    Bound out = BOUND_EMPTY;
    for (int corner = 0; corner < 8; corner++) {
        V3 p = v3(corner & 1 ? b.hi.x : b.lo.x, corner & 2 ? b.hi.y : b.lo.y,
                  corner & 4 ? b.hi.z : b.lo.z);
        out = bound_add(out, xform_point(x, p));
    }
    return out;
}
