/* How far the light of a photon may be spread.  What is too faint to be seen need not be spread
 * further, which would only take it to where no light goes.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/faint_int.h"

#include "trace/trace.h"

static double brightest_light(const Scene *scene, V3 middle)
{
    double most = 0;
    for (int i = 0; i < scene->light_count; i++) {
        const Light *light = &scene->lights[i];
        float fade = (float)light_fade(light, v3_dist(light->location, middle));
        most = fmax(most, (double)(rgb_max(light->color) * fade));
    }
    return most;
}

double faint_radius(const Scene *scene, V3 middle, double light, double part)
{
    double lamp = brightest_light(scene, middle);
    return lamp > 0 ? sqrt(light / (lamp * part * PMS_PI)) : 0;
}
