/* The report of a study: CSV, JSON and a page with plots, in its folder.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_REPORT_H
#define PMS_STUDY_REPORT_H

#include "study/study.h"

#include <stdio.h>

/* How pictures are shown on the page: see ocio_new and ocio_apply. */
typedef struct ReportLook {
    const char *ocio_config, *display, *view;
} ReportLook;

/* Write study.csv, study.json, study.html and study.svg into the study's folder.  Without gnuplot
 * there are no plots, and a warning says what to install. */
Status report_write(const Study *study, const ReportLook *look);

/* Print one line a point, and all of the study. */
void report_print_csv(FILE *file, const Study *study);
void report_print_json(FILE *file, const Study *study);

/* Print what matters most, for people. */
void report_print_text(FILE *file, const Study *study);

/* Return the name of a point's setting; "own": there is none. */
const char *report_name(const StudyPoint *point);

/* Write an error as percent: "6.7 %", or that it is below what the reference can tell. */
void report_percent(double error, char out[32]);

/* Write seconds as they are read: "0.35 s", "12 s", "4.2 min", "3.1 h". */
void report_time(double seconds, char out[32]);

/* Write what halving the error costs: "2.9 times the time", "not by this alone". */
void report_halving(const StudyTrend *trend, char out[48]);

/* Write what an advice is worth: "measured", "extrapolated from ...", "out of reach". */
void report_basis(const Study *study, const StudyAdvice *advice, char out[160]);

#endif
