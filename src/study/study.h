/* A study: what accuracy costs in one scene, setting by setting.
 *
 * The scene is rendered with each setting that matters to it varied, and compared with a reference.
 * All that is measured lies in a folder; a study that ended early goes on from there.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_STUDY_H
#define PMS_STUDY_STUDY_H

#include "study/analysis.h"

typedef struct StudyOptions {
    RenderOptions render;       /* what to start from; its progress is told that of the study */
    const char *folder;         /* made if it is not there */
    const char *reference_path; /* a picture to compare with; NULL: one is built */
    double seconds;             /* for all of it */
} StudyOptions;

typedef struct Study {
    StudyOptions options;
    StudyBase base;
    Plan plan;
    Arena *arena;
    Diag *diag;
    Truth truth;
    StudyPoint *points;
    int count;
    StudyRun *runs;   /* STUDY_SEEDS of each point */
    bool *is_left;    /* of each run: there was no time for it */
    StudyAnalysis analysis;
    double started;   /* clock_wall */
    double run_started, run_expected; /* of the run at hand */
    char phase[96];   /* what is being done */
} Study;

/* Run a study.  `study` has what was measured, analysed, also after ERR_INTERRUPTED if there is
 * anything (analysis.row_count is not 0).  ERR_USAGE if the folder holds the study of another
 * picture.  Free with study_done. */
Status study_run(const Scene *scene, const StudyOptions *options, Arena *arena, Diag *diag,
                 Study *study);
void study_done(Study *study);

/* Return how many runs there are in all, how many are done, and how many points have none. */
int study_run_count(const Study *study);
int study_done_count(const Study *study);
int study_missing_points(const Study *study);

/* Write the path of the picture of a point, the first seed's. */
void study_picture_path(const Study *study, const StudyPoint *point, char *out, size_t size);

#endif
