/* finish: how a surface answers light.
 *
 * `diffuse albedo`, `phong albedo` and `specular albedo` give the share of light sent back; the
 * factor that turns it into the plain amount depends on items that may still follow, so it is
 * applied at the closing brace.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

static double diffuse_factor(const Finish *f)
{
    return (f->brilliance + 1.0) / 2;
}

static double phong_factor(const Finish *f)
{
    return (f->phong_size + 1.0) / 2;
}

static double specular_factor(const Finish *f)
{
    double r = f->roughness;
    return (1 / r + 2) / (4 * (2 - pow(2, -1 / (2 * r))));
}

static float scaled(float value, double factor)
{
    return (float)(value * factor);
}

static void apply_albedo(Finish *f)
{
    if (f->is_diffuse_albedo) {
        f->diffuse = scaled(f->diffuse, diffuse_factor(f));
        f->diffuse_back = scaled(f->diffuse_back, diffuse_factor(f));
    }
    if (f->is_phong_albedo)
        f->phong = scaled(f->phong, phong_factor(f));
    if (f->is_specular_albedo)
        f->specular = scaled(f->specular, specular_factor(f));
}

/* Take the factors off again, so that a finish made from another may change roughness. */
static void remove_albedo(Finish *f)
{
    if (f->is_diffuse_albedo) {
        f->diffuse = scaled(f->diffuse, 1 / diffuse_factor(f));
        f->diffuse_back = scaled(f->diffuse_back, 1 / diffuse_factor(f));
    }
    if (f->is_phong_albedo)
        f->phong = scaled(f->phong, 1 / phong_factor(f));
    if (f->is_specular_albedo)
        f->specular = scaled(f->specular, 1 / specular_factor(f));
}

/* --- items --------------------------------------------------------------------------------- */

static float read_amount(Parser *p, const char *what)
{
    return (float)read_finite(p, what, NULL);
}

static void read_diffuse(Parser *p, Finish *f)
{
    parse_next(p);
    f->is_diffuse_albedo = parse_accept(p, KW_ALBEDO);
    f->diffuse = read_amount(p, "diffuse");
    parse_comma(p);
    if (parse_is_expression(p))
        f->diffuse_back = read_amount(p, "diffuse");
}

static void read_roughness(Parser *p, Finish *f)
{
    enum { SMOOTHEST = 1000000 };
    parse_next(p);
    Span span;
    double roughness = read_finite(p, "roughness", &span);
    if (!(roughness > 0)) {
        parse_warn(p, WARN_VALUE, span, "roughness wants a number above 0, got %g: %g is used",
                   roughness, 1.0 / SMOOTHEST);
        roughness = 1.0 / SMOOTHEST;
    }
    f->roughness = (float)roughness;
}

/* A number that may be missing: the keyword alone means 1. */
static float read_optional_amount(Parser *p, const char *what)
{
    parse_next(p);
    return parse_is_expression(p) ? read_amount(p, what) : 1;
}

/* The items in the braces of reflection. */
static void read_reflection_item(Parser *p, Finish *f)
{
    switch (parse_peek(p)->kind) {
    case KW_FRESNEL:
        parse_next(p);
        f->is_fresnel = parse_flag(p);
        break;
    case KW_FALLOFF:
        parse_next(p);
        f->reflection_falloff = read_amount(p, "falloff");
        break;
    case KW_EXPONENT:
        parse_next(p);
        f->reflection_exponent = (float)read_above_zero(p, "exponent");
        break;
    case KW_METALLIC:
        f->reflection_metallic = read_optional_amount(p, "metallic");
        break;
    default:
        parse_fail_here(p, "in reflection");
    }
}

/* reflection RGB, or reflection { RGB [, RGB] items }: from head on to grazing. */
static void read_reflection(Parser *p, Finish *f)
{
    parse_next(p);
    f->is_fresnel = false;
    f->reflection_falloff = 1;
    f->reflection_metallic = 0;
    if (!parse_accept(p, TOKEN_LBRACE)) {
        f->reflection_min = f->reflection_max = read_rgb(p, "reflection");
        return;
    }
    f->reflection_exponent = 1;
    f->reflection_min = f->reflection_max = read_rgb(p, "reflection");
    parse_comma(p);
    bool has_two = parse_is_color(p) || parse_is_expression(p);
    if (has_two)
        f->reflection_max = read_rgb(p, "reflection");
    while (!read_close(p))
        read_reflection_item(p, f);
    if (f->is_fresnel && !has_two)
        f->reflection_min = RGB_BLACK;
}

