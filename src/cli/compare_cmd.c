/* pms compare: how far apart two images are.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/verdict.h"
#include "image/z_test.h"

static Status write_difference(const Args *args, const Image *a, const Image *b)
{
    double gain;
    TRY(args_number(args, OPT_GAIN, 0, 1e6, 4, &gain));
    if (!args_has(args, OPT_DIFF))
        return OK;
    Image difference;
    TRY(image_difference(args->diag, a, b, (float)gain, &difference));
    Status status = picture_write(args->diag, args->value[OPT_DIFF], &difference);
    image_done(&difference);
    return status;
}

/* Measure, and make the picture of what flips along with it. */
static Status measure(const Args *args, const Image *a, const Image *reference, CompareResult *out)
{
    Image map = {0};
    bool has_map = args_has(args, OPT_FLIP_MAP);
    TRY(image_compare_flip(args->diag, a, reference, out, has_map ? &map : NULL));
    Status status = has_map ? picture_write(args->diag, args->value[OPT_FLIP_MAP], &map) : OK;
    image_done(&map);
    return status;
}

static void z_test_print(const ZTest *z, const int corner[2])
{
    const char *noise = z->is_exact_a   ? "B alone; A counts as exact"
                        : z->is_exact_b ? "A alone; B counts as exact"
                                        : "both images";
    printf("z-test   with the noise of %s%s\n", noise, z->has_bias ? "; bias subtracted" : "");
    printf("pixels   %zu\n", z->pixels);
    printf("critical %.4g  (level %.3g, Student's t, %d degrees of freedom)\n", z->critical,
           z->level, Z_TEST_FREEDOM);
    printf("accepted %.4f %%  (of %g %% wanted)\n", 100 * z->share, 100 * Z_TEST_SHARE);
    printf("worst    %.4g at %d,%d\n", z->worst, corner[0] + z->worst_x, corner[1] + z->worst_y);
    if (z->bad > 0)
        printf("rejected %zu pixels that are not numbers\n", z->bad);
    printf("verdict  %s\n", z->passes ? "pass" : "fail");
}

static const char *json_bool(bool is_so)
{
    return is_so ? "true" : "false";
}

static void z_test_print_json(const ZTest *z, const int corner[2])
{
    printf(", \"z_test\": {\"exact_a\": %s, \"exact_b\": %s, \"bias\": %s, \"pixels\": %zu",
           json_bool(z->is_exact_a), json_bool(z->is_exact_b), json_bool(z->has_bias), z->pixels);
    printf(", \"level\": %.6g, \"critical_z\": %.6g, \"accepted\": %.6f, \"worst_z\": ", z->level,
           z->critical, z->share);
    json_number(stdout, z->worst);
    printf(", \"worst_x\": %d, \"worst_y\": %d, \"bad\": %zu, \"pass\": %s}",
           corner[0] + z->worst_x, corner[1] + z->worst_y, z->bad, json_bool(z->passes));
}

static void print_all(const Args *args, const CompareResult *result, const ZTest *z,
                      const int corner[2])
{
    bool has_z = args_has(args, OPT_Z_TEST);
    if (args_has(args, OPT_JSON)) {
        printf("{");
        metrics_print_json(stdout, result);
        if (has_z)
            z_test_print_json(z, corner);
        printf("}\n");
    } else {
        metrics_print(stdout, result);
        if (has_z)
            z_test_print(z, corner);
    }
}

static Status z_test_check(Diag *diag, const ZTest *z)
{
    if (z->passes)
        return OK;
    return diag_fail(diag, ERR_COMPARE,
                     "the images differ by more than their noise: %.4f %% of the pixels accept, "
                     "less than %g %%",
                     100 * z->share, 100 * Z_TEST_SHARE);
}

static Status compare_loaded(const Args *args, Image *a, Image *b)
{
    Thresholds limits;
    CompareResult result;
    ZTest z = {.passes = true};
    int corner[2];
    TRY(thresholds_read(args, &limits));
    TRY(crop_apply(args, a, b, corner));
    if (args_has(args, OPT_Z_TEST))
        TRY(z_test(args->diag, a, b, &z));
    TRY(measure(args, a, b, &result));
    TRY(write_difference(args, a, b));
    print_all(args, &result, &z, corner);
    if (args_has(args, OPT_Z_TEST) && result.max_error == 0)
        diag_warn(
            args->diag, WARN_VALUE, SPAN_NONE,
            "the images are the same to the last bit: rendered with one seed, they say nothing "
            "of their noise");
    TRY(z_test_check(args->diag, &z));
    return thresholds_check(args->diag, &limits, &result);
}

Status compare_cmd(Args *args)
{
    TRY(args_want_operands(args, 2, "two images"));
    Image a, b;
    TRY(image_load(args->diag, args->operands[0], &a));
    Status status = image_load(args->diag, args->operands[1], &b);
    if (status == OK)
        status = compare_loaded(args, &a, &b);
    image_done(&a);
    image_done(&b);
    return status;
}
