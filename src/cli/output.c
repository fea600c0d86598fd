/* From a rendered image to files: OpenEXR, and PNG through OpenColorIO.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/work.h"
#include "image/exr.h"
#include "image/ocio.h"
#include "image/png_file.h"

#include <string.h>
#include <strings.h>

typedef enum FileKind { FILE_UNKNOWN, FILE_EXR, FILE_PNG } FileKind;

static FileKind kind_of(const char *path)
{
    const char *extension = path_extension(path);
    if (strcasecmp(extension, "exr") == 0)
        return FILE_EXR;
    return strcasecmp(extension, "png") == 0 ? FILE_PNG : FILE_UNKNOWN;
}

enum { META_MAX = 16, META_TEXT = 2048, OUTPUTS_MAX = 64 };

/* The header fields, with room for their texts. */
typedef struct Header {
    MetaItem items[META_MAX];
    char texts[META_MAX][META_TEXT];
    Meta meta;
} Header;

static void header_add(Header *header, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void header_add(Header *header, const char *name, const char *format, ...)
{
    if (header->meta.count >= META_MAX)
        return;
    char *text = header->texts[header->meta.count];
    va_list list;
    va_start(list, format);
    vsnprintf(text, META_TEXT, format, list);
    va_end(list);
    header->items[header->meta.count++] = (MetaItem){name, text};
    header->meta.items = header->items;
}

static void header_fill(Header *header, const Args *args, const Scene *scene,
                        const RenderResult *result)
{
    char line[META_TEXT] = "";
    size_t length = 0;
    for (int i = 0; i < args->argc && length < sizeof line; i++)
        length += (size_t)snprintf(line + length, sizeof line - length, "%s%s", i ? " " : "",
                                   args->argv[i]);
    header_add(header, "software", "pms %s", PMS_VERSION);
    header_add(header, "pms.scene", "%s", scene->path);
    header_add(header, "pms.command", "%s", line);
    header_add(header, "pms.seed", "%s", args->value[OPT_SEED] ? args->value[OPT_SEED] : "0");
    header_add(header, "pms.integrator",
               plan_has(&result->plan, FEATURE_PATHS) ? "path, light_radius %.17g" : "photons",
               result->plan.light_radius);
    header_add(header, "pms.photons", "caustic %llu, global %llu, volume %llu",
               (unsigned long long)result->stats.count[STAT_PHOTONS_CAUSTIC],
               (unsigned long long)result->stats.count[STAT_PHOTONS_GLOBAL],
               (unsigned long long)result->stats.count[STAT_PHOTONS_VOLUME]);
    if (result->passes)
        header_add(
            header, "pms.passes", "%llu; gather radius caustic %.9g to %.9g, global %.9g to %.9g",
            (unsigned long long)result->passes, result->first_radii.caustic,
            result->last_radii.caustic, result->first_radii.global, result->last_radii.global);
    if (result->error.is_known)
        header_add(header, "pms.error",
                   "95 %% of the pixels within %.3g %% of their luminance, with 90 %% confidence "
                   "within %.3g %%; noise alone %.3g %%, bias alone %.3g %%",
                   100 * result->error.whole, 100 * result->error.bound, 100 * result->error.noise,
                   100 * result->error.bias);
    header_add(header, "pms.settings",
               "assumed_gamma %g, max_trace_level %d, adc_bailout %g, gather %d %d",
               scene->settings.assumed_gamma, scene->settings.max_trace_level,
               scene->settings.adc_bailout, scene->settings.photons.gather_min,
               scene->settings.photons.gather_max);
    char seconds[META_TEXT] = "";
    length = 0;
    for (int i = 0; i < PHASE_COUNT; i++)
        length += (size_t)snprintf(seconds + length, sizeof seconds - length, "%s%s %.3f",
                                   i ? ", " : "", phase_name((PhaseId)i), result->stats.seconds[i]);
    header_add(header, "pms.seconds", "%s", seconds);
}

/* Colours are stored with alpha multiplied in; PNG wants them without. */
static void unpremultiply(float *pixels, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        float *p = pixels + 4 * i;
        for (int c = 0; c < 3 && p[3] > 0; c++)
            p[c] /= p[3];
    }
}

static void drop_alpha(float *pixels, size_t count)
{
    for (size_t i = 0; i < count; i++)
        memmove(pixels + 3 * i, pixels + 4 * i, 3 * sizeof(float));
}

static Status show(const Args *args, float *pixels, size_t count, int channels, bool *is_srgb)
{
    Ocio *ocio;
    TRY(ocio_new(args->diag, args->value[OPT_OCIO], &ocio));
    const char *display = args->value[OPT_DISPLAY], *view = args->value[OPT_VIEW];
    Status status = ocio_apply(args->diag, ocio, display, view, pixels, count, channels);
    *is_srgb = status == OK && ocio_is_srgb(ocio, display, view);
    ocio_free(ocio);
    return status;
}