static void read_irid(Parser *p, Finish *f)
{
    read_open(p);
    f->irid = read_amount(p, "irid");
    while (!read_close(p)) {
        if (parse_accept(p, KW_THICKNESS))
            f->irid_thickness = read_amount(p, "thickness");
        else if (parse_accept(p, KW_TURBULENCE))
            f->irid_turbulence = (float)parse_v3(p).x;
        else
            parse_fail_here(p, "in irid");
    }
}

/* ior, refraction and caustics stood in finish once. */
static void read_old_interior_item(Parser *p, Finish *f)
{
    Token word = parse_next(p);
    parse_warn(p, WARN_LANGUAGE, word.span, "this item belongs in `interior`");
    if (word.kind == KW_IOR)
        f->ior = (float)read_ior(p);
    else if (word.kind == KW_CAUSTICS)
        f->caustics = (float)read_not_negative(p, "caustics");
    else
        read_finite(p, "refraction", NULL); /* filter and transmit decide now */
}

/* ambient, emission, diffuse and what is like them; returns false if none comes next. */
static bool read_matt_item(Parser *p, Finish *f)
{
    switch (parse_peek(p)->kind) {
    case KW_AMBIENT:
        parse_next(p);
        f->ambient = read_rgb(p, "ambient");
        return true;
    case KW_EMISSION:
        parse_next(p);
        f->emission = read_rgb(p, "emission");
        return true;
    case KW_DIFFUSE:
        read_diffuse(p, f);
        return true;
    case KW_BRILLIANCE:
        parse_next(p);
        f->brilliance = (float)read_not_negative(p, "brilliance");
        return true;
    case KW_CRAND:
        parse_next(p);
        f->crand = read_amount(p, "crand");
        return true;
    case KW_IRID:
        read_irid(p, f);
        return true;
    default:
        return false;
    }
}

/* The highlights; returns false if none comes next. */
static bool read_highlight_item(Parser *p, Finish *f)
{
    switch (parse_peek(p)->kind) {
    case KW_PHONG:
        parse_next(p);
        f->is_phong_albedo = parse_accept(p, KW_ALBEDO);
        f->phong = read_amount(p, "phong");
        return true;
    case KW_PHONG_SIZE:
        parse_next(p);
        f->phong_size = (float)read_not_negative(p, "phong_size");
        return true;
    case KW_SPECULAR:
        parse_next(p);
        f->is_specular_albedo = parse_accept(p, KW_ALBEDO);
        f->specular = read_amount(p, "specular");
        return true;
    case KW_ROUGHNESS:
        read_roughness(p, f);
        return true;
    case KW_METALLIC:
        f->metallic = read_optional_amount(p, "metallic");
        return true;
    default:
        return false;
    }
}

static void read_finish_item(Parser *p, Finish *f)
{
    if (read_matt_item(p, f) || read_highlight_item(p, f))
        return;
    switch (parse_peek(p)->kind) {
    case KW_REFLECTION:
        read_reflection(p, f);
        break;
    case KW_REFLECTION_EXPONENT:
        parse_next(p);
        f->reflection_exponent = (float)read_above_zero(p, "reflection_exponent");
        break;
    case KW_CONSERVE_ENERGY:
        parse_next(p);
        f->conserves_energy = true;
        break;
    case KW_IOR:
    case KW_REFRACTION:
    case KW_CAUSTICS:
        read_old_interior_item(p, f);
        break;
    default:
        parse_fail_here(p, "in a finish");
    }
}

const Finish *read_finish(Parser *p, const Finish *base)
{
    read_open(p);
    Finish finish = *base;
    const Value *value = parse_accept_value(p, VALUE_FINISH);
    if (value)
        finish = *(const Finish *)value->node;
    remove_albedo(&finish);
    while (!read_close(p))
        read_finish_item(p, &finish);
    apply_albedo(&finish);
    return parse_copy(p, &finish, sizeof finish);
}
