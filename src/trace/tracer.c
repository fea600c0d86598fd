/* The tracer: the ray index over the objects of a scene, and what queries need of each.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "base/mem.h"
#include "base/work.h"
#include "math/eps.h"
#include "trace/shadow_view.h"

#include <string.h>

/* With more objects the ray index is as good, with more lights views cost too much memory. */
enum { VIEW_OBJECTS_MAX = 1024, VIEW_LIGHTS_MAX = 32 };

/* Looks at parts of objects that prove shadows: for all lights together, and for one face of one.
 */
enum { SHADOW_LOOKS = 400000, SHADOW_FACE_LOOKS = 100000 };

/* Which surfaces the leaves of a shape have. */
typedef struct LeafSummary {
    bool may_transmit, has_filter, has_filter_besides_targets, is_closed, has_media, no_radiosity;
    bool is_hollow;
} LeafSummary;

static bool is_refracting_target(const Surface *surface)
{
    return surface->is_target && surface->photons.refraction == TRI_ON;
}

static void summarize(const Tracer *tracer, const Shape *shape, LeafSummary *sum)
{
    if (shape->clip_count > 0)
        sum->is_closed = false;
    for (int i = 0; i < shape->child_count; i++)
        summarize(tracer, shape->children[i], sum);
    if (shape->kind >= SHAPE_UNION)
        return;
    const Surface *surface = &tracer->scene->surfaces[shape->surface];
    sum->is_closed &= shape_is_closed(shape);
    bool is_filter = plan_filters_shadow(tracer->plan, surface);
    sum->has_filter |= is_filter;
    sum->has_filter_besides_targets |= is_filter && !is_refracting_target(surface);
    sum->may_transmit |= surface->may_transmit;
    sum->has_media |= surface->interior->is_hollow && surface->interior->media_count > 0;
    sum->no_radiosity &= surface->no_radiosity;
    sum->is_hollow &= surface->interior->is_hollow;
}

/* Return the largest factor by which the transform stretches: exact when its columns are at
 * right angles (scaled, then turned), else somewhat more.  It is the root of a bound on the
 * eigenvalues of the columns' products (Gershgorin's circles). */
static double largest_stretch(const Xform *x)
{
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int j = 0; j < 3; j++)
            sum += fabs(x->to[0][i] * x->to[0][j] + x->to[1][i] * x->to[1][j] +
                        x->to[2][i] * x->to[2][j]);
        most = fmax(most, sum);
    }
    return sqrt(most);
}

/* A little larger than it need be, for the rounding of tests against it. */
static void set_ball(const Object *object, TracedObject *out)
{
    const Shape *shape = object->shape;
    if (!bound_is_finite(object->bound) || bound_is_empty(object->bound))
        return;
    out->center = bound_center(object->bound);
    out->radius = bound_radius(object->bound) * (1 + 1e-9);
    out->has_ball = true;
    if (shape->kind == SHAPE_SPHERE) {
        /* The box around it is that much larger. */
        double stretch = shape->is_transformed ? largest_stretch(&shape->xform) : 1;
        double rounding = 32 * EPS_DOUBLE * v3_max_abs(out->center);
        double own = shape->u.sphere.radius * stretch * (1 + 1e-9) + rounding;
        out->radius = fmin(out->radius, own);
    }
    out->radius2 = out->radius * out->radius;
}

static bool is_within(const Object *object, V3 p)
{
    const Bound *b = &object->bound;
    return p.x >= b->lo.x && p.x <= b->hi.x && p.y >= b->lo.y && p.y <= b->hi.y && p.z >= b->lo.z &&
           p.z <= b->hi.z && shape_is_inside(object->shape, p);
}

/* May a shadow ray that arrives have been inside a solid?  Of an opaque one it does not pass the
 * surface: the light is in it, or all of space may be. */
static bool may_hold_shadow_ray(const Tracer *tracer, uint32_t i)
{
    const Object *object = &tracer->scene->objects[i];
    const TracedObject *traced = &tracer->objects[i];
    bool may =
        traced->shadow != SHADOW_NONE && (traced->may_transmit || !bound_is_finite(object->bound));
    for (int k = 0; k < tracer->scene->light_count && !may; k++)
        may = traced->shadow != SHADOW_NONE && is_within(object, tracer->scene->lights[k].location);
    return may;
}

