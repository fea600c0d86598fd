/* Where in which source text something stands.
 *
 * Sources live in the text arena, as long as the Scene, so a Span may be kept anywhere and
 * a message about it made at any time.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_SPAN_H
#define PMS_BASE_SPAN_H

#include <stddef.h>
#include <stdint.h>

typedef struct Source {
    const char *path; /* as messages show it */
    const char *text; /* the bytes of the file, terminated by a 0 that is not counted */
    size_t size;      /* bytes */
} Source;

typedef struct Span {
    const Source *source; /* NULL: nowhere in a file (a default, the command line) */
    uint32_t begin, end;  /* bytes from the start of the text; end is one past the last */
} Span;

#define SPAN_NONE ((Span){0})

typedef struct Place {
    int line, column; /* both from 1; the column counts bytes */
} Place;

/* Return the line and column where `span` begins; {0,0} for SPAN_NONE.  O(size). */
Place span_place(Span span);

/* Return the span from the start of `first` to the end of `last` (same source), or `first`
 * alone when the two are in different sources. */
Span span_join(Span first, Span last);

#endif
