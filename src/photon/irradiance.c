/* Irradiance computed ahead.
 *
 * Near edges and corners the disk around a place is not all surface, and behind a thin wall it is
 * the next room.  Rays along the surface tell: where the disk is not clear, or the photons in it
 * lie to one side, its area is measured by trial, and photons that cannot be seen from the place
 * are left out.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/irradiance.h"

#include "base/mem.h"
#include "base/work.h"
#include "math/sample.h"
#include "photon/gather.h"
#include "photon/photon_map_int.h"

enum {
    PLACE_PHOTONS = 50, /* of an estimate */
    CLEAR_RAYS = 8,     /* along the surface, to see whether something stands on it */
    AREA_RAYS = 48,     /* to measure the disk */
    LOOKUP_PLACES = 6,  /* nearest places that are tried, of each way they face */
    LOOKUP_MORE = 32,   /* and if none of those is near for its radius */
    PLACES_MOST = 3 * LOOKUP_MORE,
    CHUNK_PLACES = 256,
    IRRADIANCE_RNG = 0x697272,
    FLAG_CLUTTERED = 1 /* of a place, beside PHOTON_INSIDE: not all of the disk is seen from it */
};

/* Heights of the rays along a surface, in radii: above roughness, below what stands there. */
#define CLEAR_HEIGHT 0.05

/* Photons whose mean place is further off, in radii, lie to one side: on a whole disk it is within
 * this with near certainty. */
#define ASIDE_MOST 0.2

/* Bound on how far a place is off its surface, relative to its distance from the map's centre: it
 * is rounded to floats. */
#define PLACE_ROUNDING 0x1p-22

/* Surfaces turned further away than this are others: of photons and of places. */
#define PHOTON_COSINE 0.5
#define PLACE_COSINE 0.7

/* It vanishes at the rim, so that the sum is right for photons spread at random and for photons
 * spread evenly: those of a light that come directly are in between. */
#define PLACE_KERNEL KERNEL_EPANECHNIKOV

/* How far a place speaks for its surroundings, in radii of its disk. */
#define PLACE_REACH 1.5

/* Places are so dense that one nearer than this, in radii, is found almost always, except where
 * bright light ends: there places of small disks crowd on one side. */
#define PLACE_NEAR 0.5

/* Which way places face: along an axis, the lower way or the higher. */
enum { FACINGS = 6 };

/* A normal that is nearer to an axis than to another by less than this may face along both: it is
 * more than what its code loses. */
#define FACING_SLACK 0.1

/* Estimates reach this many times as far as the map's own search radius. */
#define PLACE_RADIUS_MOST 6

/* Places are found among those that face the same way: a search among all would go through
 * thousands of others before it finds a small surface that faces elsewhere, or that there is none.
 * Power: irradiance; direction: code of the radius; flags: see above. */
struct IrradianceMap {
    PhotonMap *places[FACINGS]; /* NULL: none */
    double reach;               /* how far the furthest reaching place speaks, scene units */
    const PhotonMap *photons;   /* that the estimates were made from; must outlive the map */
    double radius;              /* the most that an estimate reaches */
};

/* How much a normal faces one of the six ways. */
static double facing(V3 n, int way)
{
    double along = way / 2 == 0 ? n.x : way / 2 == 1 ? n.y : n.z;
    return way & 1 ? along : -along;
}

/* A radius in 16 bits: its logarithm. */
static uint16_t radius_encode(double radius)
{
    double code = log2(radius) * 256 + 0x8000;
    return (uint16_t)(code < 0 ? 0 : code > 0xffff ? 0xffff : code);
}

static double radius_decode(const Photon *place)
{
    return exp2(((double)(place->phi | place->theta << 8) - 0x8000) / 256);
}

typedef struct PlaceWork {
    const Tracer *tracer;
    const PhotonMap *photons;
    Photon *places;
    size_t count;
    uint64_t seed;
    double radius; /* the most an estimate reaches */
    TraceThread *threads;
    GatherScratch **scratches;
} PlaceWork;

/* A place and its disk. */
typedef struct Disk {
    V3 p, n, s, t;  /* s and t lie in the surface */
    bool is_inside; /* of a solid */
    double radius;
    double rounding; /* of p, scene units */
    double lift;     /* of what looks along the surface, scene units */
} Disk;

