/* Noise: values, derivatives, and bounds on both.
 *
 * The random numbers of the tables come from the language's generator, but for those of
 * noise_lattice.def.  SPDX-License-Identifier: Apache-2.0 */
#include "math/noise.h"

#include "math/eps.h"

enum {
    HASH_SIZE = 4096,
    GRADIENT_SIZE = 2048,
    CORNERS = 8,
    CELLS_MAX = 2, /* a side of a box: larger ones know only the bounds of all noise */
    CELL_OFFSET = 10000
};

/* Cells reach a little below whole numbers below 0. */
#define CELL_SLACK 1e-10

/* Where the cells of generator 3 are. */
#define GRADIENT_OFFSET 10000000.023157213

/* Generator 2 stretches the lattice to 0 to 1, generator 3 the gradients. */
#define RANGED_OFFSET 1.05242
#define RANGED_SCALE 0.48985582
#define GRADIENT_SCALE (0.5 * 1.59)
#define GRADIENT_MIDDLE (0.5 * 0.985)

/* Bounds on all derivatives of unstretched noise, and relative rounding of its values. */
#define STEEPEST 12.0
#define NOISE_ROUNDING (64 * EPS_DOUBLE)

struct Noise {
    uint16_t hash[HASH_SIZE], permutation[GRADIENT_SIZE];
    V3 gradients[GRADIENT_SIZE];
};

static const double lattice[] = {
#include "math/noise_lattice.def"
};

/* --- tables --------------------------------------------------------------------------------- */

static uint32_t draw(uint32_t *state)
{
    *state = *state * 1812433253U + 12345U;
    return *state >> 16 & 0x7FFF;
}

static void swap(uint16_t *a, uint16_t *b)
{
    uint16_t c = *a;
    *a = *b;
    *b = c;
}

static void make_hash(Noise *noise)
{
    uint32_t state = 0;
    for (int i = 0; i < HASH_SIZE; i++)
        noise->hash[i] = (uint16_t)i;
    for (int i = HASH_SIZE - 1; i >= 0; i--)
        swap(&noise->hash[i], &noise->hash[draw(&state) % HASH_SIZE]);
}

static double draw_side(uint32_t *state)
{
    return ((double)(draw(state) % (2 * GRADIENT_SIZE)) - GRADIENT_SIZE) / GRADIENT_SIZE;
}

static void make_gradients(Noise *noise)
{
    uint32_t state = 1;
    for (int i = 0; i < GRADIENT_SIZE; i++) {
        V3 v;
        do {
            double x = draw_side(&state), y = draw_side(&state);
            v = v3(x, y, draw_side(&state));
        } while (v3_len2(v) < 1e-5 || v3_len2(v) > 1);
        noise->gradients[i] = v3_scale(v, 1 / sqrt(v3_len2(v)));
    }
    /* Only every other slot is shuffled, and one beyond the end takes part. */
    uint16_t slots[GRADIENT_SIZE + 1] = {0};
    for (int i = 0; i < GRADIENT_SIZE; i++)
        slots[i] = (uint16_t)i;
    for (int i = GRADIENT_SIZE; i > 0; i -= 2)
        swap(&slots[i], &slots[draw(&state) % GRADIENT_SIZE]);
    for (int i = 0; i < GRADIENT_SIZE; i++)
        noise->permutation[i] = slots[i];
}

const Noise *noise_new(Arena *arena)
{
    Noise *noise = ARENA_NEW(arena, Noise);
    if (!noise)
        return NULL;
    make_hash(noise);
    make_gradients(noise);
    return noise;
}

unsigned noise_hash(const Noise *noise, int x, int y, int z)
{
    const uint16_t *hash = noise->hash;
    unsigned mask = HASH_SIZE - 1;
    return hash[hash[hash[(unsigned)x & mask] ^ ((unsigned)y & mask)] ^ ((unsigned)z & mask)];
}

/* --- cells ---------------------------------------------------------------------------------- */

/* Where a coordinate is in its cell. */
typedef struct Place {
    unsigned cell;   /* into the tables */
    double corner;   /* the cell's lower side */
    double fraction; /* from there */
} Place;

