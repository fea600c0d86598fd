/* Rows of the table that `make check-hard` prints: what was measured, and what it may be.
 *
 * HARD=long in the environment asks for the long counts.  Include after cmocka.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_HARD_H
#define PMS_TESTS_HARD_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline bool hard_is_long(void)
{
    const char *mode = getenv("HARD");
    return mode && strcmp(mode, "long") == 0;
}

/* Print the row of a case.
 *
 * name   in plain words, without a colon.
 * limit  as text.
 * what   what was measured, as printf. */
static inline void hard_row(const char *name, const char *limit, const char *what, ...)
    __attribute__((format(printf, 3, 4)));

static inline void hard_row(const char *name, const char *limit, const char *what, ...)
{
    char text[256];
    va_list list;
    va_start(list, what);
    vsnprintf(text, sizeof text, what, list);
    va_end(list);
    printf("# hard: %s: %s (%s)\n", name, text, limit);
    fflush(stdout);
}

#endif
