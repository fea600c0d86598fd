/* Real roots of polynomials of any degree within an interval.
 *
 * x is scaled so that the interval is within [-1, 1].  Pieces of it are described by their
 * Bernstein coefficients, whose changes of sign bound the number of roots: none, or one that Newton
 * steps kept inside a bracket then find, or a single turning point whose height decides between two
 * and none; all other pieces are halved, at places where the sign is certain.  Every number goes
 * with a bound on its error, side by side so that both are computed at once.  What cannot be told
 * from zero is one root of odd or of even multiplicity, as the signs to both sides say.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/roots_int.h"

#include "math/v3.h"

#include <float.h>
#include <limits.h>
#include <stddef.h>

/* Steps up to this part of x leave the bound on the error of a value as it is. */
#define STEP_NEAR 0x1p-12

enum {
    FRESH_DEPTH = 6, /* halvings for whose rounding the first coefficients allow */
    DEPTH_MAX = DBL_MANT_DIG + 7,
    CUTS_MAX = 40 /* for each degree */
};

typedef struct Piece {
    double a, b;        /* where it is, within [-1, 1] */
    int sign_a, sign_b; /* the signs there, +1 or -1 */
    int depth;
    Pair at[TERMS_MAX]; /* Bernstein coefficients */
} Piece;

static int sign_at(const Solver *s, double x)
{
    Value v = value_at(s, x);
    return sign_of(v.f, v.error);
}

/* Return the sign at a place to cut: certain to the coefficients of pieces, too, as they are never
 * certain next to a place that is not. */
static int sign_at_cut(const Solver *s, double x)
{
    Value v = value_at(s, x);
    return sign_of(v.f, v.error * s->widening);
}

/* --- pieces -------------------------------------------------------------------------------- */

static void piece_place(Piece *piece, double a, double b, int sign_a, int sign_b, int depth)
{
    piece->a = a;
    piece->b = b;
    piece->sign_a = sign_a;
    piece->sign_b = sign_b;
    piece->depth = depth;
}

/* Derive the coefficients of a piece from those of the polynomial: about the end nearer to 0, where
 * they are smaller. */
static void piece_fill(const Solver *s, Piece *piece)
{
    int n = s->degree;
    bool is_backward = fabs(piece->b) < fabs(piece->a);
    double from = is_backward ? piece->b : piece->a;
    double width = is_backward ? piece->a - piece->b : piece->b - piece->a;
    Pair *t = piece->at, way = PAIR(from, fabs(from)), step = PAIR(width, fabs(width));
    for (int i = 0; i <= n; i++)
        t[i] = s->c[i] + PAIR(0, s->spare * fabs(s->c[i][0]));
    if (from != 0)
        for (int k = 0; k < n; k++)
            for (int i = n - 1; i >= k; i--)
                t[i] += t[i + 1] * way;
    Pair power = PAIR(1, 1);
    double binomial = 1;
    for (int i = 0; i <= n; i++) {
        t[i] *= power / PAIR(binomial, binomial);
        power *= step;
        binomial = binomial * (n - i) / (i + 1);
    }
    for (int k = 1; k <= n; k++)
        for (int i = n; i >= k; i--)
            t[i] += t[i - 1];
    if (!is_backward)
        return;
    for (int i = 0; i < n - i; i++) {
        Pair other = t[i];
        t[i] = t[n - i];
        t[n - i] = other;
    }
}

/* Cut a piece in two, `share` of the way along it. */
static void piece_split(const Solver *s, double share, Piece *left, Piece *right)
{
    int n = s->degree;
    Pair *r = right->at, to = PAIR(share, share), rest = PAIR(1 - share, 1 - share);
    left->at[0] = r[0];
    for (int k = 1; k <= n; k++) {
        for (int i = 0; i <= n - k; i++)
            r[i] = r[i] * rest + r[i + 1] * to;
        left->at[k] = r[0];
    }
}

/* Count the changes of sign that a list can have at most; signs that are not certain may be any. */
typedef struct Changes {
    int most, first, last; /* first, last: certain sign, 0: there is none */
    int unknown;           /* in a row */
} Changes;