/* Numbers so large that they have no fraction are all in one cell. */
static unsigned cell_index(double corner, double offset)
{
    double at = corner + offset;
    return fabs(at) < 0x1p53 ? (unsigned)(uint64_t)(int64_t)at : 0;
}

static double lattice_corner(double v)
{
    return trunc(v >= 0 ? v : v - (1 - CELL_SLACK));
}

static Place lattice_place(double v)
{
    double corner = lattice_corner(v);
    return (Place){cell_index(corner, CELL_OFFSET), corner, v - corner};
}

static Place gradient_place(double v)
{
    double t = v + GRADIENT_OFFSET, corner = floor(t);
    return (Place){cell_index(corner, 0), corner, t - corner};
}

static Place place_of(int generator, double v)
{
    return generator == NOISE_GENERATORS ? gradient_place(v) : lattice_place(v);
}

/* What a corner of a cell gives the places around it: value + slope . (p - corner). */
typedef struct Corner {
    double value;
    V3 slope;
} Corner;

/* The corners of a cell in the order of z, y, x, x changing fastest. */
static void lattice_hashes(const Noise *noise, const unsigned cell[3], unsigned out[CORNERS])
{
    const uint16_t *hash = noise->hash;
    unsigned x = cell[0] % HASH_SIZE, y = cell[1] % HASH_SIZE, z = cell[2] % HASH_SIZE;
    for (unsigned i = 0; i < CORNERS; i++) {
        unsigned first = hash[(x + (i & 1)) % HASH_SIZE];
        unsigned second = hash[(first ^ (y + (i >> 1 & 1))) % HASH_SIZE];
        out[i] = hash[(second ^ (z + (i >> 2))) % HASH_SIZE] & 255U;
    }
}

static Corner lattice_at(unsigned i)
{
    return (Corner){0.5 * lattice[i], v3(lattice[i + 1], lattice[i + 2], lattice[i + 3])};
}

static void gradient_corners(const Noise *noise, const unsigned cell[3], Corner out[CORNERS])
{
    const uint16_t *permutation = noise->permutation;
    for (unsigned i = 0; i < CORNERS; i++) {
        unsigned x = (cell[0] + (i & 1)) % GRADIENT_SIZE;
        unsigned y = (cell[1] + (i >> 1 & 1)) % GRADIENT_SIZE;
        unsigned z = (cell[2] + (i >> 2)) % GRADIENT_SIZE;
        unsigned second = permutation[(permutation[x] + y) % GRADIENT_SIZE];
        out[i] = (Corner){0, noise->gradients[(second + z) % GRADIENT_SIZE]};
    }
}

static void corners_of(const Noise *noise, int generator, const unsigned cell[3],
                       Corner out[CORNERS])
{
    unsigned hashes[CORNERS];
    if (generator == NOISE_GENERATORS) {
        gradient_corners(noise, cell, out);
        return;
    }
    lattice_hashes(noise, cell, hashes);
    for (int i = 0; i < CORNERS; i++)
        out[i] = lattice_at(hashes[i]);
}

/* --- values --------------------------------------------------------------------------------- */

static double ease(double f)
{
    return f * f * (3 - 2 * f);
}

static double between(double t, double a, double b)
{
    return a + t * (b - a);
}

/* What corner i gives the place (x, y, z) of a cell. */
static double corner_value(const Corner *c, int i, double x, double y, double z)
{
    return c->value + c->slope.x * (x - (i & 1)) + c->slope.y * (y - (i >> 1 & 1)) +
           c->slope.z * (z - (i >> 2));
}

static double blend(const double v[CORNERS], double x, double y, double z)
{
    return between(z, between(y, between(x, v[0], v[1]), between(x, v[2], v[3])),
                   between(y, between(x, v[4], v[5]), between(x, v[6], v[7])));
}

static double blend_corners(const Corner corners[CORNERS], const Place at[3])
{
    double x = at[0].fraction, y = at[1].fraction, z = at[2].fraction, v[CORNERS];
    for (int i = 0; i < CORNERS; i++)
        v[i] = corner_value(&corners[i], i, x, y, z);
    return blend(v, ease(x), ease(y), ease(z));
}

