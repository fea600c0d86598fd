/* The plots of a report: a script for gnuplot, which is run, and what it draws.
 *
 * The script has the data in it, so it can be kept and drawn again.
 * SPDX-License-Identifier: Apache-2.0 */
#include "study/report_int.h"

#include "base/child.h"
#include "base/file.h"

#include <math.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SVG_BYTES_MAX = 16 << 20, COLOURS = 8, POINTS = 6, PANEL_COLUMNS = 3, PANEL_HEIGHT = 250 };

/* Colours that are told apart by people who see fewer: Okabe and Ito's, without the yellow, which a
 * white page swallows. */
static const char *const colours[COLOURS] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#56B4E9", "#E69F00", "#5D3FA8", "#7A7A7A"};
static const int point_types[POINTS] = {7, 5, 9, 11, 13, 4};

typedef struct Script {
    FILE *file;
    const Study *study;
} Script;

static const StudyRow *row_of(const Script *s, const StudyTrend *trend, int i)
{
    return &s->study->analysis.rows[trend->rows[i]];
}

/* Return true if some error of it is large enough to tell. */
static bool is_shown(const StudyTrend *trend)
{
    return isfinite(trend->best);
}

static const char *colour_of(int trend)
{
    return colours[trend % COLOURS];
}

static int points_of(int trend)
{
    return point_types[trend / COLOURS % POINTS + trend % 2 * (trend < COLOURS ? 0 : 1)];
}

/* --- data ----------------------------------------------------------------------------------- */

/* Columns: seconds, error in percent, value, spread in percent, label. */
static void print_row(const Script *s, const StudyRow *row, double value, const char *label)
{
    double spread = isnan(row->spread) ? 0 : 100 * row->spread;
    if (isnan(row->error))
        return;
    fprintf(s->file, "%.6g %.6g %.6g %.6g \"%s\"\n", row->seconds, 100 * row->error, value, spread,
            label);
}

/* Return the next tick's label, or none if it would run into the one before. */
static const char *tick_label(const StudyTrend *trend, double value, double before,
                              char room[SETTING_LABEL_MAX])
{
    SettingKind kind = setting_kind((SettingId)trend->setting);
    if (kind == SETTING_WORDS || kind == SETTING_TIMES)
        setting_label((SettingId)trend->setting, value, room);
    else
        snprintf(room, SETTING_LABEL_MAX, "%g", value);
    return kind != SETTING_WORDS && value < 1.35 * before ? "" : room;
}

static void print_trend_data(const Script *s, int number)
{
    const StudyTrend *trend = &s->study->analysis.trends[number];
    double before = 0;
    fprintf(s->file, "$trend%d << EOD\n", number);
    for (int i = 0; i < trend->count; i++) {
        double value = study_trend_value(&s->study->analysis, trend, i);
        char room[SETTING_LABEL_MAX];
        const char *label = tick_label(trend, value, before, room);
        before = *label ? value : before;
        print_row(s, row_of(s, trend, i), value, label);
    }
    fprintf(s->file, "EOD\n$own%d << EOD\n", number);
    if (trend->own_row >= 0)
        print_row(s, &s->study->analysis.rows[trend->own_row], trend->own, "");
    fputs("EOD\n", s->file);
}

static void print_front_data(const Script *s)
{
    const StudyAnalysis *all = &s->study->analysis;
    fputs("$front << EOD\n", s->file);
    for (int i = 0; i < all->front_count; i++)
        print_row(s, &all->rows[all->front[i]], 0, "");
    fputs("EOD\n$own << EOD\n", s->file);
    print_row(s, &all->rows[0], 0, "");
    fputs("EOD\n", s->file);
}

static void print_data(const Script *s)
{
    print_front_data(s);
    for (int i = 0; i < s->study->analysis.trend_count; i++)
        print_trend_data(s, i);
}

/* --- the main plot -------------------------------------------------------------------------- */

static void begin_svg(const Script *s, const char *name, int width, int height)
{
    fprintf(s->file,
            "reset\nset terminal svg name '%s' size %d,%d dynamic enhanced font "
            "'Helvetica,Arial,sans-serif,14' background '#ffffff'\nset output '%s.svg'\n",
            name, width, height, name);
    fputs("set border 3 lc rgb '#666666'\nset tics nomirror out scale 0.6\n"
          "set grid xtics ytics lc rgb '#e4e4e4' lt 1 lw 1\n",
          s->file);
}

