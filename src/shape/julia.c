/* Julia fractals: the points of a slice through four dimensions from which an iteration does not
 * escape.
 *
 * Quaternions are iterated as a real part and a vector.  Hypercomplex numbers commute, and are
 * pairs of complex numbers that are iterated each on its own: x + iy + jz + kw with ij = k, j^2 =
 * -1 is a = (x - w) + i(y + z) and b = (x + w) + i(y - z).
 *
 * A line is walked through by steps.  Squares and cubes tell from how fast they escape how far the
 * set is at least: with a potential G the distance is no less than G/(2|G'|); others are looked at
 * every so often.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bracket.h"
#include "shape/shape_int.h"

#include <complex.h>
#include <float.h>

enum { FAR_ITERATIONS = 12 };

/* Steps are no shorter than this part of what the precision asks for: what is finer may be missed.
 */
#define STEP_PART 0.25

/* Steps are so much longer than is known to be empty; where the next place does not know the rest
 * to be empty, they are taken back. */
#define STEP_REACH 1.28

/* Norm squared of what has escaped far enough for its potential. */
#define FAR_NORM 1e6

/* Heights below this are on the surface. */
#define HEIGHT_SMALL EPS_DOUBLE

/* How far off the set a point found on it may be, in radii: the set is rough. */
#define POINT_ROUNDING 1e-9

/* A place and its derivatives by the three coordinates. */
typedef struct Quaternion {
    double r;
    V3 v;
} Quaternion;

typedef double complex Complex;

typedef struct Pair {
    Complex a, b;
} Pair;

/* What an iteration tells of a place. */
typedef struct Fate {
    bool is_inside;
    double distance; /* in 4D, to the set at least; 0: not known */
} Fate;

/* A form, and what follows from it. */
struct JuliaData {
    JuliaForm form;
    double radius;  /* of a ball around all of it whose border is outside */
    double limit2;  /* what the norm squared of no iteration is above */
    double height;  /* the fourth coordinate at the origin */
    V3 slope;       /* of the fourth coordinate */
    double surface; /* potential of the surface: of that norm in the last iteration */
};

/* What no iteration may be above: that of the language. */
static double limit_of(const JuliaForm *form)
{
    double c = sqrt(form->c[0] * form->c[0] + form->c[1] * form->c[1] + form->c[2] * form->c[2] +
                    form->c[3] * form->c[3]);
    return form->is_hypercomplex ? 4 : num_min(2, 1 + c * (1 + 0x1p-40));
}

static double degree_of(const JuliaForm *form)
{
    return form->function == JULIA_CUBE && !form->is_hypercomplex ? 3 : 2;
}

/* Return how far out a number can begin that adds c each time and is at `limit` last: |z^n + c| is
 * no less than |z|^n - |c|. */
static double first_of(double limit, double c, double degree, int iterations)
{
    double most = limit;
    for (int i = 1; i < iterations; i++)
        most = num_min(limit, pow(most + c, 1 / degree));
    return most;
}

/* Return the radius of a ball around the set. */
static double radius_of(const JuliaForm *form)
{
    const double *c = form->c;
    double limit = limit_of(form);
    if (!form->is_hypercomplex)
        return first_of(limit, hypot(hypot(c[0], c[1]), hypot(c[2], c[3])), degree_of(form),
                        form->iterations);
    if (form->function != JULIA_SQR && form->function != JULIA_CUBE)
        return limit;
    double most = limit * sqrt(2);
    double a = first_of(most, hypot(c[0] - c[3], c[1] + c[2]), 2, form->iterations);
    double b = first_of(most, hypot(c[0] + c[3], c[1] - c[2]), 2, form->iterations);
    return num_min(limit, sqrt(0.5 * (a * a + b * b)));
}

