/* The geometry against itself in quad precision: every crossing, its bound, its point and normal,
 * and the inside, for every kind of shape, for random and for hard rays.
 *
 * A line is known to its rounding only, so an answer is right if it is that of a line within a few
 * ulps of the one asked for: where the two lists tell different stories, such a line is looked for.
 *
 * Beside its TAP it prints a line for each shape: what was measured, and the limits.
 *
 *   quad_test [name of a shape]    RAYS=n or HARD=long: how many rays of both sorts
 *
 * SPDX-License-Identifier: Apache-2.0 */
#include "quad_lists.h"
#include "quad_rays.h"

#include "base/work.h"
#include "math/eps.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum {
    RAYS_PER_MODEL = 128,
    NORMALS_TRIED = 64,
    LINES_TRIED = 256, /* beside one whose lists differ */
    TOLD_MAX = 12      /* faults that are printed */
};

#define LIMIT_T 1e-11 /* of t, or of the size of the shape */
#define LIMIT_NORMAL 1e-9
#define TANGENT_SINE 0.01 /* what meets the surface at less is tangent */
#define FAR 10            /* of the sizes of shape and ray: how much of a line is looked at */
#define ROUNDING_ULPS 128 /* by which a line may be off, of the numbers that place it */

typedef struct Tally {
    long rays, crossings, fuzzy; /* fuzzy: decided by rounding */
    long missed, phantom, liars, off, inside, closest;
    double worst_t, worst_normal, worst_share; /* worst error of t, of its bound */
} Tally;

typedef struct Run {
    int which;
    long rays;
    Tally all;
    int told;
    pthread_mutex_t lock;
} Run;

/* One ray at one shape, seen in both worlds. */
typedef struct Shot {
    Run *run;
    uint64_t seed;
    long number;
    RayMaker maker;
    const RayKind *kind;
    Model *quad;
    TestRay ray;
    List d, q, near;
    int partner[MEETINGS_MAX]; /* see list_align */
    Tally tally;
} Shot;

/* --- small helpers -------------------------------------------------------------------------- */

static Quad3 wide(V3 a)
{
    return (Quad3){a.x, a.y, a.z};
}

static double far_of(const Shot *s)
{
    return FAR * (s->maker.size + v3_len(s->ray.o));
}

static void tell(Shot *s, const char *fault, double number)
{
    pthread_mutex_lock(&s->run->lock);
    if (s->run->told++ < TOLD_MAX) {
        V3 o = s->ray.o, d = s->ray.d;
        fprintf(stderr, "# %s, model %llu, ray %ld (%s): %s %g\n#   %a %a %a  %a %a %a\n",
                double_world.name(s->run->which), (unsigned long long)s->seed, s->number,
                s->kind->name, fault, number, o.x, o.y, o.z, d.x, d.y, d.z);
        for (int k = 0; k < 2; k++) {
            const List *list = k ? &s->q : &s->d;
            fprintf(stderr, "#   %s%s", k ? "quad" : "double", list->is_inside_before ? " in" : "");
            for (int i = 0; i < list->count && i < 12; i++)
                fprintf(stderr, " [%.17g +-%.3g %+d leaf %d part %u]", (double)list->at[i].t,
                        (double)list->at[i].t_error, list->at[i].change, list->at[i].leaf,
                        list->at[i].part);
            fprintf(stderr, "\n");
        }
    }
    pthread_mutex_unlock(&s->run->lock);
}

/* --- lines beside a line -------------------------------------------------------------------- */

/* Bound by how much rounding moves a line, or the shape. */
static double rounding_at(const Shot *s, V3 o)
{
    double place = v3_max_abs(s->maker.lo) + v3_max_abs(s->maker.hi) + 6;
    return ROUNDING_ULPS * EPS_DOUBLE * (v3_max_abs(o) + place);
}

/* Return line number i beside one: moved by what rounding may do, and turned about the place of
 * some crossing. */