/* The smallest and the largest of what is shown. */
typedef struct AxisSpan {
    double lo, hi;
} AxisSpan;

static void extend(AxisSpan *range, double value)
{
    if (!(value > 0) || !isfinite(value))
        return;
    range->lo = fmin(range->lo, value);
    range->hi = fmax(range->hi, value);
}

/* Set a logarithmic axis to the range and a little more, with ticks at 1, 2 and 5 of each power. */
static void set_axis(const Script *s, char axis, AxisSpan range, const char *unit)
{
    const double least = range.lo / 1.25, most = range.hi * 1.25;
    const char *comma = "";
    fprintf(s->file, "set logscale %c\nset %crange [%.6g:%.6g]\nset %ctics (", axis, axis, least,
            most, axis);
    for (int power = (int)floor(log10(least)); power <= (int)ceil(log10(most)); power++)
        for (int digit = 1; digit <= 5; digit += digit == 1 ? 1 : 3) {
            double tick = digit * pow(10, power);
            if (tick < least || tick > most)
                continue;
            fprintf(s->file, "%s'%g%s' %.6g", comma, tick, unit, tick);
            comma = ", ";
        }
    fputs(")\n", s->file);
}

static AxisSpan seconds_range(const Script *s)
{
    AxisSpan range = {INFINITY, 0};
    const StudyAnalysis *all = &s->study->analysis;
    for (int i = 0; i < all->row_count; i++)
        if (!isnan(all->rows[i].error))
            extend(&range, all->rows[i].seconds);
    return range;
}

/* Percent. */
static AxisSpan error_range(const Script *s)
{
    AxisSpan range = {INFINITY, 0};
    const StudyAnalysis *all = &s->study->analysis;
    for (int i = 0; i < all->row_count; i++)
        extend(&range, 100 * all->rows[i].error);
    extend(&range, 100 * s->study->truth.noise.percentile);
    return range;
}

static AxisSpan trend_range(const Script *s, const StudyTrend *trend)
{
    AxisSpan range = {INFINITY, 0};
    for (int i = 0; i < trend->count; i++) {
        const StudyRow *row = row_of(s, trend, i);
        double spread = isnan(row->spread) ? 0 : row->spread;
        extend(&range, 100 * (row->error - spread));
        extend(&range, 100 * (row->error + spread));
    }
    double middle = sqrt(range.lo * range.hi); /* what hardly changes is to look flat */
    return (AxisSpan){fmin(range.lo, middle / 1.5), fmax(range.hi, middle * 1.5)};
}

/* Name, and how fast the error falls. */
static void print_key(const Script *s, const StudyTrend *trend)
{
    char name[64];
    size_t length = 0;
    for (const char *c = setting_name((SettingId)trend->setting); *c; c++) /* _ lowers letters */
        name[length++] = *c == '_' ? ' ' : *c;
    name[length] = 0;
    fprintf(s->file, "title '%s%s", name, trend->is_fine ? " at 16 samples" : "");
    if (trend->fit.count >= 2)
        fprintf(s->file, ":  slope %.2f", trend->fit.slope);
    fputs("'", s->file);
}

static void print_fit(const Script *s, int number)
{
    const StudyFit *fit = &s->study->analysis.trends[number].fit;
    if (fit->count < 2)
        return;
    fprintf(s->file,
            ", \\\n  [%.6g:%.6g] 100*exp(%.6g)*x**(%.6g) with lines lc rgb '%s' lw 1 dt 3 notitle",
            fit->lo, fit->hi, fit->base, fit->slope, colour_of(number));
}

