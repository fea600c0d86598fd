/* A map from byte strings to pointers.  SPDX-License-Identifier: Apache-2.0 */
#include "base/strmap.h"

#include <stdbool.h>
#include <string.h>

enum { STRMAP_FIRST = 64, WORD_MAX = 64 };

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

static int min3(int a, int b, int c)
{
    int m = a < b ? a : b;
    return m < c ? m : c;
}

/* Optimal string alignment distance, by rows. */
int word_distance(const char *a, size_t a_length, const char *b, size_t b_length, int limit)
{
    int rows[3][WORD_MAX + 1];
    size_t gap = a_length > b_length ? a_length - b_length : b_length - a_length;
    if (a_length > WORD_MAX || b_length > WORD_MAX || gap > (size_t)limit)
        return limit + 1;
    int *before = rows[0], *above = rows[1], *row = rows[2];
    for (size_t j = 0; j <= b_length; j++)
        above[j] = (int)j;
    for (size_t i = 1; i <= a_length; i++) {
        row[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            int replace = above[j - 1] + (a[i - 1] != b[j - 1]);
            row[j] = min3(replace, above[j] + 1, row[j - 1] + 1);
            bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (is_swap && before[j - 2] + 1 < row[j])
                row[j] = before[j - 2] + 1;
        }
        int *spare = before;
        before = above;
        above = row;
        row = spare;
    }
    return above[b_length] > limit ? limit + 1 : above[b_length];
}

const char *strmap_nearest(const StrMap *map, const char *key, size_t length)
{
    int limit = length < 4 ? 1 : length < 8 ? 2 : 3;
    const char *nearest = NULL;
    int best = limit + 1;
    for (size_t i = 0; i < map->capacity; i++) {
        const StrEntry *entry = &map->entries[i];
        if (!entry->key || !entry->value)
            continue;
        int distance = word_distance(key, length, entry->key, entry->length, limit);
        bool is_nearer =
            distance < best || (distance == best && nearest && strcmp(entry->key, nearest) < 0);
        if (is_nearer && distance <= limit) {
            best = distance;
            nearest = entry->key;
        }
    }
    return nearest;
}
