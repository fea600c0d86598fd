/* The pilot: which parts of a beam matter, and how much light it brings.
 *
 * A few rays go through every cell of a beam.  Cells that lie whole inside the target's outline,
 * or whole outside, are settled; those along it are split in four and tried again, as long as
 * the pilot's share of the photons lasts.  The photons then go to the cells that see the target.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/emission_int.h"

#include "base/mem.h"
#include "base/work.h"

enum {
    CELL_RAYS = 2,       /* pilot rays a cell, each way */
    CELL_RAYS_FIRST = 4, /* in the first round, if the pilot may: what it misses is hard to mend */
    SIDE_MIN = 2,
    SIDE_FIRST_MAX = 32,  /* cells a side of the first round */
    SIDE_SEARCH_MAX = 32, /* a beam in which nothing is found is tried up to this */
    SIDE_MAX = 128,
    LINES_TRIED = 1024, /* of a beam of what glows, to see how many carry light */
    PILOT_PART = 4,     /* the pilot sends about this part of the photons, but only to the target */
    PASS_PILOT = 0x710  /* random numbers, by map */
};

typedef enum CellState { CELL_OPEN, CELL_SETTLED } CellState;

typedef struct Cell {
    float flux;       /* that the cell would bring if it were the whole beam, summed RGB */
    float importance; /* how dense photons should be */
    uint8_t hits, rays;
    uint8_t state;
} Cell;

typedef struct Grid {
    int side;
    Cell *cells;
} Grid;

/* How much a cell matters where a pilot ray found this flux: for caustics that it was found;
 * for indirect light flux, less what is far off (its part that comes back goes as the distance
 * squared; the best density is as the root of the product). */
static float importance(const Emission *emission, Rgb flux, V3 at)
{
    if (map_is_aimed(emission->rules.map))
        return 1;
    double far = v3_dist(at, emission->rules.center) / fmax(emission->rules.radius, 1e-300);
    return rgb_sum(flux) / (float)fmax(1, far);
}

/* Send ray `i` of n x n through a cell; returns the flux it finds. */
static Rgb scout_ray(const Emission *emission, TraceThread *thread, const Beam *beam, int side,
                     int cell, int n, int i, V3 *at)
{
    uint64_t item = (emission_beam_number(emission, beam) << 40) + ((uint64_t)side << 28) +
                    ((uint64_t)cell << 8) + (uint64_t)i;
    Rng rng = rng_at(emission->options->seed, PASS_PILOT + (uint32_t)emission->rules.map, item);
    double u = (i % n + rng_double(&rng)) / n, v = (i / n + rng_double(&rng)) / n;
    V2 square = {(cell % side + u) / side, (cell / side + v) / side};
    V2 area = {rng_double(&rng), 0};
    area.v = rng_double(&rng);
    BeamRay ray;
    double choice = beam->light ? 0 : rng_double(&rng);
    if (!emission_ray_at(thread, beam, square, area, choice, &ray))
        return RGB_BLACK;
    Rgb found = photon_scout(thread, &emission->rules, beam, &ray, &rng, at);
    return rgb_is_finite(found) ? found : RGB_BLACK;
}

static Cell scout_cell(const Emission *emission, TraceThread *thread, const Beam *beam, int side,
                       int number, int n)
{
    Cell cell = {.rays = (uint8_t)(n * n)};
    for (int i = 0; i < n * n; i++) {
        V3 at = {0};
        Rgb found = scout_ray(emission, thread, beam, side, number, n, i, &at);
        if (rgb_is_black(found))
            continue;
        cell.flux += rgb_sum(found) / (float)(n * n);
        cell.importance = fmaxf(cell.importance, importance(emission, found, at));
        cell.hits++;
    }
    return cell;
}

/* Settle cells that look like all around them; returns how many are left open. */
static int settle_cells(Grid *grid)
{
    int side = grid->side, open = 0;
    for (int c = 0; c < side * side; c++) {
        const Cell *cell = &grid->cells[c];
        bool is_full = cell->hits == cell->rays, is_settled = is_full || cell->hits == 0;
        for (int y = c / side - 1; y <= c / side + 1; y++)
            for (int x = c % side - 1; x <= c % side + 1; x++)
                if (x >= 0 && y >= 0 && x < side && y < side) {
                    const Cell *near = &grid->cells[y * side + x];
                    is_settled &= near->hits == (is_full ? near->rays : 0);
                }
        grid->cells[c].state = is_settled ? CELL_SETTLED : CELL_OPEN;
        open += !is_settled;
    }
    return open;
}

static bool grid_split(Grid *grid)
{
    int side = grid->side * 2;
    Cell *cells = mem_array((size_t)side * (size_t)side, sizeof *cells);
    if (!cells)
        return false;
    for (int c = 0; c < side * side; c++)
        cells[c] = grid->cells[c / side / 2 * grid->side + c % side / 2];
    mem_free(grid->cells);
    *grid = (Grid){side, cells};
    return true;
}

