/* The photon pass against raw Embree: how many photons it stores a second, next to how many of
 * the very same rays Embree answers a second on the same scene.
 *
 * The rays are recorded by standing in for trace_closest (the linker's --wrap).  Embree's scene
 * is made of its own triangles and spheres, its rays are asked one by one, as the pass asks
 * them; one thread each, least of several rounds that take turns.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "base/stats.h"
#include "photon/photon_pass.h"
#include "sdl/sdl.h"
#include "shape/mesh.h"

#include <embree3/rtcore.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 12 };

/* Endless planes are squares of this half side for Embree. */
#define PLANE_HALF 1000.0

/* --- recording -------------------------------------------------------------------------- */

typedef struct Recorder {
    struct RTCRayHit *rays;
    size_t count, capacity;
    bool is_on;
} Recorder;

static Recorder recorder;

bool __real_trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out);
bool __wrap_trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out);

bool __wrap_trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out)
{
    if (recorder.is_on) {
        void *rays = recorder.rays;
        if (mem_grow(&rays, recorder.count, &recorder.capacity, sizeof *recorder.rays) != 0)
            exit(3);
        recorder.rays = rays;
        struct RTCRayHit *r = &recorder.rays[recorder.count++];
        memset(r, 0, sizeof *r);
        r->ray.org_x = (float)ray->o.x;
        r->ray.org_y = (float)ray->o.y;
        r->ray.org_z = (float)ray->o.z;
        r->ray.dir_x = (float)ray->d.x;
        r->ray.dir_y = (float)ray->d.y;
        r->ray.dir_z = (float)ray->d.z;
    }
    return __real_trace_closest(thread, ray, kind, out);
}

/* --- the scene for Embree --------------------------------------------------------------- */

typedef struct Triangles {
    float (*at)[3];
    uint32_t (*corner)[3];
    uint32_t points, triangles;
} Triangles;

static Triangles triangles_new(RTCGeometry geometry, uint32_t points, uint32_t triangles)
{
    return (Triangles){rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float), points),
                       rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                               3 * sizeof(uint32_t), triangles),
                       0, 0};
}

static void add_point(Triangles *t, V3 p)
{
    float *at = t->at[t->points++];
    at[0] = (float)p.x;
    at[1] = (float)p.y;
    at[2] = (float)p.z;
}

static void add_square(Triangles *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const uint32_t corners[2][3] = {{a, b, c}, {a, c, d}};
    memcpy(t->corner[t->triangles], corners, sizeof corners);
    t->triangles += 2;
}

static void fill_plane(Triangles *t, const Xform *x)
{
    for (int i = 0; i < 4; i++)
        add_point(t, xform_point(x, v3(i == 1 || i == 2 ? PLANE_HALF : -PLANE_HALF,
                                       i >= 2 ? PLANE_HALF : -PLANE_HALF, 0)));
    add_square(t, 0, 1, 2, 3);
}