/* How a generator stretches its noise: factor * noise + offset. */
static double stretch_factor(int generator)
{
    return generator == 1 ? 1 : generator == 2 ? RANGED_SCALE : GRADIENT_SCALE;
}

static double stretch(int generator, double v)
{
    return generator == 1   ? v + 0.5
           : generator == 2 ? (v + RANGED_OFFSET) * RANGED_SCALE
                            : GRADIENT_SCALE * v + GRADIENT_MIDDLE;
}

static double clamp_unit(double v)
{
    return v < 0 ? 0 : v > 1 ? 1 : v;
}

static void find_place(int generator, V3 p, Place at[3], unsigned cell[3])
{
    const double v[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++) {
        at[i] = place_of(generator, v[i]);
        cell[i] = at[i].cell;
    }
}

double noise_value(const Noise *noise, int generator, V3 p)
{
    Place at[3];
    unsigned cell[3];
    Corner corners[CORNERS];
    if (!v3_is_finite(p))
        return NAN;
    find_place(generator, p, at, cell);
    corners_of(noise, generator, cell, corners);
    return clamp_unit(stretch(generator, blend_corners(corners, at)));
}

/* Blend along two axes of the differences along the third: the derivative of the weights. */
static double blend_steps(const double v[CORNERS], int axis, double s, double t)
{
    int step = 1 << axis, a = axis == 0 ? 2 : 1, b = axis == 2 ? 2 : 4;
    double d[4];
    for (int i = 0; i < 4; i++) {
        int at = (i & 1 ? a : 0) + (i & 2 ? b : 0);
        d[i] = v[at + step] - v[at];
    }
    return between(t, between(s, d[0], d[1]), between(s, d[2], d[3]));
}

double noise_gradient(const Noise *noise, int generator, V3 p, V3 *gradient)
{
    Place at[3];
    unsigned cell[3];
    Corner corners[CORNERS];
    double v[CORNERS], slopes[3][CORNERS], eased[3], steep[3], g[3];
    *gradient = v3(0, 0, 0);
    if (!v3_is_finite(p))
        return NAN;
    find_place(generator, p, at, cell);
    corners_of(noise, generator, cell, corners);
    for (int i = 0; i < CORNERS; i++) {
        v[i] = corner_value(&corners[i], i, at[0].fraction, at[1].fraction, at[2].fraction);
        for (int k = 0; k < 3; k++)
            slopes[k][i] = v3_at(corners[i].slope, k);
    }
    for (int k = 0; k < 3; k++) {
        eased[k] = ease(at[k].fraction);
        steep[k] = 6 * at[k].fraction * (1 - at[k].fraction);
    }
    for (int k = 0; k < 3; k++)
        g[k] = steep[k] * blend_steps(v, k, eased[k == 0], eased[k == 2 ? 1 : 2]) +
               blend(slopes[k], eased[0], eased[1], eased[2]);
    double value = stretch(generator, blend(v, eased[0], eased[1], eased[2]));
    if (value > 0 && value < 1)
        *gradient = v3_scale(v3(g[0], g[1], g[2]), stretch_factor(generator));
    return clamp_unit(value);
}

V3 noise_vector(const Noise *noise, V3 p)
{
    Place at[3];
    unsigned cell[3], hashes[CORNERS];
    double out[3];
    Corner corners[CORNERS];
    if (!v3_is_finite(p))
        return v3(NAN, NAN, NAN);
    find_place(NOISE_GENERATOR_DEFAULT, p, at, cell);
    lattice_hashes(noise, cell, hashes);
    for (unsigned k = 0; k < 3; k++) {
        for (int i = 0; i < CORNERS; i++)
            corners[i] = lattice_at(hashes[i] + 4 * k);
        out[k] = blend_corners(corners, at);
    }
    return v3(out[0], out[1], out[2]);
}

/* --- turbulence ----------------------------------------------------------------------------- */

