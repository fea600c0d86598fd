/* Photons in media, found by rays: boxes around the balls of the photons, over the map's own tree.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/volume.h"

#include "base/mem.h"
#include "base/work.h"
#include "photon/gather.h"
#include "photon/photon_map_int.h"
#include "trace/media_along.h"

#include <string.h>

enum { STACK_MAX = 80, CHUNK_BLOCKS = 64 };

/* The kernel in the middle of the disk, over its mean. */
#define KERNEL_MOST 2

/* Planes at the ends of a ray count as no steeper than this: rise of the place where a ray beside
 * it meets them over the way beside. */
#define STEEP_MOST 8

/* A photon that gives a ray less than this part of what photons together give rays in a common
 * place is not seen at all: half the first step of a picture of 8 bits (IEC 61966-2-1). */
#define FAINT_PART (0.5 / (255 * 12.92))

/* However faint, a photon is spread over this part of the common radius. */
#define LEAST_PART 0.25

/* The photons of a ball lie within its radius of a ray through its middle, on a way of two radii: a
 * ray meets so many times those of the ball. */
#define TUBE_PART 1.5

/* Rounding of where a ray enters and leaves a box. */
#define BOX_SLACK 0x1p-20f

typedef struct VolumeBox {
    float lo[3], hi[3]; /* relative to the map's centre */
    float radius;       /* of the largest ball */
} VolumeBox;

struct VolumeIndex {
    const PhotonMap *map;
    VolumeBox *boxes; /* of every node: balls included */
    float *radius;    /* of a block's balls */
};

/* --- making ------------------------------------------------------------------------------- */

/* The light that photons of a block give a ray, times the area it is spread over. */
typedef struct BlockLight {
    float most, mean; /* of a photon, largest channel */
} BlockLight;

typedef struct IndexWork {
    VolumeIndex *index;
    const Tracer *tracer;
    GatherScratch **scratch; /* per thread */
    int nearest;
    double radius;      /* 0: from the density */
    BlockLight *lights; /* per block; NULL: all balls have one radius */
} IndexWork;

static V3 block_center(const PhotonBlock *block)
{
    double sum[3] = {0};
    int count = 0;
    for (int i = 0; i < BLOCK_PHOTONS; i++) {
        if (isnan(block->pos[0][i]))
            continue;
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += (double)block->pos[axis][i];
        count++;
    }
    double scale = count > 0 ? 1.0 / count : 0;
    return v3(sum[0] * scale, sum[1] * scale, sum[2] * scale);
}

static double radius_around(const PhotonMap *map, V3 p, int nearest, GatherScratch *scratch)
{
    size_t count = photon_map_count(map);
    GatherLimits limits = {.max_photons = (size_t)nearest < count ? nearest : (int)count,
                           .max_radius = INFINITY,
                           .shape = GATHER_SPHERE,
                           .normal_cosine = -1};
    const uint32_t *found;
    double radius2;
    photon_nearest(map, p, v3(0, 0, 1), &limits, scratch, &found, &radius2);
    return radius2 > 0 && isfinite(radius2) ? sqrt(radius2) : 0;
}

/* Return the number of a block's photon in the map. */
static size_t lane_index(const PhotonMap *map, const PhotonBlock *block, int i)
{
    return (size_t)(block - map->blocks) * BLOCK_PHOTONS + (size_t)i;
}

/* All photons of a block are taken to be in the media of the first. */
static BlockLight block_light(const Tracer *tracer, const PhotonMap *map, const PhotonBlock *block)
{
    BlockLight light = {0};
    MediaHere here;
    int count = 0;
    for (int i = 0; i < BLOCK_PHOTONS; i++) {
        V3 at = v3((double)block->pos[0][i], (double)block->pos[1][i], (double)block->pos[2][i]);
        if (!v3_is_finite(at))
            continue;
        V3 p = v3_add(map->center, at);
        MediaPoint point;
        if (count++ == 0) {
            Interiors inside;
            interiors_at(tracer, p, &inside);
            media_here(tracer, &inside, &here);
        }
        media_at(&here, p, &point);
        float its =
            rgb_max(rgb_mul(point.scattering, photon_map_power(map, lane_index(map, block, i))));
        light.most = fmaxf(light.most, its);
        light.mean += (its - light.mean) / (float)count;
    }
    return light;
}

