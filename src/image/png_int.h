/* Reading PNG: what png_file.c and bitmap_png.c share.
 *
 * libpng reports errors by a jump; none leaves these functions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_PNG_INT_H
#define PMS_IMAGE_PNG_INT_H

#include "base/diag.h"

#include <png.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct PngJob {
    Diag *diag;
    const char *path;
    FILE *file;
    size_t file_bytes;
    png_structp png;
    png_infop info;
    uint8_t *bytes;    /* the pixels as the file has them */
    png_bytep *rows;   /* into bytes */
    bool is_memory;    /* memory ran out */
    int error;         /* errno at the time of the complaint */
    char message[160]; /* libpng's complaint */
} PngJob;

/* Open job->path and read up to the pixels; `prepare` asks libpng for the form they are wanted
 * in, and may be left by libpng's jump. */
Status png_job_begin(PngJob *job, void (*prepare)(PngJob *job));

/* Read the pixels into job->bytes. */
Status png_job_rows(PngJob *job);

/* Return the exponent that brings the file's values to light, or 0 if they are sRGB. */
double png_job_gamma(PngJob *job);

/* Close the file and free what the job holds, whatever became of it. */
void png_job_end(PngJob *job);

#endif
