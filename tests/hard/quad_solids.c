/* The oracle's curved solids: polynomials, fields, swept and turned curves, iterated and written
 * functions.  SPDX-License-Identifier: Apache-2.0 */
#include "quad_shapes.h"

/* --- polynomials ---------------------------------------------------------------------------- */

static Shape *make_poly(ShapeKit *kit, int degree)
{
    double c[128];
    int count = poly_term_count(degree);
    for (int i = 0; i < count; i++)
        c[i] = kit_number(kit, -1, 1);
    return shape_poly(kit->arena, degree, c);
}

static Shape *make_cubic(ShapeKit *kit)
{
    return make_poly(kit, 3);
}

static Shape *make_quartic(ShapeKit *kit)
{
    return make_poly(kit, 4);
}

static Shape *make_sextic(ShapeKit *kit)
{
    return make_poly(kit, 6);
}

/* x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + c = 0 */
static Shape *make_tooth(ShapeKit *kit)
{
    double c[35] = {0};
    for (int axis = 0; axis < 3; axis++) {
        int e[3] = {0};
        e[axis] = 4;
        c[poly_term_index(4, e[0], e[1], e[2])] = 1;
        e[axis] = 2;
        c[poly_term_index(4, e[0], e[1], e[2])] = -1;
    }
    c[poly_term_index(4, 0, 0, 0)] = kit_number(kit, 0, 0.5);
    return shape_poly(kit->arena, 4, c);
}

static Shape *make_superellipsoid(ShapeKit *kit)
{
    double e = kit_number(kit, 0.1, 2), n = kit_number(kit, 0.1, 2);
    return shape_superellipsoid(kit->arena, e, n);
}

/* --- blobs ---------------------------------------------------------------------------------- */

static BlobComponent component(ShapeKit *kit, bool is_ball)
{
    double radius = kit_number(kit, 0.5, 1), strength = kit_number(kit, -0.5, 1.5);
    Xform scale = xform_scale(v3(radius, radius, radius)), turn = xform_rotate(kit_point(kit, 3));
    Xform move = xform_translate(kit_point(kit, 0.5)), place = xform_then(&scale, &turn);
    return (BlobComponent){.place = xform_then(&place, &move),
                           .length = is_ball ? 0 : kit_number(kit, 0.2, 1),
                           .strength = strength,
                           .texture = MESH_NO_TEXTURE};
}

static Shape *make_blob(ShapeKit *kit)
{
    enum { COUNT = 5 };
    BlobComponent c[COUNT];
    for (int i = 0; i < COUNT; i++)
        c[i] = component(kit, i < 3);
    c[0].strength = 2;
    return shape_blob(kit->arena, kit_number(kit, 0.1, 0.5), c, COUNT, false);
}

/* --- curves --------------------------------------------------------------------------------- */