static void changes_add(Changes *c, int sign)
{
    if (sign == 0) {
        c->unknown++;
        return;
    }
    if (c->first == 0) {
        c->first = sign;
        c->most = c->unknown;
    } else if (sign == c->last) {
        c->most += (c->unknown + 1) / 2 * 2;
    } else {
        c->most += 1 + c->unknown / 2 * 2;
    }
    c->last = sign;
    c->unknown = 0;
}

static Changes piece_changes(const Solver *s, const Piece *piece)
{
    Changes c = {0, 0, 0, 0};
    changes_add(&c, piece->sign_a);
    for (int i = 1; i < s->degree; i++)
        changes_add(&c, sign_of(piece->at[i][0], piece->at[i][1]));
    changes_add(&c, piece->sign_b);
    return c;
}

static Changes slope_changes(const Solver *s, const Piece *piece)
{
    Changes c = {0, 0, 0, 0};
    for (int i = 0; i < s->degree; i++) {
        Pair a = piece->at[i], b = piece->at[i + 1];
        changes_add(&c, sign_of(b[0] - a[0], a[1] + b[1]));
    }
    c.most += c.unknown;
    return c;
}

/* --- roots --------------------------------------------------------------------------------- */

void solver_add(Solver *s, double x, double error)
{
    if (s->count >= s->degree)
        return;
    double place = s->scale * x;
    s->out[s->count++] = (Root){place, s->scale * error + 2 * EPS_DOUBLE * fabs(place)};
}

/* Are the signs certain a step to both sides, as the value and its derivatives say?  No: they may
 * be all the same. */
static bool is_step_sure(const Solver *s, const Value *v, double x, double step)
{
    double bent = step * step * (fabs(v->bend) + 2 * s->third * step);
    return step <= STEP_NEAR * fabs(x) && bent <= 0.25 * v->error &&
           fabs(v->slope) * step >= 2 * (fabs(v->f) + v->error);
}

/* Bound the error of the only root of [a, b], where the polynomial has the value v: as far from it
 * the signs are certain. */
static double error_of(const Solver *s, const Value *v, double x, double a, double b, int sign_b)
{
    double step = 2 * (1 + EPS_DOUBLE) * (fabs(v->f) + v->error) / fabs(v->slope);
    double least = 2 * EPS_DOUBLE * fabs(x) + DBL_MIN;
    if (!(step > least))
        step = least;
    if (is_step_sure(s, v, x, step))
        return step;
    for (; step < b - a; step *= 2) {
        bool is_after = x - step <= a || sign_at(s, x - step) == -sign_b;
        bool is_before = x + step >= b || sign_at(s, x + step) == sign_b;
        if (is_after && is_before)
            return step;
    }
    return b - a;
}

/* Halley's steps, each of which leaves about the cube of the error, kept inside a bracket. */
void solver_find(Solver *s, double a, double b, int sign_b, double x)
{
    double lo = a, hi = b;
    Value v;
    if (!(x > lo && x < hi))
        x = 0.5 * (lo + hi);
    for (int i = 0;; i++) {
        v = bend_at(s, x);
        if (fabs(v.f) <= v.error || i == 200)
            break;
        if ((v.f > 0) == (sign_b > 0))
            hi = x;
        else
            lo = x;
        double next = x - v.f * v.slope / (v.slope * v.slope - v.f * v.bend);
        if (!(next > lo && next < hi) || (i & 7) == 7)
            next = 0.5 * (lo + hi);
        if (!(next > lo && next < hi) || next == x)
            break;
        x = next;
    }
    solver_add(s, x, error_of(s, &v, x, a, b, sign_b));
}

/* Return where in a piece the polygon of its coefficients crosses zero. */
static double polygon_root(const Solver *s, const Piece *piece)
{
    for (int i = 0; i < s->degree; i++) {
        double f = piece->at[i][0], g = piece->at[i + 1][0];
        if ((f > 0) != (g > 0))
            return piece->a + (piece->b - piece->a) * (i + f / (f - g)) / s->degree;
    }
    return 0.5 * (piece->a + piece->b);
}