static void describe_object(Tracer *tracer, uint32_t i)
{
    const Object *object = &tracer->scene->objects[i];
    TracedObject *out = &tracer->objects[i];
    LeafSummary sum = {.is_closed = true, .no_radiosity = true, .is_hollow = true};
    summarize(tracer, object->shape, &sum);
    out->shape = object->shape;
    out->is_closed = sum.is_closed;
    out->may_transmit = sum.may_transmit;
    set_ball(object, out);
    out->is_hidden[RAY_CAMERA] = object->no_image;
    out->is_hidden[RAY_REFRACTED] = object->no_image;
    out->is_hidden[RAY_PHOTON] = object->no_image || object->no_shadow;
    out->is_hidden[RAY_REFLECTED] = object->no_reflection;
    out->is_hidden[RAY_DIFFUSE] = object->no_shadow || sum.no_radiosity;
    out->is_hidden[RAY_LIGHT] = out->is_hidden[RAY_DIFFUSE];
    if (object->no_shadow)
        out->shadow = SHADOW_NONE;
    else if (!sum.has_filter || !plan_has(tracer->plan, FEATURE_TRANSPARENT_SHADOWS))
        out->shadow = SHADOW_BLOCK;
    else
        out->shadow = sum.has_filter_besides_targets ? SHADOW_FILTER : SHADOW_TARGET;
    if (!shape_is_solid(object->shape))
        return;
    bool has_media = sum.has_media && plan_has(tracer->plan, FEATURE_MEDIA);
    /* What is not hollow has no fog inside, opaque or not. */
    if (sum.may_transmit || plan_has_air(tracer->plan))
        tracer->clear[tracer->clear_count++] = i;
    if (has_media)
        tracer->media[tracer->media_count++] = i;
    out->keeps_air_out =
        !sum.is_hollow && plan_has_air(tracer->plan) && may_hold_shadow_ray(tracer, i);
    tracer->solid_count += out->keeps_air_out;
}

/* Rays to this light all end in one point. */
static bool has_view(const Tracer *tracer, const Light *light)
{
    return light->kind != LIGHT_CYLINDER && !light->is_parallel && !light->is_shadowless &&
           !plan_light_has_area(tracer->plan, light);
}

/* What may be seen from the eye and from the lights that are points. */
static Status make_views(Tracer *tracer, const Bound *boxes, uint32_t count, Diag *diag)
{
    const Scene *scene = tracer->scene;
    const uint32_t *objects = tracer->index_objects;
    int lights = scene->light_count < VIEW_LIGHTS_MAX ? scene->light_count : VIEW_LIGHTS_MAX;
    bool is_complete = true;
    for (int i = 0; i < lights; i++) {
        const Light *light = &scene->lights[i];
        if (!has_view(tracer, light))
            continue;
        tracer->light_views[i] =
            view_index_new(light->location, boxes, objects, count, scene->object_count);
        is_complete &= tracer->light_views[i] != NULL;
    }
    if (scene->camera.kind == CAMERA_PERSPECTIVE && scene->camera.aperture == 0) {
        tracer->camera_view =
            view_index_new(scene->camera.location, boxes, objects, count, scene->object_count);
        is_complete &= tracer->camera_view != NULL;
    }
    return is_complete ? OK : diag_no_memory(diag, "the views of eye and lights");
}

static bool has_scattering(const Interior *interior)
{
    for (int i = 0; i < interior->media_count; i++)
        if (!rgb_is_black(interior->media[i]->scattering))
            return true;
    return false;
}

/* Do media scatter the light of lamps anywhere? */
static bool media_scatter_light(const Tracer *tracer)
{
    const Scene *scene = tracer->scene;
    if (!plan_has(tracer->plan, FEATURE_MEDIA) || !plan_has(tracer->plan, FEATURE_LIGHTS))
        return false;
    for (int i = 0; i < scene->atmosphere.media_count; i++)
        if (!rgb_is_black(scene->atmosphere.media[i]->scattering))
            return true;
    for (uint32_t i = 0; i < scene->surface_count; i++)
        if (has_scattering(scene->surfaces[i].interior))
            return true;
    return false;
}

/* The faces of the views of lights, to be proved in any order. */
typedef struct ShadowWork {
    const Tracer *tracer;
    size_t count;
    ShadowView *views[VIEW_LIGHTS_MAX * SHADOW_FACES_MAX];
    int faces[VIEW_LIGHTS_MAX * SHADOW_FACES_MAX];
    bool is_short[VIEW_LIGHTS_MAX * SHADOW_FACES_MAX]; /* memory ran out */
} ShadowWork;

