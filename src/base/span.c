/* Where in which source text something stands.  SPDX-License-Identifier: Apache-2.0 */
#include "base/span.h"

Place span_place(Span span)
{
    if (!span.source)
        return (Place){0, 0};
    Place place = {1, 1};
    const char *text = span.source->text;
    for (size_t i = 0; i < span.begin && i < span.source->size; i++) {
        int is_newline = text[i] == '\n' || (text[i] == '\r' && text[i + 1] != '\n');
        place.column = is_newline ? 1 : place.column + 1;
        place.line += is_newline;
    }
    return place;
}

Span span_join(Span first, Span last)
{
    if (first.source != last.source || last.end < first.begin)
        return first;
    first.end = last.end;
    return first;
}