/* Find the only turning point of a piece, where the slope's sign becomes `sign`. */
static double find_turn(const Solver *s, const Piece *piece, int sign)
{
    int n = s->degree;
    double lo = piece->a, hi = piece->b;
    double at_lo = piece->at[1][0] - piece->at[0][0], at_hi = piece->at[n][0] - piece->at[n - 1][0];
    double x = lo + (hi - lo) * at_lo / (at_lo - at_hi);
    if (!(x > lo && x < hi))
        x = 0.5 * (lo + hi);
    for (int i = 0; i < 200; i++) {
        Value v = bend_at(s, x);
        if (v.slope == 0)
            break;
        if ((v.slope > 0) == (sign > 0))
            hi = x;
        else
            lo = x;
        double next = x - v.slope / (2 * v.bend);
        if (!(next > lo && next < hi) || (i & 7) == 7)
            next = 0.5 * (lo + hi);
        if (!(next > lo && next < hi))
            break;
        double moved = fabs(next - x);
        x = next;
        if (moved <= EPS_DOUBLE * fabs(x))
            break;
    }
    return x;
}

/* A piece with the same sign at both ends that turns once: two roots, two equal ones or none. */
static void solve_turn(Solver *s, const Piece *piece)
{
    double x = find_turn(s, piece, piece->sign_b);
    Value v = bend_at(s, x);
    int sign = sign_of(v.f, v.error);
    if (sign == piece->sign_a)
        return;
    if (sign != 0) {
        double away = sqrt(fabs(v.f / v.bend));
        solver_find(s, piece->a, x, sign, x - away);
        solver_find(s, x, piece->b, piece->sign_b, x + away);
        return;
    }
    double error = sqrt(4 * v.error / fabs(v.bend)) + 2 * EPS_DOUBLE * fabs(x);
    if (!(error < piece->b - piece->a))
        error = piece->b - piece->a;
    solver_add(s, x, error);
    solver_add(s, x, error);
}

/* A piece that cannot be told from zero.  At an end of the interval it may be what lies beyond that
 * is zero: only the signs count there. */
static void solve_zero(Solver *s, const Piece *piece)
{
    bool is_at_end = piece->a <= s->lo || piece->b >= s->hi;
    if (is_at_end && piece->sign_a == piece->sign_b)
        return;
    double x = 0.5 * (piece->a + piece->b), error = 0.5 * (piece->b - piece->a);
    solver_add(s, x, error);
    if (piece->sign_a == piece->sign_b)
        solver_add(s, x, error);
}

/* Decide on a piece if that can be done; false when it is to be cut. */
static bool solve_piece(Solver *s, const Piece *piece)
{
    Changes f = piece_changes(s, piece);
    if (f.most == 0)
        return true;
    if (f.most == 1) {
        solver_find(s, piece->a, piece->b, piece->sign_b, polygon_root(s, piece));
        return true;
    }
    Changes slope = slope_changes(s, piece);
    if (slope.most == 0 && piece->sign_a != piece->sign_b) {
        solver_find(s, piece->a, piece->b, piece->sign_b, polygon_root(s, piece));
        return true;
    }
    if (slope.most <= 1 && piece->sign_a == piece->sign_b) {
        if (slope.first == -piece->sign_a)
            solve_turn(s, piece);
        return true;
    }
    return false;
}