static void line_beside(Shot *s, int i, Quad3 *o, Quad3 *d)
{
    static const double share[4] = {1, 0.3, 0.1, 0.01};
    double most = rounding_at(s, s->ray.o);
    Rng rng = rng_at(s->seed, 7, (uint64_t)(s->number * LINES_TRIED + i));
    V3 move = v3_scale(random_unit(&rng), most * share[rng_u32(&rng) % 4]);
    double by = most * share[rng_u32(&rng) % 4] / (s->maker.size + v3_len(s->ray.o));
    V3 turn = v3_scale(random_unit(&rng), i & 1 ? by : 0);
    const List *list = rng_u32(&rng) % 2 ? &s->d : &s->q;
    Quad at = list->count ? list->at[rng_u32(&rng) % (uint32_t)list->count].t : 0;
    *o = quad_mad(quad_mad(wide(s->ray.o), 1, wide(move)), -at, wide(turn));
    *d = quad_mad(wide(s->ray.d), 1, wide(turn));
}

/* Does double say what is true of a line? */
static bool is_true(Shot *s, const List *list, double slack)
{
    return list_align(&s->d, list, wide(s->ray.d), slack, s->maker.size, s->partner);
}

/* Find a line that rounding cannot tell from the ray's, of which it is true what double says. */
static bool find_true_line(Shot *s)
{
    for (int i = 0; i < LINES_TRIED; i++) {
        Quad3 o, d;
        line_beside(s, i, &o, &d);
        list_line(&quad_world, s->quad, o, d, far_of(s), &s->near);
        if (is_true(s, &s->near, rounding_at(s, s->ray.o)))
            return true;
    }
    return false;
}

/* --- what is checked ------------------------------------------------------------------------ */

static double turned(Quad3 a, Quad3 b)
{
    Quad3 miss = quad_minus(a, b);
    return sqrt(quad_dot(miss, miss));
}

/* Return how much the normal changes when its point is moved by rounding: much at the tip of a
 * cone. */
static double normal_doubt(const Shot *s, const Meeting *d, Quad3 n)
{
    double most = 0, off = rounding_at(s, (V3){0, 0, 0});
    for (int i = 0; i < NORMALS_TRIED; i++) {
        Rng rng = rng_at(s->seed, 6, (uint64_t)(s->number * LINES_TRIED + i));
        Meeting on = *d;
        quad_world.pull(s->quad, quad_mad(d->p, off, wide(random_unit(&rng))), &on);
        most = fmax(most, turned(on.n, n));
    }
    return most;
}

/* The point is on the surface and on the ray, and the normal is that of the surface. */
static void check_point(Shot *s, const Meeting *d)
{
    Meeting on = *d;
    quad_world.pull(s->quad, d->p, &on);
    double off = fabs(quad_dot(quad_minus(on.p, d->p), on.n));
    if (!(off <= (double)d->p_error)) {
        s->tally.off++;
        tell(s, "the point is off by more than it says:", off / (double)d->p_error);
    }
    Quad3 pulled = quad_minus(d->p, quad_mad(wide(s->ray.o), d->t, wide(s->ray.d)));
    double far = sqrt(quad_dot(pulled, pulled)), most = (double)(2 * d->t_error + d->p_error);
    if (!(far <= most + rounding_at(s, s->ray.o))) {
        s->tally.off++;
        tell(s, "the point is not on the ray, of its bound:", far / most);
    }
    double turn = turned(d->n, on.n);
    if (turn > LIMIT_NORMAL && turn <= LIMIT_NORMAL + 2 * normal_doubt(s, d, on.n))
        return;
    s->tally.worst_normal = fmax(s->tally.worst_normal, turn);
    if (!(turn <= LIMIT_NORMAL))
        tell(s, "the normal is off by", turn);
}

static void check_t(Shot *s, int i)
{
    const Meeting *d = &s->d.at[i], *q = &s->q.at[s->partner[i]];
    double miss = quad_abs(d->t - q->t), slant = fabs(quad_dot(q->n, wide(s->ray.d)));
    double bound = (double)(d->t_error + q->t_error);
    if (list_is_touching(&s->d, i))
        return;
    s->tally.worst_share = fmax(s->tally.worst_share, miss / bound);
    if (!(miss <= bound)) {
        s->tally.liars++;
        tell(s, "t is off by more than it says:", miss / bound);
    }
    if (slant < TANGENT_SINE)
        return;
    double relative = miss / fmax(quad_abs(q->t), s->maker.size);
    s->tally.worst_t = fmax(s->tally.worst_t, relative);
    if (!(relative <= LIMIT_T))
        tell(s, "t is off by", relative);
}

