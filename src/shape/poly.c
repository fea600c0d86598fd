/* Algebraic surfaces: where a polynomial in x, y and z of degree 2 to 35 is zero; inside it is
 * negative.
 *
 * Along a line the polynomial is one in t, made by Horner's scheme with x, y and z as linear
 * polynomials about the point of the line nearest to the origin.  The bounds on the errors of its
 * coefficients come from the same scheme over magnitudes.  Where it only touches zero, as squares
 * of other polynomials do everywhere, there is a sheet: a surface without an inside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"
#include "shape/shape_int.h"

#include <string.h>

enum { TERMS_MAX = ROOTS_DEGREE_MAX + 1, PART_SURFACE = 0, PART_SHEET = 1 };

/* Rows of coefficients belong to one power of x and of y. */
typedef struct PolyRow {
    const double *c; /* of z^degree and lower powers */
    int degree;      /* -1: all of the row is 0 */
} PolyRow;

struct PolyData {
    int degree;
    const PolyRow *rows; /* from x^degree down, for each from the highest power of y down */
};

int poly_term_count(int degree)
{
    return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

int poly_term_index(int degree, int i, int j, int k)
{
    int a = degree - i, b = a - j, c = b - k;
    return a * (a + 1) * (a + 2) / 6 + b * (b + 1) / 2 + c;
}

Shape *shape_poly(Arena *arena, int degree, const double *c)
{
    Shape *shape = leaf_new(arena, SHAPE_POLY);
    PolyData *data = ARENA_NEW(arena, PolyData);
    PolyRow *rows = ARENA_ARRAY(arena, PolyRow, (size_t)(degree + 1) * (size_t)(degree + 2) / 2);
    double *own = arena_copy(arena, c, (size_t)poly_term_count(degree) * sizeof *c);
    if (!shape || !data || !rows || !own)
        return NULL;
    *data = (PolyData){degree, rows};
    for (int a = 0; a <= degree; a++)
        for (int b = 0; b <= a; b++, rows++) {
            *rows = (PolyRow){own, b};
            own += b + 1;
            while (rows->degree >= 0 && rows->c[0] == 0) {
                rows->degree--;
                rows->c++;
            }
        }
    shape->u.poly = data;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- along a line -------------------------------------------------------------------------- */

/* A number, its magnitude when all terms add up, and the same with the errors of x, y and z. */
typedef double Trio __attribute__((vector_size(4 * sizeof(double))));

typedef struct Along {
    int degree; /* -1: zero */
    Trio c[TERMS_MAX];
} Along;

/* One of x, y and z along the line: at + way * t. */
typedef struct Linear {
    Trio at, way;
} Linear;

static void set_axis(Linear *axis, double at, double way, double at_error, double way_error)
{
    double a = fabs(at), w = fabs(way);
    axis->at = (Trio){at, a, a + at_error, 0};
    axis->way = (Trio){way, w, w + way_error, 0};
}

static void set_axes(Linear axis[3], V3 at, V3 way, V3 at_error, V3 way_error)
{
    set_axis(&axis[0], at.x, way.x, at_error.x, way_error.x);
    set_axis(&axis[1], at.y, way.y, at_error.y, way_error.y);
    set_axis(&axis[2], at.z, way.z, at_error.z, way_error.z);
}

/* Multiply by a linear polynomial, keeping terms up to `most`. */
static inline void times(Along *p, const Linear *by, int most)
{
    int n = p->degree;
    if (n < 0)
        return;
    if (n < most) {
        p->c[n + 1] = p->c[n] * by->way;
        p->degree = n + 1;
    }
    for (int i = n; i > 0; i--)
        p->c[i] = p->c[i] * by->at + p->c[i - 1] * by->way;
    p->c[0] *= by->at;
}

static inline void add(Along *p, const Along *other)
{
    int i = 0;
    for (; i <= p->degree && i <= other->degree; i++)
        p->c[i] += other->c[i];
    for (; i <= other->degree; i++)
        p->c[i] = other->c[i];
    if (other->degree > p->degree)
        p->degree = other->degree;
}

static void add_number(Along *p, double c)
{
    if (p->degree < 0) {
        p->degree = 0;
        p->c[0] = (Trio){0, 0, 0, 0};
    }
    double a = fabs(c);
    p->c[0] += (Trio){c, a, a, 0};
}

/* Expand along a line in powers of t up to `most`. */
static void expand(const PolyData *poly, const Linear axis[3], int most, Along *out)
{
    const PolyRow *row = poly->rows;
    Along y, z;
    out->degree = -1;
    for (int a = 0; a <= poly->degree; a++) {
        times(out, &axis[0], most);
        y.degree = -1;
        for (int b = 0; b <= a; b++, row++) {
            times(&y, &axis[1], most);
            if (row->degree < 0)
                continue;
            z.degree = -1;
            for (int k = 0; k <= row->degree; k++) {
                times(&z, &axis[2], most);
                if (row->c[k] != 0)
                    add_number(&z, row->c[k]);
            }
            add(&y, &z);
        }
        add(out, &y);
    }
}

/* The relative rounding of a coefficient: of each product up to `degree` factors and as many sums
 * for each axis. */
static double relative_error(int degree)
{
    return (6 * degree + 8) * EPS_DOUBLE;
}

/* The polynomial of a ray about t = base. */
typedef struct RayPoly {
    int degree;
    double base;
    double c[TERMS_MAX], error[TERMS_MAX];
} RayPoly;

static void ray_poly(const Shape *shape, const Ray *ray, RayPoly *out)
{
    const PolyData *poly = shape->u.poly;
    LocalRay l;
    local_ray(shape, ray, &l);
    double base = -v3_dot(l.o, l.d) / v3_len2(l.d);
    V3 p = v3_mad(l.o, base, l.d), e = local_error(&l, base);
    Linear axis[3];
    set_axes(axis, p, l.d, e, l.d_error);
    Along along;
    expand(poly, axis, poly->degree, &along);
    out->base = base;
    out->degree = along.degree;
    double rounding = relative_error(poly->degree);
    for (int i = 0; i <= along.degree; i++) {
        Trio c = along.c[i];
        out->c[i] = c[0];
        out->error[i] = c[2] - c[1] + rounding * c[2];
    }
    /* A leading coefficient that is nothing but rounding would put roots nowhere. */
    while (out->degree > 0 && fabs(out->c[out->degree]) <= out->error[out->degree])
        out->degree--;
}

static int find(const RayPoly *poly, double near, double far, int most, bool *is_inside, Root *out)
{
    *is_inside = false;
    if (poly->degree < 0)
        return 0;
    return roots_first(poly->c, poly->error, poly->degree, near - poly->base, far - poly->base,
                       most, is_inside, out);
}

/* Make a crossing of the root at out[i]; returns how many roots it stands for. */
static int take(const Shape *shape, const RayPoly *poly, const Root *root, int i, int count,
                bool *is_inside, Crossing *out)
{
    bool is_sheet = i + 1 < count && root[i + 1].x == root[i].x;
    double t = poly->base + root[i].x;
    LeafHit hit = {t, root[i].error + 4 * EPS_DOUBLE * (fabs(poly->base) + fabs(t)), PART_SHEET, 0,
                   true};
    if (!is_sheet) {
        hit.part = PART_SURFACE;
        hit.change = *is_inside ? -1 : 1;
        *is_inside = !*is_inside;
    }
    crossing_fill(shape, &hit, out);
    return is_sheet ? 2 : 1;
}

static bool poly_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    RayPoly poly;
    Root root[TERMS_MAX];
    Crossing crossing;
    bool is_before, is_inside;
    ray_poly(shape, line->ray, &poly);
    int count = find(&poly, line->near, line->far, TERMS_MAX, &is_before, root);
    is_inside = is_before;
    for (int i = 0; i < count;) {
        i += take(shape, &poly, root, i, count, &is_inside, &crossing);
        scratch_push(scratch, &crossing);
    }
    return is_before;
}

static bool poly_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    RayPoly poly;
    Root root[TERMS_MAX];
    bool is_inside;
    ray_poly(shape, ray, &poly);
    int count = find(&poly, ray->tmin, ray->tmax, 1, &is_inside, root);
    for (int i = 0; i < count;) {
        i += take(shape, &poly, root, i, count, &is_inside, out);
        if (out->t > ray->tmin && out->t < ray->tmax)
            return true;
    }
    return false;
}

