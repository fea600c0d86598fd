/* Spline spans in Bezier form.  SPDX-License-Identifier: Apache-2.0 */
#include "math/spline_curve.h"

int spline_degree(SplineKind kind)
{
    return kind == SPLINE_LINEAR ? 1 : kind == SPLINE_QUADRATIC ? 2 : 3;
}

int spline_points_min(SplineKind kind)
{
    return spline_degree(kind) + 1;
}

int spline_span_count(SplineKind kind, int point_count)
{
    int least = spline_points_min(kind);
    if (point_count < least)
        return 0;
    return kind == SPLINE_BEZIER ? point_count / 4 : point_count - least + 1;
}

void spline_span(SplineKind kind, const double *points, int stride, int span, double *out)
{
    double p[SPLINE_POINTS_MAX] = {0};
    int first = kind == SPLINE_BEZIER ? 4 * span : span;
    for (int i = 0; i < spline_points_min(kind); i++)
        p[i] = points[(long)(first + i) * stride];
    switch (kind) {
    case SPLINE_LINEAR:
        out[0] = p[0];
        out[1] = p[1];
        break;
    case SPLINE_QUADRATIC:
        out[0] = p[1];
        out[1] = p[1] + (p[2] - p[0]) / 4;
        out[2] = p[2];
        break;
    case SPLINE_CUBIC:
        out[0] = p[1];
        out[1] = p[1] + (p[2] - p[0]) / 6;
        out[2] = p[2] - (p[3] - p[1]) / 6;
        out[3] = p[2];
        break;
    case SPLINE_BEZIER:
        for (int i = 0; i < 4; i++)
            out[i] = p[i];
        break;
    case SPLINE_B:
        out[0] = (p[0] + 4 * p[1] + p[2]) / 6;
        out[1] = (2 * p[1] + p[2]) / 3;
        out[2] = (p[1] + 2 * p[2]) / 3;
        out[3] = (p[1] + 4 * p[2] + p[3]) / 6;
        break;
    }
}
