/* Diagnostics.
 *
 * The look:
 *     scenes/a.pov:2:19: error: radius wants a float, got a vector of 2
 *         2 | sphere { <0,0,0>, R + <1,2>
 *           |                   ^~~~~~~~~
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/diag.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { MESSAGE_MAX = 4096, LINE_SHOWN_MAX = 400, TAB_WIDTH = 4 };

/* A message being built; what does not fit is cut. */
typedef struct Message {
    char text[MESSAGE_MAX];
    size_t length;
} Message;

static void append(Message *m, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void append_v(Message *m, const char *format, va_list args)
{
    size_t room = sizeof m->text - m->length;
    int wrote = vsnprintf(m->text + m->length, room, format, args);
    if (wrote > 0)
        m->length += (size_t)wrote < room ? (size_t)wrote : room - 1;
}

static void append(Message *m, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    append_v(m, format, args);
    va_end(args);
}

static void append_char(Message *m, char c)
{
    if (m->length + 1 < sizeof m->text) {
        m->text[m->length++] = c;
        m->text[m->length] = 0;
    }
}

static void append_place(Message *m, Span span)
{
    if (!span.source) {
        append(m, "pms: ");
        return;
    }
    Place place = span_place(span);
    append(m, "%s:%d:%d: ", span.source->path, place.line, place.column);
}

/* Show one source byte: tabs become blanks, control bytes a question mark. */
static void append_source_char(Message *m, unsigned char c)
{
    if (c == '\t')
        append(m, "%*s", TAB_WIDTH, "");
    else
        append_char(m, c < 32 || c == 127 ? '?' : (char)c);
}

static int width_of(unsigned char c)
{
    /* The bytes after the first of a UTF-8 character take no column of their own. */
    return c == '\t' ? TAB_WIDTH : (c & 0xC0) != 0x80;
}

/* Append the source line of `span` and a caret line under it. */
static void append_excerpt(Message *m, Span span)
{
    if (!span.source)
        return;
    const char *text = span.source->text;
    size_t size = span.source->size;
    size_t begin = span.begin < size ? span.begin : size;
    size_t start = begin;
    while (start > 0 && text[start - 1] != '\n' && text[start - 1] != '\r' &&
           begin - start < LINE_SHOWN_MAX / 2)
        start--;
    size_t stop = begin;
    while (stop < size && text[stop] != '\n' && text[stop] != '\r' && stop - start < LINE_SHOWN_MAX)
        stop++;

    append(m, "%5d | ", span_place(span).line);
    for (size_t i = start; i < stop; i++)
        append_source_char(m, (unsigned char)text[i]);
    append(m, "\n      | ");
    for (size_t i = start; i < begin; i++)
        append(m, "%*s", width_of((unsigned char)text[i]), "");
    append_char(m, '^');
    size_t end = span.end < stop ? span.end : stop;
    int tail = 0;
    for (size_t i = begin; i < end; i++)
        tail += width_of((unsigned char)text[i]);
    for (int i = 1; i < tail; i++)
        append_char(m, '~');
    append_char(m, '\n');
}

static void default_sink(void *ctx, const char *text)
{
    (void)ctx;
    fputs(text, stderr);
}

void diag_drop(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

void diag_init(Diag *diag, void (*sink)(void *ctx, const char *text), void *ctx)
{
    memset(diag, 0, sizeof *diag);
    diag->sink = sink ? sink : default_sink;
    diag->ctx = ctx;
    pthread_mutex_init(&diag->lock, NULL);
}

static int warn_limit(WarnKind kind)
{
    static const int limits[] = {
#define X(name, limit) limit,
#include "base/warn.def"
#undef X
    };
    return limits[kind];
}

static void send(Diag *diag, const Message *m)
{
    pthread_mutex_lock(&diag->lock);
    diag->sink(diag->ctx, m->text);
    pthread_mutex_unlock(&diag->lock);
}

void diag_done(Diag *diag)
{
    int more = 0;
    for (int kind = 0; kind < WARN_COUNT; kind++) {
        int over = diag->warnings[kind] - warn_limit((WarnKind)kind);
        more += over > 0 ? over : 0;
    }
    if (more) {
        Message m = {.length = 0};
        append(&m, "pms: warning: (%d more)\n", more);
        send(diag, &m);
    }
    pthread_mutex_destroy(&diag->lock);
}

static void count_error(Diag *diag)
{
    pthread_mutex_lock(&diag->lock);
    diag->errors++;
    pthread_mutex_unlock(&diag->lock);
}

static void report(Diag *diag, Span span, const char *kind, const char *format, va_list args,
                   bool with_excerpt)
{
    Message m = {.length = 0};
    append_place(&m, span);
    append(&m, "%s: ", kind);
    append_v(&m, format, args);
    append_char(&m, '\n');
    if (with_excerpt)
        append_excerpt(&m, span);
    /* A message that was cut still ends its line. */
    if (m.length + 1 >= sizeof m.text)
        m.text[sizeof m.text - 2] = '\n';
    send(diag, &m);
}

void diag_error_v(Diag *diag, Span span, const char *format, va_list args)
{
    count_error(diag);
    report(diag, span, "error", format, args, true);
}

void diag_error(Diag *diag, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    diag_error_v(diag, span, format, args);
    va_end(args);
}

void diag_warn_v(Diag *diag, WarnKind kind, Span span, const char *format, va_list args)
{
    pthread_mutex_lock(&diag->lock);
    bool is_shown = diag->warnings[kind]++ < warn_limit(kind);
    pthread_mutex_unlock(&diag->lock);
    if (is_shown)
        report(diag, span, "warning", format, args, true);
}

void diag_warn(Diag *diag, WarnKind kind, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    diag_warn_v(diag, kind, span, format, args);
    va_end(args);
}

void diag_note(Diag *diag, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report(diag, span, "note", format, args, false);
    va_end(args);
}

void diag_say(Diag *diag, const char *text)
{
    pthread_mutex_lock(&diag->lock);
    diag->sink(diag->ctx, text);
    pthread_mutex_unlock(&diag->lock);
}

Status diag_fail(Diag *diag, Status status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    count_error(diag);
    report(diag, SPAN_NONE, "error", format, args, false);
    va_end(args);
    return status;
}

Status diag_no_memory(Diag *diag, const char *what)
{
    return diag_fail(diag, ERR_MEMORY, "out of memory for %s", what);
}
