/* What `pms explain` prints for people: what is on first, in 100 columns.  Counts have two digits:
 * more of them would only seem to be known.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/explain_int.h"

#include "render/progressive.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { NAME_WIDTH = 21, COLUMNS = 100, TEXT_MAX = 512, COUNT_MAX = 24 };

/* --- words and numbers ---------------------------------------------------------------------- */

/* Print words in lines of COLUMNS that begin at NAME_WIDTH; returns the column reached from
 * `column`. */
static int print_words(const char *text, int column)
{
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (column > NAME_WIDTH && column + 1 + length > COLUMNS) {
            printf("\n%*s", NAME_WIDTH, "");
            column = NAME_WIDTH;
        }
        column += printf("%s%.*s", column > NAME_WIDTH ? " " : "", length, text);
        text += length + (text[length] == ' ');
    }
    return column;
}

/* Print a name, and words beside it with the place in the scene behind. */
static void print_reason(const char *name, const char *reason, Span span)
{
    char text[TEXT_MAX];
    Place place = span_place(span);
    printf("%-*s", NAME_WIDTH, name);
    int column = print_words(reason, NAME_WIDTH);
    if (span.source)
        snprintf(text, sizeof text, "(%s:%d:%d)", span.source->path, place.line, place.column);
    print_words(span.source ? text : "", column);
    putchar('\n');
}

/* Write a count with two digits and the letter of its thousands; all are as wide, to stand below
 * each other. */
static const char *rounded(double count, char out[COUNT_MAX])
{
    static const char *const letters[] = {"  ", " k", " M", " G", " T"};
    int step = 0;
    double scale = count > 0 ? pow(10, floor(log10(count)) - 1) : 1;
    double value = scale >= 1 ? round(count / scale) * scale : round(count);
    for (; value >= 999.5 && step < 4; step++)
        value /= 1000;
    snprintf(out, COUNT_MAX, step > 0 && value < 9.95 ? "%.1f%s" : "%.0f%s", value, letters[step]);
    return out;
}

/* Write a part in per cent. */
static const char *percent(double part, char out[COUNT_MAX])
{
    if (part > 0 && part < 0.005)
        snprintf(out, COUNT_MAX, "<1%%");
    else
        snprintf(out, COUNT_MAX, "%.0f%%", 100 * part);
    return out;
}

/* --- effects -------------------------------------------------------------------------------- */

static void print_on(const Explanation *e)
{
    printf("%-*s%s\n", NAME_WIDTH, "effects that are on", "why");
    for (int i = 0; i < FEATURE_COUNT; i++)
        if (plan_has(&e->plan, (FeatureId)i))
            print_reason(feature_name((FeatureId)i), e->plan.rows[i].reason, e->plan.rows[i].why);
}

static void print_off(const Explanation *e)
{
    char names[TEXT_MAX] = "";
    if (e->has_all)
        printf("\n%-*s%s\n", NAME_WIDTH, "effects that are off", "why");
    for (int i = 0; i < FEATURE_COUNT; i++) {
        const PlanRow *row = &e->plan.rows[i];
        size_t used = strlen(names);
        if (row->is_on)
            continue;
        if (e->has_all)
            print_reason(feature_name((FeatureId)i), row->reason, row->why);
        snprintf(names + used, sizeof names - used, "%s%s%s", used ? ", " : "",
                 feature_name((FeatureId)i), row->forced ? " (command line)" : "");
    }
    if (e->has_all || !*names)
        return;
    printf("\n%-*s", NAME_WIDTH, "off (--all says why)");
    print_words(names, NAME_WIDTH);
    putchar('\n');
}

static void print_cost(const Costs *costs, int cost)
{
    char count[COUNT_MAX], part[COUNT_MAX];
    printf("%9s %5s", rounded(costs->count[cost], count),
           percent(costs_share_of(costs, cost), part));
}

/* What each effect costs; an effect's second unit has no name before it. */
static void print_work(const Explanation *e)
{
    FeatureId before = FEATURE_COUNT;
    printf("\n%-*s%8s  %5s", NAME_WIDTH, "work", "expected", "share");
    printf(e->is_measured ? "%9s  %5s  of\n" : "  of\n", "had", "share");
    for (int i = 0; i < COST_COUNT; i++) {
        FeatureId feature = cost_feature(i);
        bool is_any = feature == FEATURE_COUNT;
        if (!is_any && !plan_has(&e->plan, feature))
            continue;
        if (!(e->expected.costs.count[i] > 0 || e->had.count[i] > 0))
            continue;
        printf("%-*s", NAME_WIDTH,
               is_any              ? "any picture"
               : feature == before ? ""
                                   : feature_name(feature));
        before = feature;
        print_cost(&e->expected.costs, i);
        if (e->is_measured)
            print_cost(&e->had, i);
        printf("  %s\n", cost_unit(i));
    }
}

/* --- lights --------------------------------------------------------------------------------- */

static void print_asked(const Asked *asked)
{
    if (!isnan(asked->count))
        printf("count %.0f", asked->count);
    if (!isnan(asked->spacing))
        printf("spacing %g", asked->spacing);
    if (!isnan(asked->global))
        printf("%sglobal_photons %.0f", isnan(asked->count) && isnan(asked->spacing) ? "" : " and ",
               asked->global);
}

