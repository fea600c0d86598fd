/* The names of effects.  SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan_int.h"

#include <string.h>

typedef struct FeatureInfo {
    const char *name, *aliases, *text;
    int quality;
} FeatureInfo;

static const FeatureInfo features[] = {
#define X(id, name, aliases, quality, text) {name, aliases, text, quality},
#include "plan/feature.def"
#undef X
};

const char *feature_name(FeatureId feature)
{
    return features[feature].name;
}

const char *feature_text(FeatureId feature)
{
    return features[feature].text;
}

const char *feature_aliases(FeatureId feature)
{
    return features[feature].aliases;
}

int feature_quality(FeatureId feature)
{
    return features[feature].quality;
}

static bool has_word(const char *words, const char *word, size_t length)
{
    while (*words) {
        size_t here = strcspn(words, " ");
        if (here == length && memcmp(words, word, length) == 0)
            return true;
        words += here + (words[here] == ' ');
    }
    return false;
}

FeatureId feature_find(const char *name, size_t length)
{
    int i = 0;
    while (i < FEATURE_COUNT && !has_word(features[i].name, name, length) &&
           !has_word(features[i].aliases, name, length))
        i++;
    return (FeatureId)i;
}
