/* The parameters of the primitive shapes.
 *
 * What POV-Ray draws as nothing (radius 0, a triangle without area) becomes an empty node and
 * a warning; what has no meaning at all (an axis without direction) is an error.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "math/eps.h"

Node *read_leaf(Parser *p, const Shape *shape)
{
    Node *node = parse_alloc(p, sizeof *node);
    node->kind = NODE_LEAF;
    node->size = 1;
    node->shape = parse_no_null(p, shape);
    return node;
}

Node *read_empty(Parser *p)
{
    Node *node = parse_alloc(p, sizeof *node);
    node->kind = NODE_CSG;
    node->csg = SHAPE_UNION;
    node->depth = 1;
    node->size = 1;
    return node;
}

/* Read a radius: a negative one means its absolute value. */
static double read_radius(Parser *p, const char *what)
{
    Span span;
    double radius = read_finite(p, what, &span);
    if (radius < 0) {
        radius = -radius;
        parse_warn(p, WARN_GEOMETRY, span, "%s is negative: %g is used", what, radius);
    } else if (radius == 0) {
        parse_warn(p, WARN_GEOMETRY, span, "%s is 0", what);
    }
    return radius;
}

Node *read_sphere(Parser *p)
{
    V3 center = parse_v3(p);
    parse_comma(p);
    double radius = read_radius(p, "the radius of a sphere");
    return radius > 0 ? read_leaf(p, shape_sphere(parse_arena(p), center, radius)) : read_empty(p);
}

Node *read_box(Parser *p)
{
    V3 corner = parse_v3(p);
    parse_comma(p);
    V3 opposite = parse_v3(p);
    return read_leaf(p, shape_box(parse_arena(p), corner, opposite));
}

/* Fail unless two ends of an axis are apart, as POV-Ray measures it. */
static void check_axis(Parser *p, Span span, V3 bottom, V3 top, const char *what)
{
    if (!(v3_dist(bottom, top) > EPS_LANGUAGE))
        parse_fail(p, span, "the two ends of a %s are at the same point", what);
}

Node *read_cylinder(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 bottom = parse_v3(p);
    parse_comma(p);
    V3 top = parse_v3(p);
    check_axis(p, span_join(first, parse_last_span(p)), bottom, top, "cylinder");
    parse_comma(p);
    double radius = read_radius(p, "the radius of a cylinder");
    bool is_open = parse_accept(p, KW_OPEN);
    if (!(radius > 0))
        return read_empty(p);
    return read_leaf(p, shape_cone(parse_arena(p), bottom, radius, top, radius, is_open));
}

/* Read a radius of a cone; 0 is its tip. */
static double read_cone_radius(Parser *p)
{
    Span span;
    double radius = read_finite(p, "the radius of a cone", &span);
    if (radius < 0)
        parse_warn(p, WARN_GEOMETRY, span, "the radius of a cone is negative: %g is used", -radius);
    return fabs(radius);
}

Node *read_cone(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 bottom = parse_v3(p);
    parse_comma(p);
    double bottom_radius = read_cone_radius(p);
    parse_comma(p);
    V3 top = parse_v3(p);
    check_axis(p, span_join(first, parse_last_span(p)), bottom, top, "cone");
    parse_comma(p);
    double top_radius = read_cone_radius(p);
    Span all = span_join(first, parse_last_span(p));
    bool is_open = parse_accept(p, KW_OPEN);
    if (!(bottom_radius > 0 || top_radius > 0)) {
        parse_warn(p, WARN_GEOMETRY, all, "both radii of a cone are 0");
        return read_empty(p);
    }
    return read_leaf(p,
                     shape_cone(parse_arena(p), bottom, bottom_radius, top, top_radius, is_open));
}

Node *read_torus(Parser *p)
{
    Span span;
    double major = read_finite(p, "the major radius of a torus", &span);
    if (major < 0)
        parse_warn(p, WARN_GEOMETRY, span, "the major radius of a torus is negative: %g is used",
                   -major);
    parse_comma(p);
    double minor = read_radius(p, "the minor radius of a torus");
    if (!(minor > 0))
        return read_empty(p);
    return read_leaf(p, shape_torus(parse_arena(p), fabs(major), minor));
}

Node *read_plane(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 normal = parse_v3(p);
    if (!(v3_len2(v3_unit(normal)) > 0))
        parse_fail(p, span_join(first, parse_last_span(p)), "the normal of a plane is 0");
    parse_comma(p);
    double distance = read_finite(p, "the distance of a plane", NULL);
    return read_leaf(p, shape_plane(parse_arena(p), v3_unit(normal), distance));
}

Node *read_disc(Parser *p)
{
    V3 center = parse_v3(p);
    parse_comma(p);
    Span first = parse_peek(p)->span;
    V3 normal = v3_unit(parse_v3(p));
    Span span = span_join(first, parse_last_span(p));
    parse_comma(p);
    double radius = read_radius(p, "the radius of a disc");
    double hole = 0;
    parse_comma(p);
    if (parse_is_expression(p))
        hole = fabs(read_finite(p, "the hole of a disc", NULL));
    if (!(v3_len2(normal) > 0)) {
        parse_warn(p, WARN_GEOMETRY, span, "the normal of a disc is 0: it is not seen");
        return read_empty(p);
    }
    if (!(radius > hole)) {
        parse_warn(p, WARN_GEOMETRY, span, "the hole of a disc is all of it: it is not seen");
        return read_empty(p);
    }
    return read_leaf(p, shape_disc(parse_arena(p), center, normal, radius, hole));
}

/* --- triangles ----------------------------------------------------------------------------- */

bool read_triangle_is_flat(const V3 corner[3])
{
    V3 cross = v3_cross(v3_sub(corner[1], corner[0]), v3_sub(corner[2], corner[0]));
    return !(v3_max_abs(cross) > 0) || !v3_is_finite(cross);
}

Node *read_triangle(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 corner[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = parse_v3(p);
        parse_comma(p);
    }
    if (read_triangle_is_flat(corner)) {
        parse_warn(p, WARN_GEOMETRY, span_join(first, parse_last_span(p)),
                   "degenerate triangle: it has no area");
        return read_empty(p);
    }
    return read_leaf(p, shape_triangle(parse_arena(p), corner, NULL));
}

Node *read_smooth_triangle(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 corner[3], normal[3];
    bool has_normals = true;
    for (int i = 0; i < 3; i++) {
        corner[i] = parse_v3(p);
        parse_comma(p);
        normal[i] = v3_unit(parse_v3(p));
        has_normals &= v3_len2(normal[i]) > 0;
        parse_comma(p);
    }
    if (!has_normals || read_triangle_is_flat(corner)) {
        parse_warn(p, WARN_GEOMETRY, span_join(first, parse_last_span(p)),
                   "degenerate smooth triangle: it has no area, or a normal is 0");
        return read_empty(p);
    }
    return read_leaf(p, shape_triangle(parse_arena(p), corner, normal));
}