/* Does the way from a to b meet nothing? */
static bool is_clear(TraceThread *thread, V3 a, V3 b)
{
    Hit hit;
    double far = v3_dist(a, b);
    if (!(far > 0))
        return true;
    Ray ray = {a, v3_scale(v3_sub(b, a), 1 / far), 0, far};
    return !trace_closest(thread, &ray, RAY_LIGHT, &hit);
}

static V3 above(const Disk *disk, double x, double y)
{
    V3 p = v3_mad(disk->p, disk->lift, disk->n);
    return v3_mad(v3_mad(p, x * disk->radius, disk->s), y * disk->radius, disk->t);
}

/* Is nothing in the way as far as the place is used?  The rays are that much longer that a wall
 * between two of them is met as well. */
static bool disk_is_clear(TraceThread *thread, const Disk *disk)
{
    double far = PLACE_REACH / cos(PMS_PI / CLEAR_RAYS);
    for (int i = 0; i < CLEAR_RAYS; i++) {
        double angle = 2 * PMS_PI * i / CLEAR_RAYS;
        V3 end = above(disk, far * cos(angle), far * sin(angle));
        if (!is_clear(thread, above(disk, 0, 0), end))
            return false;
    }
    return true;
}

/* Set how high above the surface to look along it: inside a solid not through its other face. */
static void set_lift(TraceThread *thread, Disk *disk)
{
    Hit hit;
    disk->lift = CLEAR_HEIGHT * disk->radius;
    Ray ray = {disk->p, disk->n, disk->rounding, 2 * disk->lift};
    if (disk->is_inside && trace_closest(thread, &ray, RAY_LIGHT, &hit))
        disk->lift = hit.t / 2;
}

/* Is there surface of the disk within `down` below p? */
static bool is_surface_below(TraceThread *thread, const Disk *disk, V3 p, double down)
{
    Hit hit;
    Ray ray = {p, v3_neg(disk->n), 0, down};
    return trace_closest(thread, &ray, RAY_LIGHT, &hit) &&
           fabs(v3_dot(hit.point.ng, disk->n)) > PHOTON_COSINE &&
           shape_point_is_inside(&hit.point, disk->n) == disk->is_inside;
}

/* The part of the disk that is surface and seen from its middle, weighed as photons are. */
static double disk_part(TraceThread *thread, const Disk *disk, Rng *rng)
{
    double found = 0;
    double down = disk->lift + GATHER_SLAB * disk->radius;
    uint64_t key = rng_u64(rng);
    for (int i = 0; i < AREA_RAYS; i++) {
        V2 at = warp_disk(sample_2d((uint32_t)i, key));
        V3 p = above(disk, at.u, at.v);
        if (!is_clear(thread, above(disk, 0, 0), p))
            continue;
        if (is_surface_below(thread, disk, p, down))
            found += gather_kernel(PLACE_KERNEL, at.u * at.u + at.v * at.v);
    }
    return fmax(found, 1) / AREA_RAYS;
}

static V3 photon_place(const PhotonMap *map, const Photon *photon)
{
    V3 p = v3((double)photon->pos[0], (double)photon->pos[1], (double)photon->pos[2]);
    return v3_add(photon_map_center(map), p);
}

/* As GATHER_DISK measures it. */
static double photon_distance2(const PhotonMap *map, const Photon *photon, V3 p, V3 n)
{
    V3 to = v3_sub(photon_place(map, photon), p);
    double height = v3_dot(to, n) / GATHER_SLAB;
    return fmax(v3_len2(to), height * height);
}

/* How far the photons' mean place is off the middle, in radii. */
static double mean_aside(const PhotonMap *map, const Disk *disk, const uint32_t *index, int count)
{
    V3 sum = v3(0, 0, 0);
    for (int i = 0; i < count; i++) {
        Photon photon = photon_map_at(map, index[i]);
        sum = v3_add(sum, v3_sub(photon_place(map, &photon), disk->p));
    }
    sum = v3_mad(sum, -v3_dot(sum, disk->n), disk->n);
    return v3_len(sum) / (disk->radius * count);
}

