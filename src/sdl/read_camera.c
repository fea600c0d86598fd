/* camera: items in any order, finished vectors at the closing brace.
 *
 * The items are collected and applied in a fixed order: up and right, angle, look_at, the size
 * of an orthographic view, focal distance, and the transforms last.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "math/eps.h"

typedef struct CameraDraft {
    Camera camera;
    V3 sky, look_at, focal_point;
    bool has_look_at, has_focal_point, has_angle, has_right_or_up;
    double angle; /* radians, 0: not given */
    Xform xform;
    Span look_at_span;
} CameraDraft;

/* --- items --------------------------------------------------------------------------------- */

static void read_angle(Parser *p, CameraDraft *d)
{
    parse_next(p);
    d->has_angle = true;
    if (d->camera.kind == CAMERA_ORTHOGRAPHIC && !parse_is_expression(p))
        return;
    Span span;
    double degrees = read_finite(p, "angle", &span);
    if (!(degrees >= 0 && degrees < 180))
        parse_fail(p, span, "angle wants at least 0 and less than 180 degrees, got %g", degrees);
    d->angle = degrees * (PMS_PI / 180);
}

static void read_blur_samples(Parser *p, CameraDraft *d)
{
    enum { BLUR_SAMPLES_MAX = 1000000 };
    parse_next(p);
    long samples = parse_int(p, "blur_samples", 1, BLUR_SAMPLES_MAX);
    parse_comma(p);
    if (parse_is_expression(p))
        samples = parse_int(p, "blur_samples", samples, BLUR_SAMPLES_MAX);
    d->camera.blur_samples = (int)samples;
}

/* Read a number of (0,1) or [0,1]; what lies outside is replaced, as POV-Ray does. */
static double read_fraction(Parser *p, const char *what, double lowest, double standard)
{
    parse_next(p);
    Span span;
    double value = read_finite(p, what, &span);
    if (value >= lowest && value < 1)
        return value;
    parse_warn(p, WARN_VALUE, span, "%s wants a number between 0 and 1, got %g: %g is used", what,
               value, standard);
    return standard;
}

/* Focal blur; returns false if none of its items comes next. */
static bool read_blur_item(Parser *p, CameraDraft *d)
{
    switch (parse_peek(p)->kind) {
    case KW_APERTURE:
        parse_next(p);
        d->camera.aperture = fabs(read_finite(p, "aperture", NULL));
        return true;
    case KW_FOCAL_POINT:
        parse_next(p);
        d->focal_point = parse_v3(p);
        d->has_focal_point = true;
        return true;
    case KW_BLUR_SAMPLES:
        read_blur_samples(p, d);
        return true;
    case KW_CONFIDENCE:
        d->camera.blur_confidence = read_fraction(p, "confidence", 1e-300, 0.9);
        return true;
    case KW_VARIANCE:
        d->camera.blur_variance = read_fraction(p, "variance", 0, 1e-4);
        return true;
    default:
        return false;
    }
}

/* The vectors; returns false if none comes next. */
static bool read_vector_item(Parser *p, CameraDraft *d)
{
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_LOCATION:
        parse_next(p);
        d->camera.location = parse_v3(p);
        return true;
    case KW_DIRECTION:
        parse_next(p);
        d->camera.direction = parse_v3(p);
        return true;
    case KW_RIGHT:
        parse_next(p);
        d->camera.right = parse_v3(p);
        d->has_right_or_up = true;
        return true;
    case KW_UP:
        parse_next(p);
        d->camera.up = parse_v3(p);
        d->has_right_or_up = true;
        return true;
    case KW_SKY:
        parse_next(p);
        d->sky = parse_v3(p);
        return true;
    case KW_LOOK_AT:
        parse_next(p);
        d->look_at = parse_v3(p);
        d->look_at_span = span_join(head.span, parse_last_span(p));
        d->has_look_at = true;
        return true;
    default:
        return false;
    }
}

/* A type of camera after other items, or one that pms lacks. */
static void fail_camera_item(Parser *p)
{
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_PERSPECTIVE:
    case KW_ORTHOGRAPHIC:
        parse_fail(p, head.span, "the type of a camera must come before its other items");
    case KW_CYLINDER:
        parse_fail_not_yet(p, head.span, "cylinder cameras");
    case KW_SPHERICAL:
        parse_fail_not_yet(p, head.span, "spherical cameras");
    case KW_NORMAL:
        parse_fail_not_yet(p, head.span, "normals of cameras");
    default:
        parse_fail_here(p, "in a camera");
    }
}