/* Try the open cells; returns whether anything was found at all. */
static bool scout_grid(const Emission *emission, TraceThread *thread, const Beam *beam,
                       const Grid *grid, int n)
{
    bool has_hits = false;
    for (int c = 0; c < grid->side * grid->side; c++) {
        if (grid->cells[c].state == CELL_OPEN)
            grid->cells[c] = scout_cell(emission, thread, beam, grid->side, c, n);
        has_hits |= grid->cells[c].hits > 0;
    }
    return has_hits;
}

/* Try and split until the outline is fine enough; returns false when memory is out. */
static bool refine_grid(const Emission *emission, TraceThread *thread, const Beam *beam,
                        double rays, int first, Grid *grid)
{
    for (int n = first;; n = CELL_RAYS) {
        bool has_hits = scout_grid(emission, thread, beam, grid, n);
        int open = settle_cells(grid), next = grid->side * 2;
        if (!has_hits) { /* something small may be there all the same */
            if (next > SIDE_SEARCH_MAX)
                return true;
            for (int c = 0; c < grid->side * grid->side; c++)
                grid->cells[c].state = CELL_OPEN;
        } else {
            rays -= (double)open * 4 * CELL_RAYS * CELL_RAYS;
            if (open == 0 || next > SIDE_MAX || rays < 0)
                return true;
        }
        if (!grid_split(grid))
            return false;
    }
}

/* Hand what was found to the beam; returns false when memory is out. */
static bool take_cells(Beam *beam, const Grid *grid)
{
    size_t count = (size_t)grid->side * (size_t)grid->side;
    double flux = 0;
    for (size_t c = 0; c < count; c++)
        flux += (double)grid->cells[c].flux;
    beam->flux = flux / (double)count;
    beam->side = grid->side;
    if (!(flux > 0))
        return true;
    float *found = mem_array(count, sizeof *found);
    beam->cumulative = mem_array(count, sizeof *beam->cumulative);
    if (found && beam->cumulative) {
        for (size_t c = 0; c < count; c++)
            found[c] = grid->cells[c].importance;
        beam_set_cells(beam, found);
    }
    mem_free(found);
    return found && beam->cumulative;
}

/* Lines through a box often miss what glows in it: find how many do not. */
static void try_lines(const Emission *emission, TraceThread *thread, Beam *beam)
{
    Rng rng = rng_at(emission->options->seed, PASS_PILOT + MAP_COUNT,
                     emission_beam_number(emission, beam));
    int lit = 0;
    for (int i = 0; i < LINES_TRIED; i++) {
        V2 u = {rng_double(&rng), 0}, more;
        u.v = rng_double(&rng);
        more.u = rng_double(&rng);
        more.v = rng_double(&rng);
        double density;
        BeamRay ray;
        V2 square = beam_warp(beam, u, &density);
        lit += emitter_ray(thread, beam, square, more, rng_double(&rng), &ray);
    }
    beam->part_lit = fmax(1, lit) / LINES_TRIED;
}

typedef struct Pilot {
    Emission *emission;
    double rays;    /* for a beam */
    bool *is_short; /* per beam: memory ran out */
} Pilot;

static void pilot_beam(void *ctx, size_t index, int thread)
{
    Pilot *pilot = ctx;
    Emission *emission = pilot->emission;
    Beam *beam = &emission->beams[index];
    int side = SIDE_MIN, n = CELL_RAYS;
    while (side < SIDE_FIRST_MAX && (double)(side * side * 4 * n * n) <= pilot->rays)
        side *= 2;
    if ((double)(side * side) * CELL_RAYS_FIRST * CELL_RAYS_FIRST <= pilot->rays)
        n = CELL_RAYS_FIRST;
    uint64_t *counts = emission->threads[thread].stats.count, before = counts[STAT_PHOTON_RAYS];
    Grid grid = {side, mem_array((size_t)(side * side), sizeof(Cell))};
    double rest = pilot->rays - (double)(side * side) * n * n;
    pilot->is_short[index] =
        !grid.cells || !refine_grid(emission, &emission->threads[thread], beam, rest, n, &grid) ||
        !take_cells(beam, &grid);
    if (!beam->light && beam->cumulative)
        try_lines(emission, &emission->threads[thread], beam);
    counts[emission_ray_counter(emission, beam)] += counts[STAT_PHOTON_RAYS] - before;
    mem_free(grid.cells);
}

Status emission_pilot(Emission *emission, double photons)
{
    size_t count = (size_t)emission->beam_count;
    Pilot pilot = {emission, photons / PILOT_PART / (double)count,
                   mem_array(count, sizeof *pilot.is_short)};
    if (!pilot.is_short)
        return diag_no_memory(emission->diag, "photon beams");
    Status status = work_for(emission->thread_count, count, pilot_beam, &pilot);
    for (size_t i = 0; i < count && status == OK; i++)
        if (pilot.is_short[i])
            status = diag_no_memory(emission->diag, "photon beams");
    mem_free(pilot.is_short);
    return status;
}