static void fill_box(Triangles *t, const Xform *x)
{
    static const uint32_t side[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (int i = 0; i < 8; i++)
        add_point(t, xform_point(x, v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    for (int i = 0; i < 6; i++)
        add_square(t, side[i][0], side[i][1], side[i][2], side[i][3]);
}

static void fill_mesh(Triangles *t, const Xform *x, const MeshData *mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        add_point(t, xform_point(x, mesh->vertices[i]));
    memcpy(t->corner, mesh->corners, (size_t)mesh->triangle_count * 3 * sizeof(uint32_t));
}

static RTCGeometry sphere_geometry(RTCDevice device, const Xform *x)
{
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float *at = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                        4 * sizeof(float), 1);
    V3 center = xform_point(x, v3(0, 0, 0));
    at[0] = (float)center.x;
    at[1] = (float)center.y;
    at[2] = (float)center.z;
    at[3] = (float)v3_len(xform_dir(x, v3(1, 0, 0)));
    return geometry;
}

static RTCGeometry geometry_of(RTCDevice device, const Shape *shape)
{
    if (shape->kind == SHAPE_SPHERE)
        return sphere_geometry(device, &shape->xform);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    Triangles t;
    if (shape->kind == SHAPE_PLANE) {
        t = triangles_new(geometry, 4, 2);
        fill_plane(&t, &shape->xform);
    } else if (shape->kind == SHAPE_BOX) {
        t = triangles_new(geometry, 8, 12);
        fill_box(&t, &shape->xform);
    } else if (shape->kind == SHAPE_MESH) {
        t = triangles_new(geometry, shape->u.mesh->vertex_count, shape->u.mesh->triangle_count);
        fill_mesh(&t, &shape->xform, shape->u.mesh);
    } else {
        fprintf(stderr, "the bench scenes may not have this shape\n");
        exit(4);
    }
    return geometry;
}

static RTCScene embree_scene(RTCDevice device, const Scene *scene)
{
    RTCScene out = rtcNewScene(device);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        RTCGeometry geometry = geometry_of(device, scene->objects[i].shape);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(out, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(out);
    return out;
}

static double time_embree(RTCScene scene, size_t *hits)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    *hits = 0;
    double started = clock_cpu();
    for (size_t i = 0; i < recorder.count; i++) {
        struct RTCRayHit ray = recorder.rays[i];
        ray.ray.tnear = 1e-5f;
        ray.ray.tfar = INFINITY;
        ray.ray.mask = UINT32_MAX;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &ray);
        *hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return clock_cpu() - started;
}

/* --- the pass --------------------------------------------------------------------------- */

/* Processor seconds to build a map of these photons once more. */
static double time_build(const PhotonMap *map, Diag *diag)
{
    if (!map)
        return 0;
    size_t count = photon_map_count(map);
    Photon *photons = mem_array(count, sizeof *photons);
    if (!photons)
        exit(3);
    for (size_t i = 0; i < count; i++)
        photons[i] = photon_map_at(map, i);
    double started = clock_cpu();
    PhotonMap *again;
    if (photon_map_new(diag, photons, count, photon_map_center(map), 1, &again) != OK)
        exit(3);
    double seconds = clock_cpu() - started;
    photon_map_free(again);
    return seconds;
}

/* Processor seconds of the pass without the building of its trees. */
static double time_pass(const Tracer *tracer, Diag *diag, uint64_t *stored, uint64_t *rays)
{
    PhotonOptions options = {.seed = 1, .threads = 1};
    Stats stats = {0};
    PhotonMaps maps;
    double started = clock_cpu();
    if (photon_pass(tracer, &options, diag, &stats, &maps) != OK)
        exit(3);
    double seconds = clock_cpu() - started;
    seconds -= time_build(maps.caustic, diag) + time_build(maps.global, diag);
    *stored = stats.count[STAT_PHOTONS_CAUSTIC] + stats.count[STAT_PHOTONS_GLOBAL];
    *rays = stats.count[STAT_PHOTON_RAYS];
    photon_maps_done(&maps);
    return seconds;
}

static void bench_scene(RTCDevice device, const char *name, const char *text)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    SdlOptions options = {.width = 320, .height = 240, .threads = 1};
    PlanOptions plan_options = PLAN_OPTIONS_DEFAULT;
    Scene *scene;
    Plan plan;
    Tracer *tracer;
    if (sdl_load_text(&diag, name, text, strlen(text), &options, &scene) != OK ||
        plan_make(scene, &plan_options, scene->arena, &plan) != OK ||
        tracer_new(scene, &plan, 1, &diag, &tracer) != OK)
        exit(2);
    uint64_t stored, rays;
    size_t hits;
    recorder.count = 0;
    recorder.is_on = true;
    time_pass(tracer, &diag, &stored, &rays);
    recorder.is_on = false;
    RTCScene raw = embree_scene(device, scene);
    double ours = 1e9, theirs = 1e9;
    for (int i = 0; i < ROUNDS; i++) {
        ours = fmin(ours, time_pass(tracer, &diag, &stored, &rays));
        theirs = fmin(theirs, time_embree(raw, &hits));
    }
    double stored_rate = (double)stored / ours, ray_rate = (double)rays / ours;
    double raw_rate = (double)recorder.count / theirs;
    printf("  %-28s %8.2f %9.2f %9.2f %9.2f %9.2f %9.2f\n", name, (double)rays / (double)stored,
           stored_rate * 1e-6, ray_rate * 1e-6, raw_rate * 1e-6, stored_rate / raw_rate,
           ray_rate / raw_rate);
    rtcReleaseScene(raw);
    tracer_free(tracer);
    scene_free(scene);
    diag_done(&diag);
}

/* --- the scenes ------------------------------------------------------------------------- */

#define FLOOR "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 0.8 } }\n"
#define GLASS                                                                                      \
    "pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.5 }\n"                     \
    "photons { target refraction on reflection off collect off }\n"

static const char glass_sphere[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 photons { count 200000 } }\n"
    "light_source { <0,6,0> rgb 1 }\n" FLOOR "sphere { <0,1.5,0>, 1 " GLASS "}\n";

static const char mirror_box[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 photons { count 200000 } }\n"
    "light_source { <3,6,0> rgb 1 }\n" FLOOR
    "box { <-1,0,-1>, <-0.9,2,1> pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection 1 }\n"
    "  photons { target reflection on } }\n";

/* A bumpy mesh of 2 n^2 triangles over a floor. */
static const char glass_mesh[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 photons { count 200000 } }\n"
    "light_source { <0,6,0> rgb 1 }\n" FLOOR "#declare N = 120;\n"
    "#macro P(I, J, S) <3*I/N-1.5, 1.5 + S*(0.3*cos(pi*(I/N-0.5))*cos(pi*(J/N-0.5))\n"
    "  + 0.03*S*sin(9*I/N)*sin(7*J/N)), 3*J/N-1.5> #end\n"
    "mesh {\n"
    "#declare I = 0; #while (I < N) #declare J = 0; #while (J < N)\n"
    "#declare S = -1; #while (S < 2)\n"
    "  triangle { P(I,J,S), P(I+1,J,S), P(I+1,J+1,S) }\n"
    "  triangle { P(I,J,S), P(I+1,J+1,S), P(I,J+1,S) }\n"
    "#declare S = S + 2; #end\n"
    "#declare J = J + 1; #end #declare I = I + 1; #end\n"
    "  inside_vector y " GLASS "}\n";

static const char diffuse_box[] = "#version 3.7;\n"
                                  "global_settings { assumed_gamma 1 max_trace_level 20 pms { gi "
                                  "on gi_method map global_photons 200000 } }\n"
                                  "light_source { <0,1.8,0> rgb 1 }\n"
                                  "#default { finish { ambient 0 diffuse 0.8 } }\n"
                                  "box { <-2,-2,-2>, <2,2,2> hollow pigment { rgb <1,0.9,0.8> } }\n"
                                  "box { <-1,-2,-1>, <0,0,0.5> rotate 20*y pigment { rgb 1 } }\n"
                                  "sphere { <0.8,-1.3,0.5>, 0.7 pigment { rgb <0.5,0.7,1> } }\n";

int main(void)
{
    RTCDevice device = rtcNewDevice("threads=1");
    printf("photon pass, millions a second, 1 thread (reach: stored / raw 0.4)\n");
    printf("  %-28s %8s %9s %9s %9s %9s %9s\n", "", "rays per", "stored", "rays", "raw rays",
           "stored/", "rays/");
    printf("  %-28s %8s %9s %9s %9s %9s %9s\n", "scene", "stored", "(pms)", "(pms)", "(Embree)",
           "raw", "raw");
    bench_scene(device, "glass sphere", glass_sphere);
    bench_scene(device, "mirror", mirror_box);
    bench_scene(device, "glass mesh, 58k triangles", glass_mesh);
    bench_scene(device, "diffuse box, indirect light", diffuse_box);
    rtcReleaseDevice(device);
    mem_free(recorder.rays);
    return 0;
}