/* Sum the photons; hidden ones are left out where the disk is not clear. */
static Rgb sum_photons(TraceThread *thread, const PhotonMap *map, const Disk *disk,
                       const uint32_t *index, int count, bool is_all_clear)
{
    double r = 0, g = 0, b = 0;
    for (int i = 0; i < count; i++) {
        Photon photon = photon_map_at(map, index[i]);
        V3 n = normal14_decode(photon.flags >> 2);
        V3 p = v3_mad(photon_place(map, &photon), disk->lift, n);
        double x = photon_distance2(map, &photon, disk->p, disk->n) / (disk->radius * disk->radius);
        if (!is_all_clear && !is_clear(thread, above(disk, 0, 0), p))
            continue;
        double weight = gather_kernel(PLACE_KERNEL, fmin(1, x));
        Rgb power = rgb_scale(photon_map_power(map, index[i]), (float)weight);
        r += (double)power.r;
        g += (double)power.g;
        b += (double)power.b;
    }
    return rgb((float)r, (float)g, (float)b);
}

/* Find the photons that speak at a place. */
static int find_photons(const PhotonMap *photons, const Photon *place, V3 p, double radius,
                        GatherScratch *scratch, const uint32_t **index, double *radius2)
{
    const GatherLimits limits = {.max_photons = PLACE_PHOTONS,
                                 .max_radius = radius,
                                 .shape = GATHER_DISK,
                                 .normal_cosine = PHOTON_COSINE,
                                 .side =
                                     place->flags & PHOTON_INSIDE ? GATHER_INSIDE : GATHER_OUTSIDE};
    return photon_nearest(photons, p, normal14_decode(place->flags >> 2), &limits, scratch, index,
                          radius2);
}

static void estimate(PlaceWork *work, TraceThread *thread, GatherScratch *scratch, size_t number)
{
    Photon *place = &work->places[number];
    Rng rng = rng_at(work->seed, IRRADIANCE_RNG, number);
    Disk disk = {.p = photon_place(work->photons, place),
                 .n = normal14_decode(place->flags >> 2),
                 .is_inside = (place->flags & PHOTON_INSIDE) != 0};
    V3 offset = v3_sub(disk.p, photon_map_center(work->photons));
    disk.rounding = PLACE_ROUNDING * v3_len(offset);
    const uint32_t *index;
    double radius2;
    v3_frame(disk.n, &disk.s, &disk.t);
    int count = find_photons(work->photons, place, disk.p, work->radius, scratch, &index, &radius2);
    disk.radius = sqrt(radius2);
    Rgb irradiance = RGB_BLACK;
    uint16_t flags = 0;
    if (count > 0 && radius2 > 0 && isfinite(radius2)) {
        set_lift(thread, &disk);
        bool is_all_clear = disk_is_clear(thread, &disk);
        double part = 1;
        if (!is_all_clear || mean_aside(work->photons, &disk, index, count) > ASIDE_MOST)
            part = disk_part(thread, &disk, &rng);
        flags = is_all_clear ? 0 : FLAG_CLUTTERED;
        irradiance = sum_photons(thread, work->photons, &disk, index, count, is_all_clear);
        irradiance = rgb_scale(irradiance, (float)(1 / (PMS_PI * radius2 * part)));
    }
    uint16_t code = radius_encode(disk.radius);
    rgbe_encode(irradiance, &rng, place->rgbe);
    place->phi = (uint8_t)code;
    place->theta = (uint8_t)(code >> 8);
    place->flags = (uint16_t)((place->flags & ~FLAG_CLUTTERED) | flags);
}

static void estimate_chunk(void *ctx, size_t index, int thread)
{
    PlaceWork *work = ctx;
    size_t first = index * CHUNK_PLACES, end = first + CHUNK_PLACES;
    for (size_t i = first; i < end && i < work->count; i++)
        estimate(work, &work->threads[thread], work->scratches[thread], i);
}

/* --- the map ------------------------------------------------------------------------------ */

static Status make_threads(PlaceWork *work, int threads, int *made, Diag *diag)
{
    work->threads = mem_array((size_t)threads, sizeof *work->threads);
    work->scratches = mem_array((size_t)threads, sizeof *work->scratches);
    if (!work->threads || !work->scratches)
        return diag_no_memory(diag, "irradiance");
    for (; *made < threads; ++*made) {
        TRY(trace_thread_init(&work->threads[*made], work->tracer, diag));
        work->scratches[*made] = gather_scratch_new();
        if (!work->scratches[*made]) {
            trace_thread_done(&work->threads[*made]);
            return diag_no_memory(diag, "irradiance");
        }
    }
    return OK;
}

