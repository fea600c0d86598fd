/* What tests of code that talks through Diag share: a Diag whose last message is kept.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUIET_H
#define PMS_TESTS_QUIET_H

#include "base/diag.h"

#include <stdio.h>

static char last_message[4096];

static void keep(void *ctx, const char *text)
{
    (void)ctx;
    snprintf(last_message, sizeof last_message, "%s", text);
}

/* Return a fresh Diag that prints nothing. */
static inline Diag *quiet(void)
{
    static Diag diag;
    diag_init(&diag, keep, NULL);
    last_message[0] = 0;
    return &diag;
}

#endif
