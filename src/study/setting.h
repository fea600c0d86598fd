/* The settings a study tries: when each matters, its values, how it is set in memory and by a user.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_SETTING_H
#define PMS_STUDY_SETTING_H

#include "render/render.h"

typedef enum SettingId {
#define X(id, ...) id,
#include "study/setting.def"
#undef X
    SETTING_COUNT
} SettingId;

/* The scene as it stands, with nothing varied. */
enum { SETTING_OWN = -1 };

/* With few samples of a pixel, edges make most of the error, whatever else is set: other settings
 * are then tried with so many, too. */
enum { FINE_SAMPLES = 16 };

typedef enum SettingKind {
    SETTING_TIMES,  /* values are factors of the scene's own */
    SETTING_VALUES, /* values are tried as they stand */
    SETTING_WORDS,  /* values number words */
    SETTING_WAYS    /* another way to render, of which the scene has no value: as they stand */
} SettingKind;

enum { SETTING_VALUES_MAX = 8, SETTING_LABEL_MAX = 48, SETTING_HOW_MAX = 256 };

/* What a study starts from. */
typedef struct StudyBase {
    const Scene *scene;
    const RenderOptions *options;
    const Plan *plan;
    double radius;       /* the photons are gathered within, scene units; 0: there are none */
    bool has_path_truth; /* path tracing shows the same light */
} StudyBase;

/* A picture to be made: the scene with one thing changed. */
typedef struct StudyPoint {
    int setting;  /* SettingId, or SETTING_OWN */
    double value;
    bool is_fine; /* with FINE_SAMPLES of a pixel besides, so that edges hide nothing */
    char label[SETTING_LABEL_MAX]; /* the value, as it is shown */
    char how[SETTING_HOW_MAX];     /* what a user writes to have it */
    Scene scene;                   /* the study's, with this change */
    RenderOptions options;
    double photon_cost, eye_cost; /* seconds expected, over those of the scene as it stands */
    double seconds;               /* it takes, if that is set; else 0 */
} StudyPoint;

/* Return the name of a setting, as files have it, and its title. */
const char *setting_name(SettingId id);
const char *setting_title(SettingId id);
SettingKind setting_kind(SettingId id);

/* Return the scene's own value (of ways any number); NaN: the setting does not matter to it. */
double setting_own(SettingId id, const StudyBase *base);

/* List the values to try, the scene's own not among them; returns how many. */
int setting_values(SettingId id, const StudyBase *base, double out[SETTING_VALUES_MAX]);

/* Make the point of a value.  ERR_MEMORY or OK. */
Status setting_point(SettingId id, const StudyBase *base, double value, bool is_fine,
                     StudyPoint *out);

/* Make the point of the scene as it stands. */
void setting_point_own(const StudyBase *base, StudyPoint *out);

/* List all points to try, that of the scene as it stands first.  Memory comes from `arena`;
 * ERR_MEMORY or OK. */
Status setting_grid(const StudyBase *base, Arena *arena, StudyPoint **points, int *count);

/* Write a value as it is shown. */
void setting_label(SettingId id, double value, char out[SETTING_LABEL_MAX]);

#endif