static void prove_face(void *ctx, size_t index, int thread)
{
    (void)thread;
    ShadowWork *work = ctx;
    long looks = SHADOW_LOOKS / (long)work->count;
    looks = looks < SHADOW_FACE_LOOKS ? looks : SHADOW_FACE_LOOKS;
    work->is_short[index] =
        !shadow_view_prove(work->views[index], work->faces[index], work->tracer, looks);
}

/* What is known of the shadows of lights without size that media scatter. */
static Status make_shadow_views(Tracer *tracer, int threads, Diag *diag)
{
    const Scene *scene = tracer->scene;
    ShadowWork work = {.tracer = tracer};
    if (!media_scatter_light(tracer) || scene->object_count > VIEW_OBJECTS_MAX)
        return OK;
    for (int i = 0; i < scene->light_count && i < VIEW_LIGHTS_MAX; i++) {
        const Light *light = &scene->lights[i];
        if (!light->lights_media || tracer->light_interiors[i] ||
            !shadow_view_is_of_use(tracer, light))
            continue;
        ShadowView *view = tracer->shadow_views[i] = shadow_view_new(tracer, light);
        if (!view)
            return diag_no_memory(diag, "the shadows of lights");
        for (int face = 0; face < view->face_count; face++, work.count++) {
            work.views[work.count] = view;
            work.faces[work.count] = face;
        }
    }
    TRY(work_for(threads, work.count, prove_face, &work));
    for (size_t i = 0; i < work.count; i++)
        if (work.is_short[i])
            return diag_no_memory(diag, "the shadows of lights");
    return OK;
}

bool trace_lit_stretches(const Tracer *tracer, int light, const Ray *ray, double begin, double end,
                         LitStretches *out)
{
    if (!tracer->shadow_views[light])
        return false;
    shadow_view_cut(tracer->shadow_views[light], ray, begin, end, out);
    return true;
}

/* Sort the objects into those with a box and those without; an empty box is never met. */
static Status index_objects(Tracer *tracer, int threads, Diag *diag)
{
    const Scene *scene = tracer->scene;
    uint32_t count = scene->object_count, bounded = 0;
    Bound *boxes = mem_array(count + 1, sizeof *boxes);
    tracer->index_objects = mem_array(count + 1, sizeof *tracer->index_objects);
    tracer->unbounded = mem_array(count + 1, sizeof *tracer->unbounded);
    Status status = OK;
    if (!boxes || !tracer->index_objects || !tracer->unbounded) {
        status = diag_no_memory(diag, "the ray index");
        goto done;
    }
    for (uint32_t i = 0; i < count; i++) {
        Bound bound = scene->objects[i].bound;
        if (bound_is_empty(bound))
            continue;
        if (!bound_is_finite(bound)) {
            tracer->unbounded[tracer->unbounded_count++] = i;
            continue;
        }
        tracer->bound = bound_union(tracer->bound, bound);
        tracer->index_objects[bounded] = i;
        boxes[bounded++] = bound;
    }
    if (bounded > 0)
        status = box_index_new(diag, boxes, bounded, threads, &tracer->index);
    if (status == OK && bounded > 0 && bounded <= VIEW_OBJECTS_MAX)
        status = make_views(tracer, boxes, bounded, diag);
done:
    mem_free(boxes);
    return status;
}

static bool has_area_light(const Tracer *tracer)
{
    for (int i = 0; i < tracer->scene->light_count; i++)
        if (plan_light_has_area(tracer->plan, &tracer->scene->lights[i]))
            return true;
    return false;
}

/* Find what absorbs the light of lamps right where they stand. */
static void find_light_interiors(Tracer *tracer)
{
    if (!plan_has(tracer->plan, FEATURE_ABSORPTION))
        return;
    for (int i = 0; i < tracer->scene->light_count; i++) {
        const Light *light = &tracer->scene->lights[i];
        Interiors inside;
        interiors_at(tracer, light->location, &inside);
        if (inside.count > 0 && !light->is_parallel && light->kind != LIGHT_CYLINDER)
            tracer->light_interiors[i] = inside.in[inside.count - 1];
    }
}