static void solve(Solver *s, Piece *piece)
{
    static const double share[] = {0.5, 0.4375, 0.5625, 0.375, 0.625, 0.25, 0.75, 0.125, 0.875};
    if (s->count >= s->most || solve_piece(s, piece))
        return;
    int sign = 0;
    double cut = 0, part = 0;
    for (size_t i = 0; i < sizeof share / sizeof share[0] && sign == 0; i++) {
        part = share[i];
        cut = piece->a + (piece->b - piece->a) * part;
        sign = cut > piece->a && cut < piece->b ? sign_at_cut(s, cut) : 0;
    }
    if (sign == 0 || piece->depth >= DEPTH_MAX || ++s->cuts > CUTS_MAX * s->degree) {
        solve_zero(s, piece);
        return;
    }
    Piece left;
    piece_place(&left, piece->a, cut, piece->sign_a, sign, piece->depth + 1);
    if (left.depth % FRESH_DEPTH == 0)
        piece_fill(s, &left);
    else
        piece_split(s, part, &left, piece);
    piece_place(piece, cut, piece->b, sign, piece->sign_b, piece->depth + 1);
    if (piece->depth % FRESH_DEPTH == 0)
        piece_fill(s, piece);
    solve(s, &left);
    solve(s, piece);
}

/* --- the whole interval -------------------------------------------------------------------- */

/* Scale x; false when the coefficients come near to over- or underflow. */
static bool solver_init(Solver *s, const double *c, const double *c_error, int degree, double lo,
                        double hi)
{
    double power = 1, most = 0;
    s->degree = degree;
    s->third = 0;
    s->scale = num_max(fabs(lo), fabs(hi));
    s->lo = lo / s->scale;
    s->hi = hi / s->scale;
    for (int i = 0; i <= degree; i++, power *= s->scale) {
        double size = fabs(c[i] * power), least = TERMS_MAX * DBL_MIN; /* underflow */
        s->c[i] = PAIR(c[i] * power, (c_error ? c_error[i] * power : 0) +
                                         3 * (degree + 1) * EPS_DOUBLE * size + least);
        most = num_max(most, size);
        s->third += size * (i * (i - 1) * (i - 2) / 6);
    }
    s->spare = (2 * FRESH_DEPTH * degree + 10) * EPS_DOUBLE;
    s->widening = 1 + s->spare / (3 * (degree + 1) * EPS_DOUBLE);
    return most > 0x1p-800 && most < 0x1p800;
}

/* Is the constant term larger than all others together can be? */
static bool is_never_zero(const Solver *s)
{
    double rest = s->c[0][1];
    for (int i = 1; i <= s->degree; i++)
        rest += fabs(s->c[i][0]) + s->c[i][1];
    return fabs(s->c[0][0]) > rest;
}

/* The sign at an end, as computed where it is not certain. */
static int end_sign(const Solver *s, double x)
{
    return value_at(s, x).f < 0 ? -1 : 1;
}

/* Return where to cut first: at 0, where the coefficients have the most digits, or next to it; an
 * end of the interval where there is no such place. */
static double first_cut(const Solver *s)
{
    static const double place[] = {0, 0x1p-6, -0x1p-6, 0x1p-4, -0x1p-4, 0.25, -0.25};
    if (s->lo < 0 && s->hi > 0)
        for (size_t i = 0; i < sizeof place / sizeof place[0]; i++)
            if (place[i] > s->lo && place[i] < s->hi && sign_at_cut(s, place[i]) != 0)
                return place[i];
    return s->lo;
}

static void solve_whole(Solver *s)
{
    s->is_negative = s->c[0][0] < 0;
    if (is_never_zero(s) || (s->degree <= 4 && solver_monotone(s)))
        return;
    Piece piece;
    double cut = first_cut(s);
    int sign_lo = end_sign(s, s->lo), sign_hi = end_sign(s, s->hi), sign = sign_lo;
    s->is_negative = sign_lo < 0;
    if (cut > s->lo) {
        sign = end_sign(s, cut);
        piece_place(&piece, s->lo, cut, sign_lo, sign, 0);
        piece_fill(s, &piece);
        solve(s, &piece);
    }
    if (s->count >= s->most)
        return;
    piece_place(&piece, cut, s->hi, sign, sign_hi, 0);
    piece_fill(s, &piece);
    solve(s, &piece);
}

/* The exponent of a number: 0.5 <= |x| 2^-e < 1. */
static int exponent_of(double x)
{
    int e;
    frexp(x, &e);
    return e;
}

