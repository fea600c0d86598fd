/* Progressive rendering: the mean of many passes, each with its own photons and samples.
 *
 * A pass is right on average but for the blur of its gather radius r.  From pass i to the next one
 * r^2 is multiplied by (i + a) / (i + 1), so that it falls as i^(a-1).  The variance of a pass goes
 * as 1/r^2, that of the mean of n passes as the sum of 1/r^2 over n^2, which is n^-a; the blur goes
 * as r^2, and its mean as n^(a-1).  Square of the blur and variance fall alike with 2 (1 - a) = a:
 * a is 2/3, and the error squared falls as n^(-2/3).  Photons in media are disks across the rays
 * that find them, so the same holds for them.  No statistics are kept at the points that are
 * looked at, so passes need not look at the same ones: each samples pixels and lenses anew.
 *
 * Every other pass belongs to one of two halves of the picture that have nothing random in common;
 * how they differ tells how wrong the picture is (error_map.h).
 *
 * Everything random is a function of seed and pass, and sums are kept in double precision between
 * runs: a picture is the same bits however its passes are spread over runs and threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/progressive.h"

#include "base/rng.h"
#include "base/work.h"
#include "base/mem.h"
#include "render/checkpoint.h"
#include "render/error_map.h"
#include "render/film_sum.h"
#include "render/pass.h"

/* Names the seeds of the photons of passes, and of the samples of halves. */
enum { SERIES_RNG = 0x736572, HALF_RNG = 0x68616c };

/* a, see above. */
#define SERIES_ALPHA (2.0 / 3)

/* From this pass on the product of the factors is had in closed form. */
enum { SERIES_FAR = 4096 };

/* The picture so far is shown after passes 1, 2, 4, 8 ... and when it has not been for so long, or
 * so many times as long as showing it takes. */
#define SHOW_SECONDS 5
#define SHOW_COSTS 20

typedef struct Series {
    const Tracer *tracer;
    const RenderOptions *asked;
    RenderOptions options; /* as asked, but for how pixels are sampled and progress goes */
    Diag *diag;
    RenderResult *out;
    Film film; /* of a pass */
    FilmSum halves[2];
    Film shown; /* the picture, of layers that were asked for */
    ErrorMap errors;
    PassRadii first;                /* gather radii of the first pass */
    uint64_t passes_asked;          /* stop after so many */
    double started, passes_started; /* seconds of clock_wall */
    double last_shown, show_cost;
    uint64_t last_shown_pass;
    char settings[CHECKPOINT_SETTINGS_MAX];
} Series;

/* --- radii ---------------------------------------------------------------------------------- */

/* The product of (i + a) / (i + 1) goes as v^(a-1) (1 - a (1-a) (2-a) / (24 v^2) + ...), where
 * v = pass + a/2; the next term is below the rounding from SERIES_FAR on. */
static double far_product(uint64_t pass)
{
    const double a = SERIES_ALPHA;
    double v = (double)pass + a / 2;
    return pow(v, a - 1) * exp(-a * (1 - a) * (2 - a) / (24 * v * v));
}

double progressive_shrink(uint64_t pass)
{
    double shrink2 = 1;
    for (uint64_t i = 1; i < pass && i < SERIES_FAR; i++)
        shrink2 *= ((double)i + SERIES_ALPHA) / ((double)i + 1);
    if (pass > SERIES_FAR)
        shrink2 *= far_product(pass) / far_product(SERIES_FAR);
    return sqrt(shrink2);
}

static uint64_t passes_done(const Series *s)
{
    return s->halves[0].passes + s->halves[1].passes;
}

static PassRadii scaled(PassRadii radii, double factor)
{
    return (PassRadii){radii.caustic * factor, radii.global * factor, radii.volume * factor};
}

/* --- progress ------------------------------------------------------------------------------- */

/* Return the seconds until the last pass is done, or a negative number. */
static double seconds_left(const Series *s, double pass_fraction)
{
    const ProgressiveOptions *progressive = &s->asked->progressive;
    double now = clock_wall(), done = (double)s->out->new_passes + pass_fraction;
    double left = INFINITY;
    if (progressive->passes && done > 0.01) {
        double to_do = (double)(s->passes_asked - passes_done(s)) - pass_fraction;
        left = (now - s->passes_started) / done * to_do;
    }
    if (progressive->seconds > 0)
        left = fmin(left, fmax(0, s->started + progressive->seconds - now));
    return isfinite(left) ? left : -1;
}

