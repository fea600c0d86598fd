/* The one door to the heap.  SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* madvise */
#include "base/mem.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/* Blocks from twice this size on lie on large pages where the system has them: it hands these out
 * faster, and finds what is on them sooner. */
#define LARGE_PAGE_BYTES ((size_t)2 << 20)

/* Allocations left before they start to fail; negative: they never do. */
static atomic_long fail_countdown = -1;

void mem_fail_from(long n)
{
    atomic_store(&fail_countdown, n > 0 ? n - 1 : -1);
}

static int must_fail(void)
{
    long left = atomic_load(&fail_countdown);
    if (left < 0)
        return 0;
    while (left > 0 && !atomic_compare_exchange_weak(&fail_countdown, &left, left - 1)) {
    }
    return left == 0;
}

/* Ask for large pages, all of which lie within the block.  It is only a wish. */
static void wish_large(void *block, size_t size)
{
#ifdef MADV_HUGEPAGE
    if (!block || size < 2 * LARGE_PAGE_BYTES)
        return;
    uintptr_t begin = (uintptr_t)block, end = begin + size;
    begin = (begin + LARGE_PAGE_BYTES - 1) / LARGE_PAGE_BYTES * LARGE_PAGE_BYTES;
    end = end / LARGE_PAGE_BYTES * LARGE_PAGE_BYTES;
    (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE);
#else
    (void)block, (void)size;
#endif
}

void *mem_alloc(size_t size)
{
    if (must_fail())
        return NULL;
    void *block = calloc(1, size ? size : 1);
    wish_large(block, size);
    return block;
}

void *mem_array(size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size)
        return NULL;
    return mem_alloc(count * size);
}

void *mem_resize(void *block, size_t size)
{
    return must_fail() ? NULL : realloc(block, size ? size : 1);
}

void mem_free(void *block)
{
    free(block);
}

int mem_grow(void **items, size_t count, size_t *capacity, size_t item_size)
{
    if (count < *capacity)
        return 0;
    size_t wanted = *capacity ? *capacity * 2 : 16;
    if (wanted > SIZE_MAX / item_size)
        return -1;
    void *grown = mem_resize(*items, wanted * item_size);
    if (!grown)
        return -1;
    *items = grown;
    *capacity = wanted;
    return 0;
}
