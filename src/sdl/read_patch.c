/* bicubic_patch.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "shape/patch.h"

enum { PATCH_STEPS_MAX = 1000 }; /* more is no mistake: the flatness ends it before */

/* Take `type` and its number; both kinds look the same here. */
static void read_type(Parser *p)
{
    Span span;
    parse_next(p);
    double type = read_finite(p, "the type of a bicubic_patch", &span);
    if (type != 0 && type != 1)
        parse_warn(p, WARN_GEOMETRY, span,
                   "the type of a bicubic_patch is 0 or 1, not %g: 1 is used", type);
}

static int read_steps(Parser *p, const char *what)
{
    parse_next(p);
    double steps = read_not_negative(p, what);
    return steps < PATCH_STEPS_MAX ? (int)steps : PATCH_STEPS_MAX;
}

static void read_corner_uvs(Parser *p, Patch *patch)
{
    parse_next(p);
    for (int i = 0; i < 4; i++) {
        patch->uv[i] = parse_v2(p);
        parse_comma(p);
    }
}

/* Read one of the settings before the points; returns false if none comes next. */
static bool read_patch_item(Parser *p, Patch *patch, bool *has_type)
{
    switch (parse_peek(p)->kind) {
    case KW_TYPE:
        read_type(p);
        *has_type = true;
        return true;
    case KW_FLATNESS:
        parse_next(p);
        patch->flatness = read_finite(p, "flatness", NULL);
        return true;
    case KW_ACCURACY:
        parse_next(p);
        read_finite(p, "accuracy", NULL);
        return true;
    case KW_U_STEPS:
        patch->u_steps = read_steps(p, "u_steps");
        return true;
    case KW_V_STEPS:
        patch->v_steps = read_steps(p, "v_steps");
        return true;
    case KW_UV_VECTORS:
        read_corner_uvs(p, patch);
        return true;
    default:
        return false;
    }
}

/* Make the leaf of a patch that has been read. */
static Node *finish_patch(Parser *p, const Patch *patch, Span span)
{
    int u, v;
    MeshData *mesh = parse_alloc(p, sizeof *mesh);
    if (!patch_halvings(patch, &u, &v))
        parse_fail(p, span,
                   "the patch would need more than %d cells: wants fewer steps or a "
                   "larger flatness",
                   1 << PATCH_HALVINGS_MAX);
    if (!patch_mesh(parse_arena(p), patch, u, v, mesh))
        parse_no_null(p, NULL);
    if (mesh->triangle_count == 0) {
        parse_warn(p, WARN_GEOMETRY, span, "the patch has no area: it is not seen");
        return read_empty(p);
    }
    return read_mesh_leaf(p, mesh);
}

Node *read_bicubic_patch(Parser *p)
{
    Span brace = parse_last_span(p);
    bool has_type = false;
    Patch patch = {.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    do {
        parse_comma(p);
    } while (read_patch_item(p, &patch, &has_type));
    if (!has_type)
        parse_fail(p, brace, "a bicubic_patch wants its `type`, 0 or 1");
    for (int i = 0; i < 16; i++) {
        patch.point[i / 4][i % 4] = parse_v3(p);
        parse_comma(p);
    }
    return finish_patch(p, &patch, span_join(brace, parse_last_span(p)));
}