static void find_radii(void *ctx, size_t chunk, int thread)
{
    IndexWork *work = ctx;
    const PhotonMap *map = work->index->map;
    uint32_t first = (uint32_t)chunk * CHUNK_BLOCKS, end = first + CHUNK_BLOCKS;
    for (uint32_t i = first; i < end && i < map->block_count; i++) {
        const PhotonBlock *block = &map->blocks[i];
        V3 p = v3_add(map->center, block_center(block));
        work->index->radius[i] =
            work->lights ? (float)radius_around(map, p, work->nearest, work->scratch[thread])
                         : (float)work->radius;
        if (work->lights)
            work->lights[i] = block_light(work->tracer, map, block);
    }
}

/* Limit the radii to where light can be seen.
 *
 * The light to compare with is that of the photons themselves where they are of common density:
 * what lamps would send there tells nothing, as they may be turned away or behind walls. */
static void limit_radii(const IndexWork *work)
{
    const PhotonMap *map = work->index->map;
    double sum = 0, common = photon_map_radius(map, BLOCK_PHOTONS);
    for (uint32_t i = 0; i < map->block_count; i++)
        sum += (double)work->lights[i].mean;
    double around = TUBE_PART * BLOCK_PHOTONS * sum / map->block_count;
    for (uint32_t i = 0; around > 0 && i < map->block_count; i++) {
        double light = KERNEL_MOST * (double)work->lights[i].most;
        double most = common * fmax(sqrt(light / (around * FAINT_PART)), LEAST_PART);
        work->index->radius[i] = fminf(work->index->radius[i], (float)most);
    }
}

static VolumeBox block_box(const PhotonBlock *block, float radius)
{
    VolumeBox box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, radius};
    for (int i = 0; i < BLOCK_PHOTONS; i++)
        for (int axis = 0; axis < 3; axis++) {
            float x = block->pos[axis][i];
            box.lo[axis] = x - radius < box.lo[axis] ? x - radius : box.lo[axis];
            box.hi[axis] = x + radius > box.hi[axis] ? x + radius : box.hi[axis];
        }
    return box;
}

static void fill_boxes(VolumeIndex *index)
{
    const PhotonMap *map = index->map;
    uint32_t inner = map->block_count - 1;
    for (uint32_t node = inner + map->block_count; node-- > 0;) {
        if (node >= inner) {
            uint32_t block = block_of_node(map, node);
            index->boxes[node] = block_box(&map->blocks[block], index->radius[block]);
            continue;
        }
        const VolumeBox *a = &index->boxes[2 * node + 1], *b = &index->boxes[2 * node + 2];
        for (int axis = 0; axis < 3; axis++) {
            index->boxes[node].lo[axis] = fminf(a->lo[axis], b->lo[axis]);
            index->boxes[node].hi[axis] = fmaxf(a->hi[axis], b->hi[axis]);
        }
        index->boxes[node].radius = fmaxf(a->radius, b->radius);
    }
}

static bool make_scratch(IndexWork *work, int threads)
{
    work->scratch = mem_array((size_t)threads, sizeof *work->scratch);
    for (int i = 0; work->scratch && i < threads; i++)
        if (!(work->scratch[i] = gather_scratch_new()))
            return false;
    return work->scratch != NULL;
}

