/* Arenas: many small allocations, freed in one call.
 *
 * Built with -DARENA_PARANOID each item is a heap block of its own, so that the address
 * sanitizer sees an overrun (the idea is libgit2's debug pool).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_ARENA_H
#define PMS_BASE_ARENA_H

#include <stddef.h>

typedef struct Arena Arena;

/* Return an empty arena, or NULL.  Free with arena_free.  One thread at a time. */
Arena *arena_new(void);

/* Free the arena and all it holds; NULL is allowed. */
void arena_free(Arena *arena);

/* Return `size` zeroed bytes, aligned to 16, that live as long as the arena; NULL when
 * memory is out. */
void *arena_alloc(Arena *arena, size_t size);

/* Return room for `count` zeroed items of `size` bytes, or NULL (also on overflow). */
void *arena_array(Arena *arena, size_t count, size_t size);

/* Return a copy of `size` bytes at `from`, or NULL. */
void *arena_copy(Arena *arena, const void *from, size_t size);

/* Return a terminated copy of the `length` bytes at `text`, or NULL. */
char *arena_strndup(Arena *arena, const char *text, size_t length);

/* Forget all items but keep the memory for reuse. */
void arena_reset(Arena *arena);

/* Return the bytes handed out since the last reset. */
size_t arena_bytes(const Arena *arena);

#define ARENA_NEW(arena, Type) ((Type *)arena_alloc((arena), sizeof(Type)))
#define ARENA_ARRAY(arena, Type, count) ((Type *)arena_array((arena), (count), sizeof(Type)))

#endif