static Status png_bits(const Args *args, long *out)
{
    TRY(args_int(args, OPT_BITS, 8, 16, 8, out));
    if (*out != 8 && *out != 16)
        return diag_fail(args->diag, ERR_USAGE, "--bits wants 8 or 16, got %ld", *out);
    return OK;
}

static Status write_png(const Args *args, const Image *image, const char *path, const Meta *meta)
{
    long bits;
    TRY(png_bits(args, &bits));
    size_t count = (size_t)image->width * (size_t)image->height;
    float *pixels = mem_array(count, 4 * sizeof(float));
    if (!pixels)
        return diag_no_memory(args->diag, path);
    memcpy(pixels, image->layers[0].pixels, count * 4 * sizeof(float));
    int channels = args_has(args, OPT_ALPHA) ? 4 : 3;
    if (channels == 4)
        unpremultiply(pixels, count);
    else
        drop_alpha(pixels, count);
    bool is_srgb = false;
    Status status = show(args, pixels, count, channels, &is_srgb);
    if (status == OK)
        status = png_write(args->diag, path, image->width, image->height, channels, pixels,
                           (int)bits, is_srgb, meta);
    mem_free(pixels);
    return status;
}

static Status write_exr(const Args *args, const Image *image, const char *path, const Meta *meta)
{
    long threads;
    TRY(args_int(args, OPT_THREADS, 1, WORK_THREADS_MAX, work_thread_count(), &threads));
    ExrOptions options = {.is_half = args_has(args, OPT_HALF), .threads = (int)threads};
    return exr_write(args->diag, path, image, meta, options);
}

Status output_write(const Args *args, const Scene *scene, RenderResult *result,
                    const char *const *paths, int path_count)
{
    Header *header = mem_alloc(sizeof *header);
    if (!header)
        return diag_no_memory(args->diag, "the image header");
    header_fill(header, args, scene, result);
    Status status = OK;
    for (int i = 0; i < path_count && status == OK; i++) {
        if (kind_of(paths[i]) == FILE_EXR)
            status = write_exr(args, &result->image, paths[i], &header->meta);
        else
            status = write_png(args, &result->image, paths[i], &header->meta);
    }
    mem_free(header);
    return status;
}

Status output_can_write(const Args *args, const char *path)
{
    OutFile out;
    TRY(out_begin(args->diag, path, &out));
    out_discard(&out);
    return OK;
}

/* The options of PNG files, tried on one pixel. */
static Status can_show(const Args *args)
{
    long bits;
    bool is_srgb;
    float pixel[3] = {0};
    TRY(png_bits(args, &bits));
    return show(args, pixel, 1, 3, &is_srgb);
}

/* Fail if two of the files that are to be written are one, or one of them is the scene: nobody
 * wants only the last one. */
static Status all_are_apart(const Args *args, const char *const *paths, int path_count)
{
    const char *all[OUTPUTS_MAX + 3];
    int count = 0;
    for (int i = 0; i < path_count && count < OUTPUTS_MAX; i++)
        all[count++] = paths[i];
    const char *others[] = {args->value[OPT_STATS], args->value[OPT_ERROR_MAP]};
    for (int i = 0; i < 2; i++)
        if (others[i] && strcmp(others[i], "-") != 0)
            all[count++] = others[i];
    for (int i = 0; i < args->operand_count; i++)
        for (int k = 0; k < count; k++)
            if (file_is_same(args->operands[i], all[k]))
                return diag_fail(args->diag, ERR_USAGE, "'%s' would replace the scene", all[k]);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            if (file_is_same(all[i], all[k]))
                return diag_fail(args->diag, ERR_USAGE,
                                 "two things are to be written to '%s': give each a name", all[i]);
    return OK;
}

Status output_preflight(const Args *args, const char *const *paths, int path_count)
{
    const char *stats = args->value[OPT_STATS];
    bool has_kind[FILE_PNG + 1] = {false};
    TRY(all_are_apart(args, paths, path_count));
    for (int i = 0; i < path_count; i++) {
        FileKind kind = kind_of(paths[i]);
        if (kind == FILE_UNKNOWN)
            return diag_fail(args->diag, ERR_USAGE,
                             "cannot tell the format of '%s': it should end in .exr or .png",
                             paths[i]);
        has_kind[kind] = true;
        TRY(output_can_write(args, paths[i]));
    }
    if (stats && strcmp(stats, "-") != 0)
        TRY(output_can_write(args, stats));
    if (args_has(args, OPT_LAYERS) && !has_kind[FILE_EXR])
        diag_warn(args->diag, WARN_FILE, SPAN_NONE,
                  "--layers go into EXR files only, and no EXR file is to be written");
    return has_kind[FILE_PNG] ? can_show(args) : OK;
}
