/* Light that media scatter once, from the lights to the eye.
 *
 * Along a ray the light that would arrive without shadows is cheap and smooth: it is summed up
 * first (light_run.h).  What costs is the shadow rays.  Of a light without size it is known for
 * most of a ray, without any, whether it arrives; where it is not, places spread evenly over the
 * light are looked at.  Where nothing is known these are few at first, and more only where
 * neighbours differ by what can be seen.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"
#include "eye/light_run.h"

enum {
    PLACES_FIRST_MAX = 64,
    PLACES_MAX = 256 /* shadow rays to one light for one ray */
};

/* What sums of light without shadows may be wrong by, in parts of the tolerance. */
#define SUM_TOLERANCE 0.1f

/* With less than this part of the light open, most places are at edges anyway: no more are looked
 * for, as to stop where neighbours are alike favours what most of them are. */
#define OPEN_LITTLE 0.5f

/* Between two places whose shadows differ by more than this, over the channels, is an edge. */
#define END_STEP 0.75f

/* What a shadow ray found, for a stretch of the light of a run. */
typedef struct LightPlace {
    double begin, end, at; /* parts of the whole */
    Rgb arrived;
} LightPlace;

typedef struct Scatter {
    EyeThread *eye;
    const MediaProfile *profile;
    MediaLobes lobes;
    const Ray *ray;
    const EyeLight *light;
    MediaCare care;
    LightRun all;        /* the light without shadows */
    LightRun open;       /* of that, what it is not known of whether it arrives */
    const LightRun *run; /* the one of both that is looked at */
    int count;
    LightPlace places[PLACES_MAX];
} Scatter;

/* --- shadows ------------------------------------------------------------------------------ */

/* Return what arrives of a light at a place. */
static Rgb look_at_light(const Scatter *s, double t)
{
    EyeThread *eye = s->eye;
    const EyeLight *light = s->light;
    V3 p = ray_at(s->ray, t);
    LightSample sample = light_at(light->light, light_point(eye, light, p), p);
    if (!(sample.distance > 0))
        return RGB_WHITE;
    Rgb arrived = air_shadow(eye, light, p, &sample, light->makes_volume);
    if (rgb_is_black(arrived))
        return arrived;
    return rgb_mul(
        arrived, media_air_shadow(&eye->trace, p, sample.to_light, sample.distance, light->index));
}

static LightPlace make_place(const Scatter *s, double begin, double end, double u)
{
    LightPlace place = {.begin = begin, .end = end, .at = begin + (end - begin) * u};
    place.arrived = look_at_light(s, light_run_t(s->run, place.at));
    return place;
}

static float whole_difference(const Scatter *s, const LightPlace *a, const LightPlace *b)
{
    Rgb d = rgb_mul(rgb_sub(a->arrived, b->arrived), s->run->whole);
    return rgb_sum_abs(d);
}

/* Halve the stretches beside a visible step; returns whether there were any. */
static bool refine(Scatter *s)
{
    bool is_marked[PLACES_MAX] = {false};
    int count = s->count, marked = 0;
    for (int i = 0; i + 1 < count; i++) {
        const LightPlace *a = &s->places[i], *b = a + 1;
        float step = whole_difference(s, a, b);
        float width = (float)fmax(a->end - a->begin, b->end - b->begin);
        if (step > s->care.threshold && step * width / 2 > s->care.tolerance)
            is_marked[i] = is_marked[i + 1] = true;
    }
    for (int i = 0; i < count; i++)
        marked += is_marked[i];
    if (marked == 0 || count + marked > PLACES_MAX)
        return false;
    int to = s->count = count + marked;
    for (int i = count - 1; i >= 0; i--) {
        LightPlace place = s->places[i];
        if (!is_marked[i]) {
            s->places[--to] = place;
            continue;
        }
        double middle = 0.5 * (place.begin + place.end), u = rng_double(&s->eye->rng);
        bool is_right = place.at >= middle;
        LightPlace other =
            is_right ? make_place(s, place.begin, middle, u) : make_place(s, middle, place.end, u);
        place.begin = is_right ? middle : place.begin;
        place.end = is_right ? place.end : middle;
        s->places[--to] = is_right ? place : other;
        s->places[--to] = is_right ? other : place;
    }
    return true;
}

/* How many places are looked at first: such that a shadow between two of them, which more places
 * would not be looked for, is within the tolerance in the mean; and as many as the scene asks for,
 * unless the light is too dim to matter. */
