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

#include "base/mem.h"
#include "base/rng.h"
#include "base/work.h"
#include "render/checkpoint.h"
#include "render/pace.h"
#include "render/pass.h"

/* Names the seeds of the photons of passes, and of the samples of halves. */
enum { SERIES_RNG = 0x736572, HALF_RNG = 0x68616c };

/* a, see above. */
#define SERIES_ALPHA (2.0 / 3)

/* From this pass on the product of the factors is had in closed form. */
enum { SERIES_FAR = 4096 };

/* What writing the picture takes, seconds for a pixel, before it is known. */
#define ENDING_SECONDS 4e-7

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
    SeriesState state;
    Film shown; /* the picture, of layers that were asked for */
    ErrorMap errors;
    uint64_t measured_at; /* passes that the errors are known of */
    bool is_steered;      /* samples go where errors are */
    bool is_told;         /* what is going to be done */
    bool is_reached;      /* the error wanted, when a plan was due: between plans errors are known
                             by chance, as when a picture is shown */
    Pace pace;
    uint64_t passes_asked; /* stop after so many */
    double passes_started; /* seconds of clock_wall */
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
    return series_passes(&s->state);
}

static PassRadii scaled(PassRadii radii, double factor)
{
    return (PassRadii){radii.caustic * factor, radii.global * factor, radii.volume * factor};
}

/* --- progress ------------------------------------------------------------------------------- */

/* Return how far the way to the goal is gone, or a negative number if there is none: passes,
 * seconds, and with an error wanted the work, which goes as one over its square. */
static double fraction_done(const Series *s, double pass_fraction)
{
    const ProgressiveOptions *wanted = &s->asked->progressive;
    double passes = (double)passes_done(s) + pass_fraction, fraction = -1;
    if (wanted->passes)
        fraction = passes / (double)s->passes_asked;
    if (wanted->seconds > 0)
        fraction = fmax(fraction, (clock_wall() - s->pace.started) / wanted->seconds);
    if (wanted->error > 0 && s->out->error.is_known) {
        double part = wanted->error / s->out->error.bound;
        fraction = fmax(fraction, part * part * passes / (double)s->measured_at);
    }
    return fraction;
}

/* Return the seconds until the goal is reached, or a negative number. */
static double seconds_left(const Series *s, double fraction, double pass_fraction)
{
    double left = INFINITY, now = clock_wall();
    double passes = (double)passes_done(s) + pass_fraction;
    double fresh = (double)s->out->new_passes + pass_fraction;
    if (fresh > 0.01 && fraction > 0)
        left = (now - s->passes_started) / fresh * passes * fmax(0, 1 / fraction - 1);
    if (s->pace.seconds > 0)
        left = fmin(left, fmax(0, s->pace.started + s->pace.seconds - now));
    return isfinite(left) ? left : -1;
}

/* Photons and samples are taken to be half of a pass each. */
static void report_pass(void *ctx, const RenderProgress *of_pass)
{
    Series *s = ctx;
    const ProgressiveOptions *wanted = &s->asked->progressive;
    RenderProgress progress = *of_pass;
    bool is_eye = of_pass->phase[0] == 'e' && pass_needs_photons(tracer_plan(s->tracer));
    double part = of_pass->fraction;
    if (pass_needs_photons(tracer_plan(s->tracer)))
        part = part / 2 + (is_eye ? 0.5 : 0);
    double fraction = fraction_done(s, part);
    progress.pass = passes_done(s) + 1;
    progress.passes = wanted->passes;
    progress.seconds_left = seconds_left(s, fraction, part);
    progress.error = s->out->error.is_known ? s->out->error.bound : 0;
    progress.error_wanted = wanted->error;
    if (s->is_steered && fraction >= 0)
        progress.fraction = fmin(fraction, 1 - 0x1p-20);
    s->asked->progress(s->asked->progress_ctx, &progress);
}

/* --- showing and keeping what is there ------------------------------------------------------ */

static Status keep_state(Series *s)
{
    const char *path = s->asked->progressive.state_path;
    return path ? checkpoint_write(s->diag, path, s->settings, &s->state) : OK;
}

/* Find the errors of the passes done, unless they are known. */
static void measure(Series *s)
{
    if (s->measured_at == passes_done(s) || s->state.halves[1].passes == 0)
        return;
    error_map_of_halves(s->state.halves, &s->film, &tracer_scene(s->tracer)->settings, &s->errors);
    s->out->error = error_figure(&s->errors);
    s->measured_at = passes_done(s);
}

