/* What a render is expected to take.
 *
 * The picture is made in small, with fewer photons, whose estimates cover as much of it as in full
 * (photon_pass.h): so a photon has the same chance to be seen.  Counts of the eye pass grow with
 * the pixels, but not all of them in proportion: what is found at edges, or kept and read by
 * neighbours, grows less.  So there are two pictures in small at least, and each count is taken to
 * go on as it grew between them, as a power of the pixels.  Counts of the photon pass grow by the
 * photons, but for what every pass has to do: a straight line through the two.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/forecast.h"

#include "base/mem.h"
#include "render/pass.h"

#include <math.h>

enum {
    PIXELS = 4800,             /* of the larger picture in small */
    PHOTONS = 10000,           /* sent for it */
    SMALLER = 4,               /* pixels and photons of the one before are this part */
    SKETCHES_OF_GATHERING = 4, /* what gather rays take is hard to guess */
    WORK_MOST = 3000000        /* of the eye pass of a picture in small: a second or two */
};

/* Records of the irradiance cache come to an end when they cover all that is seen: beyond the
 * picture in small their number grows with this part of the power (measured: twice as many at most
 * for a picture of 64 times the pixels). */
#define KEPT_POWER 0.25

/* A picture in small, and what it took. */
typedef struct Sketch {
    Miniature size;
    RenderOptions options;
    Stats photons, eye;
    PhotonBooks books;
} Sketch;

static int small_side(int full, double part)
{
    return (int)fmax(1, round(full / part));
}

/* Set up a picture in small whose pixels are `side` of the full one's. */
static void sketch_init(Sketch *sketch, const RenderOptions *options, double side, double photons)
{
    RenderOptions *small = &sketch->options;
    *small = *options;
    small->width = small_side(options->width, side);
    small->height = small_side(options->height, side);
    small->layers = 0;
    small->is_watched = true;
    small->progress = NULL;
    if (options->plan.is_progressive) {
        small->aa = AA_UNIFORM;
        small->samples = options->samples > 1 ? options->samples : 1;
    }
    double full = (double)options->width * (double)options->height;
    side = sqrt(full / ((double)small->width * (double)small->height));
    sketch->size = (Miniature){.side = side, .photons = photons};
}

/* Make the film; that of one of many passes says how many samples each pixel gets. */
static Status sketch_film(const RenderOptions *options, Diag *diag, Film *film)
{
    size_t pixels = (size_t)options->width * (size_t)options->height;
    TRY(film_init(film, options, FILM_SAMPLES | FILM_CLUES, diag));
    if (!options->plan.is_progressive)
        return OK;
    film->samples = mem_array(pixels, sizeof *film->samples);
    for (size_t i = 0; film->samples && i < pixels; i++)
        film->samples[i].wanted = (uint16_t)options->samples;
    return film->samples ? OK : diag_no_memory(diag, "a forecast");
}

static Status sketch_render(Sketch *sketch, const Tracer *tracer, Diag *diag)
{
    Film film = {0};
    Stats all = {0};
    PassResult result;
    PassRadii radii = {0};
    PassSeries series = {.shrink = 1, .is_repeat = true, .first = &radii};
    PassOptions pass = {.render = &sketch->options,
                        .photon_seed = sketch->options.seed,
                        .series = sketch->options.plan.is_progressive ? &series : NULL,
                        .miniature = &sketch->size};
    Status status = sketch_film(&sketch->options, diag, &film);
    if (status == OK)
        status = pass_render(tracer, &pass, diag, &all, &film, &result);
    mem_free(film.samples);
    film_done(&film);
    if (status != OK)
        return status;
    sketch->photons = result.photon_stats;
    for (int i = 0; i < STAT_COUNT; i++)
        sketch->eye.count[i] = all.count[i] - result.photon_stats.count[i];
    sketch->books = result.books;
    return OK;
}

/* --- from small to full --------------------------------------------------------------------- */

/* Return work of the eye pass, as if estimates took as many photons as in full. */
static double eye_count(const Sketch *sketch, const Plan *plan, int cost)
{
    Costs costs;
    costs_find(plan, &sketch->eye, &costs);
    double count = costs.count[cost];
    return cost_is_of_estimates(cost) ? count / miniature_gather(&sketch->size) : count;
}

static double full_eye_count(const Sketch sketches[2], const Plan *plan, int cost)
{
    double most = eye_count(&sketches[0], plan, cost), least = eye_count(&sketches[1], plan, cost);
    double pixels = sketches[0].size.side * sketches[0].size.side;
    double grown = sketches[1].size.side * sketches[1].size.side / pixels;
    double power = least > 0 && grown > 1 ? log(most / least) / log(grown) : 1;
    /* Estimates of the smaller one took more: they reached beyond what light there is, and say
     * nothing of how it goes on. */
    if (cost_is_of_estimates(cost) && power < 0)
        power = 1;
    power = fmin(1, fmax(0, power));
    if (cost_feature(cost) == FEATURE_FINAL_GATHER && plan_has(plan, FEATURE_IRRADIANCE_CACHE))
        power *= KEPT_POWER;
    return most > 0 ? most * pow(pixels, power) : 0;
}

