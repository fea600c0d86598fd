/* Meshes.
 *
 * A mesh with an inside vector is a solid: along a line its triangles are entered and left in
 * turn, each line meeting exactly one triangle around an edge.  Where their number is odd the
 * mesh has a hole there and they are sheets.  Without an inside vector all are sheets.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

#include "base/mem.h"

Status mesh_index(Diag *diag, MeshData *mesh, int threads)
{
    Bound all = BOUND_EMPTY;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        all = bound_add(all, mesh->vertices[i]);
    TRY(tri_index_new(diag, mesh->vertices, mesh->vertex_count, mesh->corners, mesh->triangle_count,
                      threads, &mesh->index));
    mesh->bound = bound_pad(all);
    /* The sign of the volume says where the winding's normals point. */
    double volume = 0;
    V3 middle = bound_center(all);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *c = mesh->corners + 3 * i;
        V3 a = v3_sub(mesh->vertices[c[0]], middle), b = v3_sub(mesh->vertices[c[1]], middle);
        volume += v3_dot(v3_cross(v3_sub(mesh->vertices[c[2]], middle), b), a);
    }
    mesh->is_turned = mesh->has_inside && volume < 0;
    return OK;
}

void mesh_done(MeshData *mesh)
{
    tri_index_free(mesh->index);
    mesh->index = NULL;
}

Shape *shape_mesh(Arena *arena, const MeshData *mesh)
{
    Shape *shape = leaf_new(arena, SHAPE_MESH);
    if (!shape)
        return NULL;
    shape->u.mesh = mesh;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* Return the flat normal of a triangle, in the language's sense, not unit. */
static V3 flat_normal(const MeshData *mesh, uint32_t triangle)
{
    const uint32_t *c = mesh->corners + 3 * (size_t)triangle;
    V3 a = mesh->vertices[c[0]];
    V3 n = v3_cross(v3_sub(mesh->vertices[c[2]], a), v3_sub(mesh->vertices[c[1]], a));
    return mesh->is_turned ? v3_neg(n) : n;
}

static Ray local_part(const LocalRay *local, double tmin, double tmax)
{
    return (Ray){local->o, local->d, tmin, tmax};
}

static void fill(const Shape *shape, const LocalRay *ray, const TriHit *hit, Crossing *out)
{
    double off =
        v3_sum_abs(ray->o_error) + fabs(hit->t) * v3_sum_abs(ray->d_error) + shape->rounding.place;
    *out = (Crossing){.t = hit->t,
                      .t_error = hit->t_error + hit->t_slope * off,
                      .leaf = shape,
                      .part = hit->triangle,
                      .is_visible = true,
                      .u = hit->u,
                      .v = hit->v};
}

static bool mesh_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    LocalRay local;
    TriHit hit;
    local_ray(shape, ray, &local);
    Ray part = local_part(&local, ray->tmin, ray->tmax);
    if (!tri_index_closest(shape->u.mesh->index, &part, &hit))
        return false;
    fill(shape, &local, &hit, out);
    if (shape->u.mesh->has_inside) {
        bool is_entering = v3_dot(flat_normal(shape->u.mesh, hit.triangle), local.d) < 0;
        out->change = out->leaf_change = is_entering ? 1 : -1;
    }
    return true;
}

/* Find all triangles along the line; returns how many are in scratch->triangles. */
static int all_triangles(const MeshData *mesh, const Ray *line, ShapeScratch *scratch)
{
    for (;;) {
        int room = (int)scratch->triangle_capacity;
        int count = tri_index_all(mesh->index, line, scratch->triangles, room);
        if (count <= room)
            return count;
        void *items = scratch->triangles;
        size_t wanted = count < CROSSINGS_MAX ? (size_t)count : (size_t)CROSSINGS_MAX;
        while (scratch->triangle_capacity < wanted &&
               mem_grow(&items, scratch->triangle_capacity, &scratch->triangle_capacity,
                        sizeof *scratch->triangles) == 0)
            scratch->triangles = items;
        if (scratch->triangle_capacity <= (size_t)room) {
            scratch->is_overflown = true;
            return room;
        }
    }
}