static Status estimate_all(PlaceWork *work, const IrradianceOptions *options, Diag *diag)
{
    int threads = options->threads;
    int made = 0;
    Status status = make_threads(work, threads, &made, diag);
    if (status == OK)
        status = work_for(threads, (work->count + CHUNK_PLACES - 1) / CHUNK_PLACES, estimate_chunk,
                          work);
    for (int i = 0; i < made; i++) {
        stats_add(options->stats, &work->threads[i].stats);
        trace_thread_done(&work->threads[i]);
        gather_scratch_free(work->scratches[i]);
    }
    options->stats->count[STAT_PLACES] += work->count;
    mem_free(work->threads);
    mem_free(work->scratches);
    return status;
}

/* The way a normal faces most. */
static int facing_of(V3 n)
{
    int best = 0;
    for (int way = 1; way < FACINGS; way++)
        if (facing(n, way) > facing(n, best))
            best = way;
    return best;
}

/* Build the trees; `places` is freed. */
static Status build(const PlaceWork *work, const IrradianceOptions *options, Diag *diag,
                    IrradianceMap *map)
{
    Status status = OK;
    for (int way = 0; way < FACINGS && status == OK; way++) {
        size_t count = 0, used = 0;
        for (size_t i = 0; i < work->count; i++)
            count += facing_of(normal14_decode(work->places[i].flags >> 2)) == way;
        if (count == 0)
            continue;
        Photon *part = mem_array(count, sizeof *part);
        if (!part)
            status = diag_no_memory(diag, "irradiance");
        for (size_t i = 0; part && i < work->count; i++)
            if (facing_of(normal14_decode(work->places[i].flags >> 2)) == way)
                part[used++] = work->places[i];
        if (part)
            status = photon_map_new(diag, part, count, photon_map_center(work->photons),
                                    options->threads, &map->places[way]);
        if (status == OK && options->is_watched)
            status = photon_map_watch(diag, map->places[way]);
    }
    map->photons = work->photons;
    map->radius = work->radius;
    for (size_t i = 0; i < work->count; i++)
        map->reach = fmax(map->reach, PLACE_REACH * radius_decode(&work->places[i]));
    return status;
}

Status irradiance_map_new(const Tracer *tracer, const PhotonMap *photons, Photon *places,
                          size_t count, const IrradianceOptions *options, Diag *diag,
                          IrradianceMap **out)
{
    PlaceWork work = {.tracer = tracer,
                      .photons = photons,
                      .places = places,
                      .count = count,
                      .seed = options->seed,
                      .radius = PLACE_RADIUS_MOST * options->radius};
    if (!(work.radius > 0))
        work.radius = INFINITY;
    IrradianceMap *map = mem_alloc(sizeof *map);
    Status status = map ? estimate_all(&work, options, diag) : diag_no_memory(diag, "irradiance");
    if (status == OK)
        status = build(&work, options, diag, map);
    mem_free(places);
    if (status == OK)
        *out = map;
    else
        irradiance_map_free(map);
    return status;
}

void irradiance_map_free(IrradianceMap *map)
{
    for (int way = 0; map && way < FACINGS; way++)
        photon_map_free(map->places[way]);
    mem_free(map);
}

Status irradiance_map_see(const IrradianceMap *map, Diag *diag)
{
    GatherScratch *scratch = gather_scratch_new();
    if (!scratch)
        return diag_no_memory(diag, "photons seen");
    for (int way = 0; way < FACINGS; way++) {
        const PhotonMap *places = map->places[way];
        for (size_t i = 0; places && i < photon_map_count(places); i++) {
            if (!photon_map_is_seen(places, i))
                continue;
            const uint32_t *index;
            double radius2;
            Photon place = photon_map_at(places, i);
            int count = find_photons(map->photons, &place, photon_place(places, &place),
                                     map->radius, scratch, &index, &radius2);
            for (int k = 0; k < count; k++)
                photon_map_see(map->photons, index[k]);
        }
    }
    gather_scratch_free(scratch);
    return OK;
}

