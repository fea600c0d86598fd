/* A photon pass in small.  With the photons that are sent, f times as many, the area that an
 * estimate covers is to be as many pixels as in full, which are s^2 times as large each: so it
 * takes f s^2 times the photons; a ball takes f s^3 times as many, of which a ray cuts f s^2 times
 * as many as in full.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_pass.h"

#include <limits.h>

double miniature_gather(const Miniature *miniature)
{
    return miniature ? miniature->photons * miniature->side * miniature->side : 1;
}

static int whole(double photons)
{
    return photons < 1 ? 1 : photons > INT_MAX ? INT_MAX : (int)ceil(photons);
}

int miniature_photons(const Miniature *miniature, int most)
{
    return whole(miniature_gather(miniature) * most);
}

int miniature_ball(const Miniature *miniature, int most)
{
    return whole(miniature_radius(miniature, miniature_gather(miniature) * most));
}

double miniature_radius(const Miniature *miniature, double radius)
{
    return miniature ? miniature->side * radius : radius;
}
