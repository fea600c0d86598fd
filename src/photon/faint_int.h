/* How far the light of a photon may be spread; for photon/ only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_FAINT_INT_H
#define PMS_PHOTON_FAINT_INT_H

#include "scene/scene.h"

/* Return the radius of a disk over which `light` gives this part of the light of the brightest lamp
 * in the middle of the scene.
 *
 * light  light times area, largest channel.
 *
 * Scene units; 0: there is no lamp.  Any thread. */
double faint_radius(const Scene *scene, V3 middle, double light, double part);

#endif