/* A closed loop of four quadratic or cubic spans, or a polygon of as many sides. */
static CurveSpan *loop(ShapeKit *kit, int degree, double radius, double at)
{
    static const double side[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    CurveSpan *spans = ARENA_ARRAY(kit->arena, CurveSpan, 4);
    double knot[4][2];
    for (int i = 0; i < 4; i++) {
        knot[i][0] = at + radius * (side[i][0] + kit_short(kit, -0.5, 0.5));
        knot[i][1] = radius * (side[i][1] + kit_short(kit, -0.5, 0.5));
    }
    for (int i = 0; spans && i < 4; i++) {
        const double *from = knot[i], *to = knot[(i + 1) % 4];
        for (int k = 0; k <= degree; k++) {
            spans[i].a[k] = k < degree ? from[0] : to[0];
            spans[i].b[k] = k < degree ? from[1] : to[1];
            if (k > 0 && k < degree) {
                spans[i].a[k] += kit_short(kit, -0.5, 0.5);
                spans[i].b[k] += kit_short(kit, -0.5, 0.5);
            }
        }
    }
    return spans;
}

static Shape *make_prism_of(ShapeKit *kit, int degree, bool is_conic)
{
    double lo = kit_short(kit, is_conic ? 0.25 : -1, 0.5), hi = lo + kit_short(kit, 0.25, 1);
    PrismForm form = {.lo = lo, .hi = hi, .is_conic = is_conic, .degree = degree, .span_count = 4};
    CurveSpan *spans = loop(kit, degree, 0.5, 0);
    form.spans = spans;
    for (int i = 0; i < 4; i++)
        kit_mark(kit, v3(is_conic ? hi * spans[i].a[0] : spans[i].a[0], hi,
                         is_conic ? hi * spans[i].b[0] : spans[i].b[0]));
    return shape_prism(kit->arena, &form);
}

static Shape *make_prism(ShapeKit *kit)
{
    return make_prism_of(kit, 1, false);
}

static Shape *make_cubic_prism(ShapeKit *kit)
{
    return make_prism_of(kit, 3, false);
}

static Shape *make_conic_prism(ShapeKit *kit)
{
    return make_prism_of(kit, 3, true);
}

static Shape *make_lathe_of(ShapeKit *kit, int degree)
{
    CurveSpan *spans = loop(kit, degree, 0.25, 0.75);
    return spans ? shape_lathe(kit->arena, degree, spans, 4) : NULL;
}

static Shape *make_lathe(ShapeKit *kit)
{
    return make_lathe_of(kit, 1);
}

static Shape *make_quadratic_lathe(ShapeKit *kit)
{
    return make_lathe_of(kit, 2);
}

static Shape *make_cubic_lathe(ShapeKit *kit)
{
    return make_lathe_of(kit, 3);
}

static Shape *make_sor(ShapeKit *kit)
{
    V2 points[6];
    for (int i = 0; i < 6; i++) {
        points[i].u = kit_number(kit, 0.3, 1);
        points[i].v = 0.5 * (i - 2.5);
    }
    return shape_sor(kit->arena, points, 6, false);
}

static Shape *make_sweep_of(ShapeKit *kit, SplineKind kind, int count)
{
    double ball[6][4];
    for (int i = 0; i < count; i++) {
        V3 p = kit_point(kit, 1);
        ball[i][0] = p.x, ball[i][1] = p.y, ball[i][2] = p.z;
        ball[i][3] = kit_number(kit, 0.1, 0.4);
    }
    uint32_t spans = (uint32_t)spline_span_count(kind, count);
    SweepSpan *out = ARENA_ARRAY(kit->arena, SweepSpan, spans);
    for (uint32_t i = 0; out && i < spans; i++) {
        for (int axis = 0; axis < 3; axis++)
            spline_span(kind, &ball[0][axis], 4, (int)i, out[i].c[axis]);
        spline_span(kind, &ball[0][3], 4, (int)i, out[i].r);
    }
    return out ? shape_sphere_sweep(kit->arena, spline_degree(kind), out, spans) : NULL;
}

static Shape *make_linear_sweep(ShapeKit *kit)
{
    return make_sweep_of(kit, SPLINE_LINEAR, 4);
}

static Shape *make_cubic_sweep(ShapeKit *kit)
{
    return make_sweep_of(kit, SPLINE_CUBIC, 5);
}

static Shape *make_ovus(ShapeKit *kit)
{
    double bottom = kit_number(kit, 0.5, 1), top = kit_number(kit, 0.1, 1);
    return shape_ovus(kit->arena, bottom, top);
}

/* --- functions ------------------------------------------------------------------------------ */

/* (x^2 + y^2 + z^2 + c)^2 - x^2 + y z, in a box or a ball */
static const Func *function(ShapeKit *kit)
{
    FuncBuilder b;
    func_begin(&b, 3);
    int square[3], sum = func_const(&b, kit_number(kit, -0.75, 0));
    for (int i = 0; i < 3; i++) {
        int x = func_param(&b, i);
        square[i] = func_step(&b, FUNC_MUL, (int[]){x, x});
        sum = func_step(&b, FUNC_ADD, (int[]){sum, square[i]});
    }
    int both = func_step(&b, FUNC_MUL, (int[]){sum, sum});
    int product = func_step(&b, FUNC_MUL, (int[]){func_param(&b, 1), func_param(&b, 2)});
    both = func_step(&b, FUNC_SUB, (int[]){both, square[0]});
    return func_end(kit->arena, &b, func_step(&b, FUNC_ADD, (int[]){both, product}));
}

/* sin(a x) + sin(b y) + z */
static const Func *waves(ShapeKit *kit)
{
    FuncBuilder b;
    func_begin(&b, 3);
    int sum = func_param(&b, 2);
    for (int i = 0; i < 2; i++) {
        int many = func_const(&b, kit_number(kit, 2, 6));
        int x = func_step(&b, FUNC_MUL, (int[]){func_param(&b, i), many});
        sum = func_step(&b, FUNC_ADD, (int[]){sum, func_step(&b, FUNC_SIN, &x)});
    }
    return func_end(kit->arena, &b, sum);
}

static Shape *make_isosurface(ShapeKit *kit)
{
    const Func *func = function(kit);
    Shape *box = shape_box(kit->arena, v3(-1, -1, -1), v3(1, 1, 1));
    return shape_isosurface(kit->arena, func, 0, box, false);
}

static Shape *make_wave_isosurface(ShapeKit *kit)
{
    const Func *func = waves(kit);
    Shape *ball = shape_sphere(kit->arena, v3(0, 0, 0), 1);
    return shape_isosurface(kit->arena, func, 0, ball, false);
}

static Shape *make_julia_of(ShapeKit *kit, bool is_hypercomplex)
{
    JuliaForm form = {.is_hypercomplex = is_hypercomplex,
                      .function = JULIA_SQR,
                      .c = {-0.25, 0.5, 0.125, -0.25},
                      .iterations = 4,
                      .precision = 50,
                      .slice = {0, 0, 0, 1}};
    for (int i = 0; i < 4; i++)
        form.c[i] += kit_number(kit, -0.25, 0.25);
    return shape_julia(kit->arena, &form);
}

static Shape *make_julia(ShapeKit *kit)
{
    return make_julia_of(kit, false);
}

static Shape *make_hypercomplex_julia(ShapeKit *kit)
{
    return make_julia_of(kit, true);
}

const ShapeCase solid_cases[] = {
    {.name = "cubic", .make = make_cubic},
    {.name = "quartic", .make = make_quartic},
    {.name = "poly of degree 6", .make = make_sextic},
    {.name = "polynomial", .make = make_tooth},
    {.name = "superellipsoid", .make = make_superellipsoid},
    {.name = "blob", .make = make_blob},
    {.name = "prism", .make = make_prism},
    {.name = "cubic prism", .make = make_cubic_prism},
    {.name = "conic prism", .make = make_conic_prism},
    {.name = "lathe", .make = make_lathe},
    {.name = "quadratic lathe", .make = make_quadratic_lathe},
    {.name = "cubic lathe", .make = make_cubic_lathe},
    {.name = "sor", .make = make_sor},
    {.name = "linear sphere_sweep", .make = make_linear_sweep},
    {.name = "cubic sphere_sweep", .make = make_cubic_sweep},
    {.name = "ovus", .make = make_ovus},
    {.name = "isosurface", .make = make_isosurface},
    {.name = "isosurface of waves", .make = make_wave_isosurface},
    {.name = "julia_fractal", .make = make_julia, .may_skip = true},
    {.name = "hypercomplex julia_fractal", .make = make_hypercomplex_julia, .may_skip = true},
    {.name = NULL},
};
