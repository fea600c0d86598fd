/* Cubics and quartics, the plain case.
 *
 * The turning points, in closed form or by Newton steps from a start that cannot overshoot, cut the
 * interval into pieces in each of which the polynomial is monotone: a change of sign is one root.
 * It is enough to know a turning point roughly, as the height there is off by the square of that
 * only, and one step of Newton's accounts for most of it.  Where a sign is not certain this is for
 * roots_within.c.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots_int.h"

#include "math/v3.h"

#include <stddef.h>

/* Turning points are looked for as long as none can be beyond this, in units of the interval. */
#define TURN_FAR 0x1p8

/* Where the monotone pieces end: the polynomial there, and half of its second derivative if it is a
 * turning point, else 0. */
typedef struct Stops {
    int count;
    double x[5], f[5], bend[5];
} Stops;

static void add_stop(Stops *stops, double x, double f, double bend)
{
    stops->x[stops->count] = x;
    stops->f[stops->count] = f;
    stops->bend[stops->count++] = bend;
}

/* The turning points, ascending; -1: they are out of reach. */
static int rough_turns(const Solver *s, double out[3])
{
    if (s->degree == 3) {
        const double c[3] = {s->c[1][0], 2 * s->c[2][0], 3 * s->c[3][0]};
        Root roots[2];
        int count = roots_quadratic(c, NULL, roots);
        for (int i = 0; i < count; i++)
            out[i] = roots[i].x;
        return count;
    }
    double far = TURN_FAR * fabs(s->c[4][0]);
    if (!(fabs(s->c[3][0]) < far && fabs(s->c[2][0]) < TURN_FAR * far &&
          fabs(s->c[1][0]) < TURN_FAR * TURN_FAR * far))
        return -1;
    const double c[4] = {s->c[1][0], 2 * s->c[2][0], 3 * s->c[3][0], 4 * s->c[4][0]};
    return roots_cubic_rough(c, out);
}

/* Add a turning point; false when the height there is not certain. */
static bool add_turn(const Solver *s, double x, Stops *stops)
{
    Value v = bend_at(s, x);
    double off = -0.5 * v.slope / v.bend, f = v.f + 0.5 * off * v.slope;
    x += off;
    if (!(2 * s->third * fabs(off * off * off) <= v.error) || sign_of(f, 2 * v.error) == 0)
        return false;
    if (x > stops->x[stops->count - 1] && x < s->hi)
        add_stop(stops, x, f, v.bend);
    return true;
}

static bool find_stops(const Solver *s, Stops *stops)
{
    double turns[3];
    int count = rough_turns(s, turns);
    if (count < 0)
        return false;
    stops->count = 0;
    add_stop(stops, s->lo, value_at(s, s->lo).f, 0);
    for (int i = 0; i < count; i++)
        if (turns[i] > s->lo && turns[i] < s->hi && !add_turn(s, turns[i], stops))
            return false;
    add_stop(stops, s->hi, value_at(s, s->hi).f, 0);
    return true;
}

/* Guess how far from a turning point at height f, on the way to one at g, the root is: as on the
 * parabola there, or on the cubic between the two. */
static double guess_from(double f, double g, double bend, double way, bool is_last)
{
    return is_last ? copysign(sqrt(-f / bend), way) : way * sqrt(f / (3 * (f - g)));
}

/* Guess the root between two stops. */
static double guess(const Stops *stops, int i)
{
    double a = stops->x[i], b = stops->x[i + 1], f = stops->f[i], g = stops->f[i + 1];
    bool is_last_a = stops->bend[i + 1] == 0, is_last_b = stops->bend[i] == 0;
    if (is_last_a && is_last_b)
        return a + (b - a) * (f / (f - g));
    bool is_from_a = is_last_a || (!is_last_b && fabs(f) < fabs(g));
    return is_from_a ? a + guess_from(f, g, stops->bend[i], b - a, is_last_a)
                     : b + guess_from(g, f, stops->bend[i + 1], a - b, is_last_b);
}

bool solver_monotone(Solver *s)
{
    Stops stops;
    if (!find_stops(s, &stops))
        return false;
    s->is_negative = stops.f[0] < 0;
    for (int i = 0; i + 1 < stops.count && s->count < s->most; i++) {
        bool is_after = stops.f[i + 1] < 0;
        if (is_after != (stops.f[i] < 0))
            solver_find(s, stops.x[i], stops.x[i + 1], is_after ? -1 : 1, guess(&stops, i));
    }
    return true;
}