Status tracer_new(const Scene *scene, const Plan *plan, int threads, Diag *diag, Tracer **out)
{
    *out = NULL;
    Tracer *tracer = mem_alloc(sizeof *tracer);
    if (!tracer)
        return diag_no_memory(diag, "the tracer");
    tracer->scene = scene;
    tracer->plan = plan;
    tracer->has_dispersion = plan_has(plan, FEATURE_DISPERSION);
    tracer->bound = BOUND_EMPTY;
    tracer->objects = mem_array((size_t)scene->object_count + 1, sizeof *tracer->objects);
    tracer->clear = mem_array((size_t)scene->object_count + 1, sizeof *tracer->clear);
    tracer->light_views = mem_array((size_t)scene->light_count + 1, sizeof *tracer->light_views);
    tracer->shadow_views = mem_array((size_t)scene->light_count + 1, sizeof *tracer->shadow_views);
    tracer->media = mem_array((size_t)scene->object_count + 1, sizeof *tracer->media);
    tracer->light_interiors =
        mem_array((size_t)scene->light_count + 1, sizeof *tracer->light_interiors);
    if (!tracer->objects || !tracer->clear || !tracer->media || !tracer->light_views ||
        !tracer->light_interiors || !tracer->shadow_views) {
        tracer_free(tracer);
        return diag_no_memory(diag, "the tracer");
    }
    for (uint32_t i = 0; i < scene->object_count; i++)
        describe_object(tracer, i);
    find_light_interiors(tracer);
    for (int i = 0; i < scene->light_count; i++)
        tracer->bound = bound_add(tracer->bound, scene->lights[i].location);
    if (bound_is_empty(tracer->bound))
        tracer->bound = (Bound){{0, 0, 0}, {0, 0, 0}};
    Status status = index_objects(tracer, threads, diag);
    if (status == OK)
        status = make_shadow_views(tracer, threads, diag);
    if (status == OK && has_area_light(tracer)) {
        tracer->bundles = bundle_index_new(tracer->objects, scene->object_count);
        status = tracer->bundles ? OK : diag_no_memory(diag, "the tracer");
    }
    if (status != OK) {
        tracer_free(tracer);
        return status;
    }
    *out = tracer;
    return OK;
}

void tracer_free(Tracer *tracer)
{
    if (!tracer)
        return;
    box_index_free(tracer->index);
    bundle_index_free(tracer->bundles);
    view_index_free(tracer->camera_view);
    for (int i = 0; tracer->light_views && i < tracer->scene->light_count; i++)
        view_index_free(tracer->light_views[i]);
    mem_free(tracer->light_views);
    for (int i = 0; tracer->shadow_views && i < tracer->scene->light_count; i++)
        shadow_view_free(tracer->shadow_views[i]);
    mem_free(tracer->shadow_views);
    mem_free(tracer->light_interiors);
    mem_free(tracer->index_objects);
    mem_free(tracer->unbounded);
    mem_free(tracer->clear);
    mem_free(tracer->media);
    mem_free(tracer->objects);
    mem_free(tracer);
}

const Scene *tracer_scene(const Tracer *tracer)
{
    return tracer->scene;
}

const Plan *tracer_plan(const Tracer *tracer)
{
    return tracer->plan;
}

Bound tracer_bound(const Tracer *tracer)
{
    return tracer->bound;
}

Status trace_thread_init(TraceThread *thread, const Tracer *tracer, Diag *diag)
{
    memset(thread, 0, sizeof *thread);
    size_t lights = (size_t)tracer->scene->light_count;
    thread->tracer = tracer;
    thread->shapes = shape_scratch_new();
    thread->scratch = arena_new();
    thread->blockers = mem_array(lights + 1, sizeof *thread->blockers);
    if (!thread->shapes || !thread->scratch || !thread->blockers) {
        trace_thread_done(thread);
        return diag_no_memory(diag, "a tracing thread");
    }
    for (size_t i = 0; i < lights; i++)
        thread->blockers[i] = NO_OBJECT;
    return OK;
}

void trace_thread_done(TraceThread *thread)
{
    shape_scratch_free(thread->shapes);
    arena_free(thread->scratch);
    mem_free(thread->blockers);
    mem_free(thread->crossed);
    thread->crossed = NULL;
    thread->crossed_capacity = 0;
    thread->shapes = NULL;
    thread->scratch = NULL;
    thread->blockers = NULL;
}
