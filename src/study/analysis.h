/* What the runs of a study say: means over seeds, trends, the front, and what to choose.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_ANALYSIS_H
#define PMS_STUDY_ANALYSIS_H

#include "study/record.h"

enum { STUDY_SEEDS = 3, STUDY_TARGETS = 3 };

/* The mean of the runs of a point. */
typedef struct StudyRow {
    const StudyPoint *point;
    int seeds;               /* of how many runs */
    double seconds, phase[PHASE_COUNT]; /* of the fastest run: the least disturbed */
    double error;            /* relative, of ERROR_PERCENTILE of the pixels, less the noise of
                                the reference; NaN: too small to tell from it */
    double rmse, rel_mse, flip;
    double estimate, bound;  /* of the error, by the renders themselves; NaN: none */
    double spread;           /* standard deviation of the error over seeds; NaN: of one */
    bool is_front;           /* nothing measured is both faster and better */
} StudyRow;

/* error = exp(base) seconds^slope, fitted. */
typedef struct StudyFit {
    int count;    /* points; less than 2: there is no fit */
    double slope, base;
    double lo, hi; /* seconds of the points */
} StudyFit;

/* How the error goes with one setting. */
typedef struct StudyTrend {
    int setting;
    bool is_fine;      /* with FINE_SAMPLES of a pixel besides */
    int rows[SETTING_VALUES_MAX + 1]; /* of the rows, by value; the scene's own among them */
    int count;
    int own_row;       /* of these the one with the scene's own value; -1: it was not measured */
    double own;        /* value; NaN: a way to render */
    StudyFit fit;
    double halving;    /* times the seconds to halve the error; infinite: it never does so */
    bool is_worse;     /* the error grows with what is spent */
    double best;       /* the smallest error of it */
    double part;       /* that over the error with the scene's own value */
} StudyTrend;

typedef enum AdviceKind { ADVICE_NONE, ADVICE_MEASURED, ADVICE_EXTRAPOLATED } AdviceKind;

typedef struct StudyAdvice {
    double target; /* relative error */
    AdviceKind kind;
    int row;        /* measured: the cheapest that reaches it; else the nearest to it */
    double seconds, error;
    char how[SETTING_HOW_MAX];
} StudyAdvice;

typedef struct StudyAnalysis {
    StudyRow *rows; /* those with at least one run; row 0 is the scene as it stands */
    int row_count;
    int *front; /* rows, by seconds */
    int front_count;
    StudyTrend trends[SETTING_COUNT]; /* by how much the setting can take off the error */
    int trend_count;
    StudyAdvice advice[STUDY_TARGETS];
} StudyAnalysis;

/* Fit a line through the logarithms.  Values that are no positive numbers are left out. */
StudyFit study_fit(const double *seconds, const double *errors, int count);

/* Mark the points that no other beats in both; returns how many.  NaN errors are never marked. */
int study_front(const double *seconds, const double *errors, int count, bool *is_front);

/* Analyse the runs: runs[STUDY_SEEDS * i + s] is of point i with seed s; `noise` is the
 * reference's, a percentile, or NaN.  Memory comes from
 * `arena`.  ERR_MEMORY or OK; without a run of the scene as it stands there are no rows. */
Status study_analyse(const StudyBase *base, const StudyPoint *points, int count,
                     const StudyRun *runs, double noise, Arena *arena, StudyAnalysis *out);

/* Return the value of the setting in row trend->rows[i]. */
double study_trend_value(const StudyAnalysis *all, const StudyTrend *trend, int i);

/* Return the relative errors that choices are looked for. */
const double *study_targets(void);

#endif
