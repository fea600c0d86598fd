/* Errors taken aside: messages of what may fail are kept, and told later where they belong.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_ASIDE_H
#define PMS_STUDY_ASIDE_H

#include "base/diag.h"

enum { ASIDE_TEXT_MAX = 400 };

/* What `diag` is told goes on to another, but for errors. */
typedef struct Aside {
    Diag diag;
    Diag *shown;
    char text[ASIDE_TEXT_MAX]; /* the errors since aside_clear, with "; " between; cut if long */
} Aside;

/* Make aside->diag pass warnings on to `shown` and keep errors.  It must not move until
 * aside_done. */
void aside_init(Aside *aside, Diag *shown);
void aside_done(Aside *aside);

/* Forget the errors. */
void aside_clear(Aside *aside);

/* Return why a call ended with `status`: the errors, or what the status means.  Borrowed. */
const char *aside_reason(const Aside *aside, Status status);

#endif
