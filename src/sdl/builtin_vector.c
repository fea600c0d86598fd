/* Built-in functions that yield vectors.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

static V3 argument(Parser *p)
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    return terms_v3(p, &terms, begin);
}

static V3 call_vcross(Parser *p)
{
    V3 a = argument(p);
    parse_comma(p);
    return v3_cross(a, argument(p));
}

static V3 call_vnormalize(Parser *p)
{
    V3 a = argument(p);
    if (a.x == 0 && a.y == 0 && a.z == 0)
        parse_warn(p, WARN_VALUE, p->last, "`vnormalize` of <0, 0, 0> is <0, 0, 0>");
    return v3_unit(a);
}

/* About x, then y, then z, in degrees, in the left-handed sense. */
static V3 call_vrotate(Parser *p)
{
    V3 point = argument(p);
    parse_comma(p);
    V3 angles = v3_scale(argument(p), PMS_PI / 180);
    Xform xform = xform_rotate(angles);
    return xform_point(&xform, point);
}

/* Rodrigues' formula. */
static V3 call_vaxis_rotate(Parser *p)
{
    V3 point = argument(p);
    parse_comma(p);
    V3 axis = v3_unit(argument(p));
    parse_comma(p);
    double angle = parse_float(p) * (PMS_PI / 180), c = cos(angle), s = sin(angle);
    V3 turned = v3_mad(v3_scale(point, c), s, v3_cross(axis, point));
    return v3_mad(turned, (1 - c) * v3_dot(axis, point), axis);
}

/* Its parentheses are the caller's. */
void parse_vector_call(Parser *p, TokenKind word, Terms *out)
{
    V3 result = word == KW_VCROSS       ? call_vcross(p)
                : word == KW_VNORMALIZE ? call_vnormalize(p)
                : word == KW_VROTATE    ? call_vrotate(p)
                                        : call_vaxis_rotate(p);
    *out = (Terms){.count = 3, .n = {result.x, result.y, result.z}};
}
