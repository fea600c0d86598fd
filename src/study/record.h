/* What a study has measured so far, in memory and in a file that grows by a line a run.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_RECORD_H
#define PMS_STUDY_RECORD_H

#include "base/stats.h"
#include "study/setting.h"
#include "study/truth.h"

/* One render of a point, with one seed. */
typedef struct StudyRun {
    bool is_done;
    double seconds; /* of the render, without reading and writing */
    double phase[PHASE_COUNT];
    TruthError error;
    double estimate, bound; /* of the error, by the render itself: see ErrorFigure; NaN: none */
    double radius;   /* photons were gathered within, scene units */
} StudyRun;

/* The key of a run in the file. */
typedef struct RunKey {
    int setting;
    double value;
    bool is_fine;
    int seed;
} RunKey;

/* Append a run to the file, with a heading if it is the first. */
Status record_append(Diag *diag, const char *path, const RunKey *key, const StudyRun *run);

/* Read all whole lines of the file and hand them to `take`.  Lines of settings that this version
 * has not are skipped, so are a last line that was cut short and those with numbers that no run
 * has.  No file is no error. */
Status record_read(Diag *diag, const char *path, Arena *arena,
                   void (*take)(void *ctx, const RunKey *key, const StudyRun *run), void *ctx);

#endif