/* Photons and samples are taken to be half of a pass each. */
static void report_pass(void *ctx, const RenderProgress *of_pass)
{
    Series *s = ctx;
    RenderProgress progress = *of_pass;
    bool is_eye = of_pass->phase[0] == 'e' && pass_needs_photons(tracer_plan(s->tracer));
    double fraction = of_pass->fraction;
    if (pass_needs_photons(tracer_plan(s->tracer)))
        fraction = fraction / 2 + (is_eye ? 0.5 : 0);
    progress.pass = passes_done(s) + 1;
    progress.passes = s->asked->progressive.passes;
    progress.seconds_left = seconds_left(s, fraction);
    s->asked->progress(s->asked->progress_ctx, &progress);
}

/* --- showing and keeping what is there ------------------------------------------------------ */

static Status keep_state(Series *s)
{
    const char *path = s->asked->progressive.state_path;
    return path ? checkpoint_write(s->diag, path, s->settings, &s->first, s->halves) : OK;
}

/* Make the picture of the passes done. */
static Status make_picture(Series *s)
{
    const SceneSettings *settings = &tracer_scene(s->tracer)->settings;
    Image *picture = &s->shown.image;
    film_sum_mean(s->halves, 2, picture);
    film_linearize(picture, settings);
    s->out->passes = passes_done(s);
    s->out->first_radii = s->first;
    if (s->halves[1].passes == 0)
        return OK;
    error_map_of_halves(s->halves, &s->film, settings, &s->errors);
    return error_map_show(&s->errors, picture, s->asked, s->diag, s->out);
}

static Status show(Series *s)
{
    const ProgressiveOptions *progressive = &s->asked->progressive;
    double begun = clock_wall();
    TRY(keep_state(s));
    if (progressive->show) {
        TRY(make_picture(s));
        s->out->image = s->shown.image;
        Status status = progressive->show(progressive->show_ctx, s->out);
        s->out->image = (Image){0};
        TRY(status);
    }
    s->last_shown = clock_wall();
    s->show_cost = s->last_shown - begun;
    s->last_shown_pass = passes_done(s);
    return OK;
}

static bool is_due(const Series *s)
{
    bool is_power_of_2 = (passes_done(s) & (passes_done(s) - 1)) == 0;
    double pause = fmax(SHOW_SECONDS, SHOW_COSTS * s->show_cost);
    return is_power_of_2 || clock_wall() - s->last_shown >= pause;
}

/* Show if it is time.  A disk that is full now may have room later: only the first failure of a
 * run is one, since then nothing is lost. */
static Status show_if_due(Series *s)
{
    if (!is_due(s))
        return OK;
    Status status = show(s);
    if (status != ERR_FILE || s->out->new_passes == 1)
        return status;
    diag_warn(s->diag, WARN_FILE, SPAN_NONE,
              "the picture after pass %llu was not kept; rendering goes on",
              (unsigned long long)passes_done(s));
    s->last_shown = clock_wall();
    return OK;
}

/* --- passes --------------------------------------------------------------------------------- */

static bool is_over(const Series *s)
{
    const ProgressiveOptions *progressive = &s->asked->progressive;
    if (work_ending || passes_done(s) >= s->passes_asked)
        return true;
    if (!(progressive->seconds > 0) || s->out->new_passes == 0)
        return false;
    double now = clock_wall(), a_pass = (now - s->passes_started) / (double)s->out->new_passes;
    return now + a_pass - s->started > progressive->seconds;
}

/* The seed of what the eye draws at random in a half: its samples are those of a series of their
 * own. */
static uint64_t half_seed(const Series *s, uint64_t half)
{
    Rng rng = rng_at(s->asked->seed, HALF_RNG, half);
    return rng_u64(&rng);
}

static Status run_pass(Series *s)
{
    uint64_t number = passes_done(s);
    FilmSum *half = &s->halves[number % 2];
    PassResult result;
    Rng seed = rng_at(s->asked->seed, SERIES_RNG, number);
    PassSeries series = {.shrink = progressive_shrink(number + 1),
                         .is_repeat = s->out->new_passes > 0,
                         .first = &s->first};
    PassOptions pass = {&s->options, rng_u64(&seed), &series, NULL};
    s->options.seed = half_seed(s, number % 2);
    film_sum_follow(half, &s->film);
    TRY(pass_render(s->tracer, &pass, s->diag, &s->out->stats, &s->film, &result));
    film_sum_add(half, &s->film);
    photon_books_add(&s->out->books, &result.books, s->out->new_passes);
    s->out->caustic_hash = result.caustic_hash;
    s->out->global_hash = result.global_hash;
    s->out->volume_hash = result.volume_hash;
    s->out->last_radii = scaled(s->first, series.shrink);
    s->out->new_passes++;
    s->out->stats.count[STAT_PIXELS] = (uint64_t)s->film.width * (uint64_t)s->film.height;
    pass_result_done(&result);
    return OK;
}

