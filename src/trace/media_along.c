/* Media along a stretch of a ray.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/media_along.h"

#include "trace/trace_int.h"

enum { CELLS_FIRST_MAX = 64 };

/* --- which media -------------------------------------------------------------------------- */

static void add_list(MediaHere *here, const Medium *const *media, int count)
{
    bool is_seen = false;
    for (int i = 0; i < count; i++) {
        is_seen |= medium_is_seen(media[i]);
        here->is_homogeneous &= medium_is_homogeneous(media[i]);
    }
    if (is_seen)
        here->lists[here->list_count++] = (MediaList){media, count};
}

void media_of_interior(const Interior *interior, MediaHere *out)
{
    out->is_open = out->is_homogeneous = true;
    out->is_conserving = false;
    out->list_count = 0;
    if (interior->is_hollow)
        add_list(out, interior->media, interior->media_count);
}

void media_of_air(const Tracer *tracer, MediaHere *out)
{
    const Atmosphere *air = &tracer->scene->atmosphere;
    out->is_open = out->is_homogeneous = true;
    out->is_conserving = false;
    out->list_count = 0;
    add_list(out, air->media, air->media_count);
}

void media_here(const Tracer *tracer, const Interiors *inside, MediaHere *out)
{
    media_of_air(tracer, out);
    for (int i = 0; i < inside->count; i++)
        out->is_open &= inside->in[i]->is_hollow;
    if (!out->is_open)
        out->list_count = 0;
    for (int i = 0; i < inside->count && out->is_open; i++)
        add_list(out, inside->in[i]->media, inside->in[i]->media_count);
}

/* --- coefficients ------------------------------------------------------------------------- */

void media_at(const MediaHere *here, V3 p, MediaPoint *out)
{
    *out = (MediaPoint){RGB_BLACK, RGB_BLACK, RGB_BLACK};
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++) {
            const Medium *medium = here->lists[l].media[i];
            Rgb density = medium_density(medium, p);
            out->extinction = rgb_add(out->extinction, rgb_mul(density, medium_extinction(medium)));
            out->emission = rgb_add(out->emission, rgb_mul(density, medium->emission));
            out->scattering = rgb_add(out->scattering, rgb_mul(density, medium->scattering));
        }
}

static MediaLobe medium_lobe(const MediaHere *here, const Medium *medium, V3 p)
{
    Rgb scattering = rgb_mul(medium_density(medium, p), medium->scattering);
    if (here->is_conserving)
        scattering = rgb_scale(scattering, (float)medium_gain(medium));
    return (MediaLobe){medium->phase, (double)medium->eccentricity, scattering};
}

/* Add light scattered alike to what is there; returns false when there is no room. */
static bool add_lobe(MediaLobes *to, MediaLobe lobe)
{
    for (int i = 0; i < to->count; i++) {
        MediaLobe *old = &to->lobes[i];
        if (old->phase == lobe.phase && old->eccentricity == lobe.eccentricity) {
            old->scattering = rgb_add(old->scattering, lobe.scattering);
            return true;
        }
    }
    if (to->count == (int)(sizeof to->lobes / sizeof to->lobes[0]))
        return false;
    to->lobes[to->count++] = lobe;
    return true;
}

void media_lobes(const MediaHere *here, MediaLobes *out)
{
    out->here = here;
    out->count = 0;
    bool is_complete = here->is_homogeneous;
    for (int l = 0; l < here->list_count && is_complete; l++)
        for (int i = 0; i < here->lists[l].count && is_complete; i++) {
            const Medium *medium = here->lists[l].media[i];
            if (!rgb_is_black(medium->scattering))
                is_complete = add_lobe(out, medium_lobe(here, medium, v3(0, 0, 0)));
        }
    if (!is_complete)
        out->count = 0;
}

static Rgb lobe_value(const MediaLobe *lobe, double cosine)
{
    double phase = phase_value(lobe->phase, lobe->eccentricity, cosine);
    return rgb_scale(lobe->scattering, (float)phase);
}

Rgb media_scattered(const MediaLobes *lobes, V3 p, double cosine)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < lobes->count; i++)
        sum = rgb_add(sum, lobe_value(&lobes->lobes[i], cosine));
    if (lobes->count > 0)
        return sum;
    const MediaHere *here = lobes->here;
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++) {
            const Medium *medium = here->lists[l].media[i];
            if (rgb_is_black(medium->scattering))
                continue;
            MediaLobe lobe = medium_lobe(here, medium, p);
            sum = rgb_add(sum, lobe_value(&lobe, cosine));
        }
    return sum;
}

/* The tolerance makes the error of a stretch at default settings about two steps of an 8-bit
 * picture; it goes with the standard deviation the variance stands for. */
static float tolerance_of(const Medium *medium)
{
    return sqrtf(medium->variance) * (1 - medium->confidence);
}

MediaCare media_care(const MediaHere *here)
{
    MediaCare care = {1, 1, INFINITY, INFINITY};
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++) {
            const Medium *medium = here->lists[l].media[i];
            double cells = ceil((medium->samples + 2) / 3.0) * medium->intervals;
            care.cells = cells > care.cells ? (int)fmin(cells, CELLS_FIRST_MAX) : care.cells;
            care.level = medium->aa_level > care.level ? medium->aa_level : care.level;
            care.tolerance = fminf(care.tolerance, tolerance_of(medium));
            care.threshold = fminf(care.threshold, medium->aa_threshold);
        }
    return care;
}

/* --- the profile -------------------------------------------------------------------------- */

