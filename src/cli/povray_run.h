/* The installed povray, run on the same scene.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_POVRAY_RUN_H
#define PMS_CLI_POVRAY_RUN_H

#include "cli/cli.h"

/* What one program made of a scene. */
typedef struct SideRun {
    Image image;
    double cpu_seconds, wall_seconds;
} SideRun;

/* Run povray on the scene of the command line with the size, antialiasing, quality, threads,
 * libraries and declares given there, and read its picture (16 bits a channel).
 *
 * folder  where its picture and messages go.
 * Fails with ERR_LIBRARY if povray is not installed or fails; its own words are passed on. */
Status povray_run(const Args *args, const RenderOptions *options, const char *folder, SideRun *out);

#endif
