/* The page of a report: one HTML file with everything in it, so that it can be read anywhere.
 * SPDX-License-Identifier: Apache-2.0 */
#include "study/report_int.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pictures shown of the front. */
enum { SHOWN_MOST = 6 };

static const char style[] =
    "body{margin:0;background:#fff;color:#1d1d1f;font:16px/1.5 -apple-system,'Segoe UI',Helvetica,"
    "Arial,'DejaVu Sans',sans-serif}\n"
    "main{width:1100px;max-width:calc(100vw - 40px);margin:48px auto 80px}\n"
    "h1{font-size:34px;line-height:1.2;margin:0 0 4px;letter-spacing:-.01em}\n"
    "h2{font-size:23px;margin:56px 0 6px;padding-top:18px;border-top:1px solid #ddd}\n"
    "p{max-width:780px;margin:8px 0 14px}\n"
    ".sub{color:#6a6a6f;margin:0 0 24px}\n"
    ".lead{font-size:19px;line-height:1.55}\n"
    "figure{margin:18px 0 8px}\n"
    "figure svg{width:100%;height:auto;display:block}\n"
    "table{border-collapse:collapse;margin:14px "
    "0;font-size:15px;font-variant-numeric:tabular-nums}\n"
    "th{text-align:left;font-weight:600;color:#55555a;border-bottom:2px solid #1d1d1f;"
    "padding:6px 22px 6px 0;vertical-align:bottom}\n"
    "td{border-bottom:1px solid #e6e6e6;padding:7px 22px 7px 0;vertical-align:top}\n"
    "td.n,th.n{text-align:right;white-space:nowrap}\n"
    "td.b{font-size:19px;font-weight:600;white-space:nowrap}\n"
    "code{font:13.5px/1.45 ui-monospace,Menlo,Consolas,'DejaVu Sans Mono',monospace;"
    "background:#f4f4f2;padding:2px 5px;border-radius:3px}\n"
    ".no{color:#8a4b00}.quiet{color:#6a6a6f;font-size:14px}\n"
    ".strip{display:grid;grid-template-columns:repeat(3,1fr);gap:26px 24px;margin:18px 0}\n"
    ".card img{width:100%;height:auto;display:block;margin-bottom:6px;image-rendering:auto}\n"
    ".card b{font-size:18px}\n"
    "details{margin:14px 0}summary{cursor:pointer;color:#0062a3}\n"
    "details table{font-size:13px}\n";

typedef struct Page {
    FILE *file;
    const Study *study;
    const ReportLook *look;
    Plots plots;
} Page;

void html_text(FILE *file, const char *text)
{
    for (; *text; text++) {
        if (*text == '<')
            fputs("&lt;", file);
        else if (*text == '>')
            fputs("&gt;", file);
        else if (*text == '&')
            fputs("&amp;", file);
        else if (*text == '"')
            fputs("&quot;", file);
        else
            fputc(*text, file);
    }
}

/* Print a text between two pieces of markup. */
static void put(const Page *page, const char *before, const char *text, const char *after)
{
    fputs(before, page->file);
    html_text(page->file, text);
    fputs(after, page->file);
}

static void put_percent(const Page *page, const char *before, double error, const char *after)
{
    char text[32];
    report_percent(error, text);
    put(page, before, text, after);
}

static void put_time(const Page *page, const char *before, double seconds, const char *after)
{
    char text[32];
    report_time(seconds, text);
    put(page, before, text, after);
}

/* What a user writes, or a remark where there is nothing to write. */
static void put_how(const Page *page, const char *how)
{
    bool is_remark = how[0] == '(';
    put(page, is_remark ? "<span class=\"quiet\">" : "<code>", how,
        is_remark ? "</span>" : "</code>");
}

static const StudyRow *own_of(const Page *page)
{
    return &page->study->analysis.rows[0];
}

/* --- the top -------------------------------------------------------------------------------- */