/* Run passes; ERR_INTERRUPTED when somebody ended them, with whole passes in the sum. */
static Status run_passes(Series *s)
{
    Status status = OK;
    s->passes_started = s->last_shown = clock_wall();
    work_is_patient = 1;
    while (status == OK && !is_over(s)) {
        status = run_pass(s);
        if (status == OK && !is_over(s))
            status = show_if_due(s);
    }
    work_is_patient = 0;
    if (status == OK && work_ending)
        status = ERR_INTERRUPTED;
    work_ending = 0;
    return status;
}

/* --- set-up --------------------------------------------------------------------------------- */

static void set_options(Series *s)
{
    s->options.samples = s->asked->samples > 1 ? s->asked->samples : 1;
    s->options.aa = AA_UNIFORM;
    if (s->asked->progress) {
        s->options.progress = report_pass;
        s->options.progress_ctx = s;
    }
    /* The samples of a pixel are numbered by 32 bits. */
    uint64_t most = UINT32_MAX / (uint64_t)s->options.samples;
    uint64_t asked = s->asked->progressive.passes;
    s->passes_asked = asked && asked < most ? asked : most;
}

/* Take up the state of a run before. */
static Status resume(Series *s)
{
    const ProgressiveOptions *progressive = &s->asked->progressive;
    if (!progressive->is_resumed)
        return OK;
    bool is_there;
    TRY(checkpoint_read(s->diag, progressive->state_path, s->settings, &s->first, s->halves,
                        &is_there));
    if (!is_there)
        diag_warn(s->diag, WARN_FILE, SPAN_NONE,
                  "there is no '%s' to resume from: starting with the first pass",
                  progressive->state_path);
    s->last_shown_pass = passes_done(s);
    s->out->last_radii = scaled(s->first, progressive_shrink(passes_done(s)));
    if (passes_done(s) > s->passes_asked)
        diag_warn(s->diag, WARN_FILE, SPAN_NONE,
                  "'%s' has %llu passes already: the picture is of these", progressive->state_path,
                  (unsigned long long)passes_done(s));
    return OK;
}

/* Take over the picture of the passes done.  Somebody waits for it: from here on only another
 * interruption counts. */
static Status finish(Series *s, Status status)
{
    if (passes_done(s) == 0)
        return status;
    work_interrupted = 0;
    if (s->last_shown_pass != passes_done(s))
        TRY(keep_state(s));
    TRY(make_picture(s));
    s->out->image = s->shown.image;
    s->shown.image = (Image){0};
    return status;
}

static Status make_films(Series *s)
{
    TRY(film_init(&s->film, s->asked, FILM_SAMPLES | FILM_CLUES, s->diag));
    TRY(film_init(&s->shown, s->asked, FILM_SHOWN, s->diag));
    TRY(error_map_init(&s->errors, &s->film, s->diag));
    size_t pixels = (size_t)s->film.width * (size_t)s->film.height;
    s->film.samples = mem_array(pixels, sizeof *s->film.samples);
    if (!s->film.samples)
        return diag_no_memory(s->diag, "the samples of pixels");
    for (size_t i = 0; i < pixels; i++)
        s->film.samples[i].wanted = (uint16_t)s->options.samples;
    for (int i = 0; i < 2; i++)
        TRY(film_sum_init(&s->halves[i], &s->film, s->diag));
    return OK;
}

static Status run_series(Series *s)
{
    TRY(make_films(s));
    checkpoint_describe(tracer_scene(s->tracer), &s->options, s->settings);
    TRY(resume(s));
    Status status = run_passes(s);
    return status == OK || status == ERR_INTERRUPTED ? finish(s, status) : status;
}

Status progressive_render(const Tracer *tracer, const RenderOptions *options, double started,
                          Diag *diag, RenderResult *out)
{
    Series s = {.tracer = tracer,
                .asked = options,
                .options = *options,
                .diag = diag,
                .out = out,
                .started = started};
    set_options(&s);
    Status status = run_series(&s);
    for (int i = 0; i < 2; i++)
        film_sum_done(&s.halves[i]);
    error_map_done(&s.errors);
    mem_free(s.film.samples);
    film_done(&s.film);
    film_done(&s.shown);
    if (out->image.layer_count == 0) /* a failure leaves nothing */
        photon_books_done(&out->books);
    return status;
}
