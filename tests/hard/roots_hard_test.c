/* Roots of polynomials where they are hard: nearly equal ones, double and triple ones, of degrees
 * up to 16, against quad precision.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"

#include "quad_plain.h"

#include "base/rng.h"
#include "math/eps.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { DEGREE = 16 };

/* A polynomial with all its digits, lowest first. */
typedef struct Poly {
    int degree;
    Quad c[2 * DEGREE + 1];
} Poly;

/* What was found, over all polynomials of a test. */
typedef struct Tally {
    long polynomials, roots, missed, phantom;
    double worst, worst_share; /* of simple roots: relative errors, and errors of their bounds */
} Tally;

/* --- polynomials ---------------------------------------------------------------------------- */

static Poly times(const Poly *a, const Poly *b)
{
    Poly out = {.degree = a->degree + b->degree};
    for (int i = 0; i <= a->degree; i++)
        for (int k = 0; k <= b->degree; k++)
            out.c[i + k] += a->c[i] * b->c[k];
    return out;
}

static Poly plus(const Poly *a, Quad factor, const Poly *b)
{
    Poly out = {.degree = a->degree > b->degree ? a->degree : b->degree};
    for (int i = 0; i <= out.degree; i++)
        out.c[i] = (i <= a->degree ? a->c[i] : 0) + factor * (i <= b->degree ? b->c[i] : 0);
    return out;
}

static Poly of_roots(const Quad *roots, int count)
{
    Poly out = {.c = {1}};
    for (int i = 0; i < count; i++) {
        Poly linear = {.degree = 1, .c = {-roots[i], 1}};
        out = times(&out, &linear);
    }
    return out;
}

static Quad value(const Poly *p, Quad x)
{
    Quad f = 0;
    for (int i = p->degree; i >= 0; i--)
        f = f * x + p->c[i];
    return f;
}

static Quad absolute(Quad x)
{
    return x < 0 ? -x : x;
}

/* Find where a polynomial changes its sign, ascending: between the places where its derivative
 * does. */
static int sign_changes(const Poly *p, Quad *out)
{
    if (p->degree == 0)
        return 0;
    Poly slope = {.degree = p->degree - 1};
    Quad turns[DEGREE + 2], bound = 1;
    for (int i = 0; i < p->degree; i++) {
        slope.c[i] = (i + 1) * p->c[i + 1];
        Quad size = absolute(p->c[i] / p->c[p->degree]);
        bound = 1 + size > bound ? 1 + size : bound;
    }
    int turn_count = sign_changes(&slope, turns + 1), count = 0;
    turns[0] = -bound;
    turns[turn_count + 1] = bound;
    for (int i = 0; i <= turn_count; i++) {
        Quad lo = turns[i], hi = turns[i + 1];
        bool is_low = value(p, lo) < 0;
        if ((value(p, hi) < 0) == is_low)
            continue;
        for (int k = 0; k < 128; k++) {
            Quad middle = (lo + hi) / 2;
            *((value(p, middle) < 0) == is_low ? &lo : &hi) = middle;
        }
        out[count++] = (lo + hi) / 2;
    }
    return count;
}

/* --- the checks ----------------------------------------------------------------------------- */

static int solve(const double *c, const double *e, int degree, Root *out)
{
    switch (degree) {
    case 2:
        return roots_quadratic(c, e, out);
    case 3:
        return roots_within(c, e, 3, -INFINITY, INFINITY, out);
    case 4:
        return roots_within(c, e, 4, -INFINITY, INFINITY, out);
    default:
        return roots_within(c, e, degree, -INFINITY, INFINITY, out);
    }
}

/* Is there a root within the bound of what was found, or is the polynomial too near to 0 there to
 * tell? */
static bool is_root(const Poly *p, const double *e, const Root *r)
{
    enum { STEPS = 16 };
    bool is_low = value(p, (Quad)r->x - r->error) < 0;
    for (int i = 0; i <= STEPS; i++) {
        Quad x = (Quad)r->x + (Quad)r->error * (2 * i - STEPS) / STEPS, f = value(p, x), off = 0;
        for (int k = p->degree; k >= 0; k--)
            off = off * absolute(x) + e[k] + 16 * (p->degree + 1) * EPS_DOUBLE * absolute(p->c[k]);
        if ((f < 0) != is_low || absolute(f) <= off)
            return true;
    }
    return false;
}

static bool is_alone(const Root *roots, int count, int i)
{
    return (i == 0 || roots[i].x - roots[i - 1].x > roots[i].error + roots[i - 1].error) &&
           (i + 1 == count || roots[i + 1].x - roots[i].x > roots[i].error + roots[i + 1].error);
}