/* --- at a point ---------------------------------------------------------------------------- */

typedef struct Value {
    double f, error; /* error: bound on that of f */
    V3 gradient;
} Value;

static Value value_at(const PolyData *poly, V3 p)
{
    const PolyRow *row = poly->rows;
    V3 a = v3_abs(p);
    double f = 0, size = 0, fx = 0, fy = 0, fz = 0;
    for (int i = 0; i <= poly->degree; i++) {
        double g = 0, g_size = 0, gy = 0, gz = 0;
        for (int j = 0; j <= i; j++, row++) {
            double h = 0, h_size = 0, hz = 0;
            for (int k = 0; k <= row->degree; k++) {
                hz = hz * p.z + h;
                h = h * p.z + row->c[k];
                h_size = h_size * a.z + fabs(row->c[k]);
            }
            gy = gy * p.y + g;
            gz = gz * p.y + hz;
            g = g * p.y + h;
            g_size = g_size * a.y + h_size;
        }
        fx = fx * p.x + f;
        fy = fy * p.x + gy;
        fz = fz * p.x + gz;
        f = f * p.x + g;
        size = size * a.x + g_size;
    }
    return (Value){f, relative_error(poly->degree) * size, v3(fx, fy, fz)};
}

static double second_along(const PolyData *poly, V3 p, V3 d)
{
    Linear axis[3];
    set_axes(axis, p, d, v3(0, 0, 0), v3(0, 0, 0));
    Along along;
    expand(poly, axis, 2, &along);
    return along.degree < 2 ? 0 : 2 * along.c[2][0];
}

