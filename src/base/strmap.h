/* A map from byte strings to pointers; open addressing, keys interned in an arena.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_STRMAP_H
#define PMS_BASE_STRMAP_H

#include "base/arena.h"

#include <stdint.h>

typedef struct StrEntry {
    const char *key; /* terminated, in the arena; NULL: a free place */
    size_t length;   /* of the key, bytes */
    uint64_t hash;
    void *value;     /* NULL: removed */
} StrEntry;

typedef struct StrMap {
    Arena *arena;      /* borrowed */
    StrEntry *entries; /* a power of two places */
    size_t capacity, used;
} StrMap;

/* Make an empty map whose memory comes from `arena`. */
void strmap_init(StrMap *map, Arena *arena);

/* Return the value of a key, or NULL. */
void *strmap_find(const StrMap *map, const char *key, size_t length);

/* Set the value of a key (NULL removes it); returns 0, or -1 when memory is out. */
int strmap_set(StrMap *map, const char *key, size_t length, void *value);

#endif
