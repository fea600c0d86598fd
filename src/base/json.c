/* JSON, written by hand.  SPDX-License-Identifier: Apache-2.0 */
#include "base/json.h"

#include <math.h>

void json_string(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            fprintf(file, "\\%c", c);
        else if (c < 32 || c == 127)
            fprintf(file, "\\u%04x", c);
        else
            fputc(c, file);
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