static double full_photon_count(const Sketch sketches[2], const Plan *plan, int cost)
{
    Costs most, least;
    costs_find(plan, &sketches[0].photons, &most);
    costs_find(plan, &sketches[1].photons, &least);
    double part = sketches[0].size.photons;
    double slope =
        fmax(0, most.count[cost] - least.count[cost]) / (part - sketches[1].size.photons);
    return most.count[cost] + slope * (1 - part);
}

static void full_costs(const Sketch sketches[2], const Plan *plan, Costs *out)
{
    for (int i = 0; i < COST_COUNT; i++)
        out->count[i] = full_eye_count(sketches, plan, i) + full_photon_count(sketches, plan, i);
}

static uint64_t times(uint64_t count, double factor)
{
    return (uint64_t)llround((double)count * factor);
}

/* Enter what became of a light's photons in small, for all it will send. */
static void full_book(LightBooks *book, const LightBooks *small)
{
    double factor = small->budget > 0 ? (double)book->budget / (double)small->budget : 0;
    book->emitted = times(small->emitted, factor);
    book->stored_paths = times(small->stored_paths, factor);
    book->absorbed = times(small->absorbed, factor);
    book->escaped = times(small->escaped, factor);
    book->cut = times(small->cut, factor);
    book->stored = times(small->stored, factor);
    book->seen = times(small->seen, factor);
}

static void full_books(PhotonBooks *books, const PhotonBooks *small)
{
    for (int i = 0; small->caustic && i < books->caustic_count; i++)
        full_book(&books->caustic[i], &small->caustic[i]);
    for (int i = 0; small->global && i < books->global_count; i++)
        full_book(&books->global[i], &small->global[i]);
    for (int i = 0; small->volume && i < books->volume_count; i++)
        full_book(&books->volume[i], &small->volume[i]);
}

static uint64_t budget_of(const LightBooks *books, int count)
{
    uint64_t sum = 0;
    for (int i = 0; books && i < count; i++)
        sum += books[i].budget;
    return sum;
}

/* --- the forecast --------------------------------------------------------------------------- */

/* Make pictures in small, each SMALLER times as large as the one before, until one is large enough
 * or would take too long; keeps the last two, the larger first. */
static Status make_sketches(const Tracer *tracer, const RenderOptions *options, Diag *diag,
                            const PhotonBooks *books, Sketch sketches[2])
{
    const Plan *plan = tracer_plan(tracer);
    uint64_t sent = budget_of(books->caustic, books->caustic_count) +
                    budget_of(books->global, books->global_count) +
                    budget_of(books->volume, books->volume_count);
    double full = (double)options->width * (double)options->height, work = 0;
    int count = plan_has(plan, FEATURE_FINAL_GATHER) ? SKETCHES_OF_GATHERING : 2;
    for (int i = 0; i < count && (i < 2 || work * SMALLER < WORK_MOST); i++) {
        double part = pow(SMALLER, i + 1 - count);
        photon_books_done(&sketches[1].books);
        sketches[1] = sketches[0];
        sketches[0] = (Sketch){0};
        sketch_init(&sketches[0], options, sqrt(fmax(1, full / PIXELS) / part),
                    fmin(1, PHOTONS / fmax(1, (double)sent)) * part);
        TRY(sketch_render(&sketches[0], tracer, diag));
        Costs costs;
        costs_find(plan, &sketches[0].eye, &costs);
        work = costs_work(&costs);
    }
    return OK;
}

Status forecast_make(const Tracer *tracer, const RenderOptions *options, Diag *diag, Forecast *out)
{
    Sketch sketches[2] = {0};
    Diag quiet; /* what there is to warn of, the render itself will */
    *out = (Forecast){0};
    PhotonOptions photons = pass_photon_options(options, options->seed);
    photons.progress = NULL;
    TRY(photon_plan_budgets(tracer, &photons, diag, &out->books));
    diag_init(&quiet, diag_drop, NULL);
    Status status = make_sketches(tracer, options, &quiet, &out->books, sketches);
    diag_done(&quiet);
    if (status == OK) {
        full_costs(sketches, tracer_plan(tracer), &out->costs);
        full_books(&out->books, &sketches[0].books);
    } else {
        forecast_done(out);
    }
    photon_books_done(&sketches[0].books);
    photon_books_done(&sketches[1].books);
    return status == ERR_MEMORY ? diag_no_memory(diag, "a forecast") : status;
}

void forecast_done(Forecast *forecast)
{
    photon_books_done(&forecast->books);
}
