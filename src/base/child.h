/* Other programs, run and waited for.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_CHILD_H
#define PMS_BASE_CHILD_H

#include "base/diag.h"

/* Run a program found on the path until it ends, without input.
 *
 * words        its name and arguments, closed by NULL.
 * folder       that it runs in; NULL: this one.
 * output, log  files that its output and its messages go to, seen from here.
 * wait_status  what waitpid says of its end.
 *
 * ERR_FILE, without a message, if there is no such program: the caller knows what it was for.
 * ERR_LIBRARY after a message if it cannot be run. */
Status child_run(Diag *diag, char *const *words, const char *folder, const char *output,
                 const char *log, int *wait_status);

#endif