static bool holds_one(const Root *found, const Quad *roots, int count)
{
    for (int i = 0; i < count; i++)
        if (absolute(roots[i] - found->x) <= found->error)
            return true;
    return false;
}

typedef int (*FindFn)(const double *c, const double *e, int degree, Root *out);

/* Return the number of the root that is nearest to x, or -1. */
static int nearest_to(Quad x, const Root *roots, int count)
{
    int best = -1;
    for (int i = 0; i < count; i++)
        if (best < 0 || absolute(roots[i].x - x) < absolute(roots[best].x - x))
            best = i;
    return best;
}

/* Is there a root in the place of this true one, within its bound?  If it is alone, how far off? */
static void check_found(Quad x, const Quad *others, int other_count, const Root *found, int count,
                        double size, Tally *tally)
{
    int i = nearest_to(x, found, count);
    if (i < 0) {
        tally->missed++;
        return;
    }
    double miss = (double)absolute(found[i].x - x), error = found[i].error + 0x1p-90 * size;
    bool is_beside = false;
    for (int k = 0; k < other_count; k++)
        is_beside |= others[k] != x && absolute(others[k] - x) < 4 * error;
    tally->missed += miss > error && !is_beside;
    if (is_beside || !is_alone(found, count, i) || error > 1e-6 * size)
        return;
    tally->worst = fmax(tally->worst, miss / size);
    tally->worst_share = fmax(tally->worst_share, miss / error);
}

/* Solve a polynomial whose roots are known; those of even multiplicity are there twice. */
static void check_known(const Poly *p, const Quad *roots, int root_count, FindFn find, Tally *tally)
{
    double c[DEGREE + 1], e[DEGREE + 1], size = 0;
    Root found[DEGREE];
    for (int i = 0; i <= p->degree; i++) {
        c[i] = (double)p->c[i];
        e[i] = (double)absolute(p->c[i] - c[i]);
    }
    int count = find(c, e, p->degree, found);
    tally->polynomials++;
    tally->roots += count;
    for (int i = 0; i < root_count; i++)
        size = fmax(size, (double)absolute(roots[i]));
    for (int i = 0; i < count; i++)
        tally->phantom += !holds_one(&found[i], roots, root_count) && !is_root(p, e, &found[i]);
    for (int k = 0; k < root_count; k++) {
        int equal = 0;
        for (int i = 0; i < root_count; i++)
            equal += roots[i] == roots[k];
        if (equal % 2)
            check_found(roots[k], roots, root_count, found, count, size, tally);
    }
}

static void check(const Poly *p, FindFn find, Tally *tally)
{
    Quad roots[DEGREE];
    check_known(p, roots, sign_changes(p, roots), find, tally);
}

/* limit: of relative errors; beyond degree 8, and of nearly equal ones, the rounding of the
 * coefficients allows for no other than the bounds. */
static void tell(const char *name, const Tally *t, double limit)
{
    printf(
        "# hard: roots, %s: %ld polynomials, %ld roots; missed %ld, phantom %ld (0); simple ones "
        "off by %.1e (%.0e), by %.2f of their bounds (1)\n",
        name, t->polynomials, t->roots, t->missed, t->phantom, t->worst, limit, t->worst_share);
    assert_int_equal(t->missed + t->phantom, 0);
    assert_true(t->worst <= limit && t->worst_share <= 1);
}

static long how_many(long few)
{
    const char *hard = getenv("HARD");
    return hard && !strcmp(hard, "long") ? 100 * few : few;
}

static int within(const double *c, const double *e, int degree, Root *out)
{
    return roots_within(c, e, degree, -INFINITY, INFINITY, out);
}

/* Quartics that are known to be hard, and their neighbours: each coefficient moved by some ulps. */
static void test_quartics(void **state)
{
    (void)state;
    static const double hard[][5] = {
        {26471900.25, -1325880, 25449, -240, 1},
        {6.52025e6, -508127, 15006.6, -198.995, 1},
        {1, -4 + 0x1p-50, 6, -4, 1},
        {4, 0, -4, 0, 1},
        {1e-12, 0, -2e-6, 0, 1},
        {1, -1e8, 1, -1e8, 1},
    };
    Tally tally = {0};
    for (size_t i = 0; i < sizeof hard / sizeof *hard; i++) {
        for (uint32_t k = 0; k < how_many(200); k++) {
            Rng rng = rng_at(31, (uint32_t)i, k);
            Poly p = {.degree = 4};
            for (int n = 0; n <= 4; n++) {
                int ulps = k ? (int)(rng_u32(&rng) % 9) - 4 : 0;
                p.c[n] = hard[i][n] * (1 + ulps * 0x1p-52);
            }
            check(&p, solve, &tally);
            check(&p, within, &tally);
        }
    }
    tell("quartics known as hard", &tally, 1e-11);
}