Status volume_index_new(const Tracer *tracer, const PhotonMap *map, int nearest, double radius,
                        int threads, Diag *diag, VolumeIndex **out)
{
    *out = NULL;
    uint32_t blocks = map->block_count;
    VolumeIndex *index = mem_alloc(sizeof *index);
    IndexWork work = {.index = index, .tracer = tracer, .nearest = nearest, .radius = radius};
    if (!index)
        return diag_no_memory(diag, "photons in media");
    index->map = map;
    index->boxes = mem_array((size_t)blocks * 2, sizeof *index->boxes);
    index->radius = mem_array((size_t)blocks + 1, sizeof *index->radius);
    Status status = index->boxes && index->radius && make_scratch(&work, threads)
                        ? OK
                        : diag_no_memory(diag, "photons in media");
    if (status == OK && !(radius > 0)) {
        work.lights = mem_array((size_t)blocks + 1, sizeof *work.lights);
        status = work.lights ? OK : diag_no_memory(diag, "photons in media");
    }
    if (status == OK)
        status = work_for(threads, (blocks + CHUNK_BLOCKS - 1) / CHUNK_BLOCKS, find_radii, &work);
    if (status == OK && work.lights)
        limit_radii(&work);
    mem_free(work.lights);
    if (status == OK)
        fill_boxes(index);
    for (int i = 0; work.scratch && i < threads; i++)
        gather_scratch_free(work.scratch[i]);
    mem_free(work.scratch);
    if (status == OK)
        *out = index;
    else
        volume_index_free(index);
    return status;
}

void volume_index_free(VolumeIndex *index)
{
    if (!index)
        return;
    mem_free(index->boxes);
    mem_free(index->radius);
    mem_free(index);
}

double volume_radius(const PhotonMap *map, int nearest)
{
    return photon_map_radius(map, nearest);
}

/* --- asking ------------------------------------------------------------------------------- */

typedef struct VolumeQuery {
    const VolumeIndex *index;
    const Ray *ray;
    double shift;     /* t where the query's own origin is */
    float o[3], d[3]; /* the ray, relative to the map's centre, from its point nearest to it */
    float over[3];    /* 1/d */
    float begin, end; /* t from there */
    float begin_slope[3], end_slope[3]; /* how these change with the place beside the ray */
    float begin_steep, end_steep;       /* the lengths of these */
    void (*visit)(void *ctx, const VolumePhoton *photon);
    void *ctx;
} VolumeQuery;

/* Return how the place where parallel rays cut a plane changes with the place beside the ray. */
static float plane_slope(const Ray *ray, V3 normal, float out[3])
{
    double cosine = v3_dot(normal, ray->d);
    V3 across = v3_mad(normal, -cosine, ray->d);
    double length = v3_len(across), steep = length / fmax(fabs(cosine), length / STEEP_MOST);
    V3 slope = length > 0 ? v3_scale(across, -copysign(steep / length, cosine)) : across;
    out[0] = (float)slope.x;
    out[1] = (float)slope.y;
    out[2] = (float)slope.z;
    return length > 0 ? (float)steep : 0;
}