static bool mesh_list(const Shape *shape, const Line *part, ShapeScratch *scratch)
{
    const MeshData *mesh = shape->u.mesh;
    LocalRay local;
    local_ray(shape, part->ray, &local);
    Ray line = local_part(&local, -INFINITY, INFINITY);
    int count = all_triangles(mesh, &line, scratch);
    bool is_solid = mesh->has_inside && count % 2 == 0;
    for (int i = 0; i < count; i++) {
        Crossing crossing;
        fill(shape, &local, &scratch->triangles[i], &crossing);
        if (is_solid)
            crossing.change = crossing.leaf_change = i % 2 ? -1 : 1;
        scratch_push(scratch, &crossing);
    }
    return false;
}

/* Are three normals one, as the language measures it? */
static bool are_equal(V3 a, V3 b, V3 c)
{
    return v3_len2(v3_sub(a, b)) <= EPS_LANGUAGE && v3_len2(v3_sub(a, c)) <= EPS_LANGUAGE;
}

static void mesh_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const MeshData *mesh = shape->u.mesh;
    const uint32_t *c = mesh->corners + 3 * (size_t)crossing->part;
    double u = crossing->u, v = crossing->v;
    (void)p;
    V3 a = mesh->vertices[c[0]], ab = v3_sub(mesh->vertices[c[1]], a);
    out->p = v3_mad(v3_mad(a, u, ab), v, v3_sub(mesh->vertices[c[2]], a));
    out->error = 2 * shape->rounding.place;
    out->ng = v3_unit(flat_normal(mesh, crossing->part));
    const uint32_t *nc = mesh->normal_corners + 3 * (size_t)crossing->part;
    if (!mesh->normals || nc[0] == UINT32_MAX)
        return;
    const V3 *n = mesh->normals;
    if (!mesh->is_smooth_by_equals && are_equal(n[nc[0]], n[nc[1]], n[nc[2]]))
        return;
    V3 ns = v3_mad(v3_mad(v3_scale(n[nc[0]], 1 - u - v), u, n[nc[1]]), v, n[nc[2]]);
    out->is_smooth = v3_len2(ns) > 0;
    out->ns = v3_unit(v3_dot(ns, out->ng) < 0 ? v3_neg(ns) : ns);
    const V3 corner[3] = {a, mesh->vertices[c[1]], mesh->vertices[c[2]]};
    const V3 normal[3] = {n[nc[0]], n[nc[1]], n[nc[2]]};
    const double weight[3] = {1 - u - v, u, v};
    out->lift = triangle_lift(out->p, corner, normal, weight);
}

static V2 mesh_uv(const Shape *shape, uint32_t triangle, double u, double v, V3 p)
{
    const MeshData *mesh = shape->u.mesh;
    (void)p;
    if (!mesh->uvs)
        return (V2){0, 0};
    const uint32_t *c = mesh->uv_corners + 3 * (size_t)triangle;
    V2 a = mesh->uvs[c[0]], b = mesh->uvs[c[1]], d = mesh->uvs[c[2]];
    double w = 1 - u - v;
    return (V2){w * a.u + u * b.u + v * d.u, w * a.v + u * b.v + v * d.v};
}

static bool mesh_is_inside(const Shape *shape, V3 p)
{
    const MeshData *mesh = shape->u.mesh;
    if (!mesh->has_inside)
        return false;
    Ray ray = {p, mesh->inside_vector, 0, INFINITY};
    return tri_index_all(mesh->index, &ray, NULL, 0) % 2 == 1;
}

static Bound mesh_bound(const Shape *shape)
{
    Bound b = shape->u.mesh->bound;
    if (shape->is_transformed)
        b = bound_transform(b, &shape->xform);
    return shape->rounding.is_exact ? b : bound_pad(b);
}

static V3 mesh_farthest(const Shape *shape, V3 n)
{
    return bound_farthest(shape->u.mesh->bound, n);
}

static double mesh_size(const Shape *shape)
{
    const Bound *b = &shape->u.mesh->bound;
    return bound_is_empty(*b) ? 0 : num_max(v3_max_abs(b->lo), v3_max_abs(b->hi));
}

const ShapeOps mesh_ops = {.list = mesh_list,
                           .closest = mesh_closest,
                           .point = mesh_point,
                           .uv = mesh_uv,
                           .is_inside = mesh_is_inside,
                           .bound = mesh_bound,
                           .farthest = mesh_farthest,
                           .size = mesh_size};
