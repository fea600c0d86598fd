/* Threads.  SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* sched_getaffinity: how many processors are really ours */
#include "base/work.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

volatile sig_atomic_t work_interrupted = 0, work_is_patient = 0, work_ending = 0;

typedef struct Crew {
    WorkFn fn;
    void *ctx;
    size_t count;
    atomic_size_t next; /* first index not handed out yet */
} Crew;

typedef struct Worker {
    Crew *crew;
    int thread;
    pthread_t handle;
} Worker;

static void *work(void *arg)
{
    Worker *worker = arg;
    Crew *crew = worker->crew;
    while (!work_interrupted) {
        size_t index = atomic_fetch_add(&crew->next, 1);
        if (index >= crew->count)
            break;
        crew->fn(crew->ctx, index, worker->thread);
    }
    return NULL;
}

Status work_for(int threads, size_t count, WorkFn fn, void *ctx)
{
    Crew crew = {.fn = fn, .ctx = ctx, .count = count};
    Worker workers[WORK_THREADS_MAX];
    if (threads > WORK_THREADS_MAX)
        threads = WORK_THREADS_MAX;
    if ((size_t)threads > count)
        threads = (int)count;
    int started = 1;
    for (; started < threads; started++) {
        workers[started] = (Worker){&crew, started, 0};
        if (pthread_create(&workers[started].handle, NULL, work, &workers[started]) != 0)
            break;
    }
    workers[0] = (Worker){&crew, 0, 0};
    work(&workers[0]);
    for (int i = 1; i < started; i++)
        pthread_join(workers[i].handle, NULL);
    return work_interrupted ? ERR_INTERRUPTED : OK;
}

int work_thread_count(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return 1;
    int count = CPU_COUNT(&set);
    return count > 0 ? count : 1;
}