static void check_lists(Shot *s)
{
    s->tally.crossings += s->d.count;
    bool is_plain = is_true(s, &s->q, 0);
    if (!is_plain && !find_true_line(s)) {
        bool is_missed = s->d.count < s->q.count;
        *(is_missed ? &s->tally.missed : &s->tally.phantom) += 1;
        tell(s, is_missed ? "a crossing is missed" : "a crossing is made up or wrong", 0);
        return;
    }
    s->tally.fuzzy += !is_plain;
    for (int i = 0; i < s->d.count; i++) {
        if (is_plain && s->partner[i] != NO_PARTNER)
            check_t(s, i);
        if (s->d.at[i].is_visible)
            check_point(s, &s->d.at[i]);
    }
}

/* Is this the first crossing of a list, up to what the bounds leave open: the ray may start at the
 * one before it, or that may be a touching? */
static bool is_first_of(const Shot *s, const List *list, bool is_hit, const Meeting *c, double off)
{
    for (int i = 0; i < list->count; i++) {
        const Meeting *m = &list->at[i];
        double error = (double)m->t_error + off / fabs(quad_dot(m->n, wide(s->ray.d)));
        if (!m->is_visible || m->t < -error)
            continue;
        if (is_hit && quad_abs(c->t - m->t) <= (double)c->t_error + error)
            return true;
        if (m->t > error && !list_is_touching(list, i))
            return false;
    }
    return !is_hit || c->t > far_of(s);
}

/* What is asked for first is first in the list, or in that of a line beside it. */
static void check_closest(Shot *s)
{
    Meeting c;
    bool is_hit = double_world.closest(s->maker.model, wide(s->ray.o), wide(s->ray.d), &c);
    if (is_first_of(s, &s->d, is_hit, &c, 0))
        return;
    for (int i = 0; i < LINES_TRIED; i++) {
        Quad3 o, d;
        line_beside(s, i, &o, &d);
        list_line(&quad_world, s->quad, o, d, far_of(s), &s->near);
        if (is_first_of(s, &s->near, is_hit, &c, rounding_at(s, s->ray.o)))
            return;
    }
    s->tally.closest++;
    tell(s, is_hit ? "the first crossing is not that of the list" : "no first crossing",
         is_hit ? (double)c.t : 0);
}

static bool is_inside_unsure(Shot *s, V3 p, bool told)
{
    double off = rounding_at(s, p);
    for (int i = 0; i < LINES_TRIED; i++) {
        Rng rng = rng_at(s->seed, 8, (uint64_t)(s->number * LINES_TRIED + i));
        if (quad_world.is_inside(s->quad, quad_mad(wide(p), off, wide(random_unit(&rng)))) == told)
            return true;
    }
    return false;
}

/* At a random point, and at one near a crossing. */
static void check_inside(Shot *s)
{
    Rng rng = rng_at(s->seed, 9, (uint64_t)s->number);
    double t = s->maker.size * 6 * rng_double(&rng);
    if (s->d.count && rng_u32(&rng) % 2) {
        const Meeting *m = &s->d.at[rng_u32(&rng) % (uint32_t)s->d.count];
        t = (double)m->t + s->maker.size * pow(10, -16 * rng_double(&rng));
    }
    V3 p = v3_mad(s->ray.o, t, s->ray.d);
    bool told = double_world.is_inside(s->maker.model, wide(p));
    if (told == quad_world.is_inside(s->quad, wide(p)) || is_inside_unsure(s, p, told))
        return;
    s->tally.inside++;
    tell(s, "inside is wrong at", t);
}

