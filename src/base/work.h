/* Threads: the only file that starts any.
 *
 * Work is a range of indices; which thread does which index must not matter to the result.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_WORK_H
#define PMS_BASE_WORK_H

#include "base/status.h"

#include <signal.h>
#include <stddef.h>

enum { WORK_THREADS_MAX = 1024 };

/* Do item `index`; `thread` is in [0, threads). */
typedef void (*WorkFn)(void *ctx, size_t index, int thread);

/* Call fn(ctx, i, thread) once for every i in [0, count), on `threads` threads, handing the
 * indices out in ascending order.  The calling thread is one of them.
 *
 * Returns OK, or ERR_INTERRUPTED when work_interrupted was set before all were done: an item may
 * cut itself short when it sees the flag.
 * When a thread cannot be started the others do its work. */
Status work_for(int threads, size_t count, WorkFn fn, void *ctx);

/* Return the number of processors this process may use, at least 1. */
int work_thread_count(void);

/* Set by the signal handler of the program; read by every long loop. */
extern volatile sig_atomic_t work_interrupted;

/* A loop of many passes sets work_is_patient; the first Ctrl-C then sets work_ending instead, and
 * the loop ends when the pass at hand is done. */
extern volatile sig_atomic_t work_is_patient, work_ending;

#endif
