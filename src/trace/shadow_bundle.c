/* Bundles of shadow rays: from one point to the points of one area light.
 *
 * All the rays lie in a cone around the way to the light's middle, cut off behind the light.
 * What is wholly outside a plane that touches the cone cannot meet any of them; most points see
 * nothing between them and the light, and then not one ray need be traced.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

/* With more objects than this the rays are cheaper than looking at all objects. */
enum { BUNDLE_OBJECTS_MAX = 512 };

/* Widens the cone by more than the rounding of the tests. */
#define WIDER (1 + 1e-9)

typedef struct Cone {
    V3 apex, axis; /* axis unit */
    double sine, cosine;
    double length; /* along the axis, to behind the light */
    double slack;  /* scene units: rounding of the apex */
    V3 light;      /* the light's middle */
    double radius; /* of the light */
} Cone;

/* Is the ball behind a plane that touches the cone on its side, or one that ends it? */
static bool ball_is_outside(const Cone *cone, const TracedObject *object)
{
    V3 to = v3_sub(object->center, cone->apex);
    double along = v3_dot(to, cone->axis), limit = object->radius + cone->slack;
    if (along < -limit || along > cone->length + limit)
        return true;
    double far2 = v3_len2(to), aside2 = far2 - along * along;
    double side = limit + along * cone->sine; /* against aside * cosine */
    return side < 0 || aside2 * cone->cosine * cone->cosine > side * side + far2 * 1e-14;
}

/* Are the apex and the whole light on one side of the plane? */
static bool plane_is_outside(const Cone *cone, const Shape *plane)
{
    V3 n = plane->u.plane.normal;
    double apex = v3_dot(n, cone->apex) - plane->u.plane.distance;
    double light = v3_dot(n, cone->light) - plane->u.plane.distance;
    return (apex > 0 && light > cone->radius) || (apex < 0 && light < -cone->radius);
}

static bool is_outside(const Cone *cone, const TracedObject *object)
{
    if (object->shadow == SHADOW_NONE)
        return true;
    if (object->shape->kind == SHAPE_PLANE)
        return plane_is_outside(cone, object->shape);
    return object->radius > 0 && ball_is_outside(cone, object);
}

void trace_shadow_bundle(const Tracer *tracer, const ShapePoint *from, V3 to_center, double radius,
                         ShadowBundle *out)
{
    double distance = v3_len(to_center);
    out->count = -1;
    radius = radius * WIDER + 1e-9 * distance;
    if (!(radius < distance) || tracer->scene->object_count > BUNDLE_OBJECTS_MAX)
        return;
    Cone cone;
    cone.axis = v3_scale(to_center, 1 / distance);
    cone.apex = trace_ray_from(from, cone.axis).o;
    cone.sine = radius / distance;
    cone.cosine = sqrt(1 - cone.sine * cone.sine);
    cone.length = distance + radius;
    cone.slack = 16 * from->p_error;
    cone.light = v3_add(from->p, to_center);
    cone.radius = radius;
    int count = 0;
    for (uint32_t i = 0; i < tracer->scene->object_count; i++) {
        if (is_outside(&cone, &tracer->objects[i]))
            continue;
        if (count == SHADOW_BUNDLE_MAX)
            return;
        out->object[count++] = i;
    }
    out->count = count;
}