static void check_ray(Shot *s)
{
    s->ray = ray_make(&s->maker, s->number, &s->kind);
    Quad3 o = wide(s->ray.o), d = wide(s->ray.d);
    list_line(&double_world, s->maker.model, o, d, far_of(s), &s->d);
    list_line(&quad_world, s->quad, o, d, far_of(s), &s->q);
    s->tally.rays++;
    check_lists(s);
    if (!double_world.may_skip(s->run->which))
        check_closest(s);
    check_inside(s);
}

/* --- runs ----------------------------------------------------------------------------------- */

static void tally_add(Tally *all, const Tally *part)
{
    all->rays += part->rays;
    all->crossings += part->crossings;
    all->fuzzy += part->fuzzy;
    all->missed += part->missed;
    all->phantom += part->phantom;
    all->liars += part->liars;
    all->off += part->off;
    all->inside += part->inside;
    all->closest += part->closest;
    all->worst_t = fmax(all->worst_t, part->worst_t);
    all->worst_normal = fmax(all->worst_normal, part->worst_normal);
    all->worst_share = fmax(all->worst_share, part->worst_share);
}

static void run_model(void *ctx, size_t index, int thread)
{
    (void)thread;
    Run *run = ctx;
    Shot *s = calloc(1, sizeof *s);
    Model *model = double_world.make(run->which, index);
    Model *quad = quad_world.make(run->which, index);
    if (!s || !model || !quad)
        abort();
    s->run = run;
    s->seed = index;
    s->quad = quad;
    ray_maker_init(&s->maker, model, index);
    long most = run->rays - (long)index * RAYS_PER_MODEL;
    for (s->number = 0; s->number < RAYS_PER_MODEL && s->number < most; s->number++)
        check_ray(s);
    pthread_mutex_lock(&run->lock);
    tally_add(&run->all, &s->tally);
    pthread_mutex_unlock(&run->lock);
    double_world.free(model);
    quad_world.free(quad);
    free(s);
}

static long ray_count(void)
{
    const char *rays = getenv("RAYS"), *hard = getenv("HARD");
    if (rays)
        return 2 * atol(rays);
    return hard && !strcmp(hard, "long") ? 2000000 : 1024;
}

static void test_shape(void **state)
{
    Run run = {.which = *(int *)*state, .rays = ray_count()};
    pthread_mutex_init(&run.lock, NULL);
    size_t models = (size_t)((run.rays + RAYS_PER_MODEL - 1) / RAYS_PER_MODEL);
    assert_int_equal(work_for(work_thread_count(), models, run_model, &run), OK);
    pthread_mutex_destroy(&run.lock);
    const Tally *t = &run.all;
    printf("# hard: %s in quad: %ld rays, %ld crossings, %ld by rounding; missed %ld, phantom %ld, "
           "beyond their bounds %ld, points %ld, inside %ld, closest %ld (0); t %.1e (%.0e), "
           "normal %.1e (%.0e); error of t up to %.2f of its bound (1)\n",
           double_world.name(run.which), t->rays, t->crossings, t->fuzzy, t->missed, t->phantom,
           t->liars, t->off, t->inside, t->closest, t->worst_t, LIMIT_T, t->worst_normal,
           LIMIT_NORMAL, t->worst_share);
    assert_true(t->crossings > t->rays / 32);
    assert_int_equal(t->missed + t->phantom + t->liars + t->off + t->inside + t->closest, 0);
    assert_true(t->worst_t <= LIMIT_T && t->worst_normal <= LIMIT_NORMAL);
}

int main(int argc, char **argv)
{
    enum { CASES_MAX = 64 };
    static int which[CASES_MAX];
    struct CMUnitTest tests[CASES_MAX] = {{0}};
    size_t count = 0;
    for (int i = 0; i < CASES_MAX && double_world.name(i); i++) {
        const char *name = double_world.name(i);
        if (argc > 1 && strcmp(argv[1], name))
            continue;
        which[count] = i;
        tests[count] = (struct CMUnitTest){name, test_shape, NULL, NULL, &which[count]};
        count++;
    }
    return _cmocka_run_group_tests("quad", tests, count, NULL, NULL);
}
