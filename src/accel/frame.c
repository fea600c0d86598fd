/* The float frame of an index, and Embree's set-up.  SPDX-License-Identifier: Apache-2.0 */
#include "accel/frame_int.h"

#include <stdio.h>

/* With so many items a quick build is worth more than the best tree: half the time and memory, for
 * rays that take as long on meshes. */
enum { QUICK_BUILD_MIN = 1 << 18 };

IndexFrame frame_of(Bound bound)
{
    IndexFrame frame = {bound, bound_center(bound), 1};
    V3 half = v3_max(v3_sub(bound.hi, frame.center), v3_sub(frame.center, bound.lo));
    int exponent = 0;
    frexp(v3_max_abs(half), &exponent);
    if (v3_max_abs(half) > 0)
        frame.scale = ldexp(1, exponent < -1000 ? 1000 : -exponent);
    return frame;
}

/* Return x rounded to float, down or up. */
static float round_down(double x)
{
    float f = (float)x;
    return f > x ? nextafterf(f, -INFINITY) : f;
}

static float round_up(double x)
{
    return -round_down(-x);
}

void frame_box(const IndexFrame *frame, Bound box, struct RTCBounds *out)
{
    V3 lo = v3_scale(v3_sub(box.lo, frame->center), frame->scale);
    V3 hi = v3_scale(v3_sub(box.hi, frame->center), frame->scale);
    *out = (struct RTCBounds){.lower_x = round_down(lo.x - FRAME_PAD),
                              .upper_x = round_up(hi.x + FRAME_PAD),
                              .lower_y = round_down(lo.y - FRAME_PAD),
                              .upper_y = round_up(hi.y + FRAME_PAD),
                              .lower_z = round_down(lo.z - FRAME_PAD),
                              .upper_z = round_up(hi.z + FRAME_PAD)};
}

/* Narrow [near, far] to where o + t d lies between lo and hi; slack: rounding of the t. */
static bool narrow(double o, double d, double lo, double hi, double *near, double *far)
{
    if (d == 0)
        return o >= lo && o <= hi;
    double t0 = (lo - o) / d, t1 = (hi - o) / d;
    double first = num_min(t0, t1), last = num_max(t0, t1);
    *near = num_max(*near, first - 4 * EPS_DOUBLE * fabs(first));
    *far = num_min(*far, last + 4 * EPS_DOUBLE * fabs(last));
    return *near <= *far;
}

bool frame_enter(const IndexFrame *frame, const Ray *ray, FrameRay *out)
{
    double near = -INFINITY, far = INFINITY;
    const Bound *b = &frame->bound;
    if (!narrow(ray->o.x, ray->d.x, b->lo.x, b->hi.x, &near, &far) ||
        !narrow(ray->o.y, ray->d.y, b->lo.y, b->hi.y, &near, &far) ||
        !narrow(ray->o.z, ray->d.z, b->lo.z, b->hi.z, &near, &far))
        return false;
    double length = v3_len(ray->d);
    out->per_t = length * frame->scale;
    out->line_start = near * out->per_t > FRAME_FAR ? near : 0;
    near = num_max(near, ray->tmin);
    if (!(near <= num_min(far, ray->tmax)))
        return false;
    if (!(out->per_t > 0) || !isfinite(near) || !isfinite(out->per_t))
        return false;
    out->start = near - FRAME_PAD / out->per_t;
    V3 o = v3_scale(v3_sub(ray_at(ray, out->start), frame->center), frame->scale);
    V3 d = v3_scale(ray->d, 1 / length);
    struct RTCRay *r = &out->hit.ray;
    r->org_x = (float)o.x, r->org_y = (float)o.y, r->org_z = (float)o.z;
    r->dir_x = (float)d.x, r->dir_y = (float)d.y, r->dir_z = (float)d.z;
    r->tnear = 0, r->time = 0;
    r->tfar = frame_end(out, ray->tmax);
    r->mask = ~0u, r->id = 0, r->flags = 0;
    out->hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    out->hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return true;
}

static Status library_failure(Diag *diag, RTCDevice device)
{
    enum RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        return diag_no_memory(diag, "the ray index");
    return diag_fail(diag, ERR_LIBRARY, "Embree cannot build the ray index (error %d)", (int)error);
}

Status frame_scene_new(Diag *diag, uint32_t count, int threads, const FrameCallbacks *calls,
                       void *data, FrameScene *out)
{
    /* More threads pay only for big indices. */
    char config[64];
    snprintf(config, sizeof config, "threads=%d,set_affinity=0",
             count < 100000 || threads < 1 ? 1 : threads);
    out->scene = NULL;
    out->device = rtcNewDevice(config);
    if (!out->device)
        return library_failure(diag, NULL);
    out->scene = rtcNewScene(out->device);
    RTCGeometry geometry = rtcNewGeometry(out->device, RTC_GEOMETRY_TYPE_USER);
    if (!out->scene || !geometry) {
        Status status = library_failure(diag, out->device);
        frame_scene_done(out);
        return status;
    }
    rtcSetGeometryUserPrimitiveCount(geometry, count);
    rtcSetGeometryUserData(geometry, data);
    rtcSetGeometryBoundsFunction(geometry, calls->bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, calls->intersect);
    rtcSetGeometryOccludedFunction(geometry, calls->occluded);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(out->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(out->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(out->scene, count < QUICK_BUILD_MIN ? RTC_BUILD_QUALITY_HIGH
                                                                : RTC_BUILD_QUALITY_LOW);
    rtcCommitScene(out->scene);
    if (rtcGetDeviceError(out->device) == RTC_ERROR_NONE)
        return OK;
    frame_scene_done(out);
    return diag_fail(diag, ERR_LIBRARY, "Embree cannot build the ray index");
}

void frame_scene_done(FrameScene *scene)
{
    if (scene->scene)
        rtcReleaseScene(scene->scene);
    if (scene->device)
        rtcReleaseDevice(scene->device);
    *scene = (FrameScene){0};
}
