/* Telling what became of the rays of a sample, and which of them made it no number.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

void witness_tell(const EyeThread *eye, const Ray *ray, RayKind kind, int level, const Hit *hit,
                  Rgb through, Rgb light)
{
    EyeStep step = {.kind = kind, .level = level, .ray = *ray, .through = through, .light = light};
    if (hit) {
        step.object = hit->object;
        step.t = hit->t;
        step.p = hit->point.p;
        step.n = hit->point.ng;
        step.p_error = hit->point.p_error;
        step.is_entering = hit->is_entering;
    }
    eye->witness->step(eye->witness->ctx, &step);
}

bool eye_step_is_finite(const EyeStep *step)
{
    return v3_is_finite(step->ray.o) && v3_is_finite(step->ray.d) && isfinite(step->t) &&
           v3_is_finite(step->p) && v3_is_finite(step->n) && isfinite(step->p_error) &&
           rgb_is_finite(step->through) && rgb_is_finite(step->light);
}

void eye_watch(EyeThread *eye, const EyeWitness *witness)
{
    eye->witness = witness;
}

uint64_t eye_fault_count(const EyeThread *eye)
{
    return eye->trace.stats.count[STAT_NAN_SAMPLE];
}

/* The first step that is no number; where all are, but their sum is not, the last one. */
typedef struct Fault {
    bool is_found;
    const Object *object;
} Fault;

static void note_fault(void *ctx, const EyeStep *step)
{
    Fault *fault = ctx;
    if (fault->is_found)
        return;
    fault->is_found = !eye_step_is_finite(step);
    fault->object = step->object;
}

const Object *eye_find_fault(EyeThread *eye, double x, double y, uint32_t pixel, uint32_t index)
{
    Fault fault = {.is_found = false};
    EyeWitness witness = {note_fault, &fault};
    EyeSample sample;
    Stats stats = eye->trace.stats; /* the sample counts once */
    eye_watch(eye, &witness);
    eye_sample(eye, x, y, pixel, index, &sample);
    eye_watch(eye, NULL);
    eye->trace.stats = stats;
    return fault.object;
}