static void put_head(const Page *page)
{
    const RenderOptions *render = &page->study->options.render;
    const char *name = path_base(page->study->base.scene->path);
    put(page,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>What accuracy "
        "costs: ",
        name, "</title>\n<style>\n");
    fputs(style, page->file);
    put(page, "</style></head>\n<body><main>\n<h1>What accuracy costs: ", name, "</h1>\n");
    fprintf(page->file,
            "<p class=\"sub\">%d &times; %d pixels &middot; %d thread%s &middot; pms %s &middot; "
            "%d of %d renders measured</p>\n",
            render->width, render->height, render->threads, render->threads == 1 ? "" : "s",
            PMS_VERSION, study_done_count(page->study), study_run_count(page->study));
}

/* The setting that takes most off the error. */
static void put_lead(const Page *page)
{
    const StudyAnalysis *all = &page->study->analysis;
    put_time(page, "<p class=\"lead\">As it stands, the scene renders in <b>",
             own_of(page)->seconds, "</b>");
    put_percent(page, " and is <b>", own_of(page)->error, "</b> from the truth. ");
    const StudyTrend *most = NULL;
    for (int i = 0; i < all->trend_count && !most; i++)
        if (!isnan(all->trends[i].own))
            most = &all->trends[i];
    if (most && most->part < 0.95) {
        put(page, "The one setting that matters most is <b>",
            setting_title((SettingId)most->setting), "</b>");
        put_percent(page, ": alone it brings the error to ", most->best, ". ");
    }
    if (all->front_count > 0) {
        const StudyRow *best = &all->rows[all->front[all->front_count - 1]];
        put_percent(page, "The best picture measured is ", best->error, " off");
        put_time(page, ", in ", best->seconds, ".");
    }
    fputs(
        "</p>\n<p class=\"quiet\">The error is what 95 % of the pixels stay below: the difference "
        "to the truth in luminance, over the luminance there (in the dark, over a tenth of the "
        "picture&rsquo;s mean). The estimates of pms speak of that figure, "
        "too.</p>\n",
        page->file);
}

/* --- recommendations ------------------------------------------------------------------------ */

static void put_advice_row(const Page *page, const StudyAdvice *advice)
{
    char basis[160];
    report_basis(page->study, advice, basis);
    put_percent(page, "<tr><td class=\"b\">", advice->target, "</td><td class=\"n\">");
    if (advice->kind == ADVICE_NONE) {
        put(page, "&ndash;</td><td colspan=\"2\" class=\"no\">", basis, "</td></tr>\n");
        return;
    }
    put_time(page, "", advice->seconds, "</td><td>");
    put_how(page, advice->how);
    put(page, "</td><td class=\"quiet\">", basis, "</td></tr>\n");
}

static void put_advice(const Page *page)
{
    fputs("<h2>What to set</h2>\n<p>The cheapest way to each accuracy. Options go on the command "
          "line, lines go into the scene.</p>\n<table><tr><th>error</th><th class=\"n\">time</th>"
          "<th>set</th><th>on what grounds</th></tr>\n",
          page->file);
    for (int i = 0; i < STUDY_TARGETS; i++)
        put_advice_row(page, &page->study->analysis.advice[i]);
    fputs("</table>\n", page->file);
}

/* --- plots ---------------------------------------------------------------------------------- */

static void put_plot(const Page *page, const char *svg, int width)
{
    fprintf(page->file, "<figure style=\"max-width:%dpx\">\n", width);
    fputs(svg, page->file);
    fputs("</figure>\n", page->file);
}

static void put_main_plot(const Page *page)
{
    if (!page->plots.main)
        return;
    fputs("<h2>Error against time</h2>\n<p>Each line is one setting, all others as the scene has "
          "them, some with 16 samples of a pixel besides. The grey stairs are the front: nothing "
          "is both faster and better. Down and to the left is better. A line that is flat buys "
          "nothing for its time; one "
          "that falls by half while the time doubles has slope &minus;1. Dotted lines are the "
          "fits.</p>\n",
          page->file);
    put_plot(page, page->plots.main, 1100);
}

