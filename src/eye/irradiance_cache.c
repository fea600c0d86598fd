/* The irradiance cache.
 *
 * Records are found by a hash of grid cells, one grid for each power of two of how far a record
 * reaches: in its own grid it lies in eight cells at most, and a point in one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/irradiance_cache.h"

#include "base/mem.h"
#include "base/rng.h"

enum { LEVELS = 64, BUCKETS_FIRST = 1024, NONE = -1 };

/* The level of the grid whose cells are one unit wide: as large as the scene. */
enum { LEVEL_OF_1 = 40 };

/* A record in front of the point by more than this part of the distance may see what the point
 * does not. */
#define FRONT_SLACK 0.05

/* The most a record's radius may be with has_nearest, over the distance of what is nearest. */
#define NEAREST_REACH 2

/* A record in a cell. */
typedef struct Entry {
    int64_t cell[3];
    int level, record;
    int next; /* in the bucket */
} Entry;

struct IrradianceCache {
    V3 center;
    double unit; /* scene units, a power of two */
    double reach;
    IrradianceRecord *records;
    size_t record_count, record_capacity;
    Entry *entries;
    size_t entry_count, entry_capacity;
    int *buckets;
    size_t bucket_count; /* a power of two */
    size_t level_records[LEVELS];
};

/* --- one record ------------------------------------------------------------------------------ */

static double vector_length(const float v[3])
{
    return v3_len(v3((double)v[0], (double)v[1], (double)v[2]));
}

void irradiance_record_init(IrradianceRecord *record, V3 p, V3 n, const GatheredLight *light,
                            bool has_nearest, double least, double most)
{
    const float channels[3] = {light->irradiance.r, light->irradiance.g, light->irradiance.b};
    double radius =
        has_nearest ? fmin(light->distance, NEAREST_REACH * light->nearest) : light->distance;
    for (int c = 0; c < 3; c++) {
        double change = vector_length(light->shift[c]);
        if (change * radius > (double)channels[c])
            radius = (double)channels[c] / change;
    }
    *record = (IrradianceRecord){.p = p, .n = n, .radius = radius, .light = *light};
    if (record->radius > most)
        record->radius = most;
    if (!(record->radius >= least)) {
        /* Held longer than it is good for: the steps it was made for are shorter. */
        float shorten = (float)fmax(0, record->radius / least);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 3; i++)
                record->light.shift[c][i] *= shorten;
        record->radius = least;
    }
}

static double times(const float a[3], V3 b)
{
    return (double)a[0] * b.x + (double)a[1] * b.y + (double)a[2] * b.z;
}

void cache_read_add(CacheRead *read, const IrradianceRecord *record)
{
    V3 to = v3_sub(read->p, record->p);
    double distance = v3_len(to), turn = 1 - v3_dot(read->n, record->n);
    double error = distance / record->radius + sqrt(fmax(0, turn));
    if (!(error < read->error))
        return;
    V3 between = v3_add(read->n, record->n);
    if (v3_dot(to, between) < -2 * FRONT_SLACK * distance)
        return;
    double weight = 1 - error / read->error;
    V3 axis = v3_cross(record->n, read->n);
    const GatheredLight *light = &record->light;
    const float channels[3] = {light->irradiance.r, light->irradiance.g, light->irradiance.b};
    double found[3];
    for (int c = 0; c < 3; c++) {
        double e = (double)channels[c] + times(light->shift[c], to) + times(light->turn[c], axis);
        found[c] = fmax(0, e);
        read->sum[c] += weight * found[c];
    }
    double luminance =
        (double)rgb_luminance(rgb((float)found[0], (float)found[1], (float)found[2]));
    read->squares += weight * luminance * luminance;
    read->noise2 += weight * weight * (double)light->noise * (double)light->noise;
    read->weight2 += weight * weight;
    read->weight += weight;
    read->count++;
}

Rgb cache_read_irradiance(const CacheRead *read)
{
    if (!(read->weight > 0))
        return RGB_BLACK;
    return rgb((float)(read->sum[0] / read->weight), (float)(read->sum[1] / read->weight),
               (float)(read->sum[2] / read->weight));
}

double cache_read_noise(const CacheRead *read)
{
    if (!(read->weight > 0))
        return 0;
    double mean = (double)rgb_luminance(cache_read_irradiance(read)), all = read->weight;
    double share = read->weight2 / (all * all), apart = read->squares / all - mean * mean;
    /* The unbiased variance of one record, and of it what the mean has. */
    double spread = share < 1 ? fmax(0, apart) / (1 - share) * share : 0;
    return sqrt(fmax(spread, read->noise2 / (all * all)));
}

/* --- the cache -------------------------------------------------------------------------------- */

static bool set_buckets(IrradianceCache *cache, size_t count)
{
    int *buckets = mem_array(count, sizeof *buckets);
    if (!buckets)
        return false;
    for (size_t i = 0; i < count; i++)
        buckets[i] = NONE;
    mem_free(cache->buckets);
    cache->buckets = buckets;
    cache->bucket_count = count;
    return true;
}

