/* Parts of the report; for study/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_REPORT_INT_H
#define PMS_STUDY_REPORT_INT_H

#include "study/report.h"

/* Write study.html with everything in it. */
Status page_write(const Study *study, const ReportLook *look);

/* The plots, as SVG texts that live in an arena.  NULL: there is none. */
typedef struct Plots {
    const char *main;     /* error against seconds, every setting */
    const char *settings; /* error against the value, one panel a setting */
    const char *estimate; /* estimated against true error */
} Plots;

/* Draw the plots with gnuplot, the first of them also as study.svg.  Without gnuplot there are
 * none, after a warning. */
Status plots_make(const Study *study, Arena *arena, Plots *out);

/* Print `text` with what HTML takes for markup escaped. */
void html_text(FILE *file, const char *text);

/* Picture and error of a point (NULL: the reference, which has no error), as <img> elements of
 * themselves. */
Status thumbnail_print(FILE *file, const Study *study, const StudyPoint *point,
                       const ReportLook *look, const char *alt);
Status thumbnail_print_error(FILE *file, const Study *study, const StudyPoint *point,
                             const char *alt);

#endif
