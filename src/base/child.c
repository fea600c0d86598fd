/* Other programs, run and waited for.  SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* posix_spawn_file_actions_addchdir_np */
#include "base/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

/* Signals that pms ignores are not ignored by what it runs. */
static void set_signals(posix_spawnattr_t *attributes)
{
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    sigaddset(&defaults, SIGXFSZ);
    posix_spawnattr_setsigdefault(attributes, &defaults);
    posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF);
}

static int start(char *const *words, const char *folder, const char *output, const char *log,
                 pid_t *child)
{
    const int write = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    int error = posix_spawn_file_actions_init(&files);
    if (error)
        return error;
    error = posix_spawnattr_init(&attributes);
    if (!error) {
        set_signals(&attributes);
        posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&files, 1, output, write, 0666);
        posix_spawn_file_actions_addopen(&files, 2, log, write, 0600);
        if (folder)
            posix_spawn_file_actions_addchdir_np(&files, folder);
        error = posix_spawnp(child, words[0], &files, &attributes, words, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&files);
    return error;
}

Status child_run(Diag *diag, char *const *words, const char *folder, const char *output,
                 const char *log, int *wait_status)
{
    pid_t child;
    int error = start(words, folder, output, log, &child);
    if (error == ENOENT)
        return ERR_FILE;
    if (error)
        return diag_fail(diag, ERR_LIBRARY, "cannot run %s: %s", words[0], strerror(error));
    while (waitpid(child, wait_status, 0) < 0) {
        if (errno != EINTR)
            return diag_fail(diag, ERR_LIBRARY, "cannot wait for %s: %s", words[0],
                             strerror(errno));
    }
    return OK;
}
