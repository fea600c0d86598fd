/* Surfaces of revolution: a profile of pieces turned around the y axis.
 *
 * Inside is what an odd number of pieces are around.  A profile that does not close gets lids, flat
 * and level, from its ends to the axis.  Pieces that share a knot agree on which side of the
 * surface a line passes it, and lids ask the same question, so that every line enters and leaves
 * in turn.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_REVOLVE_INT_H
#define PMS_SHAPE_REVOLVE_INT_H

#include "shape/box_tree.h"
#include "shape/shape_int.h"

/* A piece along which y does not turn back. */
typedef struct RevolvePiece {
    double r[4];     /* Bernstein coefficients: of the radius, or of its square (is_square) */
    double y[4];     /* of the height; of the first degree if is_square */
    double from, to; /* of the span it is of: 0 to 1 */
    uint32_t span;
} RevolvePiece;

/* A lid closes the profile at one of its ends, but is not always seen. */
typedef struct RevolveLid {
    double r, y; /* r: as in the piece */
} RevolveLid;

typedef struct RevolveData {
    bool is_square; /* sor */
    int degree;
    uint32_t piece_count, lid_count, span_count;
    RevolvePiece *pieces;
    RevolveLid *lids; /* ascending in y */
    BoxTree tree;     /* x: radius */
    double r_max, y_lo, y_hi;
} RevolveData;

/* A line in units of length about a point f of it near the shape. */
typedef struct RevolveLine {
    V3 f, e; /* e unit */
    double base, speed; /* t = base + s / speed */
    double tmin;        /* t where crossings are wanted from */
    double lo, hi;      /* s: beyond, and at these, the line is further out than any piece */
    double near, far;   /* the part of lo to hi where crossings are wanted */
    double axis;        /* s nearest to the axis */
    double per_y;       /* 1 / e.y */
} RevolveLine;

/* A place on a piece where a line crosses it. */
typedef struct RevolveRoot {
    double s, u;  /* u: on the piece */
    double terms; /* magnitude of the squares whose difference is 0 there */
} RevolveRoot;

enum { REVOLVE_ROOTS_MAX = 6 };

/* The part of a piece on which crossings are wanted, seen as [0, 1]. */
typedef struct RevolvePart {
    double from, to; /* of the piece */
    double s[2];     /* at its ends */
    bool is_tiny;    /* it is so short that nothing but s changes along it */
    bool is_cut[2];  /* it ends before the piece does */
} RevolvePart;

/* Find where a line crosses a part of a piece; is_within: whether, at its ends, the line is less
 * far out than the piece.  Returns how many. */
int lathe_roots(const RevolveData *data, const RevolvePiece *piece, const RevolvePart *part,
                const RevolveLine *l, RevolveRoot *out, bool is_within[2]);
int sor_roots(const RevolveData *data, const RevolvePiece *piece, const RevolvePart *part,
              const RevolveLine *l, RevolveRoot *out, bool is_within[2]);

/* Finish a shape whose pieces, lids and so on are set; NULL when memory is out. */
Shape *revolve_place(Arena *arena, Shape *shape, RevolveData *data);

/* Return the angle around the y axis, from x towards z, in turns from 0 to 1. */
double revolve_turn(V3 p);

/* The operations of lathe and sor. */
bool revolve_list(const Shape *shape, const Line *line, ShapeScratch *scratch);
void revolve_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out);
bool revolve_is_inside(const Shape *shape, V3 p);
Bound revolve_bound(const Shape *shape);
V3 revolve_farthest(const Shape *shape, V3 n);
double revolve_size(const Shape *shape);

/* Return the box around two circles about the y axis, in world space. */
Bound circles_bound(const Shape *shape, double r_lo, double y_lo, double r_hi, double y_hi);

/* Return the furthest point of these circles along n. */
V3 circles_farthest(double r_lo, double y_lo, double r_hi, double y_hi, V3 n);

#endif
