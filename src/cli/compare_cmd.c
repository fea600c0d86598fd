/* pms compare: how far apart two images are.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/verdict.h"

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

static Status write_flip_map(const Args *args, const Image *a, const Image *reference)
{
    if (!args_has(args, OPT_FLIP_MAP))
        return OK;
    Image map;
    TRY(image_flip(args->diag, a, reference, &map));
    Status status = picture_write(args->diag, args->value[OPT_FLIP_MAP], &map);
    image_done(&map);
    return status;
}

static Status compare_loaded(const Args *args, Image *a, Image *b)
{
    Thresholds limits;
    CompareResult result;
    TRY(thresholds_read(args, &limits));
    TRY(region_apply(args, a, b));
    TRY(image_compare(args->diag, a, b, &result));
    TRY(write_difference(args, a, b));
    TRY(write_flip_map(args, a, b));
    if (args_has(args, OPT_JSON)) {
        printf("{");
        metrics_print_json(stdout, &result);
        printf("}\n");
    } else {
        metrics_print(stdout, &result);
    }
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