/* Solve for x 2^-k, near 1, and with coefficients near 1: their powers would overflow. */
static int solve_scaled(Solver *s, const double *c, const double *c_error, int degree, double lo,
                        double hi)
{
    int k = exponent_of(num_max(fabs(lo), fabs(hi))), most = INT_MIN;
    double scaled[TERMS_MAX], error[TERMS_MAX];
    for (int i = 0; i <= degree; i++)
        if (c[i] != 0 && exponent_of(c[i]) + k * i > most)
            most = exponent_of(c[i]) + k * i;
    for (int i = 0; i <= degree; i++) {
        scaled[i] = ldexp(c[i], k * i - most);
        error[i] = c_error ? ldexp(c_error[i], k * i - most) : 0;
    }
    lo = ldexp(lo, -k);
    hi = ldexp(hi, -k);
    if (most == INT_MIN || !solver_init(s, scaled, error, degree, lo, hi))
        return 0;
    solve_whole(s);
    for (int i = 0; i < s->count; i++)
        s->out[i] = (Root){ldexp(s->out[i].x, k), ldexp(s->out[i].error, k)};
    return s->count;
}

/* Degrees up to two: the closed forms. */
static int solve_low(const double *c, const double *c_error, int degree, double lo, double hi,
                     bool *is_negative, Root *out)
{
    double given[3] = {0, 0, 0}, error[3] = {0, 0, 0};
    for (int i = 0; i <= degree; i++) {
        given[i] = c[i];
        error[i] = c_error ? c_error[i] : 0;
    }
    Root all[2];
    int count = roots_quadratic(given, error, all), kept = 0;
    if (count == 2 && all[0].x + all[0].error >= all[1].x - all[1].error) {
        double middle = 0.5 * (all[0].x + all[1].x);
        all[0].x = all[1].x = middle;
        all[0].error = all[1].error = all[0].error + all[1].error;
    }
    *is_negative = degree % 2 ? c[degree] > 0 : c[degree] < 0;
    for (int i = 0; i < count; i++) {
        if (all[i].x >= lo && all[i].x <= hi)
            out[kept++] = all[i];
        *is_negative ^= all[i].x < lo;
    }
    return kept;
}

static bool is_all_finite(const double *c, const double *c_error, int degree)
{
    for (int i = 0; i <= degree; i++)
        if (!isfinite(c[i]) || (c_error && !isfinite(c_error[i])))
            return false;
    return true;
}

int roots_first(const double *c, const double *c_error, int degree, double lo, double hi, int most,
                bool *is_negative, Root *out)
{
    while (degree > 0 && c[degree] == 0 && (!c_error || c_error[degree] == 0))
        degree--;
    *is_negative = c[0] < 0;
    if (degree <= 0 || degree > ROOTS_DEGREE_MAX || !(lo < hi) ||
        !is_all_finite(c, c_error, degree))
        return 0;
    if (degree <= 2)
        return solve_low(c, c_error, degree, lo, hi, is_negative, out);
    double bound = c[degree] != 0 ? roots_bound(c, degree) : INFINITY;
    if (bound == 0) /* a power of x */
        bound = isfinite(lo) && isfinite(hi) ? INFINITY : 1;
    if (!isfinite(bound) && !(isfinite(lo) && isfinite(hi)))
        return 0;
    if (lo >= bound || hi <= -bound) {
        *is_negative = (c[degree] < 0) ^ (lo < 0 && degree % 2 == 1);
        return 0;
    }
    lo = num_max(lo, -bound);
    hi = num_min(hi, bound);
    Solver s = {.most = most, .out = out};
    int count = 0;
    if (solver_init(&s, c, c_error, degree, lo, hi)) {
        solve_whole(&s);
        count = s.count;
    } else {
        count = solve_scaled(&s, c, c_error, degree, lo, hi);
    }
    *is_negative = s.is_negative;
    return count;
}

int roots_within(const double *c, const double *c_error, int degree, double lo, double hi,
                 Root *out)
{
    bool is_negative;
    return roots_first(c, c_error, degree, lo, hi, degree, &is_negative, out);
}
