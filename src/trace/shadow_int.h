/* Between the files that make a ShadowView.
 *
 * What casts shadows in a cell of directions is enclosed between two planes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_SHADOW_INT_H
#define PMS_TRACE_SHADOW_INT_H

#include "trace/shadow_view.h"

/* nearness = a u + b v + c, u and v from -1 to 1 */
typedef struct Plane {
    double a, b, c;
} Plane;

/* Everything nearer than `lit` is lit, everything behind `dark` is not. */
typedef struct Enclosure {
    Plane lit, dark;
} Enclosure;

/* What may cast a shadow. */
typedef struct Part {
    const Shape *shape;
    bool is_convex, is_opaque;
    bool is_at_lamp; /* its surface is: nothing is said about it */
    double nearest;  /* nearness that no point of it is above */
    double touch;    /* a surface no further than this from where rays begin is there */
} Part;

typedef struct Cell {
    double u, v, size;   /* low corner */
    uint32_t i, j, side; /* the same in smallest cells */
} Cell;

/* A face, and what is needed to look from it. */
typedef struct Sight {
    const ShadowFace *face;
    ShapeScratch *shapes;
    Enclosure nothing; /* of an empty cell: further than everything */
} Sight;

/* Return true if a is over b in all of the cell. */
bool plane_is_over(const Plane *a, const Plane *b, const Cell *cell);

/* Add what encloses one thing to what encloses others. */
void enclosure_add(Enclosure *sum, const Enclosure *e, const Cell *cell);

/* Return true if the planes are so close together that there is no more to learn. */
bool enclosure_is_close(const Enclosure *e, const Cell *cell);

/* Return true if it is proved that no ray in the cell meets a shape. */
bool part_is_missed(const ShadowFace *face, const Cell *cell, const Shape *shape);

/* Enclose a part that is not missed, as if it were opaque. */
Enclosure part_enclose(const Sight *sight, const Cell *cell, const Part *part);

/* Find the outline of a part that fills one side of a cell: u and v of `edge` are from -1 to 1;
 * *dark is then a plane behind which all is dark on the inner side.  Returns false if the outline
 * is not simple, or too wide. */
bool part_edge(const Sight *sight, const Cell *cell, const Part *part, ShadowEdge *edge,
               Plane *dark);

#endif
