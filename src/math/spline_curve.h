/* The curves of lathe, prism and sphere_sweep: spans between knots, in Bezier form.
 *
 * Spans beside each other share their knot to the last bit.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_SPLINE_CURVE_H
#define PMS_MATH_SPLINE_CURVE_H

typedef enum SplineKind {
    SPLINE_LINEAR,
    SPLINE_QUADRATIC, /* a first control point, then knots */
    SPLINE_CUBIC,     /* Catmull-Rom: a control point at each end */
    SPLINE_BEZIER,    /* four points a span */
    SPLINE_B          /* uniform, cubic */
} SplineKind;

enum { SPLINE_POINTS_MAX = 4 };

/* A span of a curve in a plane: the Bernstein coefficients of its two coordinates. */
typedef struct CurveSpan {
    double a[SPLINE_POINTS_MAX], b[SPLINE_POINTS_MAX];
} CurveSpan;

/* Return the degree of the spans. */
int spline_degree(SplineKind kind);

/* Return how many points the first span wants. */
int spline_points_min(SplineKind kind);

/* Return how many spans so many points make; fewer than spline_points_min make none. */
int spline_span_count(SplineKind kind, int point_count);

/* Write the Bernstein coefficients of one coordinate of a span.
 *
 * points  the coordinate of the first point; that of the next is `stride` numbers further on. */
void spline_span(SplineKind kind, const double *points, int stride, int span, double *out);

#endif
