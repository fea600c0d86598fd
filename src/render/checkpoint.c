/* The state of a progressive render on disk.
 *
 * A header of fixed size, the settings as text, a checksum of both, the sums of the two halves, the
 * plan, and a checksum of everything; in the byte order of the machine.  SPDX-License-Identifier:
 * Apache-2.0
 */
#include "render/checkpoint.h"

#include "base/file.h"
#include "base/hash.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char MAGIC[8] = "PMSSTATE";

enum { BYTE_ORDER_MARK = 0x01020304, FORMAT_VERSION = 4 };

typedef struct Header {
    char magic[8];
    uint32_t byte_order, version;
    uint64_t settings_size;            /* bytes */
    uint64_t value_count, pixel_count; /* of a half */
    uint64_t passes, planned;          /* so far, and until the next plan */
    uint64_t shared_rays, eye_rays;
    double caustic_radius, global_radius, volume_radius; /* of the first pass */
} Header;

static_assert(sizeof(Header) == 96, "the header has no holes");

/* --- settings ------------------------------------------------------------------------------- */

static void add_line(char settings[CHECKPOINT_SETTINGS_MAX], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void add_line(char settings[CHECKPOINT_SETTINGS_MAX], const char *format, ...)
{
    size_t used = strlen(settings);
    va_list args;
    va_start(args, format);
    vsnprintf(settings + used, CHECKPOINT_SETTINGS_MAX - used, format, args);
    va_end(args);
}

static void add_layers(char settings[CHECKPOINT_SETTINGS_MAX], unsigned layers)
{
    add_line(settings, "layers");
    for (unsigned bit = 1; bit <= layers; bit <<= 1)
        if (layers & bit)
            add_line(settings, "%c%s", layers & (bit - 1) ? ',' : ' ', film_layer_name(bit));
    add_line(settings, layers ? "\n" : " none\n");
}

/* The effects that are forced. */
static void add_effects(char settings[CHECKPOINT_SETTINGS_MAX], const PlanOptions *plan)
{
    const char *before = " ";
    add_line(settings, "effects");
    for (int i = 0; i < FEATURE_COUNT; i++) {
        if (plan->effects[i] == TRI_UNSET)
            continue;
        add_line(settings, "%s%s=%s", before, feature_name((FeatureId)i),
                 plan->effects[i] == TRI_ON ? "on" : "off");
        before = ",";
    }
    add_line(settings, *before == ' ' ? " as_planned\n" : "\n");
}

void checkpoint_describe(const Scene *scene, const RenderOptions *options,
                         char settings[CHECKPOINT_SETTINGS_MAX])
{
    static const char *const methods[] = {[INDIRECT_ANY] = "any",
                                          [INDIRECT_CACHE] = "cache",
                                          [INDIRECT_GATHER] = "gather",
                                          [INDIRECT_MAP] = "map"};
    const PlanOptions *plan = &options->plan;
    settings[0] = 0;
    add_line(settings, "pms %s\n", PMS_VERSION);
    add_line(settings, "scene_text #%016llx\n", (unsigned long long)scene->text_hash);
    add_line(settings, "declarations #%016llx\n", (unsigned long long)scene->declare_hash);
    add_line(settings, "size %dx%d\n", options->width, options->height);
    add_line(settings, "seed %llu\n", (unsigned long long)options->seed);
    add_line(settings, "samples_a_pass %d\n", options->samples);
    add_layers(settings, options->layers);
    add_line(settings, "alpha %s\n", options->has_alpha ? "on" : "off");
    add_line(settings, "integrator %s\n", plan->integrator == INTEGRATOR_PATH ? "path" : "photons");
    add_line(settings, "light_radius %.17g\n", plan->light_radius);
    add_line(settings, "gi %s\n", plan->has_indirect ? "on" : "off");
    add_line(settings, "gi_method %s\n", methods[plan->indirect]);
    add_effects(settings, plan);
    add_line(settings, "quality %d\n", plan->quality);
}

typedef struct Line {
    const char *name, *value;
    int name_length, value_length;
} Line;

/* Take the next line off a text; false: there is none. */
static bool next_line(const char **text, Line *out)
{
    size_t length = strcspn(*text, "\n"), name = strcspn(*text, " \n");
    if (length == 0)
        return false;
    size_t value = name < length ? name + 1 : length;
    *out = (Line){*text, *text + value, (int)name, (int)(length - value)};
    *text += length + ((*text)[length] == '\n');
    return true;
}

static bool is_same(const char *a, int a_length, const char *b, int b_length)
{
    return a_length == b_length && memcmp(a, b, (size_t)a_length) == 0;
}

void checkpoint_difference(const char *there, const char *here, char *out, size_t size)
{
    Line a, b;
    size_t used = 0;
    out[0] = 0;
    while (used < size && next_line(&there, &a) && next_line(&here, &b)) {
        if (!is_same(a.name, a.name_length, b.name, b.name_length)) {
            snprintf(out, size, "other settings, by another version of pms");
            return;
        }
        if (is_same(a.value, a.value_length, b.value, b.value_length))
            continue;
        const char *comma = used ? ", " : "";
        int wrote =
            a.value[0] == '#'
                ? snprintf(out + used, size - used, "%s%.*s changed", comma, a.name_length, a.name)
                : snprintf(out + used, size - used, "%s%.*s %.*s, not %.*s", comma, a.name_length,
                           a.name, a.value_length, a.value, b.value_length, b.value);
        used += (size_t)wrote;
    }
    if (used == 0)
        snprintf(out, size, "other settings, by another version of pms");
}

/* --- writing -------------------------------------------------------------------------------- */

/* A file and the hash of what went through it. */
typedef struct Stream {
    FILE *file;
    uint64_t hash;
    bool is_good;
} Stream;

static void put(Stream *out, const void *bytes, size_t size)
{
    out->is_good = out->is_good && fwrite(bytes, 1, size, out->file) == size;
    out->hash = hash_bytes(out->hash, bytes, size);
}

static void put_hash(Stream *out)
{
    uint64_t hash = out->hash;
    put(out, &hash, sizeof hash);
}

static void put_sum(Stream *out, const FilmSum *sum)
{
    put(out, sum->values, sum->count * sizeof *sum->values);
    put(out, sum->taken, sum->pixels * sizeof *sum->taken);
    put(out, sum->good, sum->pixels * sizeof *sum->good);
}

static void put_state(Stream *out, const char *settings, const SeriesState *state)
{
    const FilmSum *halves = state->halves;
    Header header = {.byte_order = BYTE_ORDER_MARK,
                     .version = FORMAT_VERSION,
                     .settings_size = strlen(settings),
                     .value_count = halves->count,
                     .pixel_count = halves->pixels,
                     .passes = series_passes(state),
                     .planned = state->steering.until,
                     .shared_rays = state->shared_rays,
                     .eye_rays = state->eye_rays,
                     .caustic_radius = state->first.caustic,
                     .global_radius = state->first.global,
                     .volume_radius = state->first.volume};
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    put(out, &header, sizeof header);
    put(out, settings, header.settings_size);
    put_hash(out);
    for (int i = 0; i < 2; i++)
        put_sum(out, &halves[i]);
    put(out, state->steering.rate, halves->pixels * sizeof *state->steering.rate);
    put_hash(out);
}

Status checkpoint_write(Diag *diag, const char *path, const char *settings,
                        const SeriesState *state)
{
    OutFile out;
    TRY(out_begin(diag, path, &out));
    Stream stream = {.file = fopen(out.temp_path, "wb")};
    stream.is_good = stream.file != NULL;
    if (stream.file) {
        put_state(&stream, settings, state);
        int error = stream.is_good ? 0 : errno;
        stream.is_good = fclose(stream.file) == 0 && stream.is_good;
        errno = error ? error : errno;
    }
    if (stream.is_good)
        return out_commit(diag, &out);
    int error = errno;
    out_discard(&out);
    return diag_fail(diag, ERR_FILE, "cannot write '%s': %s", path, strerror(error));
}

/* --- reading -------------------------------------------------------------------------------- */

typedef struct Reader {
    Diag *diag;
    const char *path;
    Stream in;
    size_t size; /* of the file, bytes */
    Header header;
    char settings[CHECKPOINT_SETTINGS_MAX];
} Reader;

static void get(Stream *in, void *bytes, size_t size)
{
    in->is_good = in->is_good && fread(bytes, 1, size, in->file) == size;
    if (in->is_good)
        in->hash = hash_bytes(in->hash, bytes, size);
}

/* Read a checksum; returns false if it is not that of what was read before it. */
static bool get_hash(Stream *in)
{
    uint64_t hash = in->hash, there = 0;
    get(in, &there, sizeof there);
    return in->is_good && there == hash;
}

static Status damaged(const Reader *r)
{
    return diag_fail(r->diag, ERR_FILE,
                     "'%s' is damaged, its checksum is wrong: it cannot be resumed from", r->path);
}

static Status senseless(const Reader *r, const char *what)
{
    return diag_fail(r->diag, ERR_FILE, "'%s' is damaged, it holds %s: it cannot be resumed from",
                     r->path, what);
}

static Status cut_short(const Reader *r, size_t wanted)
{
    return diag_fail(r->diag, ERR_FILE,
                     "'%s' is cut short, %zu bytes of %zu: it cannot be resumed from", r->path,
                     r->size, wanted);
}

static Status read_header(Reader *r)
{
    Header *header = &r->header;
    get(&r->in, header, r->size < sizeof *header ? r->size : sizeof *header);
    size_t magic = r->size < sizeof MAGIC ? r->size : sizeof MAGIC;
    if (!r->in.is_good || memcmp(header->magic, MAGIC, magic) != 0)
        return diag_fail(r->diag, ERR_FILE, "'%s' is not the state of a progressive render",
                         r->path);
    if (r->size < sizeof *header)
        return cut_short(r, sizeof *header);
    if (header->byte_order != BYTE_ORDER_MARK || header->version != FORMAT_VERSION)
        return diag_fail(r->diag, ERR_FILE,
                         "'%s' was written by another version of pms or another kind of machine",
                         r->path);
    return OK;
}

/* Read header and settings, and compare the file's size with what they say. */
static Status read_head(Reader *r)
{
    const Header *header = &r->header;
    TRY(read_header(r));
    if (header->settings_size >= sizeof r->settings || header->value_count > SIZE_MAX / 64 ||
        header->pixel_count > header->value_count || header->passes > UINT32_MAX)
        return damaged(r);
    size_t wanted =
        sizeof *header + header->settings_size + 2 * sizeof(uint64_t) +
        2 * (header->value_count * sizeof(double) + 2 * header->pixel_count * sizeof(uint32_t)) +
        header->pixel_count * sizeof(float);
    get(&r->in, r->settings, header->settings_size);
    if (!get_hash(&r->in))
        return r->size < wanted ? cut_short(r, wanted) : damaged(r);
    if (r->size < wanted)
        return cut_short(r, wanted);
    return r->size > wanted ? damaged(r) : OK;
}

static Status check_settings(const Reader *r, const char *settings, const SeriesState *state)
{
    const FilmSum *halves = state->halves;
    char difference[2 * CHECKPOINT_SETTINGS_MAX];
    if (strcmp(settings, r->settings) == 0)
        return r->header.value_count == halves->count && r->header.pixel_count == halves->pixels
                   ? OK
                   : damaged(r);
    checkpoint_difference(r->settings, settings, difference, sizeof difference);
    return diag_fail(r->diag, ERR_USAGE,
                     "'%s' is of another picture: %s; without --resume it is begun anew", r->path,
                     difference);
}

static void get_sum(Stream *in, FilmSum *sum)
{
    get(in, sum->values, sum->count * sizeof *sum->values);
    get(in, sum->taken, sum->pixels * sizeof *sum->taken);
    get(in, sum->good, sum->pixels * sizeof *sum->good);
}

static bool is_radius(double radius)
{
    return isfinite(radius) && radius >= 0;
}

/* Samples that are not numbers are not in the sums, and none is taken twice.  What errors are
 * found from may have no number. */
static Status check_sum(const Reader *r, const FilmSum *sum)
{
    for (size_t i = 0; i < sum->clues; i++)
        if (isnan(sum->values[i]))
            return senseless(r, "sums that are no numbers");
    for (size_t i = 0; i < sum->pixels; i++)
        if (sum->good[i] > sum->taken[i])
            return senseless(r, "more usable samples than were taken");
    return OK;
}

/* A checksum says that the values are those that were written, not that they make sense. */
static Status check_state(const Reader *r, const SeriesState *state)
{
    const Header *header = &r->header;
    if (!is_radius(header->caustic_radius) || !is_radius(header->global_radius) ||
        !is_radius(header->volume_radius))
        return senseless(r, "a gather radius that is none");
    if (header->planned > 2 * header->passes + STEERING_FIRST_PLAN)
        return senseless(r, "a plan for more passes than one is made for");
    for (size_t i = 0; i < state->steering.pixels; i++)
        if (!(state->steering.rate[i] >= 0 && state->steering.rate[i] <= UINT16_MAX))
            return senseless(r, "a rate of samples that no pass has");
    TRY(check_sum(r, &state->halves[0]));
    return check_sum(r, &state->halves[1]);
}

static Status read_state(Reader *r, const char *settings, SeriesState *state)
{
    TRY(read_head(r));
    TRY(check_settings(r, settings, state));
    for (int i = 0; i < 2; i++)
        get_sum(&r->in, &state->halves[i]);
    get(&r->in, state->steering.rate, state->halves->pixels * sizeof *state->steering.rate);
    return get_hash(&r->in) ? check_state(r, state) : damaged(r);
}

Status checkpoint_read(Diag *diag, const char *path, const char *settings, SeriesState *state,
                       bool *is_there)
{
    int fd;
    struct stat info;
    Reader r = {.diag = diag, .path = path};
    *is_there = stat(path, &info) == 0 || errno != ENOENT;
    if (!*is_there)
        return OK;
    TRY(file_open_input(diag, path, &fd, &r.size));
    r.in = (Stream){.file = fdopen(fd, "rb"), .is_good = true};
    if (!r.in.file) {
        close(fd);
        return diag_no_memory(diag, path);
    }
    Status status = read_state(&r, settings, state);
    fclose(r.in.file);
    if (status != OK)
        return status;
    const Header *header = &r.header;
    state->first =
        (PassRadii){header->caustic_radius, header->global_radius, header->volume_radius};
    /* The first half is a pass ahead when their number is odd. */
    state->halves[0].passes = (header->passes + 1) / 2;
    state->halves[1].passes = header->passes / 2;
    state->steering.until = header->planned;
    state->shared_rays = header->shared_rays;
    state->eye_rays = header->eye_rays;
    return OK;
}
