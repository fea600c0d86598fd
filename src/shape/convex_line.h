/* Where a line enters and leaves a convex solid whose distance is known.
 *
 * The distance to a convex solid is a convex function along a line: Newton's method from outside
 * comes nearer with every step and never goes past the surface.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_CONVEX_LINE_H
#define PMS_SHAPE_CONVEX_LINE_H

#include <stdbool.h>

/* Return the distance of the point at s of a line from a solid, negative inside; *slope: its
 * derivative. */
typedef double (*ConvexDistance)(const void *line, double s, double *slope);

/* Find where a line enters and leaves; false when it misses the solid, to rounding.
 *
 * lo, hi     a part of the line with all of the solid
 * precision  of the distances */
bool convex_line_cross(ConvexDistance distance, const void *line, double lo, double hi,
                       double precision, double *in, double *out);

/* Find the first place between lo and hi where a line enters or leaves, *is_entry telling which;
 * false when there is none.  end: the line is outside there and beyond. */
bool convex_line_first(ConvexDistance distance, const void *line, double lo, double hi, double end,
                       double precision, double *out, bool *is_entry);

#endif