/* The rows of the second derivatives. */
static void second_at(const PolyData *poly, V3 p, V3 row[3])
{
    double xx = second_along(poly, p, v3(1, 0, 0)), yy = second_along(poly, p, v3(0, 1, 0));
    double zz = second_along(poly, p, v3(0, 0, 1));
    double xy = 0.5 * (second_along(poly, p, v3(1, 1, 0)) - xx - yy);
    double xz = 0.5 * (second_along(poly, p, v3(1, 0, 1)) - xx - zz);
    double yz = 0.5 * (second_along(poly, p, v3(0, 1, 1)) - yy - zz);
    row[0] = v3(xx, xy, xz);
    row[1] = v3(xy, yy, yz);
    row[2] = v3(xz, yz, zz);
}

static V3 rows_times(const V3 row[3], V3 u)
{
    return v3(v3_dot(row[0], u), v3_dot(row[1], u), v3_dot(row[2], u));
}

/* Return the direction in which the surface bends most: across a sheet. */
static V3 steepest(const V3 row[3])
{
    V3 n = row[0];
    for (int i = 1; i < 3; i++)
        if (v3_len2(row[i]) > v3_len2(n))
            n = row[i];
    n = v3_unit(n);
    for (int i = 0; i < 6; i++)
        n = v3_unit(rows_times(row, n));
    return v3_len2(n) > 0 ? n : v3(1, 0, 0);
}

/* How far a crossing may be off, in the leaf's own units, as found along its ray. */
static double reach_of(const Shape *shape, const Crossing *crossing, V3 p)
{
    return 4 * crossing->t_error * v3_len(shape->rounding.row) + 16 * EPS_DOUBLE * v3_sum_abs(p);
}

