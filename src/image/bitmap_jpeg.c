/* JPEG, through libjpeg.
 *
 * libjpeg reports errors through a callback that must not return, so this file has to use
 * setjmp; what must survive the jump lives in a JpegJob.  SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h>

enum {
    JPEG_RATIO_MAX = 4096, /* what an empty picture may be packed by */
    JPEG_SCANS_MAX = 200   /* a progressive file may ask for work without end */
};

typedef struct JpegJob {
    struct jpeg_error_mgr errors; /* first: libjpeg hands it back */
    struct jpeg_progress_mgr progress;
    struct jpeg_decompress_struct jpeg;
    jmp_buf failed;
    char message[JMSG_LENGTH_MAX];
    Diag *diag;
    const char *path;
    Bitmap *out;
    Status status;
} JpegJob;

static void fail_job(j_common_ptr jpeg)
{
    JpegJob *job = (JpegJob *)jpeg->err;
    jpeg->err->format_message(jpeg, job->message);
    longjmp(job->failed, 1);
}

static void say_nothing(j_common_ptr jpeg)
{
    (void)jpeg;
}

static void check_scans(j_common_ptr jpeg)
{
    JpegJob *job = (JpegJob *)jpeg->err;
    if (job->jpeg.input_scan_number <= JPEG_SCANS_MAX)
        return;
    snprintf(job->message, sizeof job->message, "it has more than %d scans", JPEG_SCANS_MAX);
    longjmp(job->failed, 1);
}

/* Read it all; false when libjpeg gave up. */
static bool run(JpegJob *job, const Bytes *bytes)
{
    struct jpeg_decompress_struct *jpeg = &job->jpeg;
    if (setjmp(job->failed))
        return false;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &job->progress;
    jpeg_mem_src(jpeg, bytes->at, (unsigned long)bytes->size);
    jpeg_read_header(jpeg, TRUE);
    if (jpeg->jpeg_color_space != JCS_GRAYSCALE)
        jpeg->out_color_space = JCS_RGB;
    job->status = bitmap_begin(job->diag, job->path, job->out, jpeg->image_width,
                               jpeg->image_height, jpeg->jpeg_color_space == JCS_GRAYSCALE ? 1 : 3,
                               8, bytes->size, JPEG_RATIO_MAX);
    if (job->status != OK)
        return true;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height) {
        JSAMPROW row = (uint8_t *)job->out->samples + (size_t)jpeg->output_scanline *
                                                          (size_t)job->out->width *
                                                          (size_t)job->out->channels;
        jpeg_read_scanlines(jpeg, &row, 1);
    }
    return true;
}

Status bitmap_read_jpeg(Diag *diag, const char *path, Bitmap *out)
{
    Bytes bytes;
    Arena *arena = arena_new();
    if (!arena)
        return diag_no_memory(diag, path);
    JpegJob job = {.diag = diag, .path = path, .out = out};
    job.jpeg.err = jpeg_std_error(&job.errors);
    job.errors.error_exit = fail_job;
    job.errors.output_message = say_nothing;
    job.progress.progress_monitor = check_scans;
    Status status = bytes_open(diag, path, arena, &bytes);
    if (status == OK)
        status = run(&job, &bytes) ? job.status : bitmap_refuse(diag, path, job.message);
    /* libjpeg fills in what a file that ends too early lacks, and warns. */
    if (status == OK && job.errors.num_warnings > 0)
        status = bitmap_refuse(diag, path, "the file is broken or ends too early");
    jpeg_destroy_decompress(&job.jpeg);
    arena_free(arena);
    return status;
}