static double turbulence_term(const Noise *noise, int generator, V3 p)
{
    double value = noise_value(noise, generator, p);
    return generator == 1 ? value : 2 * value - 0.5;
}

double noise_turbulence(const Noise *noise, int generator, V3 p, const Turbulence *turbulence)
{
    double sum = turbulence_term(noise, generator, p), size = 1, strength = 1;
    if (generator != 1)
        sum = clamp_unit(sum); /* only that of the first octave */
    for (int i = 1; i < turbulence->octaves; i++) {
        size *= turbulence->lambda;
        strength *= turbulence->omega;
        sum += strength * turbulence_term(noise, generator, v3_scale(p, size));
    }
    return sum;
}

V3 noise_turbulence_vector(const Noise *noise, V3 p, const Turbulence *turbulence)
{
    V3 sum = noise_vector(noise, p);
    double size = 1, strength = 1;
    for (int i = 1; i < turbulence->octaves; i++) {
        size *= turbulence->lambda;
        strength *= turbulence->omega;
        sum = v3_mad(sum, strength, noise_vector(noise, v3_scale(p, size)));
    }
    return sum;
}

/* --- bounds --------------------------------------------------------------------------------- */

/* What a box and a cell share, and its weights; eased numbers are monotone. */
typedef struct Part {
    Range at[3], eased[3], steep[3];
} Part;

static Range hull(Range a, Range b)
{
    return (Range){fmin(a.lo, b.lo), fmax(a.hi, b.hi)};
}

static Range plus(Range a, Range b)
{
    return (Range){a.lo + b.lo, a.hi + b.hi};
}

static Range times(double by, Range a)
{
    return by < 0 ? (Range){by * a.hi, by * a.lo} : (Range){by * a.lo, by * a.hi};
}

/* For t from 0 to 1 the extremes are at its ends. */
static Range between_ranges(Range t, Range a, Range b)
{
    double s = 1 - t.lo, u = 1 - t.hi;
    return (Range){fmin(s * a.lo + t.lo * b.lo, u * a.lo + t.hi * b.lo),
                   fmax(s * a.hi + t.lo * b.hi, u * a.hi + t.hi * b.hi)};
}

static Range blend_ranges(const Range v[CORNERS], const Range t[3])
{
    Range near =
        between_ranges(t[1], between_ranges(t[0], v[0], v[1]), between_ranges(t[0], v[2], v[3]));
    Range far =
        between_ranges(t[1], between_ranges(t[0], v[4], v[5]), between_ranges(t[0], v[6], v[7]));
    return between_ranges(t[2], near, far);
}

/* Bound value + slope . (p - corner). */
static Range reach(double value, V3 slope, const Range at[3], int corner)
{
    Range sum = {value, value};
    for (int k = 0; k < 3; k++) {
        double side = corner >> k & 1;
        sum = plus(sum, times(v3_at(slope, k), (Range){at[k].lo - side, at[k].hi - side}));
    }
    return sum;
}

/* The difference of two corners along an axis, which is a plane, too. */
static Range step_range(const Corner corners[CORNERS], int from, int axis, const Range at[3])
{
    const Corner *a = &corners[from], *b = &corners[from + (1 << axis)];
    V3 slope = v3_sub(b->slope, a->slope);
    return reach(b->value - a->value - v3_at(b->slope, axis), slope, at, from);
}

static Range slope_range(const Corner corners[CORNERS], const Part *part, int axis)
{
    int a = axis == 0 ? 2 : 1, b = axis == 2 ? 2 : 4;
    Range d[4], slopes[CORNERS];
    for (int i = 0; i < 4; i++)
        d[i] = step_range(corners, (i & 1 ? a : 0) + (i & 2 ? b : 0), axis, part->at);
    Range s = part->eased[axis == 0], t = part->eased[axis == 2 ? 1 : 2];
    Range step = between_ranges(t, between_ranges(s, d[0], d[1]), between_ranges(s, d[2], d[3]));
    for (int i = 0; i < CORNERS; i++) {
        double slope = v3_at(corners[i].slope, axis);
        slopes[i] = (Range){slope, slope};
    }
    Range steep = part->steep[axis];
    Range by_weights = hull(times(steep.lo, step), times(steep.hi, step));
    return plus(by_weights, blend_ranges(slopes, part->eased));
}

