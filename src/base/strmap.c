/* A map from byte strings to pointers.  SPDX-License-Identifier: Apache-2.0 */
#include "base/strmap.h"

#include <stdbool.h>
#include <string.h>

enum { STRMAP_FIRST = 64 };

void strmap_init(StrMap *map, Arena *arena)
{
    *map = (StrMap){.arena = arena};
}

/* FNV-1a. */
static uint64_t hash_of(const char *key, size_t length)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < length; i++)
        hash = (hash ^ (unsigned char)key[i]) * 0x100000001b3u;
    return hash;
}

/* Return the place of the key, or the free place where it would go. */
static StrEntry *place_of(const StrMap *map, const char *key, size_t length, uint64_t hash)
{
    size_t mask = map->capacity - 1;
    for (size_t i = (size_t)hash & mask;; i = (i + 1) & mask) {
        StrEntry *entry = &map->entries[i];
        if (!entry->key)
            return entry;
        if (entry->hash == hash && entry->length == length && memcmp(entry->key, key, length) == 0)
            return entry;
    }
}

void *strmap_find(const StrMap *map, const char *key, size_t length)
{
    if (!map->capacity)
        return NULL;
    return place_of(map, key, length, hash_of(key, length))->value;
}

static int grow(StrMap *map)
{
    StrMap bigger = *map;
    bigger.capacity = map->capacity ? map->capacity * 2 : STRMAP_FIRST;
    bigger.entries = ARENA_ARRAY(map->arena, StrEntry, bigger.capacity);
    if (!bigger.entries)
        return -1;
    bigger.used = 0;
    for (size_t i = 0; i < map->capacity; i++) {
        const StrEntry *old = &map->entries[i];
        if (!old->key || !old->value)
            continue;
        *place_of(&bigger, old->key, old->length, old->hash) = *old;
        bigger.used++;
    }
    *map = bigger;
    return 0;
}

int strmap_set(StrMap *map, const char *key, size_t length, void *value)
{
    if (map->used * 2 >= map->capacity && grow(map) != 0)
        return -1;
    uint64_t hash = hash_of(key, length);
    StrEntry *entry = place_of(map, key, length, hash);
    if (!entry->key) {
        const char *copy = arena_strndup(map->arena, key, length);
        if (!copy)
            return -1;
        *entry = (StrEntry){.key = copy, .length = length, .hash = hash};
        map->used++;
    }
    entry->value = value;
    return 0;
}
