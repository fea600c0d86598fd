/* Which source of light each photon of a map came from.
 *
 * Photons are sent source by source, so their numbers before the tree is built tell; the tree
 * keeps these when asked.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/origins_int.h"

#include "base/mem.h"

Status origins_note(PhotonOrigins *origins, const LightBooks *books, int sources, Diag *diag)
{
    size_t count = (size_t)(origins->run_count + sources);
    PhotonRun *runs = mem_resize(origins->runs, (count + 1) * sizeof *runs);
    if (!runs)
        return diag_no_memory(diag, "the sources of photons");
    origins->runs = runs;
    uint64_t end = origins->run_count > 0 ? runs[origins->run_count - 1].end : 0;
    for (int i = 0; i < sources; i++) {
        end += books[i].stored;
        runs[origins->run_count++] = (PhotonRun){end, i};
    }
    return OK;
}

/* Return the source of the photon that had this number. */
static int source_of(const PhotonOrigins *origins, uint64_t number)
{
    int low = 0, high = origins->run_count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (number < origins->runs[middle].end)
            high = middle;
        else
            low = middle + 1;
    }
    return origins->runs[low].source;
}

void origins_count_seen(const PhotonOrigins *origins, const PhotonMap *map, LightBooks *books)
{
    for (size_t i = 0; i < photon_map_count(map); i++)
        if (photon_map_is_seen(map, i))
            books[source_of(origins, origins->order[i])].seen++;
}

void origins_done(PhotonOrigins *origins)
{
    mem_free(origins->order);
    mem_free(origins->runs);
    *origins = (PhotonOrigins){0};
}
