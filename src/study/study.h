/* A study: what accuracy costs in one scene, setting by setting.
 *
 * The scene is rendered with each setting that matters to it varied, and compared with a reference.
 * All that is measured lies in a folder; a study that ended early goes on from there.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_STUDY_H
#define PMS_STUDY_STUDY_H

#include "base/file.h"
#include "study/analysis.h"
#include "study/aside.h"

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
    const char **refusals; /* of each point why it cannot be rendered; NULL: it can */
    Aside aside;      /* of the runs */
    StudyAnalysis analysis;
    double started;   /* clock_wall */
    double run_started, run_expected; /* of the run at hand */
    char phase[96];   /* what is being done */
} Study;

/* Run a study.  A point that cannot be rendered is left out.  `study` has what was measured,
 * analysed, also when it fails, if there is anything (analysis.row_count is not 0).
 * ERR_INTERRUPTED if somebody ended it; ERR_USAGE if the scene as it stands cannot be rendered, or
 * the folder holds the study of another picture.  Free with study_done. */
Status study_run(const Scene *scene, const StudyOptions *options, Arena *arena, Diag *diag,
                 Study *study);
void study_done(Study *study);

/* Return how many runs there are in all, how many are done, how many there was no time for, and how
 * many points have none. */
int study_run_count(const Study *study);
int study_done_count(const Study *study);
int study_left_count(const Study *study);
int study_missing_points(const Study *study);

/* A path in the study's folder, whose own is short enough for all of them. */
typedef struct StudyPath {
    char text[FILE_PATH_MAX];
} StudyPath;

/* Return the path of a file of the study, and of the picture of a point, the first seed's. */
StudyPath study_path(const Study *study, const char *name);
StudyPath study_picture_path(const Study *study, const StudyPoint *point);

#endif
