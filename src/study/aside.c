/* Errors taken aside.  SPDX-License-Identifier: Apache-2.0 */
#include "study/aside.h"

#include <stdio.h>
#include <string.h>

/* How a message of diag_fail begins. */
static const char error_begin[] = "pms: error: ";

/* Keep an error, without its beginning and the end of its line. */
static void take_message(void *ctx, const char *text)
{
    Aside *aside = ctx;
    size_t begin = sizeof error_begin - 1, used = strlen(aside->text);
    if (strncmp(text, error_begin, begin) != 0) {
        diag_say(aside->shown, text);
        return;
    }
    int length = (int)strcspn(text + begin, "\n");
    snprintf(aside->text + used, sizeof aside->text - used, "%s%.*s", used ? "; " : "", length,
             text + begin);
}

void aside_init(Aside *aside, Diag *shown)
{
    aside->shown = shown;
    aside_clear(aside);
    diag_init(&aside->diag, take_message, aside);
}

void aside_done(Aside *aside)
{
    diag_done(&aside->diag);
}

void aside_clear(Aside *aside)
{
    aside->text[0] = 0;
}

const char *aside_reason(const Aside *aside, Status status)
{
    return aside->text[0] ? aside->text : status_text(status);
}
