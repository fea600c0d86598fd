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

static Status check_all(Args *args, int argc, char **argv)
{
    bool is_done;
    TRY(args_parse(args, "check", argc, argv, &is_done));
    if (is_done)
        return OK;
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

int check_cmd(int argc, char **argv)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    Args args = {.arena = arena_new(), .diag = &diag};
    Status status =
        args.arena ? check_all(&args, argc, argv) : diag_no_memory(&diag, "the command line");
    arena_free(args.arena);
    diag_done(&diag);
    return status_exit_code(status);
}