static MediaCell look(const MediaHere *here, const Ray *ray, double begin, double end, Rng *rng)
{
    MediaCell cell = {.begin = begin, .end = end};
    cell.at = begin + (end - begin) * rng_double(rng);
    media_at(here, ray_at(ray, cell.at), &cell.point);
    return cell;
}

/* Equal cells up to `near`, from there on each twice as long as the one before. */
static void first_cells(const MediaHere *here, const Ray *ray, double begin, double end,
                        double near, int cells, Rng *rng, MediaProfile *out)
{
    double middle = near > begin ? fmin(near, end) : end;
    out->count = 0;
    for (int i = 0; i < cells; i++) {
        double a = begin + (middle - begin) * i / cells;
        double b = begin + (middle - begin) * (i + 1) / cells;
        out->cells[out->count++] = look(here, ray, a, b, rng);
    }
    double step = (middle - begin) / cells;
    for (double a = middle; a < end && out->count < CELLS_FIRST_MAX * 2; a += step) {
        step *= 2;
        double b = out->count == CELLS_FIRST_MAX * 2 - 1 ? end : fmin(end, a + step);
        out->cells[out->count++] = look(here, ray, a, b, rng);
    }
}

static void add_depths(MediaProfile *profile)
{
    Rgb depth = RGB_BLACK;
    for (int i = 0; i < profile->count; i++) {
        MediaCell *cell = &profile->cells[i];
        cell->depth = depth;
        depth = rgb_mad(depth, (float)(cell->end - cell->begin), cell->point.extinction);
    }
    profile->depth = depth;
}

static float difference(const MediaPoint *a, const MediaPoint *b)
{
    Rgb x = rgb_sub(a->extinction, b->extinction), e = rgb_sub(a->emission, b->emission);
    Rgb s = rgb_sub(a->scattering, b->scattering);
    return fabsf(x.r) + fabsf(x.g) + fabsf(x.b) + fabsf(e.r) + fabsf(e.g) + fabsf(e.b) +
           fabsf(s.r) + fabsf(s.g) + fabsf(s.b);
}

/* Does the step from a cell to the next matter to what is seen of the stretch? */
static bool is_rough(const MediaCell *a, const MediaCell *b, const MediaCare *care, double length)
{
    double change = (double)difference(&a->point, &b->point);
    double seen = (double)expf(-rgb_min(a->depth));
    double longer = fmax(a->end - a->begin, b->end - b->begin);
    return change * length * seen > (double)care->threshold &&
           change * longer / 2 * seen > (double)care->tolerance;
}

/* Halve the cells beside a rough step; what was looked at stays with its half. */
static bool refine(const MediaHere *here, const Ray *ray, const MediaCare *care, double length,
                   Rng *rng, MediaProfile *profile)
{
    bool is_marked[MEDIA_CELLS_MAX] = {false};
    int count = profile->count, marked = 0;
    for (int i = 0; i + 1 < count; i++)
        if (is_rough(&profile->cells[i], &profile->cells[i + 1], care, length))
            is_marked[i] = is_marked[i + 1] = true;
    for (int i = 0; i < count; i++)
        marked += is_marked[i];
    if (marked == 0 || count + marked > MEDIA_CELLS_MAX)
        return false;
    int to = profile->count = count + marked;
    for (int i = count - 1; i >= 0; i--) {
        MediaCell cell = profile->cells[i];
        if (!is_marked[i]) {
            profile->cells[--to] = cell;
            continue;
        }
        double middle = 0.5 * (cell.begin + cell.end);
        bool is_right = cell.at >= middle;
        MediaCell left = is_right ? look(here, ray, cell.begin, middle, rng) : cell;
        MediaCell right = is_right ? cell : look(here, ray, middle, cell.end, rng);
        left.end = right.begin = middle;
        profile->cells[--to] = right;
        profile->cells[--to] = left;
    }
    return true;
}

void media_profile(const MediaHere *here, const Ray *ray, double begin, double end, double near,
                   Rng *rng, Stats *stats, MediaProfile *out)
{
    if (here->is_homogeneous) {
        stats->count[STAT_MEDIA_CELLS]++;
        out->count = 1;
        out->cells[0] = (MediaCell){.begin = begin, .end = end, .at = 0.5 * (begin + end)};
        media_at(here, ray->o, &out->cells[0].point);
        add_depths(out);
        return;
    }
    MediaCare care = media_care(here);
    first_cells(here, ray, begin, end, near, care.cells, rng, out);
    add_depths(out);
    for (int level = 0; level < care.level; level++) {
        if (!refine(here, ray, &care, end - begin, rng, out))
            break;
        add_depths(out);
    }
    stats->count[STAT_MEDIA_CELLS] += (uint64_t)out->count;
}

/* (1 - exp(-x t)) / x, also where x t is next to nothing. */
static float glow_length(float x, double length)
{
    double depth = (double)x * length;
    return (float)(depth < 1e-4 ? length * (1 - depth / 2) : -expm1(-depth) / (double)x);
}

Rgb media_glow_length(Rgb x, double length)
{
    return rgb(glow_length(x.r, length), glow_length(x.g, length), glow_length(x.b, length));
}

Rgb media_transmittance(const MediaHere *here, const Ray *ray, double begin, double end,
                        double near, Rng *rng, Stats *stats)
{
    if (here->list_count == 0 || !(end > begin))
        return RGB_WHITE;
    MediaProfile profile;
    media_profile(here, ray, begin, end, near, rng, stats, &profile);
    return media_clear(profile.depth);
}
