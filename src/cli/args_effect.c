/* --effect: effects forced on or off.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/args_int.h"

#include "base/guess.h"

#include <stdio.h>
#include <string.h>

/* Offer all names of an effect. */
static void try_names(Guess *guess, FeatureId feature, char *words, size_t size)
{
    guess_try(guess, feature_name(feature));
    snprintf(words, size, "%s", feature_aliases(feature));
    for (char *word = words; *word;) {
        char *end = word + strcspn(word, " ");
        bool is_last = !*end;
        *end = 0;
        guess_try(guess, word);
        word = is_last ? end : end + 1;
    }
}

static Status unknown_effect(const Args *args, const char *name, size_t length)
{
    char names[512] = "", words[FEATURE_COUNT][32];
    Guess guess = guess_begin(name, length);
    for (int i = 0; i < FEATURE_COUNT; i++) {
        size_t used = strlen(names);
        try_names(&guess, (FeatureId)i, words[i], sizeof words[i]);
        snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "",
                 feature_name((FeatureId)i));
    }
    if (guess.best)
        return diag_fail(args->diag, ERR_USAGE, "there is no effect '%.*s'; did you mean %s?",
                         (int)length, name, guess.best);
    return diag_fail(args->diag, ERR_USAGE, "there is no effect '%.*s'; there are %s", (int)length,
                     name, names);
}

static Tri read_switch(const char *text, size_t length)
{
    if (length == 2 && memcmp(text, "on", 2) == 0)
        return TRI_ON;
    return length == 3 && memcmp(text, "off", 3) == 0 ? TRI_OFF : TRI_UNSET;
}

Status args_add_effects(Args *args, const char *text)
{
    for (;;) {
        size_t length = strcspn(text, ","), name = strcspn(text, "=,");
        FeatureId feature = feature_find(text, name);
        Tri wanted = name < length ? read_switch(text + name + 1, length - name - 1) : TRI_UNSET;
        if (feature == FEATURE_COUNT)
            return unknown_effect(args, text, name);
        if (wanted == TRI_UNSET)
            return diag_fail(args->diag, ERR_USAGE, "--effect wants %s=on or %s=off, got '%.*s'",
                             feature_name(feature), feature_name(feature), (int)length, text);
        args->effects[feature] = wanted;
        if (!text[length])
            return OK;
        text += length + 1;
    }
}

void args_add_no_photons(Args *args)
{
    args->effects[FEATURE_CAUSTIC_MAP] = TRI_OFF;
    args->effects[FEATURE_GLOBAL_MAP] = TRI_OFF;
    args->effects[FEATURE_VOLUME_MAP] = TRI_OFF;
}