static int first_places(const Scatter *s)
{
    float most = rgb_max(s->run->whole);
    int asked = most > s->care.threshold ? s->care.cells : most > s->care.tolerance ? 2 : 1;
    float needed = ceilf(most / (4 * s->care.tolerance));
    int places = needed < PLACES_FIRST_MAX ? (int)needed : PLACES_FIRST_MAX;
    return places > asked ? places : asked;
}

static float unit(float x)
{
    return fminf(1, fmaxf(0, x));
}

/* What arrives at an end of the light: as the two places nearest to it go on, unless there is a
 * step between them. */
static Rgb arrived_at_end(const LightPlace *place, const LightPlace *next, double end)
{
    Rgb step = rgb_sub(place->arrived, next->arrived);
    if (rgb_sum_abs(step) > END_STEP || place->at == next->at)
        return place->arrived;
    float way = (float)((end - place->at) / (place->at - next->at));
    Rgb there = rgb_mad(place->arrived, way, step);
    return rgb(unit(there.r), unit(there.g), unit(there.b));
}

/* Sum up the light, what arrives of it going straight from place to place. */
static Rgb join_places(const Scatter *s)
{
    const LightPlace *first = s->places, *last = s->places + s->count - 1;
    if (first == last)
        return rgb_mul(s->run->whole, first->arrived);
    Rgb sum = RGB_BLACK, before = RGB_BLACK;
    Rgb arrived = arrived_at_end(first, first + 1, 0);
    for (const LightPlace *place = first; place <= last + 1; place++) {
        bool is_end = place > last;
        Rgb after = is_end ? s->run->whole : light_run_light(s->run, place->at);
        Rgb next = is_end ? arrived_at_end(last, last - 1, 1) : place->arrived;
        Rgb mean = rgb_scale(rgb_add(arrived, next), 0.5f);
        sum = rgb_add(sum, rgb_mul(rgb_sub(after, before), mean));
        before = after;
        arrived = next;
    }
    return sum;
}

/* Look at places of a run; returns its light, as far as that arrives. */
static Rgb shadowed(Scatter *s, const LightRun *run, bool looks_for_edges)
{
    s->run = run;
    int first = first_places(s);
    double u = rng_double(&s->eye->rng);
    s->count = 0;
    for (int i = 0; i < first; i++)
        s->places[s->count++] = make_place(s, (double)i / first, (i + 1.0) / first, u);
    for (int level = 0; looks_for_edges && level < s->care.level && refine(s); level++)
        ;
    return join_places(s);
}

/* What is known of shadows between begin and end; it does not tell how media dim the light. */
static bool known_shadows(const Scatter *s, double begin, double end, LitStretches *out)
{
    const Light *light = s->light->light;
    const Tracer *tracer = s->eye->trace.tracer;
    if (!trace_lit_stretches(tracer, s->light->index, s->ray, begin, end, out))
        return false;
    if (light->is_dimmed_by_media || s->eye->trace.is_dimmed)
        for (int i = 0; i < out->count; i++)
            if (out->items[i].state == LIT_SURE)
                out->items[i].state = LIT_UNSURE;
    return true;
}

/* The light of a lamp between begin and end. */
static Rgb lamp_light(Scatter *s, double begin, double end)
{
    const RunSource source = {s->profile, &s->lobes, s->ray, s->light->light,
                              SUM_TOLERANCE * s->care.tolerance};
    if (!light_run_sum(&source, begin, end, &s->all))
        return RGB_BLACK;
    LitStretches known;
    if (!known_shadows(s, begin, end, &known))
        return shadowed(s, &s->all, true);
    Rgb sure = light_run_sort(&s->all, &known, &s->open);
    if (!(rgb_sum(s->open.whole) > 0))
        return sure;
    bool is_little = rgb_sum(s->open.whole) < OPEN_LITTLE * rgb_sum(s->all.whole);
    return rgb_add(sure, shadowed(s, &s->open, !is_little));
}

void media_scatter(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, Rgb *light)
{
    bool has_scattering = false;
    for (int i = 0; i < profile->count; i++)
        has_scattering |= !rgb_is_black(profile->cells[i].point.scattering);
    if (!has_scattering)
        return;
    Scatter s;
    s.eye = eye;
    s.profile = profile;
    s.ray = ray;
    s.care = media_care(here);
    media_lobes(here, &s.lobes);
    for (int i = 0; i < eye->light_count; i++) {
        s.light = &eye->lights[i];
        double begin = profile->cells[0].begin, end = profile->cells[profile->count - 1].end;
        if (s.light->lights_media && light_stretch(s.light->light, ray, &begin, &end))
            *light = rgb_add(*light, lamp_light(&s, begin, end));
    }
}