static void put_panels(const Page *page)
{
    if (!page->plots.settings)
        return;
    fputs("<p>The same by value. The ring is the scene&rsquo;s own value; bars are the spread over "
          "seeds, where there is more than one.</p>\n",
          page->file);
    put_plot(page, page->plots.settings, 1100);
}

/* --- the front ------------------------------------------------------------------------------ */

static Status put_card(const Page *page, const StudyRow *row)
{
    bool has_picture = file_exists(study_picture_path(page->study, row->point).text);
    fputs(has_picture ? "<div class=\"card\">"
                      : "<div class=\"card\">(its picture was removed)<br>",
          page->file);
    if (has_picture) {
        TRY(thumbnail_print(page->file, page->study, row->point, page->look, row->point->how));
        TRY(thumbnail_print_error(page->file, page->study, row->point, "visible error"));
    }
    put_time(page, "<b>", row->seconds, "</b>");
    put_percent(page, " &nbsp; ", row->error, "<br>");
    put_how(page, row->point->how);
    fprintf(page->file, "<div class=\"quiet\">FLIP %.3f</div></div>\n", row->flip);
    return OK;
}

static Status put_reference_card(const Page *page)
{
    fputs("<div class=\"card\">", page->file);
    TRY(thumbnail_print(page->file, page->study, NULL, page->look, "the reference"));
    put(page, "<b>the reference</b><br><span class=\"quiet\">", page->study->truth.method,
        "</span></div>\n");
    return OK;
}

/* Show the front, or some of it, evenly. */
static Status put_front(const Page *page)
{
    const StudyAnalysis *all = &page->study->analysis;
    int shown = all->front_count < SHOWN_MOST ? all->front_count : SHOWN_MOST;
    fputs("<h2>The front</h2>\n<p>Nothing that was measured is both faster and better than these. "
          "Below each picture is where its error can be seen (FLIP): black is invisible, bright is "
          "plain.</p>\n<div class=\"strip\">\n",
          page->file);
    for (int i = 0; i < shown; i++) {
        int at = shown > 1 ? i * (all->front_count - 1) / (shown - 1) : 0;
        TRY(put_card(page, &all->rows[all->front[at]]));
    }
    TRY(put_reference_card(page));
    fputs("</div>\n", page->file);
    return OK;
}

/* --- settings ------------------------------------------------------------------------------- */

static void put_trend(const Page *page, const StudyTrend *trend)
{
    const StudyAnalysis *all = &page->study->analysis;
    char halving[48];
    report_halving(trend, halving);
    put(page, "<tr><td>", setting_title((SettingId)trend->setting), trend->is_fine ? " *" : "");
    fputs("</td><td>", page->file);
    for (int i = 0; i < trend->count; i++) {
        bool is_own = trend->rows[i] == trend->own_row;
        char label[SETTING_LABEL_MAX];
        setting_label((SettingId)trend->setting, study_trend_value(all, trend, i), label);
        put(page, i ? ", " : "", "", is_own ? "<b>" : "");
        put(page, "", label, is_own ? "</b>" : "");
    }
    put_percent(page, "</td><td class=\"n\">", trend->best, "</td><td class=\"n\">");
    if (trend->fit.count >= 2)
        fprintf(page->file, "%.2f", trend->fit.slope);
    put(page, "</td><td>", halving, "</td></tr>\n");
}

/* What packing photons into 20 bytes costs. */
static void put_precision(const Page *page, const StudyTrend *trend)
{
    const StudyAnalysis *all = &page->study->analysis;
    if (trend->setting != SETTING_PRECISION || trend->count < 2)
        return;
    put_percent(page, "<p>A photon takes 20 bytes: so the error is ",
                all->rows[trend->rows[0]].error, "");
    put_percent(page, ". Kept in full, in 44 bytes, photons leave ",
                all->rows[trend->rows[1]].error, ".</p>\n");
}