/* Make the picture of the passes done. */
static Status make_picture(Series *s)
{
    Image *picture = &s->shown.image;
    film_sum_mean(s->state.halves, 2, picture);
    film_linearize(picture, &tracer_scene(s->tracer)->settings);
    s->out->passes = passes_done(s);
    s->out->first_radii = s->state.first;
    measure(s);
    if (!s->out->error.is_known)
        return OK;
    return error_map_show(&s->errors, picture, s->asked, s->diag, &s->out->error_picture);
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
    s->pace.ending = s->show_cost;
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

/* --- steering ------------------------------------------------------------------------------- */

/* Return the rays that all samples of a pass share, as a number of samples that are as many rays; 0
 * before the first pass. */
static double shared_work(const SeriesState *state)
{
    double samples = 0, passes = (double)series_passes(state);
    for (int h = 0; h < 2; h++)
        for (size_t i = 0; i < state->halves[h].pixels; i++)
            samples += state->halves[h].taken[i];
    double a_sample = samples > 0 ? (double)state->eye_rays / samples : 0;
    return a_sample > 0 && passes > 0 ? (double)state->shared_rays / passes / a_sample : 0;
}

/* Return how many more passes there is time for, as they are now; infinite without a limit. */
static double passes_affordable(const Series *s)
{
    double samples = steering_samples(&s->state.steering);
    return fmax(0, pace_left(&s->pace) / pace_pass_seconds(&s->pace, samples));
}

static bool is_error_reached(const Series *s)
{
    double wanted = s->asked->progressive.error;
    return wanted > 0 && s->out->error.is_known && s->out->error.bound <= wanted;
}

/* Say once, when something is known, what is going to be done. */
static void tell_plan(Series *s)
{
    const ProgressiveOptions *wanted = &s->asked->progressive;
    double samples = steering_samples(&s->state.steering), error = s->out->error.bound;
    double passes = fmin((double)s->passes_asked, (double)passes_done(s) + passes_affordable(s));
    if (wanted->error > 0)
        passes = fmin(passes, (double)passes_done(s) * pow(error / wanted->error, 2));
    SeriesPlan plan = {.passes = passes,
                       .seconds = pace_pass_seconds(&s->pace, samples),
                       .photons =
                           pass_needs_photons(tracer_plan(s->tracer)) ? s->pace.photon_part : 0,
                       .samples = samples / (double)s->state.steering.pixels,
                       .error = error,
                       .passes_so_far = passes_done(s)};
    if (wanted->tell && !s->is_told)
        wanted->tell(wanted->tell_ctx, &plan);
    s->is_told = true;
}

/* Plan the passes to come, if that is due. */
static void plan_passes(Series *s)
{
    if (!s->is_steered || passes_done(s) < s->state.steering.until)
        return;
    measure(s);
    s->is_reached = is_error_reached(s);
    if (!s->out->error.is_known || s->is_reached)
        return;
    SteeringGoal goal = {.error = s->asked->progressive.error,
                         .shared_work = shared_work(&s->state),
                         .passes_left = passes_affordable(s)};
    steering_plan(&s->state.steering, &s->errors, s->state.halves, &s->out->error, passes_done(s),
                  &goal);
    tell_plan(s);
}

/* --- passes --------------------------------------------------------------------------------- */

/* Passes that are made in any case: with one of each half errors are known, and every pixel is
 * there. */
enum { PASSES_SURE = 2 };

/* Return how much of the next pass is to be made; 0: none of it. */
static double next_part(const Series *s)
{
    if (work_ending || passes_done(s) >= s->passes_asked || s->is_reached)
        return 0;
    if (passes_done(s) < (s->is_steered ? PASSES_SURE : 1))
        return 1;
    return s->is_steered ? pace_part(&s->pace, steering_samples(&s->state.steering)) : 1;
}

/* The seed of what the eye draws at random in a half: its samples are those of a series of their
 * own. */
static uint64_t half_seed(const Series *s, uint64_t half)
{
    Rng rng = rng_at(s->asked->seed, HALF_RNG, half);
    return rng_u64(&rng);
}

/* Make pass `number` of so many of the photons onto the film, whose samples are set, and learn what
 * it takes. */
static Status make_pass(Series *s, uint64_t number, double photon_part, PassRadii *first,
                        Stats *stats, PassResult *out)
{
    Rng seed = rng_at(s->asked->seed, SERIES_RNG, number);
    PassSeries series = {.shrink = progressive_shrink(number + 1),
                         .photon_part = photon_part,
                         .is_repeat = s->out->new_passes > 0,
                         .first = first};
    PassOptions pass = {&s->options, rng_u64(&seed), &series, NULL};
    s->options.seed = half_seed(s, number % 2);
    TRY(pass_render(s->tracer, &pass, s->diag, stats, &s->film, out));
    pace_learn(&s->pace, stats->seconds, photon_part, (double)stats->count[STAT_SAMPLES]);
    return OK;
}

/* Make a part of the next pass. */
static Status run_pass(Series *s, double part)
{
    uint64_t number = passes_done(s);
    SeriesState *state = &s->state;
    FilmSum *half = &state->halves[number % 2];
    PassResult result;
    Stats stats = {.count = {0}};
    steering_deal(&state->steering, number, part, &s->film);
    film_sum_follow(half, &s->film);
    TRY(make_pass(s, number, part * s->pace.photon_part, &state->first, &stats, &result));
    film_sum_add(half, &s->film);
    state->shared_rays += result.shared_rays;
    state->eye_rays += result.eye_rays;
    stats_add(&s->out->stats, &stats);
    photon_books_add(&s->out->books, &result.books, s->out->new_passes);
    s->out->caustic_hash = result.caustic_hash;
    s->out->global_hash = result.global_hash;
    s->out->volume_hash = result.volume_hash;
    s->out->last_radii = scaled(state->first, progressive_shrink(number + 1));
    s->out->new_passes++;
    s->out->stats.count[STAT_PIXELS] = (uint64_t)s->film.width * (uint64_t)s->film.height;
    pass_result_done(&result);
    return OK;
}

/* A trial tells what a pass takes: so many samples of a pixel, of so many of the photons. */
#define TRIAL_SAMPLES 0.0625
#define TRIAL_PHOTONS 0.1

/* Take fewer samples of a pixel than asked for, but one, if else there were no time to plan. */
static void fit_samples(Series *s)
{
    double samples = steering_samples(&s->state.steering), asked = s->options.samples;
    double part = pace_fit_samples(&s->pace, samples, STEERING_FIRST_PLAN);
    if (part < 1)
        steering_even(&s->state.steering, (float)fmax(1, part * asked));
}

/* With a limit of time, find out what passes take, and how many photons there can be in each. */
static Status try_pass(Series *s)
{
    if (!(s->pace.seconds > 0))
        return OK;
    PassResult result;
    PassRadii radii = s->state.first;
    Stats stats = {.count = {0}};
    steering_deal(&s->state.steering, 0, TRIAL_SAMPLES / s->options.samples, &s->film);
    film_sum_follow(&s->state.halves[0], &s->film);
    TRY(make_pass(s, passes_done(s), TRIAL_PHOTONS, &radii, &stats, &result));
    pass_result_done(&result);
    for (int i = 0; i < PHASE_COUNT; i++)
        s->out->stats.seconds[i] += stats.seconds[i];
    pace_fit_photons(&s->pace, steering_samples(&s->state.steering));
    if (passes_done(s) == 0)
        fit_samples(s);
    return OK;
}

/* Run passes; ERR_INTERRUPTED when somebody ended them, with whole passes in the sum. */
static Status run_passes(Series *s)
{
    double part;
    s->passes_started = s->last_shown = clock_wall();
    work_is_patient = 1;
    Status status = try_pass(s);
    if (status == OK && passes_done(s) > 0)
        plan_passes(s);
    while (status == OK && (part = next_part(s)) > 0) {
        status = run_pass(s, part);
        if (status == OK)
            plan_passes(s);
        if (status == OK && next_part(s) > 0)
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
    uint64_t most = UINT32_MAX / (uint64_t)fmax(s->options.samples, STEERING_RATE_MOST);
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
    TRY(checkpoint_read(s->diag, progressive->state_path, s->settings, &s->state, &is_there));
    if (!is_there)
        diag_warn(s->diag, WARN_FILE, SPAN_NONE,
                  "there is no '%s' to resume from: starting with the first pass",
                  progressive->state_path);
    if (!s->is_steered)
        steering_even(&s->state.steering, (float)s->options.samples);
    s->last_shown_pass = passes_done(s);
    s->out->last_radii = scaled(s->state.first, progressive_shrink(passes_done(s)));
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

/* Samples of a pass share its indirect light, unless each gathers its own. */
static unsigned shared_use(const Plan *plan)
{
    bool is_gathered =
        plan_has(plan, FEATURE_FINAL_GATHER) && !plan_has(plan, FEATURE_IRRADIANCE_CACHE);
    return plan_has(plan, FEATURE_GLOBAL_MAP) && !is_gathered ? FILM_SHARED_INDIRECT : 0;
}

static Status make_films(Series *s)
{
    unsigned use = FILM_SAMPLES | FILM_CLUES | shared_use(tracer_plan(s->tracer));
    TRY(film_init(&s->film, s->asked, use, s->diag));
    TRY(film_init(&s->shown, s->asked, FILM_SHOWN, s->diag));
    TRY(error_map_init(&s->errors, &s->film, s->diag));
    size_t pixels = (size_t)s->film.width * (size_t)s->film.height;
    s->film.samples = mem_array(pixels, sizeof *s->film.samples);
    if (!s->film.samples)
        return diag_no_memory(s->diag, "the samples of pixels");
    return series_state_init(&s->state, &s->film, (float)s->options.samples, STEERING_FIRST_PLAN,
                             s->diag);
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
                .is_steered = options->progressive.seconds > 0 || options->progressive.error > 0,
                .pace = {.seconds = options->progressive.seconds,
                         .started = started,
                         .ending = ENDING_SECONDS * options->width * options->height,
                         .photon_part = 1}};
    set_options(&s);
    Status status = run_series(&s);
    series_state_done(&s.state);
    error_map_done(&s.errors);
    mem_free(s.film.samples);
    film_done(&s.film);
    film_done(&s.shown);
    if (out->image.layer_count == 0) /* a failure leaves nothing */
        photon_books_done(&out->books);
    return status;
}