static void print_light(const LightBooks *book, const LightBooks *planned)
{
    const uint64_t counts[] = {book->emitted, book->absorbed, book->escaped,
                               book->cut,     book->stored,   book->seen};
    char text[COUNT_MAX];
    printf("%-14.14s %8.4g %6.1f%%", book->name, planned->power, 100 * planned->share);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        printf(" %8s", rounded((double)counts[i], text));
    double wasted = (double)(book->stored - book->seen);
    printf(" %8s", rounded(wasted, text));
    printf(" %5s\n", book->stored > 0 ? percent(wasted / (double)book->stored, text) : "-");
}

static void print_table(const MapRows *map, const LightBooks *books, const char *when)
{
    static const char *const heads[] = {"sent",   "absorbed", "escaped", "cut",
                                        "stored", "seen",     "wasted"};
    printf("%-14s %8s %7s", when, "power", "share");
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        printf(" %8s", heads[i]);
    putchar('\n');
    for (int i = 0; i < map->count; i++)
        print_light(&books[i], &map->expected[i]);
}

/* Say what changes the share of lights; of lights in a row only once. */
static void print_overrides(const Explanation *e, const MapRows *map)
{
    char text[TEXT_MAX], next[TEXT_MAX], names[TEXT_MAX];
    for (int i = 0, end; i < map->count; i = end) {
        Span span = explain_override(e, map, i, text, sizeof text);
        for (end = i + 1; end < map->count; end++) {
            Span other = explain_override(e, map, end, next, sizeof next);
            if (strcmp(text, next) != 0 || span.source != other.source || span.begin != other.begin)
                break;
        }
        snprintf(names, sizeof names, end - i > 1 ? "%s .. %s" : "%s", map->expected[i].name,
                 map->expected[end - 1].name);
        if (*text)
            print_reason(names, text, span);
    }
}

static void print_map(const Explanation *e, const MapRows *map)
{
    uint64_t total = 0;
    if (!map->expected)
        return;
    for (int i = 0; i < map->count; i++)
        total += map->expected[i].budget;
    printf("\n%s photons: ", map->name);
    print_asked(&map->asked);
    printf(" asked for, %" PRIu64 " to send\n", total);
    print_table(map, map->expected, "expected");
    if (map->had)
        print_table(map, map->had, "had");
    print_overrides(e, map);
}

/* --- the rest ------------------------------------------------------------------------------- */

static bool has_photons(const Explanation *e)
{
    const PhotonBooks *books = &e->expected.books;
    return books->caustic || books->global || books->volume;
}

/* How many passes there will be, of what. */
static void print_passes(const Explanation *e)
{
    const ProgressiveOptions *progressive = &e->options.progressive;
    int samples = e->options.samples > 1 ? e->options.samples : 1;
    if (!plan_has(&e->plan, FEATURE_PROGRESSIVE))
        return;
    printf("\npasses: ");
    if (progressive->passes)
        printf("%" PRIu64, progressive->passes);
    if (progressive->seconds > 0)
        printf("%swhat fits into %g s", progressive->passes ? ", or " : "", progressive->seconds);
    if (!progressive->passes && !(progressive->seconds > 0))
        printf("until Ctrl-C");
    printf("; %d sample%s a pixel in each", samples, samples == 1 ? "" : "s");
    printf(has_photons(e) ? ", and these photons" : "");
    if (has_photons(e) && progressive->passes)
        printf("; the last gather radius is %.3g of the first",
               progressive_shrink(progressive->passes));
    printf("\nwork and photons are those of one pass");
    printf(e->is_measured ? ", in the mean over %" PRIu64 "\n" : "\n", e->result.new_passes);
}

/* The effect that takes most of the work; FEATURE_COUNT: none takes any. */
static FeatureId dearest(const Explanation *e)
{
    const Costs *costs = e->is_measured ? &e->had : &e->expected.costs;
    FeatureId best = FEATURE_COUNT;
    double most = 0;
    for (int i = 0; i < FEATURE_COUNT; i++) {
        double share = costs_share(costs, (FeatureId)i);
        if (share > most) {
            most = share;
            best = (FeatureId)i;
        }
    }
    return best;
}

static void print_hint(const Explanation *e)
{
    FeatureId feature = dearest(e);
    printf("\n--effect NAME=off leaves out exactly that effect, --effect NAME=on forces one");
    if (feature != FEATURE_COUNT)
        printf("; the dearest\nis %s: --effect %s=off", feature_text(feature),
               feature_name(feature));
    printf("\n");
}

void explain_print_text(const Explanation *e)
{
    MapRows maps[MAP_ROWS];
    printf("scene %s, %dx%d: %u object%s, %d light%s\n\n", e->scene->path, e->options.width,
           e->options.height, e->scene->object_count, e->scene->object_count == 1 ? "" : "s",
           e->scene->light_count, e->scene->light_count == 1 ? "" : "s");
    print_on(e);
    print_off(e);
    print_work(e);
    explain_maps(e, maps);
    for (int i = 0; i < MAP_ROWS; i++)
        print_map(e, &maps[i]);
    if (!has_photons(e))
        printf("\nno photon pass\n");
    print_passes(e);
    print_hint(e);
}
