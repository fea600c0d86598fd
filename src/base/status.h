/* Status codes: how a fallible call says what became of it.
 *
 * A message is formatted once, where the failure happens, through Diag; the code
 * travels up.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_STATUS_H
#define PMS_BASE_STATUS_H

typedef enum Status {
#define X(name, exit_code, text) name,
#include "base/status.def"
#undef X
    STATUS_COUNT
} Status;

/* Return the program's exit code for `status`.  Never fails. */
int status_exit_code(Status status);

/* Return a short lower-case description of `status`.  Never fails. */
const char *status_text(Status status);

/* Hand a failure to the caller: the one macro in pms that hides a return. */
#define TRY(call)                                                                                  \
    do {                                                                                           \
        Status try_status_ = (call);                                                               \
        if (try_status_ != OK)                                                                     \
            return try_status_;                                                                    \
    } while (0)

#endif
