/* The file of runs: comma-separated values, a line a run.  SPDX-License-Identifier: Apache-2.0 */
#include "study/record.h"

#include "base/file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Seeds of a point are numbered from 0 up to this at most. */
enum { SEED_MOST = 1000 };

enum { RECORD_BYTES_MAX = 64 << 20, COLUMN_KEYS = 4, COLUMNS = COLUMN_KEYS + PHASE_COUNT + 8 };

static void print_heading(FILE *file)
{
    fputs("setting,value,fine,seed,seconds", file);
    for (int i = 0; i < PHASE_COUNT; i++)
        fprintf(file, ",%s", phase_name((PhaseId)i));
    fputs(",mse,relmse,percentile,flip,estimate,bound,gather_radius\n", file);
}

/* What is no number is left empty. */
static void print_number(FILE *file, double number)
{
    if (isfinite(number))
        fprintf(file, ",%.17g", number);
    else
        fputc(',', file);
}

static void print_run(FILE *file, const RunKey *key, const StudyRun *run)
{
    fprintf(file, "%s,%.17g,%d,%d",
            key->setting == SETTING_OWN ? "own" : setting_name((SettingId)key->setting), key->value,
            key->is_fine, key->seed);
    print_number(file, run->seconds);
    for (int i = 0; i < PHASE_COUNT; i++)
        print_number(file, run->phase[i]);
    print_number(file, run->error.square);
    print_number(file, run->error.rel_square);
    print_number(file, run->error.percentile);
    print_number(file, run->error.flip);
    print_number(file, run->estimate);
    print_number(file, run->bound);
    print_number(file, run->radius);
    fputc('\n', file);
}

Status record_append(Diag *diag, const char *path, const RunKey *key, const StudyRun *run)
{
    bool is_new = !file_exists(path);
    FILE *file = fopen(path, "a");
    if (!file)
        return diag_fail(diag, ERR_FILE, "cannot write '%s': %s", path, strerror(errno));
    if (is_new)
        print_heading(file);
    print_run(file, key, run);
    bool is_good = !ferror(file);
    is_good = fclose(file) == 0 && is_good;
    return is_good ? OK : diag_fail(diag, ERR_FILE, "cannot write '%s': %s", path, strerror(errno));
}

/* --- reading -------------------------------------------------------------------------------- */

static bool find_setting(const char *text, size_t length, int *out)
{
    *out = SETTING_OWN;
    if (length == 3 && memcmp(text, "own", 3) == 0)
        return true;
    for (int i = 0; i < SETTING_COUNT; i++)
        if (strlen(setting_name((SettingId)i)) == length &&
            memcmp(setting_name((SettingId)i), text, length) == 0) {
            *out = i;
            return true;
        }
    return false;
}

/* Read a field: a finite number, or NaN for an empty one. */
static bool read_field(const char *text, size_t length, double *out)
{
    char *end;
    *out = NAN;
    if (length == 0)
        return true;
    if (strspn(text, "0123456789+-.e") < length) /* strtod takes blanks, words and hexadecimals */
        return false;
    *out = strtod(text, &end);
    return end == text + length && isfinite(*out);
}

/* Read the numbers after the first column; returns how many there were, -1: not all are. */
static int read_numbers(const char *text, double out[COLUMNS])
{
    int count = 0;
    while (*text == ',' && count < COLUMNS) {
        size_t length = strcspn(++text, ",\n");
        if (!read_field(text, length, &out[count++]))
            return -1;
        text += length;
    }
    return *text == '\n' ? count : -1;
}

static bool read_key(const double numbers[3], RunKey *key)
{
    double value = numbers[0], fine = numbers[1], seed = numbers[2];
    if (isnan(value) || !(fine == 0 || fine == 1) ||
        !(seed >= 0 && seed <= SEED_MOST && seed == floor(seed)))
        return false;
    key->value = value;
    key->is_fine = fine > 0;
    key->seed = (int)seed;
    return true;
}

/* Return true if a run can have been measured so: seconds are known, and only squares are below 0,
 * if the noise of the reference is taken off them. */
static bool has_sense(const StudyRun *run)
{
    bool has_seconds = run->seconds >= 0;
    for (int i = 0; i < PHASE_COUNT; i++)
        has_seconds = has_seconds && run->phase[i] >= 0;
    return has_seconds && !(run->error.percentile < 0) && !(run->error.flip < 0) &&
           !(run->estimate < 0) && !(run->bound < 0) && !(run->radius < 0);
}

static bool read_run(const char *line, RunKey *key, StudyRun *run)
{
    double numbers[COLUMNS];
    size_t length = strcspn(line, ",\n");
    if (!find_setting(line, length, &key->setting) ||
        read_numbers(line + length, numbers) != COLUMNS - 1 || !read_key(numbers, key))
        return false;
    const double *at = numbers + COLUMN_KEYS - 1;
    *run = (StudyRun){.is_done = true, .seconds = *at++};
    for (int i = 0; i < PHASE_COUNT; i++)
        run->phase[i] = *at++;
    run->error = (TruthError){at[0], at[1], at[2], at[3]};
    run->estimate = at[4];
    run->bound = at[5];
    run->radius = isnan(at[6]) ? 0 : at[6];
    return has_sense(run);
}

Status record_read(Diag *diag, const char *path, Arena *arena,
                   void (*take)(void *ctx, const RunKey *key, const StudyRun *run), void *ctx)
{
    const char *text;
    size_t size;
    if (!file_exists(path))
        return OK;
    TRY(file_read(diag, path, RECORD_BYTES_MAX, arena, &text, &size));
    while (*text) {
        RunKey key;
        StudyRun run;
        if (read_run(text, &key, &run))
            take(ctx, &key, &run);
        text += strcspn(text, "\n");
        text += *text == '\n';
    }
    return OK;
}