static void put_settings(const Page *page)
{
    const StudyAnalysis *all = &page->study->analysis;
    fputs(
        "<h2>What halving the error costs</h2>\n<p>By one setting alone, the others being left as "
        "they are (the scene's own value is bold). &ldquo;Not by this alone&rdquo; means that "
        "something else makes most of the error. Those with a star were tried with 16 samples of a "
        "pixel, so that edges do not hide what they "
        "do.</p>\n<table><tr><th>setting</th><th>tried</th>"
        "<th class=\"n\">best error</th><th class=\"n\">slope</th><th>half the error for</th></tr>"
        "\n",
        page->file);
    for (int i = 0; i < all->trend_count; i++)
        put_trend(page, &all->trends[i]);
    fputs("</table>\n", page->file);
    for (int i = 0; i < all->trend_count; i++)
        put_precision(page, &all->trends[i]);
    put_panels(page);
}

/* --- what it rests on ----------------------------------------------------------------------- */

static void put_estimate(const Page *page)
{
    fputs("<h2>Estimate against truth</h2>\n", page->file);
    if (page->plots.estimate) {
        fputs("<p>What the program itself says its error is, beside what it is. Points between the "
              "broken lines are within 0.7 and 1.5 times the truth.</p>\n",
              page->file);
        put_plot(page, page->plots.estimate, 660);
    } else {
        fputs("<p class=\"quiet\">The renders of this study came without an estimate of their "
              "error.</p>\n",
              page->file);
    }
}

static void put_reference(const Page *page)
{
    const Truth *truth = &page->study->truth;
    put(page, "<h2>The reference</h2>\n<p>", truth->method, "");
    if (truth->seconds > 0)
        put_time(page, ", built in ", truth->seconds, "");
    fputs(". ", page->file);
    if (isnan(truth->noise.percentile)) {
        fputs("Its own error is not known and counts in every error here.</p>\n", page->file);
        return;
    }
    put_percent(page,
                "It is the mean of two halves with different random numbers; from how they differ "
                "its own noise is <b>",
                truth->noise.percentile,
                "</b>, in the measure used here, and was taken off every error, as squares are. ");
    if (truth->rel_blur2 > 0)
        put_percent(page, "What the halves have in common cannot be seen so: a blur of about <b>",
                    sqrt(truth->rel_blur2), "</b> in the root of the mean square. ");
    else if (isnan(truth->rel_blur2))
        fputs("What they have in common, the last of the blur, is not known. ", page->file);
    else
        fputs("What they have in common, the last of the blur, is too small to tell. ", page->file);
    fprintf(page->file, "FLIP has that noise in it: %.3f.</p>\n", truth->noise.flip);
}

static void put_point(const Page *page, const char *before, const StudyPoint *point)
{
    put(page, before, report_name(point), " ");
    put(page, "", point->label, point->is_fine ? " with 16 samples" : "");
}

/* The values that there was no time for at all. */
static void put_unseen(const Page *page)
{
    const Study *study = page->study;
    const char *before = "Not seen at all: ";
    for (int i = 0; i < study->count; i++) {
        if (study->runs[STUDY_SEEDS * i].is_done || study->refusals[i])
            continue;
        put_point(page, before, &study->points[i]);
        before = "; ";
    }
    fputs(*before == ';' ? "." : "", page->file);
}

/* The values that cannot be rendered. */
static void put_refused(const Page *page)
{
    const Study *study = page->study;
    const char *head = "<table><tr><th>cannot be rendered</th><th>why</th></tr>\n", *end = "";
    for (int i = 0; i < study->count; i++) {
        if (!study->refusals[i])
            continue;
        fputs(head, page->file);
        put_point(page, "<tr><td>", &study->points[i]);
        put(page, "</td><td>", study->refusals[i], "</td></tr>\n");
        head = "";
        end = "</table>\n";
    }
    fputs(end, page->file);
}

