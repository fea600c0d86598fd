/* Diagnostics: what the program says to its user about the scene and the machine.
 *
 * A message is lower case, has no full stop, says what was wanted and what was found.
 * Each is built whole and handed to the sink in one piece.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_DIAG_H
#define PMS_BASE_DIAG_H

#include "base/span.h"
#include "base/status.h"

#include <pthread.h>
#include <stdarg.h>

typedef enum WarnKind {
#define X(kind, limit) kind,
#include "base/warn.def"
#undef X
    WARN_COUNT
} WarnKind;

typedef struct Diag {
    void (*sink)(void *ctx, const char *text); /* text ends with a newline */
    void *ctx;                                 /* handed to sink */
    int errors;                                /* messages so far */
    int warnings[WARN_COUNT];                  /* per kind, shown or not */
    pthread_mutex_t lock;                      /* messages may come from any thread */
} Diag;

/* Prepare `diag` to send its messages to `sink`; NULL means standard error. */
void diag_init(Diag *diag, void (*sink)(void *ctx, const char *text), void *ctx);

/* A sink that drops all messages; errors and warnings are still counted. */
void diag_drop(void *ctx, const char *text);

/* Say "(n more warnings ...)" for kinds that went over their limit, and release `diag`. */
void diag_done(Diag *diag);

/* Report an error in the scene at `span`, with the source line and a caret. */
void diag_error(Diag *diag, Span span, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void diag_error_v(Diag *diag, Span span, const char *format, va_list args);

/* Report a warning at `span`; past the limit of its kind it is only counted. */
void diag_warn(Diag *diag, WarnKind kind, Span span, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void diag_warn_v(Diag *diag, WarnKind kind, Span span, const char *format, va_list args);

/* Add a line that says how `span` came about ("included from here"), without its text. */
void diag_note(Diag *diag, Span span, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Send `text` as it is: what a scene says with #debug. */
void diag_say(Diag *diag, const char *text);

/* Report a failure that has no place in a scene ("cannot write ...") and return `status`,
 * so that a caller can write  return diag_fail(diag, ERR_FILE, "...", ...); */
Status diag_fail(Diag *diag, Status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* diag_fail for memory that is out; `what` names what it was for. */
Status diag_no_memory(Diag *diag, const char *what);

#endif
