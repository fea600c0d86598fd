/* Plain vectors, read straight from the text: what the long lists of meshes consist of.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_VECTOR_SCAN_H
#define PMS_SDL_VECTOR_SCAN_H

#include <stdbool.h>

/* Read `<n, n>` or `<n, n, n>` with `size` numbers at `at`, which must begin with `<`.
 *
 * Returns what follows it, or NULL: it is something else, a comment is in it, or a number has
 * more digits than are exact; then the ordinary way reads it. */
const char *scan_vector(const char *at, const char *end, int size, double *out);

/* A triangle of a mesh. */
typedef struct PlainTriangle {
    double corner[3][3], normal[3][3]; /* normal: if is_smooth */
    bool is_smooth;
} PlainTriangle;

/* Read `triangle { v, v, v }` or `smooth_triangle { v, n, v, n, v, n }` of plain vectors; returns
 * what follows it, or NULL as scan_vector. */
const char *scan_triangle(const char *at, const char *end, PlainTriangle *out);

/* Skip blanks; returns what follows, or `end`. */
const char *scan_blanks(const char *at, const char *end);

#endif
