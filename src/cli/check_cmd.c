/* pms check: read scenes and say what is wrong with them.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

static Status check_one(const Args *args, int index)
{
    Scene *scene;
    double seconds;
    TRY(args_load_scene(args, index, &scene, &seconds));
    printf("%s: ok, %u object%s, %d light%s\n", args->operands[index], scene->object_count,
           scene->object_count == 1 ? "" : "s", scene->light_count,
           scene->light_count == 1 ? "" : "s");
    scene_free(scene);
    return OK;
}

Status check_cmd(Args *args)
{
    if (args->operand_count == 0)
        return diag_fail(args->diag, ERR_USAGE, "pms check wants a scene file");
    Status worst = OK;
    for (int i = 0; i < args->operand_count; i++) {
        Status status = check_one(args, i);
        if (status_exit_code(status) > status_exit_code(worst))
            worst = status;
    }
    return worst;
}
