/* Arrays: up to five dimensions, items of one type.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static int take_subscript(Parser *p, const Token *name, int size)
{
    parse_expect(p, TOKEN_LBRACKET, "the array");
    Span begin = parse_peek(p)->span;
    double index = floor(parse_float(p) + SDL_EPSILON);
    if (!(index >= 0 && index < size))
        parse_fail(p, span_join(begin, p->last), "subscript %g is outside `%s`, which has 0 to %d",
                   index, name->text, size - 1);
    parse_expect(p, TOKEN_RBRACKET, "the subscript");
    return (int)index;
}

Value *array_item(Parser *p, const Array *array, const Token *name)
{
    HoldState hold = hold_aside(p);
    size_t place = 0;
    for (int i = 0; i < array->dimension_count; i++)
        place = place * (size_t)array->size[i] + (size_t)take_subscript(p, name, array->size[i]);
    hold_restore(p, hold);
    return &array->items[place];
}

bool array_item_is_set(Parser *p, const Array *array, const Token *name)
{
    return array_item(p, array, name)->kind != VALUE_NONE;
}

void array_assign(Parser *p, Array *array, Value *item, const Value *from, Span span)
{
    if (from->kind == VALUE_ARRAY)
        parse_fail(p, span, "an array cannot be an item of an array");
    bool is_first = array->item_kind == VALUE_NONE;
    if (!is_first && (array->item_kind != from->kind ||
                      (from->kind == VALUE_NUMBERS && array->number_count != from->count))) {
        Value wanted = {.kind = array->item_kind, .count = array->number_count};
        parse_fail(p, span, "the items of this array are each %s, got %s", value_text(&wanted),
                   value_text(from));
    }
    array->item_kind = from->kind;
    array->number_count = from->count;
    *item = *from;
}

Array *array_copy(Parser *p, const Array *array)
{
    Array *copy = value_alloc(p, sizeof *copy);
    *copy = *array;
    copy->items = value_alloc(p, array->item_count * sizeof *copy->items);
    memcpy(copy->items, array->items, array->item_count * sizeof *copy->items);
    return copy;
}

/* { item, item ... } for the last dimension, { {...} {...} } for those before it. */
static void take_items(Parser *p, Array *array, int dimension, size_t *place)
{
    assert(dimension < ARRAY_DIMENSION_MAX);
    parse_expect(p, TOKEN_LBRACE, "the array");
    for (int i = 0; i < array->size[dimension]; i++) {
        if (parse_peek(p)->kind == TOKEN_RBRACE)
            parse_fail(p, parse_peek(p)->span, "%d items wanted here, got %d",
                       array->size[dimension], i);
        if (dimension + 1 < array->dimension_count) {
            take_items(p, array, dimension + 1, place);
        } else {
            Value value;
            parse_value(p, &value);
            array_assign(p, array, &array->items[(*place)++], &value, value.span);
        }
        parse_comma(p);
    }
    if (parse_peek(p)->kind != TOKEN_RBRACE)
        parse_fail(p, parse_peek(p)->span, "`}` wanted: this array has %d items here",
                   array->size[dimension]);
    parse_next(p);
}

/* Take `[size]`; `count` is that of the items so far. */
static int take_size(Parser *p, double *count)
{
    parse_expect(p, TOKEN_LBRACKET, "`array`");
    HoldState hold = hold_aside(p);
    Span begin = parse_peek(p)->span;
    double wanted = parse_float(p);
    double size = trunc(wanted + SDL_EPSILON);
    Span span = span_join(begin, p->last);
    if (!(size >= 1))
        parse_fail(p, span, "the size of an array is at least 1, not %g", wanted);
    *count *= size;
    if (!(*count <= ARRAY_ITEM_MAX))
        parse_fail(p, span, "an array has at most %.0f items", ARRAY_ITEM_MAX);
    parse_expect(p, TOKEN_RBRACKET, "the size");
    hold_restore(p, hold);
    return (int)size;
}

static void take_dimensions(Parser *p, Array *array)
{
    double count = 1;
    int dimensions = 0;
    array->size[dimensions++] = take_size(p, &count);
    while (dimensions < ARRAY_DIMENSION_MAX && raw_peek(p)->kind == TOKEN_LBRACKET)
        array->size[dimensions++] = take_size(p, &count);
    if (raw_peek(p)->kind == TOKEN_LBRACKET)
        parse_fail(p, raw_peek(p)->span, "an array has at most %d dimensions", ARRAY_DIMENSION_MAX);
    array->dimension_count = dimensions;
    array->item_count = (size_t)count;
}

void parse_array(Parser *p, Value *out)
{
    Span begin = parse_next(p).span;
    Array *array = value_alloc(p, sizeof *array);
    take_dimensions(p, array);
    array->items = value_alloc(p, array->item_count * sizeof *array->items);
    if (raw_peek(p)->kind == TOKEN_LBRACE) {
        size_t place = 0;
        HoldState outer = hold_aside(p);
        take_items(p, array, 0, &place);
        hold_restore(p, outer);
    }
    *out = (Value){.kind = VALUE_ARRAY, .node = array, .span = span_join(begin, p->last)};
}
