/* Triangle meshes: native triangles, shared between instances.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_MESH_H
#define PMS_SHAPE_MESH_H

#include "shape/shape.h"

enum { MESH_NO_TEXTURE = UINT32_MAX };

struct MeshData {
    V3 *vertices;
    uint32_t vertex_count;
    uint32_t *corners; /* 3 a triangle, into vertices */
    uint32_t triangle_count;
    V3 *normals;              /* unit, or NULL: flat */
    uint32_t *normal_corners; /* 3 a triangle, into normals; UINT32_MAX: that triangle is flat */
    V2 *uvs;                  /* or NULL */
    uint32_t *uv_corners;     /* 3 a triangle, into uvs */
    uint32_t *textures;       /* 3 a triangle, into the mesh's texture list (scene), or NULL */
    bool has_inside;          /* inside_vector was given */
    V3 inside_vector;         /* unit */
    bool is_smooth_by_equals; /* triangles with three equal normals have them; else the language
                                 takes them for flat */
    bool is_turned;           /* the winding's normals point inward: set by mesh_index */
    TriIndex *index;          /* made by mesh_index; freed by mesh_done */
    Bound bound;
};

/* Build the index and bound of a mesh whose arrays are filled (they stay borrowed). */
Status mesh_index(Diag *diag, MeshData *mesh, int threads);

/* Free the index. */
void mesh_done(MeshData *mesh);

#endif
