/* What the two halves of the command line parser share.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_ARGS_INT_H
#define PMS_CLI_ARGS_INT_H

#include "cli/cli.h"

/* Take `word` if it is one of POV-Ray's switches (+W320, -A, Declare=N=3 ...); *is_taken says
 * whether it was.  ERR_USAGE after a message for a switch with a bad value, or one pms lacks. */
Status pov_switch(Args *args, const char *word, bool *is_taken);

Status args_add_output(Args *args, const char *path);
Status args_add_library(Args *args, const char *path);
Status args_add_operand(Args *args, const char *operand);
Status args_add_declare(Args *args, const char *text);

/* Take the effects of --effect: NAME=on|off, with commas between. */
Status args_add_effects(Args *args, const char *text);

/* Take --no-photons: no effect that photons bring. */
void args_add_no_photons(Args *args);

/* Fill in what --progressive and the options beside it ask for. */
Status args_progressive(const Args *args, RenderOptions *out);

#endif
