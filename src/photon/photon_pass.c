/* The photon pass.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_pass.h"

#include <string.h>

void photon_books_done(PhotonBooks *books)
{
    memset(books, 0, sizeof *books);
}

void photon_maps_done(PhotonMaps *maps)
{
    memset(maps, 0, sizeof *maps);
}

Status photon_pass(const Tracer *tracer, const PhotonOptions *options, Diag *diag, Stats *stats,
                   PhotonMaps *out)
{
    (void)tracer, (void)options, (void)diag, (void)stats;
    memset(out, 0, sizeof *out);
    return OK;
}

Status photon_plan_budgets(const Tracer *tracer, const PhotonOptions *options, Diag *diag,
                           PhotonBooks *out)
{
    (void)tracer, (void)options, (void)diag;
    memset(out, 0, sizeof *out);
    return OK;
}
