/* From scene light to display colours, through OpenColorIO.  No C++ type crosses this header.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_OCIO_H
#define PMS_IMAGE_OCIO_H

#include "base/diag.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct Ocio Ocio;

/* Open a colour configuration.
 *
 * config  a file; NULL: $OCIO, or else pms's own (stdlib/pms.ocio, compiled in).
 * Fails with ERR_LIBRARY or ERR_FILE.  Free with ocio_free. */
Status ocio_new(Diag *diag, const char *config, Ocio **out);
void ocio_free(Ocio *ocio);

/* Convert linear Rec.709 (the config's scene_linear role) pixels to a display, in place.
 *
 * display, view  NULL: the config's defaults.  An unknown name fails with ERR_USAGE and lists
 *                the known ones.
 * pixels         count * channels floats, channels 3 or 4; alpha is left alone. */
Status ocio_apply(Diag *diag, const Ocio *ocio, const char *display, const char *view,
                  float *pixels, size_t count, int channels);

/* Return true if this display and view encode as sRGB (the PNG then says so). */
bool ocio_is_srgb(const Ocio *ocio, const char *display, const char *view);

/* Return the name of the config's file, or "built in". */
const char *ocio_name(const Ocio *ocio);

#endif
