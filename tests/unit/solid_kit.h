/* What tests of curved solids share: random lines that must enter and leave in turn, where the
 * shape's own inside test, and a slow one of the test's, say so.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_SOLID_KIT_H
#define PMS_TESTS_SOLID_KIT_H

#include "shape_kit.h"

/* 1 inside, 0 outside, -1 too near to tell. */
typedef int (*InsideFn)(const void *form, V3 p);

/* How far crossings may be off, relative to the shape's size. */
#define SOLID_TOLERANCE 1e-9

/* What is found from a point between crossings is the next one of the list. */
static inline void check_closest(const Shape *shape, Ray ray, const Crossing *items, int count,
                                 double size)
{
    for (int i = 0; i < count; i++) {
        double before = i ? items[i - 1].t : items[i].t - size;
        if (items[i].t - before < 1e-6 * size)
            continue;
        ray.tmin = 0.5 * (before + items[i].t);
        ray.tmax = i % 3 ? INFINITY : 0.5 * (items[i].t + items[i].t + size);
        Crossing c;
        int next = i;
        while (next < count && !items[next].is_visible)
            next++;
        bool is_hit = shape_closest(shape, &ray, scratch, &c);
        if (is_hit != (next < count && items[next].t < ray.tmax))
            fail_msg("from %.17g on a crossing is %s", ray.tmin, is_hit ? "made up" : "lost");
        if (!is_hit)
            continue;
        if (!(fabs(c.t - items[next].t) <= c.t_error + items[next].t_error + 1e-9 * size))
            fail_msg("the closest is at %.17g, not %.17g", c.t, items[next].t);
        if (items[next].t_error < 1e-9 * size &&
            (next + 1 == count || items[next + 1].t - items[next].t > 1e-6 * size))
            assert_int_equal(c.change, items[next].change);
    }
}

/* Check the crossings of one line; returns how many.  Without is_inside, lines may run along
 * walls. */
static inline int check_line(const Shape *shape, V3 o, V3 d, double size, InsideFn is_inside,
                             const void *form)
{
    Ray ray = {o, d, -INFINITY, INFINITY};
    CrossList list;
    shape_crossings(shape, &ray, scratch, &list);
    int state = list.is_inside_before, count = list.count;
    static Crossing items[1024];
    if (count > 1024)
        fail_msg("%d crossings", count);
    for (int i = 0; i < count; i++)
        items[i] = list.items[i];
    for (int i = 0; i < count; i++) {
        const Crossing *c = &items[i];
        assert_int_equal(c->change, state ? -1 : 1);
        state = !state;
        if (i && !(c->t >= items[i - 1].t))
            fail_msg("crossings out of order: %.17g after %.17g", c->t, items[i - 1].t);
        ShapePoint point;
        shape_point(c, &ray, &point);
        double off = v3_dist(point.p, ray_at(&ray, c->t));
        if (!(off <= SOLID_TOLERANCE * size + 1e-12 * fabs(c->t)))
            fail_msg("the point is %g off its ray (t_error %g)", off, c->t_error);
        if (!(fabs(v3_len(point.ng) - 1) < 1e-9))
            fail_msg("normal of length %g", v3_len(point.ng));
        if (v3_dot(point.ng, d) * (state ? -1 : 1) < -1e-6)
            fail_msg("the normal points to the wrong side: %g", v3_dot(point.ng, d));
        /* Between crossings. */
        double before = i ? items[i - 1].t : c->t - 2e-3 * size;
        if (c->t - before > 1e-6 * size) {
            V3 middle = ray_at(&ray, 0.5 * (c->t + before));
            if (is_inside && shape_is_inside(shape, middle) != !state)
                fail_msg("inside(<%.17g,%.17g,%.17g>) is wrong", middle.x, middle.y, middle.z);
            if (is_inside && is_inside(form, middle) == state)
                fail_msg("<%.17g,%.17g,%.17g> is %s", middle.x, middle.y, middle.z,
                         state ? "inside" : "outside");
        }
    }
    assert_int_equal(state, list.is_inside_before);
    if (is_inside)
        check_closest(shape, ray, items, count, size);
    return count;
}

/* Check random lines through a box around the shape; returns the crossings found. */
static inline long check_solid(const Shape *shape, int lines, InsideFn is_inside, const void *form)
{
    Bound box = shape_bound(shape);
    double size = v3_dist(box.lo, box.hi);
    Rng rng = rng_at(7, 1, 0);
    long found = 0;
    for (int i = 0; i < lines; i++) {
        V3 d = random_dir(&rng), at;
        at.x = box.lo.x + (box.hi.x - box.lo.x) * rng_double(&rng);
        at.y = box.lo.y + (box.hi.y - box.lo.y) * rng_double(&rng);
        at.z = box.lo.z + (box.hi.z - box.lo.z) * rng_double(&rng);
        /* Lines along the axes, and nearly so. */
        if (i % 4 == 1)
            d = v3_unit(v3(d.x, i % 8 == 1 ? 0 : 1e-9 * d.y, d.z));
        if (i % 4 == 2)
            d = v3_unit(v3(i % 8 == 2 ? 0 : 1e-9 * d.x, d.y, 1e-9 * d.z));
        found += check_line(shape, v3_mad(at, -3 * size, d), d, size, is_inside, form);
        if (is_inside && is_inside(form, at) == !shape_is_inside(shape, at))
            fail_msg("inside(<%.17g,%.17g,%.17g>) is wrong", at.x, at.y, at.z);
    }
    return found;
}

#endif