static void part_set(Part *part, int axis, Range at)
{
    double lo = at.lo * (1 - at.lo), hi = at.hi * (1 - at.hi);
    bool has_middle = at.lo < 0.5 && at.hi > 0.5;
    part->at[axis] = at;
    /* Below 0, where a fraction may begin, it falls towards 0. */
    part->eased[axis] =
        (Range){at.lo < 0 ? 0 : ease(at.lo), fmin(fmax(ease(at.lo), ease(at.hi)), 1)};
    part->steep[axis] = (Range){6 * fmin(lo, hi), has_middle ? 1.5 : 6 * fmax(lo, hi)};
}

/* The cells of a box along an axis. */
typedef struct Cells {
    int count;
    unsigned first;
    Range at[CELLS_MAX]; /* the box within them */
} Cells;

static bool cells_along(int generator, Range box, Cells *out)
{
    Place lo = place_of(generator, box.lo), hi = place_of(generator, box.hi);
    double count = hi.corner - lo.corner + 1;
    if (!(count <= CELLS_MAX)) /* or infinite, or no number */
        return false;
    out->count = (int)count;
    out->first = lo.cell;
    /* Next to a whole number a fraction may be a little below 0, as it is for values. */
    out->at[0] = (Range){lo.fraction, count > 1 ? 1 : hi.fraction};
    out->at[1] = (Range){-CELL_SLACK, hi.fraction};
    return true;
}

static void add_cell(const Noise *noise, int generator, const Cells cells[3], int number,
                     Range *value, Range *slopes)
{
    Part part;
    unsigned cell[3];
    Corner corners[CORNERS];
    Range v[CORNERS];
    for (int k = 0; k < 3; k++) {
        int at = number >> k & 1;
        cell[k] = cells[k].first + (unsigned)at;
        part_set(&part, k, cells[k].at[at]);
    }
    corners_of(noise, generator, cell, corners);
    for (int i = 0; i < CORNERS; i++)
        v[i] = reach(corners[i].value, corners[i].slope, part.at, i);
    *value = hull(*value, blend_ranges(v, part.eased));
    for (int k = 0; slopes && k < 3; k++)
        slopes[k] = hull(slopes[k], slope_range(corners, &part, k));
}

static Range stretched(Range r, double by)
{
    return (Range){by * (r.lo - NOISE_ROUNDING * STEEPEST),
                   by * (r.hi + NOISE_ROUNDING * STEEPEST)};
}

Range noise_range(const Noise *noise, int generator, const Range *box, Range *slopes)
{
    const Range none = {INFINITY, -INFINITY};
    Cells cells[3];
    double factor = stretch_factor(generator);
    for (int k = 0; slopes && k < 3; k++)
        slopes[k] = (Range){-factor * STEEPEST, factor * STEEPEST};
    for (int k = 0; k < 3; k++) {
        if (!(box[k].lo > -INFINITY && box[k].hi < INFINITY))
            return RANGE_ALL;
        if (!cells_along(generator, box[k], &cells[k]))
            return (Range){0, 1};
    }
    Range value = none;
    for (int k = 0; slopes && k < 3; k++)
        slopes[k] = none;
    for (int i = 0; i < CORNERS; i++)
        if ((i & 1) < cells[0].count && (i >> 1 & 1) < cells[1].count && i >> 2 < cells[2].count)
            add_cell(noise, generator, cells, i, &value, slopes);
    value = stretched(value, 1);
    value = (Range){stretch(generator, value.lo), stretch(generator, value.hi)};
    bool is_cut = value.lo < 0 || value.hi > 1;
    for (int k = 0; slopes && k < 3; k++) {
        slopes[k] = stretched(slopes[k], factor);
        if (is_cut)
            slopes[k] = hull(slopes[k], (Range){0, 0});
    }
    return (Range){clamp_unit(value.lo), clamp_unit(value.hi)};
}
