/* The one door to the heap.
 *
 * Every block the library owns comes through here, so a test can make the n-th
 * allocation fail and see that nothing crashes.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_MEM_H
#define PMS_BASE_MEM_H

#include <stddef.h>

/* Return `size` zeroed bytes, or NULL.  Free with mem_free.  Any thread. */
void *mem_alloc(size_t size);

/* Return room for `count` zeroed items of `size` bytes, or NULL (also on overflow). */
void *mem_array(size_t count, size_t size);

/* Grow or shrink `block` to `size` bytes, keeping its content; new bytes are not zeroed.
 * On NULL the old block is still owned by the caller. */
void *mem_resize(void *block, size_t size);

/* Free a block; NULL is allowed. */
void mem_free(void *block);

/* Make the n-th allocation from now (1 is the next one) and all after it fail; 0 stops
 * that.  For tests. */
void mem_fail_from(long n);

/* Grow an array for one more item: doubles `*capacity` when `count` has reached it.
 * Returns 0, or -1 when memory is out (the array is then unchanged). */
int mem_grow(void **items, size_t count, size_t *capacity, size_t item_size);

#endif