static void plot_main(const Script *s)
{
    const StudyAnalysis *all = &s->study->analysis;
    double noise = 100 * s->study->truth.noise.percentile;
    begin_svg(s, "study", 1060, 560);
    set_axis(s, 'x', seconds_range(s), "");
    set_axis(s, 'y', error_range(s), " %%");
    fputs("set title 'What each setting costs and buys' font ',17'\n"
          "set xlabel 'time of a render (seconds)'\nset ylabel 'error of 95 % of the pixels'\n"
          "set key at screen 0.74, screen 0.91 left top vertical Left reverse samplen 2 spacing "
          "1.3 font ',13'\n"
          "set lmargin at screen 0.085\nset rmargin at screen 0.72\n"
          "plot ",
          s->file);
    fputs("$front using 1:2 with steps lc rgb '#c8c8c8' lw 8 title 'the front'", s->file);
    if (noise > 0)
        fprintf(s->file,
                ", \\\n  %.6g with lines lc rgb '#999999' lw 1.5 dt 2 title "
                "'noise of the reference'",
                noise);
    for (int i = 0; i < all->trend_count; i++) {
        if (!is_shown(&all->trends[i]))
            continue;
        fprintf(s->file,
                ", \\\n  $trend%d using 1:2 with linespoints lc rgb '%s' lw 2 pt %d ps 0.7 ", i,
                colour_of(i), points_of(i));
        print_key(s, &all->trends[i]);
        print_fit(s, i);
    }
    if (!isnan(all->rows[0].error))
        fputs(", \\\n  $own using 1:2 with points lc rgb '#000000' pt 6 ps 1.6 lw 2 title "
              "'the scene as it stands'",
              s->file);
    fputc('\n', s->file);
}

/* --- a panel a setting ---------------------------------------------------------------------- */

static void plot_panel(const Script *s, int number)
{
    const StudyTrend *trend = &s->study->analysis.trends[number];
    SettingKind kind = setting_kind((SettingId)trend->setting);
    fprintf(s->file, "set title '%s%s' font ',14'\n", setting_title((SettingId)trend->setting),
            trend->is_fine ? " *" : "");
    set_axis(s, 'y', trend_range(s, trend), " %%");
    if (kind == SETTING_WORDS)
        fprintf(s->file, "unset logscale x\nset xrange [-0.5:%g]\n",
                study_trend_value(&s->study->analysis, trend, trend->count - 1) + 0.5);
    else
        fprintf(s->file, "set logscale x\nset xrange [%g:%g]\n",
                study_trend_value(&s->study->analysis, trend, 0) / 1.4,
                study_trend_value(&s->study->analysis, trend, trend->count - 1) * 1.4);
    fprintf(s->file,
            "plot $trend%d using 3:2:4:xtic(5) with yerrorbars lc rgb '%s' lw 1.5 pt 7 ps 0.6 "
            "notitle, \\\n  $trend%d using 3:2 with lines lc rgb '%s' lw 2 notitle",
            number, colour_of(number), number, colour_of(number));
    if (trend->own_row >= 0 && !isnan(s->study->analysis.rows[trend->own_row].error))
        fprintf(s->file,
                ", \\\n  $own%d using 3:2 with points lc rgb '#000000' pt 6 ps 1.5 lw 2 "
                "notitle",
                number);
    fputc('\n', s->file);
}

static void plot_settings(const Script *s)
{
    const StudyAnalysis *all = &s->study->analysis;
    int panels = 0;
    for (int i = 0; i < all->trend_count; i++)
        panels += is_shown(&all->trends[i]);
    int rows = (panels + PANEL_COLUMNS - 1) / PANEL_COLUMNS;
    if (rows == 0)
        return;
    begin_svg(s, "settings", 1060, rows * PANEL_HEIGHT);
    fprintf(s->file, "set multiplot layout %d,%d margins char 9,2,3,2 spacing char 10,5\n", rows,
            PANEL_COLUMNS);
    fputs("set xtics font ',11'\nset ytics font ',11'\nunset key\n", s->file);
    for (int i = 0; i < all->trend_count; i++)
        if (is_shown(&all->trends[i]))
            plot_panel(s, i);
    fputs("unset multiplot\n", s->file);
}

/* --- the estimate --------------------------------------------------------------------------- */

static bool has_estimate(const Study *study)
{
    for (int i = 0; i < study->analysis.row_count; i++)
        if (study->analysis.rows[i].estimate > 0 && study->analysis.rows[i].error > 0)
            return true;
    return false;
}