/* Whole numbers as roots, some of them double, triple or more: all coefficients are exact. */
static void test_multiple(void **state)
{
    (void)state;
    Tally tally = {0};
    for (uint32_t k = 0; k < how_many(1600); k++) {
        Rng rng = rng_at(32, 1, k);
        Quad roots[8];
        int degree = 2 + (int)(k % 7), kinds = 1 + (int)(rng_u32(&rng) % 4);
        for (int i = 0; i < degree; i++)
            roots[i] =
                i < kinds ? (int)(rng_u32(&rng) % 41) - 20 : roots[rng_u32(&rng) % (uint32_t)kinds];
        Poly p = of_roots(roots, degree);
        check_known(&p, roots, degree, solve, &tally);
        check_known(&p, roots, degree, within, &tally);
    }
    tell("double and triple", &tally, 1e-6);
}

/* Pairs of roots at distances down to rounding. */
static void test_near(void **state)
{
    (void)state;
    Tally tally = {0};
    for (uint32_t k = 0; k < how_many(1600); k++) {
        Rng rng = rng_at(33, 1, k);
        Quad roots[6];
        int degree = 2 + (int)(k % 5);
        for (int i = 0; i < degree; i++)
            roots[i] = 2 * rng_double(&rng) - 1;
        roots[1] = roots[0] + pow(10, -16 * rng_double(&rng));
        Poly p = of_roots(roots, degree);
        check_known(&p, roots, degree, solve, &tally);
        check_known(&p, roots, degree, within, &tally);
    }
    tell("nearly equal", &tally, 1e-6);
}

/* Barth's sextic along lines, some of them through its nodes, where the root is double. */
static void test_sextic(void **state)
{
    (void)state;
    Tally tally = {0};
    Quad root5 = sqrt(5);
    root5 = (root5 + 5 / root5) / 2; /* all digits */
    const Quad phi = (1 + (root5 + 5 / root5) / 2) / 2;
    for (uint32_t k = 0; k < how_many(400); k++) {
        Rng rng = rng_at(34, 1, k);
        /* (1, 0, 0) is a node. */
        Poly x[3], square[3], sum = {.c = {-1}};
        for (int i = 0; i < 3; i++) {
            double at = k % 2 ? 2 * rng_double(&rng) - 1 : i == 0;
            x[i] = (Poly){.degree = 1, .c = {at, 2 * rng_double(&rng) - 1}};
            square[i] = times(&x[i], &x[i]);
            sum = plus(&sum, 1, &square[i]);
        }
        Poly product = {.c = {4}};
        for (int i = 0; i < 3; i++) {
            Poly scaled = times(&square[i], &(Poly){.c = {phi * phi}});
            Poly factor = plus(&scaled, -1, &square[(i + 1) % 3]);
            product = times(&product, &factor);
        }
        Poly ball = times(&sum, &sum), all = plus(&product, -(1 + 2 * phi), &ball);
        check(&all, solve, &tally);
    }
    tell("a sextic of Barth", &tally, 1e-11);
}

/* Degree 16, the roots spread, in two heaps, or nearly equal in pairs. */
static void test_sixteen(void **state)
{
    (void)state;
    Tally tally = {0};
    for (uint32_t k = 0; k < how_many(100); k++) {
        Rng rng = rng_at(35, 1, k);
        Quad roots[DEGREE];
        for (int i = 0; i < DEGREE; i++) {
            double spread = 2 * rng_double(&rng) - 1;
            Quad pair = i % 2 ? roots[i - 1] + 1e-3 : (Quad)spread;
            roots[i] = k % 3 == 0 ? (Quad)(i - 7.5) / 8 : k % 3 == 1 ? (Quad)spread : pair;
        }
        Poly p = of_roots(roots, DEGREE);
        check_known(&p, roots, DEGREE, within, &tally);
    }
    tell("degree 16", &tally, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quartics), cmocka_unit_test(test_multiple),
        cmocka_unit_test(test_near),     cmocka_unit_test(test_sextic),
        cmocka_unit_test(test_sixteen),
    };
    return cmocka_run_group_tests_name("roots_hard", tests, NULL, NULL);
}