Shape *shape_julia(Arena *arena, const JuliaForm *form)
{
    Shape *shape = leaf_new(arena, SHAPE_JULIA);
    JuliaData *data = ARENA_NEW(arena, JuliaData);
    if (!shape || !data)
        return NULL;
    /* Hypercomplex: of each of the two numbers the square is no more than twice that of both. */
    double limit = limit_of(form), limit2 = limit * limit;
    double most2 = form->is_hypercomplex ? 2 * limit2 : limit2;
    *data = (JuliaData){
        .form = *form,
        .radius = radius_of(form) * (1 + 0x1p-20),
        .limit2 = form->is_hypercomplex ? limit2 : limit2 * (1 + 0x1p-24),
        .height = form->slice_distance / form->slice[3],
        .slope = v3(-form->slice[0] / form->slice[3], -form->slice[1] / form->slice[3],
                    -form->slice[2] / form->slice[3]),
        .surface = 0.5 * log(most2) * pow(degree_of(form), 1 - form->iterations),
    };
    shape->u.julia = data;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* The fourth coordinate of a point of the slice. */
static double fourth(const JuliaData *data, V3 p)
{
    return data->height + v3_dot(data->slope, p);
}

/* On the surface the norm squared of one of the iterations is the limit: its gradient is square to
 * the surface. */
typedef struct Decider {
    double limit2, off;
    V3 gradient;
} Decider;

static bool decides(Decider *decider, double n2)
{
    double off = fabs(n2 / decider->limit2 - 1);
    bool is_nearer = off < decider->off;
    decider->off = is_nearer ? off : decider->off;
    return is_nearer;
}

/* --- quaternions ---------------------------------------------------------------------------- */

static double norm2(Quaternion q)
{
    return q.r * q.r + v3_len2(q.v);
}

static Quaternion quaternion_step(const JuliaForm *form, Quaternion q)
{
    double d = v3_len2(q.v), r = q.r;
    bool is_cube = form->function == JULIA_CUBE;
    double real = is_cube ? r * (r * r - 3 * d) : r * r - d;
    double scale = is_cube ? 3 * r * r - d : 2 * r;
    V3 c = v3(form->c[1], form->c[2], form->c[3]);
    return (Quaternion){real + form->c[0], v3_mad(c, scale, q.v)};
}

/* What a step makes of a derivative dq. */
static Quaternion quaternion_slope(const JuliaForm *form, Quaternion q, Quaternion dq)
{
    double r = q.r, dr = dq.r, d = v3_len2(q.v), dd = 2 * v3_dot(q.v, dq.v);
    if (form->function == JULIA_CUBE)
        return (Quaternion){dr * (r * r - 3 * d) + r * (2 * r * dr - 3 * dd),
                            v3_mad(v3_scale(q.v, 6 * r * dr - dd), 3 * r * r - d, dq.v)};
    return (Quaternion){2 * r * dr - dd, v3_mad(v3_scale(q.v, 2 * dr), 2 * r, dq.v)};
}

/* How far the surface is at least, when |z|^2 is n2 and far out, its derivative has grown by the
 * square root of growth2, and degree^steps is `power`: the potential is ln|z| / power. */
static double distance_of(const JuliaData *data, double n2, double growth2, double power)
{
    double above = 0.5 * log(n2) - data->surface * power;
    return above > 0 ? 0.5 * above * sqrt(n2 / growth2) : 0;
}

static Fate quaternion_fate(const JuliaData *data, V3 p)
{
    const JuliaForm *form = &data->form;
    Quaternion q = {p.x, v3(p.y, p.z, fourth(data, p))};
    double growth2 = 1, power = 1, degree = degree_of(form);
    bool is_cube = degree == 3, has_escaped = false;
    for (int i = 0; i < form->iterations + FAR_ITERATIONS; i++) {
        double n2 = norm2(q);
        has_escaped = has_escaped || (n2 > data->limit2 && i < form->iterations);
        if (!has_escaped && i >= form->iterations)
            return (Fate){.is_inside = true};
        if (has_escaped && n2 > FAR_NORM)
            return (Fate){.distance = distance_of(data, n2, growth2, power)};
        growth2 *= is_cube ? 9 * n2 * n2 : 4 * n2;
        power *= degree;
        q = quaternion_step(form, q);
    }
    return (Fate){.is_inside = !has_escaped};
}

/* The largest norm squared of an iteration, in units of the limit. */
static double quaternion_norm(const JuliaData *data, V3 p)
{
    const JuliaForm *form = &data->form;
    Quaternion q = {p.x, v3(p.y, p.z, fourth(data, p))};
    double most = 0;
    for (int i = 0; i < form->iterations && most < FAR_NORM; i++) {
        most = fmax(most, norm2(q) / data->limit2);
        q = quaternion_step(form, q);
    }
    return most;
}

static V3 quaternion_gradient(Quaternion q, const Quaternion d[3])
{
    return v3(q.r * d[0].r + v3_dot(q.v, d[0].v), q.r * d[1].r + v3_dot(q.v, d[1].v),
              q.r * d[2].r + v3_dot(q.v, d[2].v));
}

static V3 quaternion_normal(const JuliaData *data, V3 p, double tilt, bool is_last)
{
    const JuliaForm *form = &data->form;
    V3 w = v3_scale(data->slope, tilt);
    Quaternion q = {p.x, v3(p.y, p.z, fourth(data, p))};
    Quaternion d[3] = {{1, v3(0, 0, w.x)}, {0, v3(1, 0, w.y)}, {0, v3(0, 1, w.z)}};
    Decider decider = {.limit2 = data->limit2, .off = INFINITY};
    for (int i = 0; i < form->iterations; i++) {
        if (decides(&decider, norm2(q)))
            decider.gradient = quaternion_gradient(q, d);
        for (int k = 0; k < 3; k++)
            d[k] = quaternion_slope(form, q, d[k]);
        q = quaternion_step(form, q);
    }
    return is_last ? quaternion_gradient(q, d) : decider.gradient;
}

/* --- hypercomplex numbers ------------------------------------------------------------------- */

static Pair pair_of(double x, double y, double z, double w)
{
    return (Pair){CMPLX(x - w, y + z), CMPLX(x + w, y - z)};
}

static double squared(Complex z)
{
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

static double pair_norm2(Pair z)
{
    return 0.5 * (squared(z.a) + squared(z.b));
}

/* Cubes are squares here: so the language has it. */
static Complex apply(const JuliaForm *form, Complex z)
{
    switch (form->function) {
    case JULIA_EXP:
        return cexp(z);
    case JULIA_RECIPROCAL:
        return 1 / z;
    case JULIA_SIN:
        return csin(z);
    case JULIA_ASIN:
        return casin(z);
    case JULIA_SINH:
        return csinh(z);
    case JULIA_ASINH:
        return casinh(z);
    case JULIA_COS:
        return ccos(z);
    case JULIA_ACOS:
        return cacos(z);
    case JULIA_COSH:
        return ccosh(z);
    case JULIA_ACOSH:
        return cacosh(z);
    case JULIA_TAN:
        return ctan(z);
    case JULIA_ATAN:
        return catan(z);
    case JULIA_TANH:
        return ctanh(z);
    case JULIA_ATANH:
        return catanh(z);
    case JULIA_LN:
        return clog(z);
    case JULIA_PWR:
        return cpow(z, CMPLX(form->power[0], form->power[1]));
    default:
        return CMPLX(creal(z) * creal(z) - cimag(z) * cimag(z), 2 * creal(z) * cimag(z));
    }
}

static Complex apply_slope(const JuliaForm *form, Complex z, Complex value)
{
    switch (form->function) {
    case JULIA_EXP:
        return value;
    case JULIA_RECIPROCAL:
        return -value * value;
    case JULIA_SIN:
        return ccos(z);
    case JULIA_ASIN:
        return 1 / csqrt(1 - z * z);
    case JULIA_SINH:
        return ccosh(z);
    case JULIA_ASINH:
        return 1 / csqrt(1 + z * z);
    case JULIA_COS:
        return -csin(z);
    case JULIA_ACOS:
        return -1 / csqrt(1 - z * z);
    case JULIA_COSH:
        return csinh(z);
    case JULIA_ACOSH:
        return 1 / (csqrt(z - 1) * csqrt(z + 1));
    case JULIA_TAN:
        return 1 + value * value;
    case JULIA_ATAN:
        return 1 / (1 + z * z);
    case JULIA_TANH:
        return 1 - value * value;
    case JULIA_ATANH:
        return 1 / (1 - z * z);
    case JULIA_LN:
        return 1 / z;
    case JULIA_PWR: {
        Complex power = CMPLX(form->power[0], form->power[1]);
        return power * cpow(z, power - 1);
    }
    default:
        return 2 * z;
    }
}

static bool is_square(const JuliaForm *form)
{
    return form->function == JULIA_SQR || form->function == JULIA_CUBE;
}

/* How far the set of one of the two complex numbers is at least, where it escapes. */
static double square_distance(const JuliaData *data, Complex z, Complex c)
{
    double growth2 = 1, power = 1;
    for (int i = 0; i < data->form.iterations + FAR_ITERATIONS; i++) {
        double n2 = squared(z);
        if (n2 > FAR_NORM)
            return distance_of(data, n2, growth2, power);
        growth2 *= 4 * n2;
        power *= 2;
        z = apply(&data->form, z) + c;
    }
    return 0;
}

static Pair pair_at(const JuliaData *data, V3 p)
{
    return pair_of(p.x, p.y, p.z, fourth(data, p));
}

static Pair pair_parameter(const JuliaForm *form)
{
    return pair_of(form->c[0], form->c[1], form->c[2], form->c[3]);
}

static Fate pair_fate(const JuliaData *data, V3 p)
{
    const JuliaForm *form = &data->form;
    Pair z = pair_at(data, p), start = z, c = pair_parameter(form);
    for (int i = 0; i < form->iterations; i++) {
        if (!(pair_norm2(z) <= data->limit2)) {
            if (!is_square(form))
                return (Fate){.distance = 0};
            double a = square_distance(data, start.a, c.a);
            double b = square_distance(data, start.b, c.b);
            return (Fate){.distance = num_max(a, b) * 0.7071067811865475};
        }
        z = (Pair){apply(form, z.a) + c.a, apply(form, z.b) + c.b};
    }
    return (Fate){.is_inside = true};
}

/* As quaternion_norm; no number counts as far out. */
static double pair_norm(const JuliaData *data, V3 p)
{
    const JuliaForm *form = &data->form;
    Pair z = pair_at(data, p), c = pair_parameter(form);
    double most = 0;
    for (int i = 0; i < form->iterations && most < FAR_NORM; i++) {
        double n2 = pair_norm2(z) / data->limit2;
        most = n2 >= 0 ? fmax(most, n2) : FAR_NORM;
        z = (Pair){apply(form, z.a) + c.a, apply(form, z.b) + c.b};
    }
    return most;
}

static V3 pair_gradient(Pair z, const Pair d[3])
{
    return v3(creal(conj(z.a) * d[0].a + conj(z.b) * d[0].b),
              creal(conj(z.a) * d[1].a + conj(z.b) * d[1].b),
              creal(conj(z.a) * d[2].a + conj(z.b) * d[2].b));
}

static V3 pair_normal(const JuliaData *data, V3 p, double tilt, bool is_last)
{
    const JuliaForm *form = &data->form;
    V3 w = v3_scale(data->slope, tilt);
    Pair z = pair_at(data, p), c = pair_parameter(form);
    Pair d[3] = {pair_of(1, 0, 0, w.x), pair_of(0, 1, 0, w.y), pair_of(0, 0, 1, w.z)};
    Decider decider = {.limit2 = data->limit2, .off = INFINITY};
    for (int i = 0; i < form->iterations; i++) {
        if (decides(&decider, pair_norm2(z)))
            decider.gradient = pair_gradient(z, d);
        Pair to = {apply(form, z.a), apply(form, z.b)};
        Complex da = apply_slope(form, z.a, to.a), db = apply_slope(form, z.b, to.b);
        for (int k = 0; k < 3; k++)
            d[k] = (Pair){da * d[k].a, db * d[k].b};
        z = (Pair){to.a + c.a, to.b + c.b};
    }
    return is_last ? pair_gradient(z, d) : decider.gradient;
}

/* --- along a line --------------------------------------------------------------------------- */

static Fate fate_of(const JuliaData *data, V3 p)
{
    return data->form.is_hypercomplex ? pair_fate(data, p) : quaternion_fate(data, p);
}

/* A walk along a line: p = o + t d. */
typedef struct JuliaWalk {
    const Shape *shape;
    const JuliaData *data;
    const LocalRay *ray;
    double in, out; /* t within the ball around the set */
    double speed;   /* |d| */
    double reach;   /* t that is empty for sure, for each unit of distance */
    double least;   /* t of the shortest steps */
} JuliaWalk;

static bool walk_begin(JuliaWalk *walk, const Shape *shape, const LocalRay *ray)
{
    const JuliaData *data = shape->u.julia;
    double a = v3_len2(ray->d), base = -v3_dot(ray->o, ray->d) / a;
    double room = data->radius * data->radius - v3_len2(v3_mad(ray->o, base, ray->d));
    if (!(room > 0))
        return false;
    double half = sqrt(room / a), speed = sqrt(a);
    /* The fourth coordinate makes a line longer. */
    *walk = (JuliaWalk){.shape = shape,
                        .data = data,
                        .ray = ray,
                        .in = base - half,
                        .out = base + half,
                        .speed = speed,
                        .reach = 1 / (speed * sqrt(1 + v3_len2(data->slope))),
                        .least = STEP_PART / (data->form.precision * speed)};
    return true;
}

static V3 walk_point(const JuliaWalk *walk, double t)
{
    return v3_mad(walk->ray->o, t, walk->ray->d);
}

static Fate walk_at(const JuliaWalk *walk, double t)
{
    return fate_of(walk->data, walk_point(walk, t));
}

/* What is 0 on the surface and negative inside. */
static double walk_height(const void *ctx, double t)
{
    const JuliaWalk *walk = ctx;
    V3 p = walk_point(walk, t);
    double norm = walk->data->form.is_hypercomplex ? pair_norm(walk->data, p)
                                                   : quaternion_norm(walk->data, p);
    return log(norm + DBL_MIN);
}

/* Find where a step went in or out.  Where it begins the line may just have gone the other way, and
 * rounding have left it there. */
static double find_change(const JuliaWalk *walk, double lo, double hi, bool is_inside)
{
    double at_lo = fmax(fabs(walk_height(walk, lo)), HEIGHT_SMALL), at_hi = walk_height(walk, hi);
    return bracket_zero(walk_height, walk, lo, is_inside ? -at_lo : at_lo, hi, at_hi, HEIGHT_SMALL);
}

static V3 normal_of(const JuliaData *data, V3 p, double tilt, bool is_last)
{
    V3 n = data->form.is_hypercomplex ? pair_normal(data, p, tilt, is_last)
                                      : quaternion_normal(data, p, tilt, is_last);
    return v3_is_finite(n) ? v3_unit(n) : v3(0, 0, 0);
}

static void fill_crossing(const JuliaWalk *walk, double t, int8_t change, Crossing *out)
{
    const JuliaData *data = walk->data;
    V3 n = normal_of(data, walk_point(walk, t), 1, false);
    double off = v3_sum_abs(local_error(walk->ray, t)) + 8 * PLACE_EPS * data->radius;
    double slant = fabs(v3_dot(n, walk->ray->d)) / walk->speed;
    /* A line that touches is off by no more than where a ball of that size is touched. */
    double error = num_min(off / slant, sqrt(data->radius * off)) / walk->speed;
    LeafHit hit = {t, error + 4 * EPS_DOUBLE * fabs(t), 0, change, true};
    crossing_fill(walk->shape, &hit, out);
}

/* Go from *t, whose fate is told, to the next change of it before `end`; false: there is none. */
static bool walk_on(const JuliaWalk *walk, double *t, double end, Fate *fate)
{
    double reach = STEP_REACH;
    while (*t < end) {
        double known = fate->distance * walk->reach;
        double next = num_min(*t + num_max(reach * known, walk->least), end);
        if (!(next > *t)) /* so far away that a step is less than a rounding */
            next = nextafter(*t, end);
        Fate there = walk_at(walk, next);
        if (reach > 1 && next - *t > num_max(known, walk->least) + there.distance * walk->reach) {
            reach = 1;
            continue;
        }
        reach = STEP_REACH;
        if (there.is_inside != fate->is_inside) {
            *t = find_change(walk, *t, next, fate->is_inside);
            *fate = (Fate){.is_inside = there.is_inside};
            return true;
        }
        *t = next;
        *fate = there;
    }
    return false;
}

static bool julia_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    LocalRay local;
    JuliaWalk walk;
    Crossing crossing;
    local_ray(shape, line->ray, &local);
    if (!walk_begin(&walk, shape, &local))
        return false;
    double t = num_max(walk.in, line->near), end = num_min(walk.out, line->far);
    Fate fate = {.is_inside = false};
    if (t < end)
        fate = walk_at(&walk, t);
    bool starts_in = fate.is_inside;
    if (starts_in && t == walk.in) {
        fill_crossing(&walk, t, 1, &crossing);
        scratch_push(scratch, &crossing);
        starts_in = false;
    }
    while (walk_on(&walk, &t, end, &fate)) {
        fill_crossing(&walk, t, fate.is_inside ? 1 : -1, &crossing);
        scratch_push(scratch, &crossing);
    }
    if (fate.is_inside && end == walk.out) {
        fill_crossing(&walk, end, -1, &crossing);
        scratch_push(scratch, &crossing);
    }
    return starts_in;
}

static bool julia_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    LocalRay local;
    JuliaWalk walk;
    (void)scratch;
    local_ray(shape, ray, &local);
    if (!walk_begin(&walk, shape, &local))
        return false;
    double t = num_max(walk.in, ray->tmin), end = num_min(walk.out, ray->tmax);
    if (!(t < end))
        return false;
    Fate fate = walk_at(&walk, t);
    if (!walk_on(&walk, &t, end, &fate) || !(t > ray->tmin && t < ray->tmax))
        return false;
    fill_crossing(&walk, t, fate.is_inside ? 1 : -1, out);
    return true;
}

