/* The rounds that fill the irradiance cache ahead of the picture.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_CACHE_FILL_H
#define PMS_EYE_CACHE_FILL_H

#include "eye/eye.h"
#include "eye/irradiance_cache.h"

typedef struct CacheFilling {
    int threads;
    uint64_t seed; /* of one of many passes: its records lie elsewhere; unused in a single one */
    void (*progress)(void *ctx, double fraction); /* or NULL */
    void *progress_ctx;
} CacheFilling;

/* The cache of a picture, and that of what the gather rays of its points saw near by. */
typedef struct IrradianceCaches {
    IrradianceCache *seen, *near;
} IrradianceCaches;
void irradiance_caches_done(IrradianceCaches *caches);

/* Fill new caches for the picture that `options` are for: from coarse to fine, every round reads
 * what the rounds before have found, so that the result is the same for any number of threads.
 * *out stays empty if the plan has no cache.  ERR_MEMORY, ERR_INTERRUPTED or OK. */
Status irradiance_cache_fill(const Tracer *tracer, const EyeOptions *options,
                             const CacheFilling *filling, Diag *diag, Stats *stats,
                             IrradianceCaches *out);

#endif