/* --- looking up --------------------------------------------------------------------------- */

typedef struct NearPlace {
    const PhotonMap *map;
    uint32_t index; /* in it */
    Photon place;
    V3 p;
    double radius;
    double distance2, off2; /* as GATHER_DISK measures it: in scene units and in radii, squared */
    bool is_near;           /* for its radius */
} NearPlace;

/* Of places near for their radii the nearest is the best: were it the one nearest in radii, those
 * that came out with large radii, and so with little light, would be chosen too often. */
static bool is_better(const NearPlace *a, const NearPlace *b)
{
    if (a->is_near != b->is_near)
        return a->is_near;
    return a->is_near ? a->distance2 < b->distance2 : a->off2 < b->off2;
}

/* Sort places found into those there are, the best first; returns how many there are then. */
static int sort_places(const PhotonMap *map, const uint32_t *index, int count, V3 p, V3 n,
                       NearPlace *out, int sorted)
{
    for (int i = 0; i < count; i++) {
        NearPlace near = {.map = map, .index = index[i], .place = photon_map_at(map, index[i])};
        near.p = photon_place(map, &near.place);
        near.radius = radius_decode(&near.place);
        near.distance2 = photon_distance2(map, &near.place, p, n);
        near.off2 = near.distance2 / (near.radius * near.radius);
        near.is_near = near.off2 < PLACE_NEAR * PLACE_NEAR;
        if (!(near.off2 <= PLACE_REACH * PLACE_REACH))
            continue;
        int at = sorted++;
        for (; at > 0 && is_better(&near, &out[at - 1]); at--)
            out[at] = out[at - 1];
        out[at] = near;
    }
    return sorted;
}

/* Find places that face as n does, of each way the `most` nearest; *is_all says whether there are
 * no more. */
static int find_places(const IrradianceMap *map, GatherScratch *scratch, const ShapePoint *at, V3 n,
                       int most, NearPlace *out, bool *is_all)
{
    const GatherLimits limits = {.max_photons = most + 1,
                                 .max_radius = map->reach,
                                 .shape = GATHER_DISK,
                                 .normal_cosine = PLACE_COSINE,
                                 .side = gather_side(at, n)};
    double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    int found = 0;
    *is_all = true;
    for (int way = 0; way < FACINGS; way++) {
        const uint32_t *index;
        double radius2;
        if (!map->places[way] || facing(n, way) < largest - FACING_SLACK)
            continue;
        int count = photon_nearest(map->places[way], at->p, n, &limits, scratch, &index, &radius2);
        *is_all = *is_all && count <= most;
        found =
            sort_places(map->places[way], index, count < most ? count : most, at->p, n, out, found);
    }
    return found;
}

/* Find the places that may speak for a point, best first.  The nearest is not the best: beside a
 * bright patch, where places crowd, it would be one of the patch, and the patch would grow. */
static int find_speakers(const IrradianceMap *map, GatherScratch *scratch, const ShapePoint *at,
                         V3 n, NearPlace *out)
{
    bool is_all;
    int found = find_places(map, scratch, at, n, LOOKUP_PLACES, out, &is_all);
    if (!is_all && !(found > 0 && out[0].is_near))
        found = find_places(map, scratch, at, n, LOOKUP_MORE, out, &is_all);
    return found;
}

Rgb irradiance_at(const IrradianceMap *map, TraceThread *thread, GatherScratch *scratch,
                  const ShapePoint *at, V3 n, double *radius)
{
    NearPlace near[PLACES_MOST];
    *radius = 0;
    int count = map ? find_speakers(map, scratch, at, n, near) : 0;
    for (int i = 0; i < count; i++) {
        const Photon *place = &near[i].place;
        double lift = CLEAR_HEIGHT * near[i].radius * sqrt(near[i].off2);
        V3 other = v3_mad(near[i].p, lift, normal14_decode(place->flags >> 2));
        V3 own = v3_mad(at->p, lift + 2 * at->p_error, n);
        if ((place->flags & FLAG_CLUTTERED) && !is_clear(thread, own, other))
            continue;
        *radius = near[i].radius;
        photon_map_see(near[i].map, near[i].index);
        return rgbe_decode(place->rgbe);
    }
    return RGB_BLACK;
}