static void read_camera_item(Parser *p, CameraDraft *d)
{
    if (parse_is_xform(p)) {
        Xform xform = parse_xform(p);
        d->xform = xform_then(&d->xform, &xform);
    } else if (!read_vector_item(p, d) && !read_blur_item(p, d)) {
        if (parse_peek(p)->kind == KW_ANGLE)
            read_angle(p, d);
        else
            fail_camera_item(p);
    }
}

/* --- from items to vectors ----------------------------------------------------------------- */

/* Turn the vectors so that direction points at look_at and right is level against sky; their
 * lengths and handedness stay. */
static void aim(Parser *p, CameraDraft *d)
{
    Camera *c = &d->camera;
    V3 direction = v3_unit(v3_sub(d->look_at, c->location));
    if (!(v3_len2(direction) > 0))
        parse_fail(p, d->look_at_span, "look_at is where the camera is: it has no direction");
    double handedness = v3_dot(v3_cross(c->up, c->direction), c->right);
    V3 right = v3_unit(v3_cross(d->sky, direction));
    if (v3_len2(right) > 0 && v3_len(v3_cross(v3_unit(d->sky), direction)) > EPS_LANGUAGE) {
        V3 up = v3_cross(direction, right);
        c->up = v3_scale(up, v3_len(c->up));
        c->right = v3_scale(right, v3_len(c->right) * (handedness > 0 ? 1 : -1));
    } else {
        parse_warn(p, WARN_VALUE, d->look_at_span,
                   "the camera looks along its sky vector: right stays as it is");
        right = v3_unit(c->right);
        c->up = v3_scale(v3_unit(v3_cross(direction, right)), v3_len(c->up));
    }
    c->direction = v3_scale(direction, v3_len(c->direction));
}

static void finish_camera(Parser *p, CameraDraft *d)
{
    Camera *c = &d->camera;
    if (d->angle > 0)
        c->direction = v3_scale(v3_unit(c->direction), 0.5 * v3_len(c->right) / tan(d->angle / 2));
    if (d->has_look_at)
        aim(p, d);
    double length = v3_len(c->direction);
    if (c->kind == CAMERA_ORTHOGRAPHIC && length > 0 && (!d->has_right_or_up || d->has_angle)) {
        double size = v3_dist(d->look_at, c->location) / length;
        c->right = v3_scale(c->right, size);
        c->up = v3_scale(c->up, size);
    }
    c->focal_distance = d->has_focal_point ? v3_dist(d->focal_point, c->location) : length;
    if (c->blur_samples == 0)
        c->aperture = 0;
}

static void move_camera(Camera *c, const Xform *xform)
{
    c->location = xform_point(xform, c->location);
    c->direction = xform_dir(xform, c->direction);
    c->right = xform_dir(xform, c->right);
    c->up = xform_dir(xform, c->up);
}

/* camera { NAME transforms }: the declared camera is finished; it can only be moved. */
static const Camera *read_named_camera(Parser *p, Camera camera)
{
    while (!read_close(p)) {
        if (!parse_is_xform(p))
            parse_fail_here(p, "after the name of a camera, where only transforms may stand");
        Xform xform = parse_xform(p);
        move_camera(&camera, &xform);
    }
    return parse_copy(p, &camera, sizeof camera);
}

const Camera *read_camera(Parser *p)
{
    Token word = read_open(p);
    const Value *value = parse_accept_value(p, VALUE_CAMERA);
    if (value) {
        Camera camera = *(const Camera *)value->node;
        camera.span = word.span;
        return read_named_camera(p, camera);
    }
    CameraDraft d = {
        .camera = CAMERA_DEFAULT, .sky = {0, 1, 0}, .look_at = {0, 0, 1}, .xform = XFORM_IDENTITY};
    d.camera.span = word.span;
    if (parse_accept(p, KW_ORTHOGRAPHIC))
        d.camera.kind = CAMERA_ORTHOGRAPHIC;
    else
        parse_accept(p, KW_PERSPECTIVE);
    while (!read_close(p))
        read_camera_item(p, &d);
    finish_camera(p, &d);
    move_camera(&d.camera, &d.xform);
    return parse_copy(p, &d.camera, sizeof d.camera);
}
