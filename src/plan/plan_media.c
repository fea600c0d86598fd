/* The rows of the plan for what fills space: media, fog, rainbows.
 * SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan_int.h"

static const Medium *first_seen(const Medium *const *media, int count)
{
    for (int i = 0; i < count; i++)
        if (medium_is_seen(media[i]))
            return media[i];
    return NULL;
}

/* Return the first medium of an object in which it counts, or NULL. */
static const Medium *first_contained(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        const Medium *found = first_seen(s->interior->media, s->interior->media_count);
        if (found && s->interior->is_hollow)
            return found;
    }
    return NULL;
}

static void plan_medium(const Scene *scene, PlanRow *row)
{
    const Medium *air = first_seen(scene->atmosphere.media, scene->atmosphere.media_count);
    const Medium *inside = first_contained(scene);
    if (air)
        row_set(row, true, air->span, "media of the atmosphere");
    else if (inside)
        row_set(row, true, inside->span, "media in a hollow object");
    else
        row_set(row, false, SPAN_NONE, "no media, or only in objects that are not hollow");
}

static void plan_fog(const Scene *scene, PlanRow *row)
{
    const Atmosphere *air = &scene->atmosphere;
    for (int i = 0; i < air->fog_count; i++)
        if (air->fogs[i]->distance > 0) {
            row_set(row, true, air->fogs[i]->span, "a fog");
            return;
        }
    row_set(row, false, SPAN_NONE, "%s", air->fog_count > 0 ? "a fog without distance" : "no fog");
}

static void plan_rainbow(const Scene *scene, PlanRow *row)
{
    const Atmosphere *air = &scene->atmosphere;
    for (int i = 0; i < air->rainbow_count; i++)
        if (air->rainbows[i]->map) {
            row_set(row, true, air->rainbows[i]->span, "a rainbow");
            return;
        }
    row_set(row, false, SPAN_NONE, "%s",
            air->rainbow_count > 0 ? "a rainbow without color_map" : "no rainbow");
}

void plan_media(const Scene *scene, const PlanOptions *options, PlanRow *rows)
{
    if (!row_ruled_out(options, FEATURE_MEDIA, rows))
        plan_medium(scene, &rows[FEATURE_MEDIA]);
    if (!row_ruled_out(options, FEATURE_FOG, rows))
        plan_fog(scene, &rows[FEATURE_FOG]);
    if (!row_ruled_out(options, FEATURE_RAINBOW, rows))
        plan_rainbow(scene, &rows[FEATURE_RAINBOW]);
}

static bool any_glows(const Medium *const *media, int count)
{
    for (int i = 0; i < count; i++)
        if (!rgb_is_black(media[i]->emission))
            return true;
    return false;
}

bool plan_media_glow(const Scene *scene)
{
    bool found = any_glows(scene->atmosphere.media, scene->atmosphere.media_count);
    for (uint32_t i = 0; i < scene->surface_count && !found; i++) {
        const Interior *interior = scene->surfaces[i].interior;
        found = interior->is_hollow && any_glows(interior->media, interior->media_count);
    }
    return found;
}

/* --- photons in media --------------------------------------------------------------------- */

static bool collects(const Medium *const *media, int count)
{
    for (int i = 0; i < count; i++)
        if (media[i]->is_collecting && !rgb_is_black(media[i]->scattering))
            return true;
    return false;
}

/* Is there a medium that scatters and in which photons are kept? */
static bool has_collecting(const Scene *scene)
{
    bool found = collects(scene->atmosphere.media, scene->atmosphere.media_count);
    for (uint32_t i = 0; i < scene->surface_count && !found; i++) {
        const Interior *interior = scene->surfaces[i].interior;
        found = interior->is_hollow && collects(interior->media, interior->media_count);
    }
    return found;
}

void plan_volume(const Scene *scene, const PlanOptions *options, Plan *plan)
{
    PlanRow *row = &plan->rows[FEATURE_VOLUME_MAP];
    const PhotonSettings *photons = &scene->settings.photons;
    bool is_forced = options->effects[FEATURE_VOLUME_MAP] == TRI_ON;
    if (row_ruled_out(options, FEATURE_VOLUME_MAP, plan->rows))
        return;
    if (!plan_has(plan, FEATURE_MEDIA) || !has_collecting(scene)) {
        row_set(row, false, SPAN_NONE, "no media scatter light and collect photons");
        return;
    }
    plan->has_volume_focus =
        plan_has(plan, FEATURE_CAUSTIC_MAP) && (photons->media_steps > 0 || is_forced);
    plan->has_volume_indirect = plan_has(plan, FEATURE_GLOBAL_MAP);
    if (plan->has_volume_focus)
        row_set(row, true, photons->span, "%s%s",
                photons->media_steps > 0 ? "media in photons{}" : "media",
                plan->has_volume_indirect ? ", and indirect light" : ": light that targets focus");
    else if (plan->has_volume_indirect)
        row_set(row, true, plan->rows[FEATURE_GLOBAL_MAP].why,
                "indirect light: what media scatter more than once");
    else
        row_set(row, false, SPAN_NONE, "no media steps in photons{}, and no indirect light");
}
