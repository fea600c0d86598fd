/* Hashes of bytes: to tell whether two things are the same, and whether one was damaged.  Not
 * proof against an attacker.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_HASH_H
#define PMS_BASE_HASH_H

#include "base/rng.h"

#include <stddef.h>
#include <string.h>

/* Return the hash of `size` bytes that follow those `hash` is of (0: of none).  Any change of one
 * word of eight bytes changes it.  What is hashed in two calls differs from the same in one. */
static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *at = (const unsigned char *)bytes;
    for (; size >= 8; at += 8, size -= 8) {
        uint64_t word;
        memcpy(&word, at, 8);
        hash = rng_mix(hash ^ word) + 0x9e3779b97f4a7c15u;
    }
    uint64_t rest = 0;
    memcpy(&rest, at, size);
    return rng_mix(hash ^ rest);
}

#endif
