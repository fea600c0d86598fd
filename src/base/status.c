/* Status codes.  SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

int status_exit_code(Status status)
{
    static const int codes[] = {
#define X(name, exit_code, text) exit_code,
#include "base/status.def"
#undef X
    };
    return codes[status];
}

const char *status_text(Status status)
{
    static const char *const texts[] = {
#define X(name, exit_code, text) text,
#include "base/status.def"
#undef X
    };
    return texts[status];
}
