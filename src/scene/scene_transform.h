/* Moving a whole scene: everything in it that has a place, a direction or a length follows, so that
 * the picture is the same.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SCENE_SCENE_TRANSFORM_H
#define PMS_SCENE_SCENE_TRANSFORM_H

#include "scene/node.h"

/* A turn, then a scaling by the same factor in all directions, then a shift. */
typedef struct Similarity {
    double scale; /* above 0 */
    Xform turn;   /* orthonormal, without a shift */
    Xform place;  /* all three */
} Similarity;

Similarity similarity_make(const Xform *turn, double scale, V3 shift);

/* Apply `by` to what was read of a scene, before scene_build_finish.  A scaling by a power of two
 * is without rounding.  Returns false when memory is out. */
bool scene_transform(SceneBuild *build, Scene *scene, const Similarity *by);

#endif
