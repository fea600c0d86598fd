/* The irradiance cache: gathered light kept where it was gathered, for points nearby.
 *
 * A record holds within an error that grows with the distance, in units of the harmonic mean
 * distance of what it sees, and with the turn of the normal; gradients take out the first order of
 * it.  The cache is written between rounds only, in an order of the caller's, and read by any
 * thread: what is found depends on nothing else.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_IRRADIANCE_CACHE_H
#define PMS_EYE_IRRADIANCE_CACHE_H

#include "eye/final_gather.h"

/* error_bound is in units in which the language's default gives a good picture; so much of it is
 * the error bound here. */
#define CACHE_ERROR_UNIT 0.25

/* What gather rays see near by is read with an error so many times as large: many of them are added
 * up. */
#define NEAR_ERROR 2

typedef struct IrradianceRecord {
    V3 p, n;       /* n unit, the side it is for */
    double radius; /* scene units: where the error of distance is 1 */
    GatheredLight light;
} IrradianceRecord;

/* Set the radius from what was gathered: the harmonic mean distance, less where the light changes
 * faster than that, within [least, most].  With has_nearest it is less where something is near:
 * else records speak for the whole way to a corner, where light drops ever faster.  Those are many
 * records of noise of their own, which shows unless it is averaged away. */
void irradiance_record_init(IrradianceRecord *record, V3 p, V3 n, const GatheredLight *light,
                            bool has_nearest, double least, double most);

/* The weighted sum of records at a point. */
typedef struct CacheRead {
    V3 p, n;
    double error; /* largest of a record that is used */
    int count;    /* records used */
    double weight, sum[3];
    double squares, noise2, weight2; /* of luminances: weighted squares; squares of weighted errors;
                                        squares of weights */
} CacheRead;

/* Add a record if it holds at the point. */
void cache_read_add(CacheRead *read, const IrradianceRecord *record);

/* Return the irradiance read; black if count is 0. */
Rgb cache_read_irradiance(const CacheRead *read);

/* Return the standard error of its luminance: what the records' own errors leave, or how far they
 * are apart if that is more. */
double cache_read_noise(const CacheRead *read);

typedef struct IrradianceCache IrradianceCache;

/* Make an empty cache for a scene around `center`, of `radius` scene units; `reach` is the largest
 * error records will be read with.  NULL when memory is out.  Free with irradiance_cache_free. */
IrradianceCache *irradiance_cache_new(V3 center, double radius, double reach);
IrradianceCache *irradiance_cache_new_like(const IrradianceCache *other);
void irradiance_cache_free(IrradianceCache *cache);
size_t irradiance_cache_count(const IrradianceCache *cache);

/* Add a record; returns false when memory is out.  Nothing may read meanwhile. */
bool irradiance_cache_add(IrradianceCache *cache, const IrradianceRecord *record);

/* Add the records of another cache, in its order.  As irradiance_cache_add. */
bool irradiance_cache_join(IrradianceCache *cache, const IrradianceCache *other);

/* Add all records that hold at read->p to a read.  Any thread. */
void irradiance_cache_read(const IrradianceCache *cache, CacheRead *read);

#endif