static VolumeQuery make_query(const VolumeIndex *index, const Ray *ray, double length,
                              const VolumeEnds *ends)
{
    V3 to = v3_sub(index->map->center, ray->o);
    VolumeQuery query = {.index = index, .ray = ray, .shift = v3_dot(to, ray->d)};
    V3 o = v3_sub(v3_scale(ray->d, query.shift), to);
    const double from[3] = {o.x, o.y, o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    for (int axis = 0; axis < 3; axis++) {
        query.o[axis] = (float)from[axis];
        query.d[axis] = (float)d[axis];
        query.over[axis] = (float)(1 / d[axis]);
    }
    query.begin = (float)-query.shift;
    query.end = (float)(length - query.shift);
    query.begin_steep = plane_slope(ray, ends->begin, query.begin_slope);
    query.end_steep = plane_slope(ray, ends->end, query.end_slope);
    return query;
}

static bool is_cut(const VolumeQuery *query, const VolumeBox *box)
{
    float near = query->begin - query->begin_steep * box->radius;
    float far = query->end + query->end_steep * box->radius;
    for (int axis = 0; axis < 3; axis++) {
        float a = (box->lo[axis] - query->o[axis]) * query->over[axis];
        float b = (box->hi[axis] - query->o[axis]) * query->over[axis];
        float low = a < b ? a : b, high = a < b ? b : a;
        near = low > near ? low : near;
        far = high < far ? high : far;
    }
    return near - far <= BOX_SLACK * (fabsf(near) + fabsf(far));
}

/* What a disk of half the area would give less, as a share, of a photon at a squared distance of x
 * squared radii. */
static float disk_excess(float x)
{
    return x < 0.5f ? 1 - 2 * (1 - 2 * x) / (1 - x) : 1;
}

static void visit_photon(const VolumeQuery *query, const PhotonBlock *block, int i, float along,
                         float way, float most, float x)
{
    const PhotonMap *map = query->index->map;
    size_t index = lane_index(map, block, i);
    photon_map_see(map, index);
    float away[3];
    for (int axis = 0; axis < 3; axis++)
        away[axis] = block->pos[axis][i] - query->o[axis] - along * query->d[axis];
    VolumePhoton photon = {.t = (double)along + query->shift,
                           .way = (double)way,
                           .aside = {(double)away[0], (double)away[1], (double)away[2]},
                           .from = photon_map_from(map, index),
                           .power = rgb_scale(photon_map_power(map, index), most * (1 - x)),
                           .excess = disk_excess(x),
                           .is_focused = block->flags[i] == PHOTON_FOCUSED};
    query->visit(query->ctx, &photon);
}

/* Epanechnikov's kernel over the disk: light keeps its sum and has no hard edge. */
static void visit_block(const VolumeQuery *query, uint32_t number)
{
    const PhotonBlock *block = &query->index->map->blocks[number];
    float radius2 = query->index->radius[number] * query->index->radius[number];
    float over2 = 1 / radius2, most = KERNEL_MOST / (float)PMS_PI * over2;
    float along[BLOCK_PHOTONS], away2[BLOCK_PHOTONS], way[BLOCK_PHOTONS], left[BLOCK_PHOTONS];
    const float *begin = query->begin_slope, *end = query->end_slope;
    for (int i = 0; i < BLOCK_PHOTONS; i++) {
        float x = block->pos[0][i] - query->o[0], y = block->pos[1][i] - query->o[1];
        float z = block->pos[2][i] - query->o[2];
        along[i] = x * query->d[0] + y * query->d[1] + z * query->d[2];
        float ax = x - along[i] * query->d[0], ay = y - along[i] * query->d[1];
        float az = z - along[i] * query->d[2];
        away2[i] = ax * ax + ay * ay + az * az;
        way[i] = along[i] - (query->begin + ax * begin[0] + ay * begin[1] + az * begin[2]);
        left[i] = query->end + ax * end[0] + ay * end[1] + az * end[2] - along[i];
    }
    for (int i = 0; i < BLOCK_PHOTONS; i++) {
        if (!(away2[i] < radius2 && way[i] > 0 && left[i] > 0))
            continue;
        visit_photon(query, block, i, along[i], way[i], most, away2[i] * over2);
    }
}

void volume_along(const VolumeIndex *index, const Ray *ray, double length, const VolumeEnds *ends,
                  void (*visit)(void *ctx, const VolumePhoton *photon), void *ctx)
{
    VolumeQuery query = make_query(index, ray, length, ends);
    query.visit = visit;
    query.ctx = ctx;
    const PhotonMap *map = index->map;
    uint32_t inner = map->block_count - 1, stack[STACK_MAX];
    int depth = 0;
    if (map->block_count == 0)
        return;
    stack[depth++] = 0;
    while (depth > 0) {
        uint32_t node = stack[--depth];
        if (!is_cut(&query, &index->boxes[node]))
            continue;
        if (node >= inner) {
            visit_block(&query, block_of_node(map, node));
        } else {
            stack[depth++] = 2 * node + 2;
            stack[depth++] = 2 * node + 1;
        }
    }
}