static void plot_estimate(const Script *s)
{
    const StudyAnalysis *all = &s->study->analysis;
    if (!has_estimate(s->study))
        return;
    fputs("$estimate << EOD\n", s->file);
    for (int i = 0; i < all->row_count; i++)
        if (all->rows[i].estimate > 0 && all->rows[i].error > 0)
            fprintf(s->file, "%.6g %.6g\n", 100 * all->rows[i].error, 100 * all->rows[i].estimate);
    fputs("EOD\n", s->file);
    begin_svg(s, "estimate", 640, 520);
    set_axis(s, 'x', error_range(s), " %%");
    set_axis(s, 'y', error_range(s), " %%");
    fputs("set title 'How good the estimate was' font ',17'\n"
          "set xlabel 'true error'\nset ylabel 'estimated error'\n"
          "set key left top Left reverse\n"
          "plot x with lines lc rgb '#888888' lw 1.5 title 'estimate = truth', \\\n"
          "  0.7*x with lines lc rgb '#bbbbbb' dt 2 title '0.7 and 1.5 times the truth', \\\n"
          "  1.5*x with lines lc rgb '#bbbbbb' dt 2 notitle, \\\n"
          "  $estimate using 1:2 with points lc rgb '#0072B2' pt 7 ps 0.8 title 'a setting'\n",
          s->file);
}

/* --- gnuplot -------------------------------------------------------------------------------- */

static Status write_script(const Study *study, const char *path)
{
    FILE *file = fopen(path, "w");
    Script script = {file, study};
    if (!file)
        return diag_fail(study->diag, ERR_FILE, "cannot write '%s'", path);
    print_data(&script);
    if (study->analysis.front_count > 0) {
        plot_main(&script);
        plot_settings(&script);
        plot_estimate(&script);
    }
    fputs("unset output\n", file);
    return fclose(file) == 0 ? OK : diag_fail(study->diag, ERR_FILE, "cannot write '%s'", path);
}

#define SCRIPT_NAME "study.gp"

/* Run it in the folder of the study, so that no name that a user chose is a part of the script;
 * *is_good tells whether it drew.  A report without plots is better than none. */
static Status run_gnuplot(const Study *study, const char *log, bool *is_good)
{
    char *words[] = {"gnuplot", SCRIPT_NAME, NULL};
    const char *text;
    size_t size;
    int ended;
    Status status = child_run(study->diag, words, study->options.folder, "/dev/null", log, &ended);
    *is_good = status == OK && WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
    if (*is_good)
        return OK;
    if (status == ERR_FILE) {
        diag_warn(
            study->diag, WARN_FILE, SPAN_NONE,
            "gnuplot is not installed: the report has tables but no plots (the Debian package "
            "is gnuplot-nox)");
        return OK;
    }
    if (status != OK || !file_exists(log))
        return OK; /* it was said why */
    TRY(file_read(study->diag, log, SVG_BYTES_MAX, study->arena, &text, &size));
    diag_warn(study->diag, WARN_FILE, SPAN_NONE,
              "gnuplot failed, the report has tables but no plots:\n%.600s", text);
    return OK;
}

/* Read a drawing, from its <svg> on; NULL if there is none. */
static Status read_svg(const Study *study, Arena *arena, const char *name, const char **out)
{
    StudyPath path = study_path(study, name);
    const char *text;
    size_t size;
    *out = NULL;
    if (!file_exists(path.text))
        return OK;
    TRY(file_read(study->diag, path.text, SVG_BYTES_MAX, arena, &text, &size));
    *out = strstr(text, "<svg");
    return OK;
}

static void remove_file(const Study *study, const char *name)
{
    unlink(study_path(study, name).text);
}

Status plots_make(const Study *study, Arena *arena, Plots *out)
{
    StudyPath script = study_path(study, SCRIPT_NAME), log = study_path(study, "gnuplot.log");
    bool is_good = false;
    *out = (Plots){0};
    remove_file(study, "study.svg");
    Status status = write_script(study, script.text);
    if (status == OK)
        status = run_gnuplot(study, log.text, &is_good);
    if (status == OK && is_good)
        status = read_svg(study, arena, "study.svg", &out->main);
    if (status == OK && is_good)
        status = read_svg(study, arena, "settings.svg", &out->settings);
    if (status == OK && is_good)
        status = read_svg(study, arena, "estimate.svg", &out->estimate);
    remove_file(study, "settings.svg");
    remove_file(study, "estimate.svg");
    remove_file(study, "gnuplot.log");
    return status;
}
