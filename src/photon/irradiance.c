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
    PLACE_PHOTONS = 50,   /* of an estimate; in one of many passes it is on a part of their disk */
    BESIDE_PHOTONS = 20,  /* fewer may lie to one side by chance */
    CLEAR_RAYS = 8,       /* along the surface, to see whether something stands on it */
    AREA_FOUND = 32,      /* of places that are tried to measure the disk */
    AREA_RAYS_MOST = 640, /* for that */
    LOOKUP_PLACES = 6,    /* nearest places that are tried, of each way they face */
    LOOKUP_MORE = 5,      /* times as many as before, if those lie to one side */
    LOOKUP_MOST = 150,
    PLACES_MOST = 3 * LOOKUP_MOST,
    SPACING_PLACES = 4, /* that tell how dense places are */
    CHUNK_PLACES = 256,
    IRRADIANCE_RNG = 0x697272,
    FLAG_CLUTTERED = 1 /* of a place, beside PHOTON_INSIDE: not all of the disk is seen from it */
};

/* Heights of the rays along a surface, in radii: above roughness, below what stands there. */
#define CLEAR_HEIGHT 0.05

/* PLACE_PHOTONS photons whose mean place is further off, in radii, lie to one side: on a whole disk
 * it is within this with near certainty. */
#define ASIDE_MOST 0.2

/* On half a disk it is at 4/(3 pi).  Further off still the place is beside a bright patch whose
 * photons are all that a disk reaches: half of it tells more of how dark it is here.  Else the
 * light around all patches together would be more than there is. */
#define BESIDE_MOST 0.5

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

/* Beyond the last places of light that ends in the dark, they speak for points nearer than so many
 * mean distances to the nearest place: at the border of half a plane of places the mean is
 * sqrt(2). */
#define PLACE_BESIDE 1.4

/* Which way places face: along an axis, the lower way or the higher. */
enum { FACINGS = 6 };

/* A normal that is nearer to an axis than to another by less than this may face along both: it is
 * more than what its code loses. */
#define FACING_SLACK 0.1

/* Estimates reach this many times as far as the map's own search radius. */
#define PLACE_RADIUS_MOST 6

/* Places are found among those that face the same way: a search among all would go through
 * thousands of others before it finds a small surface that faces elsewhere, or that there is none.
 * Power: irradiance; direction: codes of radius, edge and spacing; flags: see above. */
struct IrradianceMap {
    PhotonMap *places[FACINGS]; /* NULL: none */
    double reach;               /* how far the furthest reaching place speaks, scene units */
    const PhotonMap *photons;   /* that the estimates were made from; must outlive the map */
    GatherLimits search;        /* of an estimate, of either side */
};

/* How much a normal faces one of the six ways. */
static double facing(V3 n, int way)
{
    double along = way / 2 == 0 ? n.x : way / 2 == 1 ? n.y : n.z;
    return way & 1 ? along : -along;
}

/* The logarithm of a positive number, in eighths, as a code of so many bits. */
static unsigned log_encode(double x, int bits)
{
    double middle = ldexp(1, bits - 1), code = rint(log2(x) * 8) + middle;
    return (unsigned)fmin(fmax(code, 0), 2 * middle - 1);
}

static double log_decode(unsigned code, int bits)
{
    return exp2(((double)code - ldexp(1, bits - 1)) / 8);
}

/* A place has its radius in so many low bits of `from`, then whether its surface ends there, and in
 * the rest the spacing there over the radius. */
enum { RADIUS_BITS = 9, EDGE_BIT = 1 << RADIUS_BITS, SPACING_SHIFT = 10, SPACING_BITS = 6 };

/* A surface ends where less of the disk is of it. */
#define EDGE_PART 0.75

static double radius_decode(unsigned from)
{
    return log_decode(from & (EDGE_BIT - 1), RADIUS_BITS);
}

static double spacing_decode(unsigned from)
{
    return radius_decode(from) * log_decode(from >> SPACING_SHIFT, SPACING_BITS);
}

static unsigned place_from(const Photon *place)
{
    return place->phi | (unsigned)place->theta << 8;
}

