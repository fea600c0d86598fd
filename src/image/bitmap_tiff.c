/* TIFF, through libtiff: grey, RGB and palettes of 8 and 16 bits as they are, all else as the
 * library's own RGBA of 8 bits.  SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

#include "base/file.h"
#include "base/mem.h"

#include <stdio.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

enum {
    TIFF_RATIO_MAX = 4096,         /* what an empty picture may be packed by */
    TIFF_BLOCK_BYTES_MAX = 1 << 28 /* libtiff may ask for at a time */
};

typedef struct TiffJob {
    Diag *diag;
    const char *path;
    TIFF *tiff;
    size_t bytes;
    char message[160]; /* libtiff's first complaint */
} TiffJob;

static int keep_message(TIFF *tiff, void *data, const char *module, const char *format,
                        va_list args)
{
    TiffJob *job = data;
    (void)tiff, (void)module;
    if (!job->message[0])
        vsnprintf(job->message, sizeof job->message, format, args);
    return 1;
}

static int drop_message(TIFF *tiff, void *data, const char *module, const char *format,
                        va_list args)
{
    (void)tiff, (void)data, (void)module, (void)format, (void)args;
    return 1;
}

static Status refuse(TiffJob *job)
{
    return bitmap_refuse(job->diag, job->path,
                         job->message[0] ? job->message : "it is no TIFF file that can be read");
}

/* What is known of a file before its pixels are read. */
typedef struct TiffForm {
    uint32_t width, height;
    uint16_t bits, channels, photometric, planar, format, orientation;
} TiffForm;

static TiffForm form_of(TIFF *tiff)
{
    TiffForm f = {.photometric = PHOTOMETRIC_RGB};
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &f.width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &f.height);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &f.photometric);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &f.bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &f.channels);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &f.planar);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &f.format);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &f.orientation);
    return f;
}

/* Can the rows be taken as they are? */
static bool is_plain(TIFF *tiff, const TiffForm *f)
{
    bool is_color = f->photometric == PHOTOMETRIC_RGB && (f->channels == 3 || f->channels == 4);
    bool is_grey = f->photometric == PHOTOMETRIC_MINISBLACK && f->channels <= 2;
    bool is_indexed = f->photometric == PHOTOMETRIC_PALETTE && f->channels == 1 && f->bits == 8;
    return (is_color || is_grey || is_indexed) && (f->bits == 8 || f->bits == 16) &&
           f->format == SAMPLEFORMAT_UINT && f->planar == PLANARCONFIG_CONTIG &&
           f->orientation == ORIENTATION_TOPLEFT && !TIFFIsTiled(tiff);
}

static void take_palette(TIFF *tiff, Bitmap *out)
{
    uint16_t *red, *green, *blue;
    out->is_indexed = true;
    if (!TIFFGetField(tiff, TIFFTAG_COLORMAP, &red, &green, &blue))
        return;
    for (int i = 0; i < PALETTE_MAX; i++) {
        const uint8_t entry[4] = {(uint8_t)(red[i] >> 8), (uint8_t)(green[i] >> 8),
                                  (uint8_t)(blue[i] >> 8), 255};
        memcpy(out->palette[i], entry, sizeof entry);
    }
}

static Status read_plain(TiffJob *job, const TiffForm *f, Bitmap *out)
{
    TRY(bitmap_begin(job->diag, job->path, out, f->width, f->height, f->channels, f->bits,
                     job->bytes, TIFF_RATIO_MAX));
    size_t row_bytes = (size_t)f->width * f->channels * f->bits / 8;
    if ((size_t)TIFFScanlineSize(job->tiff) != row_bytes)
        return refuse(job);
    for (uint32_t y = 0; y < f->height; y++)
        if (TIFFReadScanline(job->tiff, (uint8_t *)out->samples + y * row_bytes, y, 0) != 1)
            return refuse(job);
    if (f->photometric == PHOTOMETRIC_PALETTE)
        take_palette(job->tiff, out);
    return OK;
}

static Status read_any(TiffJob *job, const TiffForm *f, Bitmap *out)
{
    TRY(bitmap_begin(job->diag, job->path, out, f->width, f->height, 4, 8, job->bytes,
                     4 * TIFF_RATIO_MAX));
    size_t count = (size_t)f->width * f->height;
    uint32_t *pixels = mem_array(count, sizeof *pixels);
    if (!pixels)
        return diag_no_memory(job->diag, job->path);
    bool is_read = TIFFReadRGBAImageOriented(job->tiff, f->width, f->height, pixels,
                                             ORIENTATION_TOPLEFT, 1) == 1;
    uint8_t *to = out->samples;
    for (size_t i = 0; is_read && i < count; i++) {
        *to++ = (uint8_t)TIFFGetR(pixels[i]);
        *to++ = (uint8_t)TIFFGetG(pixels[i]);
        *to++ = (uint8_t)TIFFGetB(pixels[i]);
        *to++ = (uint8_t)TIFFGetA(pixels[i]);
    }
    mem_free(pixels);
    return is_read ? OK : refuse(job);
}

static Status read_file(TiffJob *job, Bitmap *out)
{
    TiffForm form = form_of(job->tiff);
    if (form.width == 0 || form.height == 0)
        return refuse(job);
    return is_plain(job->tiff, &form) ? read_plain(job, &form, out) : read_any(job, &form, out);
}

Status bitmap_read_tiff(Diag *diag, const char *path, Bitmap *out)
{
    int fd;
    TiffJob job = {.diag = diag, .path = path};
    TRY(file_open_input(diag, path, &fd, &job.bytes));
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options) {
        close(fd);
        return diag_no_memory(diag, path);
    }
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, TIFF_BLOCK_BYTES_MAX);
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &job);
    TIFFOpenOptionsSetWarningHandlerExtR(options, drop_message, NULL);
    job.tiff = TIFFFdOpenExt(fd, path, "r", options);
    TIFFOpenOptionsFree(options);
    Status status = job.tiff ? read_file(&job, out) : refuse(&job);
    if (job.tiff)
        TIFFClose(job.tiff); /* closes fd */
    else
        close(fd);
    return status;
}