IrradianceCache *irradiance_cache_new(V3 center, double radius, double reach)
{
    IrradianceCache *cache = mem_alloc(sizeof *cache);
    if (!cache)
        return NULL;
    cache->center = center;
    cache->unit = radius > 0 && isfinite(radius) ? ldexp(1, ilogb(radius)) : 1;
    cache->reach = reach;
    if (!set_buckets(cache, BUCKETS_FIRST)) {
        mem_free(cache);
        return NULL;
    }
    return cache;
}

IrradianceCache *irradiance_cache_new_like(const IrradianceCache *other)
{
    return irradiance_cache_new(other->center, other->unit, other->reach);
}

void irradiance_cache_free(IrradianceCache *cache)
{
    if (!cache)
        return;
    mem_free(cache->records);
    mem_free(cache->entries);
    mem_free(cache->buckets);
    mem_free(cache);
}

size_t irradiance_cache_count(const IrradianceCache *cache)
{
    return cache->record_count;
}

/* The grid whose cells are just as wide as a record reaches to both sides, or wider. */
static int level_of(const IrradianceCache *cache, double reach)
{
    int exponent;
    frexp(2 * reach / cache->unit, &exponent);
    int level = exponent + LEVEL_OF_1;
    return level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : level;
}

static double cells_per_unit(const IrradianceCache *cache, int level)
{
    return ldexp(1, LEVEL_OF_1 - level) / cache->unit;
}

static void cell_at(const IrradianceCache *cache, V3 p, int level, double aside, int64_t out[3])
{
    double scale = cells_per_unit(cache, level);
    out[0] = (int64_t)floor((p.x - cache->center.x + aside) * scale);
    out[1] = (int64_t)floor((p.y - cache->center.y + aside) * scale);
    out[2] = (int64_t)floor((p.z - cache->center.z + aside) * scale);
}

static size_t bucket_of(const IrradianceCache *cache, const int64_t cell[3], int level)
{
    uint64_t h = (uint64_t)level;
    for (int i = 0; i < 3; i++)
        h = rng_mix(h ^ (uint64_t)cell[i]) + 0x9e3779b97f4a7c15u;
    return (size_t)h & (cache->bucket_count - 1);
}

static void link_entry(IrradianceCache *cache, int number)
{
    Entry *entry = &cache->entries[number];
    size_t bucket = bucket_of(cache, entry->cell, entry->level);
    entry->next = cache->buckets[bucket];
    cache->buckets[bucket] = number;
}

static bool add_entry(IrradianceCache *cache, const Entry *entry)
{
    void *entries = cache->entries;
    if (mem_grow(&entries, cache->entry_count, &cache->entry_capacity, sizeof *entry) != 0)
        return false;
    cache->entries = entries;
    if (cache->entry_count >= cache->bucket_count) {
        if (!set_buckets(cache, 4 * cache->bucket_count))
            return false;
        for (size_t i = 0; i < cache->entry_count; i++)
            link_entry(cache, (int)i);
    }
    cache->entries[cache->entry_count] = *entry;
    link_entry(cache, (int)cache->entry_count++);
    return true;
}

bool irradiance_cache_add(IrradianceCache *cache, const IrradianceRecord *record)
{
    double reach = record->radius * cache->reach;
    int level = level_of(cache, reach);
    int64_t low[3], high[3];
    void *records = cache->records;
    if (mem_grow(&records, cache->record_count, &cache->record_capacity, sizeof *record) != 0)
        return false;
    cache->records = records;
    cache->records[cache->record_count] = *record;
    cell_at(cache, record->p, level, -reach, low);
    cell_at(cache, record->p, level, reach, high);
    for (int i = 0; i < 8; i++) {
        Entry entry = {.level = level, .record = (int)cache->record_count};
        bool is_new = true;
        for (int axis = 0; axis < 3; axis++) {
            bool is_high = (i >> axis & 1) != 0;
            entry.cell[axis] = is_high ? high[axis] : low[axis];
            is_new = is_new && !(is_high && high[axis] == low[axis]);
        }
        if (is_new && !add_entry(cache, &entry))
            return false;
    }
    cache->level_records[level]++;
    cache->record_count++;
    return true;
}

bool irradiance_cache_join(IrradianceCache *cache, const IrradianceCache *other)
{
    for (size_t i = 0; i < other->record_count; i++)
        if (!irradiance_cache_add(cache, &other->records[i]))
            return false;
    return true;
}

void irradiance_cache_read(const IrradianceCache *cache, CacheRead *read)
{
    for (int level = 0; level < LEVELS; level++) {
        int64_t cell[3];
        if (cache->level_records[level] == 0)
            continue;
        cell_at(cache, read->p, level, 0, cell);
        size_t bucket = bucket_of(cache, cell, level);
        for (int i = cache->buckets[bucket]; i != NONE; i = cache->entries[i].next) {
            const Entry *entry = &cache->entries[i];
            if (entry->level == level && entry->cell[0] == cell[0] && entry->cell[1] == cell[1] &&
                entry->cell[2] == cell[2])
                cache_read_add(read, &cache->records[entry->record]);
        }
    }
}
