/* Arenas: a chain of blocks, each twice the one before.  SPDX-License-Identifier: Apache-2.0 */
#include "base/arena.h"

#include "base/mem.h"

#include <stdint.h>
#include <string.h>

enum { ARENA_ALIGN = 16, ARENA_FIRST_BLOCK = 1 << 12, ARENA_LARGEST_STEP = 1 << 22 };

typedef struct Block Block;
struct Block {
    Block *next;  /* the block filled before this one */
    size_t size;  /* bytes in data */
    size_t used;  /* bytes handed out, a multiple of ARENA_ALIGN */
    size_t dirty; /* bytes that have been handed out before; behind them all is 0 */
    unsigned char data[];
};

struct Arena {
    Block *top;   /* the block being filled */
    size_t bytes; /* handed out since the last reset */
};

Arena *arena_new(void)
{
    return mem_alloc(sizeof(Arena));
}

static void free_blocks(Block *block)
{
    while (block) {
        Block *next = block->next;
        mem_free(block);
        block = next;
    }
}

void arena_free(Arena *arena)
{
    if (!arena)
        return;
    free_blocks(arena->top);
    mem_free(arena);
}

static size_t next_block_size(const Arena *arena, size_t wanted)
{
#ifdef ARENA_PARANOID
    (void)arena;
    return wanted;
#else
    size_t size = arena->top ? arena->top->size * 2 : ARENA_FIRST_BLOCK;
    if (size > ARENA_LARGEST_STEP)
        size = ARENA_LARGEST_STEP;
    return size < wanted ? wanted : size;
#endif
}

void *arena_alloc(Arena *arena, size_t size)
{
    if (size > SIZE_MAX / 2)
        return NULL;
    size_t rounded = (size + ARENA_ALIGN - 1) & ~(size_t)(ARENA_ALIGN - 1);
    if (rounded == 0)
        rounded = ARENA_ALIGN;
    Block *block = arena->top;
#ifdef ARENA_PARANOID
    block = NULL;
    rounded = size ? size : 1;
#endif
    if (!block || block->size - block->used < rounded) {
        size_t block_size = next_block_size(arena, rounded);
        block = mem_alloc(sizeof(Block) + block_size);
        if (!block)
            return NULL;
        block->size = block_size;
        block->next = arena->top;
        arena->top = block;
    }
    void *item = block->data + block->used;
    /* What comes from the heap is 0, and untouched memory costs nothing. */
    if (block->used < block->dirty)
        memset(item, 0,
               rounded < block->dirty - block->used ? rounded : block->dirty - block->used);
    block->used += rounded;
    arena->bytes += rounded;
    return item;
}

void *arena_array(Arena *arena, size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size)
        return NULL;
    return arena_alloc(arena, count * size);
}

void *arena_copy(Arena *arena, const void *from, size_t size)
{
    void *copy = arena_alloc(arena, size);
    if (copy && size)
        memcpy(copy, from, size);
    return copy;
}

char *arena_strndup(Arena *arena, const char *text, size_t length)
{
    char *copy = arena_alloc(arena, length + 1);
    if (copy && length)
        memcpy(copy, text, length);
    return copy;
}

void arena_reset(Arena *arena)
{
    arena->bytes = 0;
    if (!arena->top)
        return;
#ifdef ARENA_PARANOID
    free_blocks(arena->top);
    arena->top = NULL;
#else
    /* The newest block is the largest: keep it alone. */
    free_blocks(arena->top->next);
    arena->top->next = NULL;
    if (arena->top->dirty < arena->top->used)
        arena->top->dirty = arena->top->used;
    arena->top->used = 0;
#endif
}

size_t arena_bytes(const Arena *arena)
{
    return arena->bytes;
}
