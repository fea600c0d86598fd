/* The report of a study: its files.  SPDX-License-Identifier: Apache-2.0 */
#include "study/report.h"

#include "base/file.h"
#include "study/report_int.h"

#include <stdlib.h>

/* Write what `print` prints as a file of the study's folder. */
static Status write_printed(const Study *study, const char *name,
                            void (*print)(FILE *file, const Study *study))
{
    char path[FILE_PATH_MAX], *text = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", study->options.folder, name);
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return diag_no_memory(study->diag, path);
    print(file, study);
    Status status = fclose(file) == 0 ? file_write(study->diag, path, text, size)
                                      : diag_no_memory(study->diag, path);
    free(text);
    return status;
}

Status report_write(const Study *study, const ReportLook *look)
{
    TRY(write_printed(study, "study.csv", report_print_csv));
    TRY(write_printed(study, "study.json", report_print_json));
    return page_write(study, look);
}