typedef struct PlaceWork {
    const Tracer *tracer;
    const PhotonMap *photons;
    Photon *places;
    size_t count;
    uint64_t seed;
    GatherLimits search; /* of an estimate, of either side */
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

/* Set how high above the surface to look along it: not through another one that is nearer, as the
 * other face of a thin solid or what rests on this one. */
static void set_lift(TraceThread *thread, Disk *disk)
{
    Hit hit;
    disk->lift = CLEAR_HEIGHT * disk->radius;
    Ray ray = {disk->p, disk->n, disk->rounding, 2 * disk->lift};
    if (trace_closest(thread, &ray, RAY_LIGHT, &hit))
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

/* Return the part of the disk that is surface and seen from its middle, weighed as photons are, by
 * trials of places that are drawn as the kernel weighs them.  It is what the light is divided by.
 * The trials until so many are found are that number over the part in the mean, so that the mean of
 * the inverse is right; of a fixed number of trials it would be too large. */
static double disk_part(TraceThread *thread, const Disk *disk, Rng *rng)
{
    int found = 0, tried = 0;
    double down = disk->lift + GATHER_SLAB * disk->radius;
    uint64_t key = rng_u64(rng);
    for (; found < AREA_FOUND && tried < AREA_RAYS_MOST; tried++) {
        V2 at = warp_disk(sample_2d((uint32_t)tried, key));
        double even = at.u * at.u + at.v * at.v; /* in [0, 1] */
        double scale = even > 0 ? sqrt((1 - sqrt(1 - fmin(1, even))) / even) : 0;
        V3 p = above(disk, scale * at.u, scale * at.v);
        if (is_clear(thread, above(disk, 0, 0), p))
            found += is_surface_below(thread, disk, p, down);
    }
    return fmax(found, 1) / tried;
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
static int find_photons(const PhotonMap *photons, const Photon *place, V3 p,
                        const GatherLimits *search, GatherScratch *scratch, const uint32_t **index,
                        double *radius2)
{
    GatherLimits limits = *search;
    limits.side = place->flags & PHOTON_INSIDE ? GATHER_INSIDE : GATHER_OUTSIDE;
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
    int count =
        find_photons(work->photons, place, disk.p, &work->search, scratch, &index, &radius2);
    disk.radius = sqrt(radius2);
    Rgb irradiance = RGB_BLACK;
    uint16_t flags = 0;
    double part = 1;
    if (count > 0 && radius2 > 0 && isfinite(radius2)) {
        double aside = mean_aside(work->photons, &disk, index, count);
        set_lift(thread, &disk);
        bool is_all_clear = disk_is_clear(thread, &disk);
        flags = is_all_clear ? 0 : FLAG_CLUTTERED;
        if (aside > BESIDE_MOST && count >= BESIDE_PHOTONS)
            disk.radius /= 2;
        if (!is_all_clear || aside > ASIDE_MOST * sqrt((double)PLACE_PHOTONS / count))
            part = disk_part(thread, &disk, &rng);
        irradiance = sum_photons(thread, work->photons, &disk, index, count, is_all_clear);
        irradiance =
            rgb_scale(irradiance, (float)(1 / (PMS_PI * disk.radius * disk.radius * part)));
    }
    unsigned code = log_encode(sqrt(radius2), RADIUS_BITS) | (part < EDGE_PART ? EDGE_BIT : 0);
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
    map->search = work->search;
    for (size_t i = 0; i < work->count; i++)
        map->reach = fmax(map->reach, PLACE_REACH * radius_decode(place_from(&work->places[i])));
    return status;
}

/* --- how dense places are ------------------------------------------------------------------- */

static size_t chunks_of(size_t count)
{
    return (count + CHUNK_PLACES - 1) / CHUNK_PLACES;
}

typedef struct SpacingWork {
    const PlaceWork *work;
    PhotonMap *places;
} SpacingWork;

/* Return the mean distance from a point to the nearest place, as dense as places are there. */
static double spacing_at(const PhotonMap *places, const Photon *place, GatherScratch *scratch)
{
    const GatherLimits limits = {.max_photons = SPACING_PLACES + 1, /* it is one of them */
                                 .max_radius = INFINITY,
                                 .shape = GATHER_DISK,
                                 .normal_cosine = PLACE_COSINE,
                                 .side =
                                     place->flags & PHOTON_INSIDE ? GATHER_INSIDE : GATHER_OUTSIDE};
    const uint32_t *index;
    double radius2;
    photon_nearest(places, photon_place(places, place), normal14_decode(place->flags >> 2), &limits,
                   scratch, &index, &radius2);
    double found = sqrt(radius2 * PMS_PI / SPACING_PLACES) / 2;
    return isfinite(found) ? found : radius_decode(place_from(place)) / 2; /* there are so few */
}

static void find_spacings_chunk(void *ctx, size_t index, int thread)
{
    SpacingWork *spacing = ctx;
    PhotonMap *places = spacing->places;
    size_t first = index * CHUNK_PLACES, end = first + CHUNK_PLACES;
    for (size_t i = first; i < end && i < photon_map_count(places); i++) {
        Photon place = photon_map_at(places, i);
        double found = spacing_at(places, &place, spacing->work->scratches[thread]);
        uint16_t *from = &places->blocks[i / BLOCK_PHOTONS].from[i % BLOCK_PHOTONS];
        unsigned code = log_encode(found / radius_decode(*from), SPACING_BITS);
        *from = (uint16_t)((unsigned)*from | code << SPACING_SHIFT);
    }
}

static Status find_spacings(const PlaceWork *work, PhotonMap *places, int threads)
{
    SpacingWork spacing = {work, places};
    return places ? work_for(threads, chunks_of(photon_map_count(places)), find_spacings_chunk,
                             &spacing)
                  : OK;
}

static Status estimate_all(PlaceWork *work, const IrradianceOptions *options, Diag *diag,
                           IrradianceMap *map)
{
    int threads = options->threads;
    int made = 0;
    Status status = make_threads(work, threads, &made, diag);
    if (status == OK)
        status = work_for(threads, chunks_of(work->count), estimate_chunk, work);
    if (status == OK)
        status = build(work, options, diag, map);
    for (int way = 0; way < FACINGS && status == OK; way++)
        status = find_spacings(work, map->places[way], threads);
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

static GatherLimits place_search(const IrradianceOptions *options)
{
    double radius = PLACE_RADIUS_MOST * options->radius;
    return (GatherLimits){.max_photons = PLACE_PHOTONS,
                          .shrink = options->area < 1 ? sqrt(options->area) : 0,
                          .max_radius = radius > 0 ? radius : INFINITY,
                          .shape = GATHER_DISK,
                          .normal_cosine = PHOTON_COSINE};
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
                      .search = place_search(options)};
    IrradianceMap *map = mem_alloc(sizeof *map);
    Status status =
        map ? estimate_all(&work, options, diag, map) : diag_no_memory(diag, "irradiance");
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
                                     &map->search, scratch, &index, &radius2);
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
    double radius;       /* scene units */
    bool is_at_edge;     /* of a surface */
    double off2, apart2; /* squares of the distance as GATHER_DISK measures it, in radii and in
                            units of the spacing there */
} NearPlace;

/* Places around a point. */
typedef struct Vicinity {
    V3 p, n;
    bool is_all; /* there are no more */
    int looked_at;
    V3 aside;      /* sum of the ways to them */
    double apart2; /* sum of squares of distances */
    int count;     /* of those that may speak, the best first */
    NearPlace best[PLACES_MOST];
} Vicinity;

static void add_place(Vicinity *around, const PhotonMap *map, uint32_t index)
{
    NearPlace near = {.map = map, .index = index, .place = photon_map_at(map, index)};
    unsigned from = place_from(&near.place);
    double radius = radius_decode(from), spacing = spacing_decode(from);
    near.p = photon_place(map, &near.place);
    near.radius = radius;
    near.is_at_edge = (from & EDGE_BIT) != 0;
    double distance2 = photon_distance2(map, &near.place, around->p, around->n);
    near.off2 = distance2 / (radius * radius);
    near.apart2 = distance2 / (spacing * spacing);
    V3 to = v3_sub(near.p, around->p);
    around->looked_at++;
    around->aside = v3_add(around->aside, to);
    around->apart2 += v3_len2(to);
    if (!(near.off2 <= PLACE_REACH * PLACE_REACH))
        return;
    int at = around->count++;
    for (; at > 0 && near.apart2 < around->best[at - 1].apart2; at--)
        around->best[at] = around->best[at - 1];
    around->best[at] = near;
}

/* Find places that face as n does, of each way the `most` nearest. */
static void find_places(const IrradianceMap *map, GatherScratch *scratch, GatherSide side, int most,
                        Vicinity *around)
{
    const GatherLimits limits = {.max_photons = most + 1, /* the last sets the radius alone */
                                 .max_radius = map->reach,
                                 .shape = GATHER_DISK,
                                 .normal_cosine = PLACE_COSINE,
                                 .side = side};
    V3 n = around->n;
    double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    around->looked_at = around->count = 0;
    around->aside = v3(0, 0, 0);
    around->apart2 = 0;
    around->is_all = true;
    for (int way = 0; way < FACINGS; way++) {
        const uint32_t *index;
        double radius2;
        if (!map->places[way] || facing(n, way) < largest - FACING_SLACK)
            continue;
        int count =
            photon_nearest(map->places[way], around->p, n, &limits, scratch, &index, &radius2);
        around->is_all = around->is_all && count < most;
        for (int i = 0; i < count; i++)
            add_place(around, map->places[way], index[i]);
    }
}

/* Do all places lie to one side?  Of n at random the mean of the ways to them is as long as this
 * with a chance of exp(-n/2). */
static bool is_one_sided(const Vicinity *around)
{
    return v3_len2(around->aside) > 0.5 * around->looked_at * around->apart2;
}

/* Do places end because there is no more light, not because there is no more surface? */
static bool ends_in_the_dark(const Vicinity *around)
{
    for (int i = 0; i < around->count; i++)
        if (around->best[i].is_at_edge)
            return false;
    return is_one_sided(around);
}

/* Find the places that may speak for a point, best first.
 *
 * Where bright light ends, places crowd on one side.  The nearest one would be of that side as far
 * as into the dark, and bright patches would grow; the nearest in units of how dense places are
 * meets the others halfway.  Were it the nearest in radii, those that came out with large radii by
 * chance, and so with little light, would be chosen too often. */
static void find_speakers(const IrradianceMap *map, GatherScratch *scratch, GatherSide side,
                          Vicinity *around)
{
    int most = LOOKUP_PLACES;
    do {
        find_places(map, scratch, side, most, around);
        most *= LOOKUP_MORE;
    } while (!around->is_all && most <= LOOKUP_MOST &&
             (around->count == 0 || is_one_sided(around)));
    if (ends_in_the_dark(around))
        while (around->count > 0 &&
               around->best[around->count - 1].apart2 > PLACE_BESIDE * PLACE_BESIDE)
            around->count--;
}

Rgb irradiance_at(const IrradianceMap *map, TraceThread *thread, GatherScratch *scratch,
                  const ShapePoint *at, V3 n, double *radius)
{
    Vicinity around; /* too large to be cleared */
    around.p = at->p;
    around.n = n;
    around.count = 0;
    *radius = 0;
    if (map)
        find_speakers(map, scratch, gather_side(at, n), &around);
    for (int i = 0; i < around.count; i++) {
        const NearPlace *near = &around.best[i];
        const Photon *place = &near->place;
        double lift = CLEAR_HEIGHT * near->radius * sqrt(near->off2);
        V3 other = v3_mad(near->p, lift, normal14_decode(place->flags >> 2));
        V3 own = v3_mad(at->p, lift + 2 * at->p_error, n);
        if ((place->flags & FLAG_CLUTTERED) && !is_clear(thread, own, other))
            continue;
        *radius = near->radius;
        photon_map_see(near->map, near->index);
        return rgbe_decode(place->rgbe);
    }
    return RGB_BLACK;
}
