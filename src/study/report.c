/* The report of a study: its files.  SPDX-License-Identifier: Apache-2.0 */
#include "study/report.h"

#include "study/report_int.h"

#include <stdlib.h>

/* Write what `print` prints as a file of the study's folder. */
static Status write_printed(const Study *study, const char *name,
                            void (*print)(FILE *file, const Study *study))
{
    StudyPath path = study_path(study, name);
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return diag_no_memory(study->diag, path.text);
    print(file, study);
    Status status = fclose(file) == 0 ? file_write(study->diag, path.text, text, size)
                                      : diag_no_memory(study->diag, path.text);
    free(text);
    return status;
}

Status report_write(const Study *study, const ReportLook *look)
{
    TRY(write_printed(study, "study.csv", report_print_csv));
    TRY(write_printed(study, "study.json", report_print_json));
    return page_write(study, look);
}
