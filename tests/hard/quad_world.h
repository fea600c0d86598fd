/* The oracle of the geometry: the same code compiled twice, with double and with quad precision.
 *
 * Each is a world of its own, reached through a table of functions.  Between them go plain
 * numbers: a shape is made in both from the same random ones, and what is asked and answered has
 * the digits of the wider one.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_WORLD_H
#define PMS_TESTS_QUAD_WORLD_H

#include "quad_plain.h"

#include <stdbool.h>
#include <stdint.h>

/* A shape in one world, with its memory.  One thread at a time. */
typedef struct Model Model;

typedef struct Quad3 {
    Quad x, y, z;
} Quad3;

typedef struct Plain3 {
    Plain x, y, z;
} Plain3;

/* A crossing, and the point there. */
typedef struct Meeting {
    Quad t, t_error;
    Quad u, v;
    Quad3 p, n;
    Quad p_error;
    int leaf; /* number of the leaf in the model */
    uint32_t part;
    int change;
    bool is_visible, is_flipped;
} Meeting;

typedef struct World {
    const char *(*name)(int which); /* of a case, or NULL */
    bool (*may_skip)(int which);    /* what is thin may be left out */

    /* Make the model of a case from random numbers: the same ones for the same seed.  NULL when
     * memory is out. */
    Model *(*make)(int which, uint64_t seed);
    void (*free)(Model *model);

    /* Around what can be seen; sides may be infinite. */
    void (*bound)(const Model *model, Plain3 *lo, Plain3 *hi);

    /* Points of the surface that are hard: corners, tips, ends of edges.  Returns how many. */
    int (*marks)(const Model *model, const Plain3 **out);

    /* Return where a direction of the shape's own space points to. */
    Plain3 (*turn)(const Model *model, Plain3 d);

    /* List the crossings of a whole line; returns how many (may exceed capacity). */
    int (*meet)(Model *model, Quad3 o, Quad3 d, bool *is_inside_before, Meeting *out, int capacity);

    /* Find the first visible crossing with 0 < t. */
    bool (*closest)(Model *model, Quad3 o, Quad3 d, Meeting *out);

    /* Pull a point near a meeting onto the surface: sets p, n and p_error of it. */
    void (*pull)(const Model *model, Quad3 p, Meeting *at);

    bool (*is_inside)(const Model *model, Quad3 p);
} World;

extern const World double_world, quad_world;

#endif