/* The height over a sheet is where the gradient across it is zero. */
static void sheet_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const PolyData *poly = shape->u.poly;
    double reach = reach_of(shape, crossing, p), bend = 0;
    V3 row[3], n = v3(1, 0, 0);
    Value v = value_at(poly, p);
    for (int i = 0; i < 2; i++) {
        second_at(poly, p, row);
        n = steepest(row);
        bend = v3_dot(n, rows_times(row, n));
        double step = v3_dot(v.gradient, n) / bend;
        if (!(fabs(step) <= reach))
            break;
        p = v3_mad(p, -step, n);
        v = value_at(poly, p);
    }
    double error = 2 * sqrt(16 * v.error / fabs(bend));
    out->p = p;
    out->ng = n;
    out->error = (error < reach || !(reach > 0) ? error : reach) + 8 * EPS_DOUBLE * v3_sum_abs(p);
}

/* Is the gradient much larger as far from p as a crossing may be off?  Then the root is a multiple
 * one: the gradient on it is nothing but rounding, and no ray can tell what is so near from it. */
static bool is_flat(const PolyData *poly, V3 p, V3 gradient, double off)
{
    V3 n = v3_unit(gradient);
    V3 beside = v3_mad(p, off, v3_is_finite(n) && v3_len2(n) > 0 ? n : v3(1, 0, 0));
    double slope = v3_len(gradient);
    return slope == 0 || v3_len(value_at(poly, beside).gradient) > 2 * slope;
}

/* The gradients to both sides of a root of odd multiplicity point the same way. */
static V3 gradient_around(const PolyData *poly, V3 p, double off)
{
    V3 sum = v3(0, 0, 0);
    for (int i = 0; i < 6; i++) {
        double side = i % 2 ? off : -off;
        V3 at = v3_add(p, v3(i / 2 == 0 ? side : 0, i / 2 == 1 ? side : 0, i / 2 == 2 ? side : 0));
        sum = v3_add(sum, value_at(poly, at).gradient);
    }
    return sum;
}

/* A gradient counts whose value at the end of what a crossing may be off is so many of its errors.
 */
#define SLOPE_SURE 16

static void poly_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    if (crossing->part == PART_SHEET) {
        sheet_point(shape, crossing, p, out);
        return;
    }
    const PolyData *poly = shape->u.poly;
    double reach = reach_of(shape, crossing, p);
    Value v = value_at(poly, p);
    for (int i = 0; i < 4 && fabs(v.f) > v.error; i++) {
        double step = v.f / v3_len2(v.gradient);
        if (!(fabs(step) * v3_len(v.gradient) <= reach))
            break;
        V3 next = v3_mad(p, -step, v.gradient);
        Value better = value_at(poly, next);
        if (!(fabs(better.f) < fabs(v.f)))
            break;
        p = next;
        v = better;
    }
    double slope = v3_len(v.gradient), error = (8 * v.error + fabs(v.f)) / slope;
    V3 up = v.gradient;
    if (is_flat(poly, p, v.gradient, reach)) {
        up = gradient_around(poly, p, reach);
        error = reach;
    }
    out->p = p;
    out->ng = v3_len2(up) > 0 ? v3_unit(up) : v3(1, 0, 0);
    out->error = (error < reach ? error : reach) + 8 * EPS_DOUBLE * v3_sum_abs(p);
}

static bool poly_is_inside(const Shape *shape, V3 p)
{
    return value_at(shape->u.poly, p).f <= 0;
}

static Bound poly_bound(const Shape *shape)
{
    (void)shape;
    return BOUND_ALL;
}

const ShapeOps poly_ops = {.list = poly_list,
                           .closest = poly_closest,
                           .point = poly_point,
                           .is_inside = poly_is_inside,
                           .bound = poly_bound};