/* --- the other operations ------------------------------------------------------------------- */

/* What is shown is the gradient after one iteration more than the surface is of, and as if the
 * fourth coordinate did not change: so POV-Ray shades it. */
static void julia_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const JuliaData *data = shape->u.julia;
    V3 n = normal_of(data, p, 1, false), shown = normal_of(data, p, 0, true);
    (void)crossing;
    out->p = p;
    out->ng = v3_len2(n) > 0 ? n : v3(1, 0, 0);
    out->is_smooth = v3_len2(shown) > 0;
    out->ns = v3_dot(shown, out->ng) < 0 ? v3_neg(shown) : shown;
    out->error = POINT_ROUNDING * data->radius;
}

static bool julia_is_inside(const Shape *shape, V3 p)
{
    const JuliaData *data = shape->u.julia;
    return v3_len2(p) <= data->radius * data->radius && fate_of(data, p).is_inside;
}

static Bound julia_bound(const Shape *shape)
{
    double r = shape->u.julia->radius;
    Bound b = bound_pad((Bound){v3(-r, -r, -r), v3(r, r, r)});
    return shape->is_transformed ? bound_pad(bound_transform(b, &shape->xform)) : b;
}

const ShapeOps julia_ops = {.list = julia_list,
                            .closest = julia_closest,
                            .point = julia_point,
                            .is_inside = julia_is_inside,
                            .bound = julia_bound};
