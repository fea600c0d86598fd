/* Plain vectors, read straight from the text.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/vector_scan.h"

#include "sdl/decimal.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline bool is_digit(char c)
{
    return (unsigned char)(c - '0') < 10;
}

const char *scan_blanks(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || (*at >= '\t' && *at <= '\r')))
        at++;
    return at;
}

/* Read an exponent after its letter; NULL if there is none. */
static const char *scan_exponent(const char *at, const char *end, int *exponent)
{
    bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    int value = 0;
    const char *first = at;
    for (; at < end && is_digit(*at) && at - first < 4; at++)
        value = value * 10 + (*at - '0');
    *exponent += is_negative ? -value : value;
    return at > first ? at : NULL;
}

/* Read a number with a sign or without. */
static const char *scan_number(const char *at, const char *end, double *out)
{
    bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    uint64_t digits = 0;
    const char *first = at;
    for (; at < end && is_digit(*at); at++)
        digits = digits * 10 + (uint64_t)(*at - '0');
    ptrdiff_t count = at - first;
    int exponent = 0;
    if (at < end && *at == '.') {
        const char *point = ++at;
        for (; at < end && is_digit(*at); at++)
            digits = digits * 10 + (uint64_t)(*at - '0');
        exponent = (int)(point - at);
        count += at - point;
    }
    if (count == 0)
        return NULL;
    if (at < end && (*at == 'e' || *at == 'E') && !(at = scan_exponent(at + 1, end, &exponent)))
        return NULL;
    if (!decimal_is_exact(count, exponent))
        return NULL;
    double value = decimal_value(digits, exponent);
    *out = is_negative ? -value : value;
    return at;
}

const char *scan_vector(const char *at, const char *end, int size, double *out)
{
    for (int i = 0; i < size; i++) {
        /* `<` the first time, then commas. */
        if (at >= end || *at != (i ? ',' : '<'))
            return NULL;
        at = scan_number(scan_blanks(at + 1, end), end, &out[i]);
        if (!at)
            return NULL;
        at = scan_blanks(at, end);
    }
    return at < end && *at == '>' ? at + 1 : NULL;
}

/* Skip a word; NULL if it is another one. */
static const char *scan_word(const char *at, const char *end, const char *word)
{
    size_t length = strlen(word);
    if ((size_t)(end - at) <= length || memcmp(at, word, length) != 0)
        return NULL;
    at = scan_blanks(at + length, end);
    return at < end && *at == '{' ? scan_blanks(at + 1, end) : NULL;
}

/* Read a vector of 3 that ends as an expression there, and the comma behind it. */
static const char *scan_item(const char *at, const char *end, double out[3])
{
    at = scan_vector(at, end, 3, out);
    if (!at)
        return NULL;
    at = scan_blanks(at, end);
    if (at < end && *at == ',')
        at = scan_blanks(at + 1, end);
    return at < end && (*at == '<' || *at == '}') ? at : NULL;
}

const char *scan_triangle(const char *at, const char *end, PlainTriangle *out)
{
    out->is_smooth = at < end && *at == 's';
    at = scan_word(at, end, out->is_smooth ? "smooth_triangle" : "triangle");
    for (int i = 0; i < 3 && at; i++) {
        at = scan_item(at, end, out->corner[i]);
        if (at && out->is_smooth)
            at = scan_item(at, end, out->normal[i]);
    }
    return at && *at == '}' ? at + 1 : NULL;
}