static void put_left_out(const Page *page)
{
    const Study *study = page->study;
    int runs = study_run_count(study), left = study_left_count(study);
    fputs("<h2>What was left out</h2>\n<p>", page->file);
    if (study_done_count(study) == runs)
        fputs("Nothing: every value was rendered with three seeds.", page->file);
    if (left > 0)
        fprintf(page->file,
                "%d of %d renders were not made: the time was over. The same command with "
                "more <code>--time</code> goes on. ",
                left, runs);
    put_unseen(page);
    fputs("</p>\n", page->file);
    put_refused(page);
}

static void put_all_row(const Page *page, const StudyRow *row)
{
    bool is_own = row->point->setting == SETTING_OWN;
    put(page, "<tr><td>", is_own ? "scene" : setting_name((SettingId)row->point->setting), "");
    put(page, " ", row->point->label, row->point->is_fine ? ", 16 samples</td>" : "</td>");
    put_time(page, "<td class=\"n\">", row->seconds, "</td>");
    put_time(page, "<td class=\"n\">",
             row->phase[PHASE_PHOTON_EMIT] + row->phase[PHASE_PHOTON_BUILD], "</td>");
    put_time(page, "<td class=\"n\">", row->phase[PHASE_IRRADIANCE] + row->phase[PHASE_EYE],
             "</td>");
    put_percent(page, "<td class=\"n\">", row->error, "</td>");
    if (isnan(row->estimate))
        fputs("<td></td>", page->file);
    else
        put_percent(page, "<td class=\"n\">", row->estimate, "</td>");
    /* Nothing is left of what is not above the noise of the reference. */
    if (row->rmse > 0)
        fprintf(page->file, "<td class=\"n\">%.3g</td>", row->rmse);
    else
        fputs("<td class=\"n\">in the noise</td>", page->file);
    fprintf(page->file, "<td class=\"n\">%.4f</td>", row->flip);
    if (isnan(row->spread))
        fputs("<td></td>", page->file);
    else
        put_percent(page, "<td class=\"n\">", row->spread, "</td>");
    fprintf(page->file, "<td class=\"n\">%d</td></tr>\n", row->seeds);
}

static void put_all(const Page *page)
{
    fputs("<details><summary>Every value that was measured</summary>\n<table><tr><th>setting</th>"
          "<th class=\"n\">time</th><th class=\"n\">photons</th><th class=\"n\">eye</th>"
          "<th class=\"n\">error</th><th class=\"n\">estimate</th><th class=\"n\">RMSE</th><th "
          "class=\"n\">FLIP</th>"
          "<th class=\"n\">spread</th><th class=\"n\">seeds</th></tr>\n",
          page->file);
    for (int i = 0; i < page->study->analysis.row_count; i++)
        put_all_row(page, &page->study->analysis.rows[i]);
    fputs("</table></details>\n", page->file);
}

/* --- all of it ------------------------------------------------------------------------------ */

static Status put_page(const Page *page)
{
    put_head(page);
    put_lead(page);
    put_advice(page);
    put_main_plot(page);
    TRY(put_front(page));
    put_settings(page);
    put_estimate(page);
    put_reference(page);
    put_left_out(page);
    put_all(page);
    fputs("</main></body></html>\n", page->file);
    return OK;
}

Status page_write(const Study *study, const ReportLook *look)
{
    StudyPath path = study_path(study, "study.html");
    char *text = NULL;
    size_t size = 0;
    Page page = {.study = study, .look = look};
    TRY(plots_make(study, study->arena, &page.plots));
    page.file = open_memstream(&text, &size);
    if (!page.file)
        return diag_no_memory(study->diag, path.text);
    Status status = put_page(&page);
    if (fclose(page.file) != 0 && status == OK)
        status = diag_no_memory(study->diag, path.text);
    if (status == OK)
        status = file_write(study->diag, path.text, text, size);
    free(text);
    return status;
}
