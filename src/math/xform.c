/* Affine transforms.  SPDX-License-Identifier: Apache-2.0 */
#include "math/xform.h"

#include <string.h>

/* out = b * a: apply a, then b. */
static void compose(const double a[3][4], const double b[3][4], double out[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out[i][j] =
                b[i][0] * a[0][j] + b[i][1] * a[1][j] + b[i][2] * a[2][j] + (j == 3 ? b[i][3] : 0);
}

Xform xform_then(const Xform *first, const Xform *second)
{
    Xform out;
    compose(first->to, second->to, out.to);
    compose(second->from, first->from, out.from);
    return out;
}

Xform xform_inverse(const Xform *x)
{
    Xform out;
    memcpy(out.to, x->from, sizeof out.to);
    memcpy(out.from, x->to, sizeof out.from);
    return out;
}

Xform xform_translate(V3 by)
{
    Xform x = XFORM_IDENTITY;
    x.to[0][3] = by.x, x.to[1][3] = by.y, x.to[2][3] = by.z;
    x.from[0][3] = -by.x, x.from[1][3] = -by.y, x.from[2][3] = -by.z;
    return x;
}

Xform xform_scale(V3 by)
{
    Xform x = XFORM_IDENTITY;
    x.to[0][0] = by.x, x.to[1][1] = by.y, x.to[2][2] = by.z;
    x.from[0][0] = 1 / by.x, x.from[1][1] = 1 / by.y, x.from[2][2] = 1 / by.z;
    return x;
}

/* Fill an orthonormal transform: its inverse is its transpose. */
static Xform from_rotation(double m[3][3])
{
    Xform x = XFORM_IDENTITY;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            x.to[i][j] = m[i][j];
            x.from[j][i] = m[i][j];
        }
    }
    return x;
}

/* Rotate in the plane from axis a to axis b.  Quarter turns are exact. */
static Xform rotate_in_plane(int a, int b, double angle)
{
    double s = sin(angle), c = cos(angle);
    double quarters = angle / (PMS_PI / 2);
    if (fabs(quarters) < 1e9 && quarters == nearbyint(quarters)) {
        static const double sines[4] = {0, 1, 0, -1};
        int q = (int)((long long)quarters & 3);
        s = sines[q];
        c = sines[(q + 1) & 3];
    }
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    m[a][a] = c, m[a][b] = -s;
    m[b][a] = s, m[b][b] = c;
    return from_rotation(m);
}

Xform xform_rotate(V3 angles)
{
    Xform x = rotate_in_plane(1, 2, angles.x);
    Xform y = rotate_in_plane(2, 0, angles.y);
    Xform z = rotate_in_plane(0, 1, angles.z);
    Xform xy = xform_then(&x, &y);
    return xform_then(&xy, &z);
}

Xform xform_axis_rotate(V3 a, double angle)
{
    /* Rodrigues: p cos + (a x p) sin + a (a.p)(1-cos). */
    double s = sin(angle), c = cos(angle), k = 1 - c;
    double m[3][3] = {{c + a.x * a.x * k, a.x * a.y * k - a.z * s, a.x * a.z * k + a.y * s},
                      {a.y * a.x * k + a.z * s, c + a.y * a.y * k, a.y * a.z * k - a.x * s},
                      {a.z * a.x * k - a.y * s, a.z * a.y * k + a.x * s, c + a.z * a.z * k}};
    return from_rotation(m);
}

Xform xform_frame(V3 s, V3 t, V3 n, V3 o)
{
    double m[3][3] = {{s.x, t.x, n.x}, {s.y, t.y, n.y}, {s.z, t.z, n.z}};
    Xform turn = from_rotation(m), move = xform_translate(o);
    return xform_then(&turn, &move);
}

bool xform_from_matrix(const double to[3][4], Xform *out)
{
    V3 r0 = v3(to[0][0], to[0][1], to[0][2]);
    V3 r1 = v3(to[1][0], to[1][1], to[1][2]);
    V3 r2 = v3(to[2][0], to[2][1], to[2][2]);
    V3 o = v3(to[0][3], to[1][3], to[2][3]);
    double determinant = v3_dot(r0, v3_cross(r1, r2));
    /* The determinant of a matrix that is singular but for rounding is below a few ulps of
     * the product of its row lengths. */
    double size = v3_len(r0) * v3_len(r1) * v3_len(r2);
    if (!isfinite(determinant) || !v3_is_finite(o) || !(fabs(determinant) > 0x1p-48 * size))
        return false;
    V3 c0 = v3_scale(v3_cross(r1, r2), 1 / determinant);
    V3 c1 = v3_scale(v3_cross(r2, r0), 1 / determinant);
    V3 c2 = v3_scale(v3_cross(r0, r1), 1 / determinant);
    double inverse[3][4] = {{c0.x, c1.x, c2.x, 0}, {c0.y, c1.y, c2.y, 0}, {c0.z, c1.z, c2.z, 0}};
    V3 back = matrix_dir((const double(*)[4])inverse, o);
    inverse[0][3] = -back.x, inverse[1][3] = -back.y, inverse[2][3] = -back.z;
    memcpy(out->to, to, sizeof out->to);
    memcpy(out->from, inverse, sizeof out->from);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(inverse[i][j]))
                return false;
    return true;
}

bool xform_is_identity(const Xform *x)
{
    static const Xform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                   {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (x->to[i][j] != identity.to[i][j])
                return false;
    return true;
}

double xform_stretch(const Xform *x)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum += x->to[i][j] * x->to[i][j];
    return sqrt(sum);
}
