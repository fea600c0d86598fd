/* The program: find the command and run it.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "base/file.h"
#include "base/guess.h"
#include "base/work.h"

#include <signal.h>
#include <string.h>

typedef struct Command {
    const char *name;
    Status (*run)(Args *args);
} Command;

static const Command commands[] = {
#define X(name, function, bit, operands, text) {name, function},
#include "cli/command.def"
#undef X
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

/* The first signal asks the passes to stop; a second one ends the program at once.  A Ctrl-C that
 * comes to a loop of many passes lets it finish the one at hand. */
static void on_interrupt(int signal_number)
{
    if (signal_number == SIGINT && work_is_patient && !work_ending) {
        work_ending = 1;
        return;
    }
    work_interrupted = 1;
    signal(signal_number, SIG_DFL);
}

static void catch_signals(void)
{
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    /* A reader that goes away, or a full file system limit, is an error of write(), not the
     * end of the program. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

/* What was printed must have arrived. */
static int end(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    fprintf(stderr, "pms: error: cannot write to the standard output\n");
    return code ? code : status_exit_code(ERR_FILE);
}

static Status parse_and_run(const Command *command, Args *args, int argc, char **argv)
{
    bool is_done;
    if (!args->arena)
        return diag_no_memory(args->diag, "the command line");
    TRY(args_parse(args, command->name, argc, argv, &is_done));
    return is_done ? OK : command->run(args);
}

static int run(const Command *command, int argc, char **argv)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    Args args = {.arena = arena_new(), .diag = &diag};
    Status status = parse_and_run(command, &args, argc, argv);
    arena_free(args.arena);
    diag_done(&diag);
    return end(status_exit_code(status));
}

/* Return the command that `word` may be a misspelling of, or NULL; what looks like an option or the
 * name of a scene is none. */
static const char *command_nearest(const char *word)
{
    Guess guess = guess_begin(word, strlen(word));
    for (int i = 0; i < COMMAND_COUNT; i++)
        guess_try(&guess, commands[i].name);
    return strpbrk(word, "./+-=") || file_exists(word) ? NULL : guess.best;
}

static int refuse(const char *word, const char *nearest)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    Status status =
        diag_fail(&diag, ERR_USAGE, "pms has no command '%s'; did you mean %s?", word, nearest);
    diag_done(&diag);
    return status_exit_code(status);
}

int main(int argc, char **argv)
{
    catch_signals();
    for (int i = 0; argc > 1 && i < COMMAND_COUNT; i++) {
        if (strcmp(argv[1], commands[i].name) != 0)
            continue;
        argv[1] = argv[0];
        return run(&commands[i], argc - 1, argv + 1);
    }
    const char *nearest = argc > 1 ? command_nearest(argv[1]) : NULL;
    return nearest ? refuse(argv[1], nearest) : run(&commands[0], argc, argv); /* render */
}
