/* JSON, written by hand.  SPDX-License-Identifier: Apache-2.0 */
#include "base/json.h"

#include <math.h>
#include <stdbool.h>

/* Return true if `text`, which is not empty, begins with a UTF-8 character; false for a sequence
 * that is cut short, longer than it must be, of a surrogate or beyond U+10FFFF.  Of that *length is
 * as far as a character might have gone on.  Only the range of the second byte depends on the
 * first. */
static bool take_utf8(const unsigned char *text, int *length)
{
    unsigned char first = text[0];
    unsigned char low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
    unsigned char high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
    int wanted = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    *length = 1;
    if ((first >= 0x80 && first < 0xC2) || first > 0xF4)
        return false;
    for (; *length < wanted; ++*length) {
        if (text[*length] < low || text[*length] > high)
            return false;
        low = 0x80;
        high = 0xBF;
    }
    return true;
}

static void put_char(FILE *file, const unsigned char *text, int length)
{
    if (text[0] == '"' || text[0] == '\\')
        fprintf(file, "\\%c", text[0]);
    else if (text[0] < 32 || text[0] == 127)
        fprintf(file, "\\u%04x", text[0]);
    else
        fwrite(text, 1, (size_t)length, file);
}

void json_string(FILE *file, const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    fputc('"', file);
    while (*at) {
        int length;
        if (take_utf8(at, &length))
            put_char(file, at, length);
        else
            fputs("\xEF\xBF\xBD", file); /* U+FFFD, the replacement character */
        at += length;
    }
    fputc('"', file);
}

void json_number(FILE *file, double number)
{
    if (isfinite(number))
        fprintf(file, "%.9g", number);
    else
        fputs("null", file);
}

void json_field(FILE *file, const char *name, double number)
{
    fprintf(file, ", \"%s\": ", name);
    json_number(file, number);
}

void json_text(FILE *file, const char *name, const char *text)
{
    fprintf(file, ", \"%s\": ", name);
    json_string(file, text);
}
