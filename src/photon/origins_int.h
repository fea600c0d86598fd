/* Which source of light each photon of a map came from; for photon/ only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_ORIGINS_INT_H
#define PMS_PHOTON_ORIGINS_INT_H

#include "photon/photon_pass.h"

/* Note, before the map is made, that each source of the books sent as many photons as they say,
 * one source after the other; a map of two kinds of photons is noted twice.  ERR_MEMORY or OK. */
Status origins_note(PhotonOrigins *origins, const LightBooks *books, int sources, Diag *diag);

/* Add to the books of each source how many of its photons in a watched map were seen. */
void origins_count_seen(const PhotonOrigins *origins, const PhotonMap *map, LightBooks *books);

void origins_done(PhotonOrigins *origins);

#endif
