/* What a picture of a moved scene has in it that the unmoved one has not.
 *
 * Everything is compared as a display shows it, white 1.  How far chance reaches is known from
 * pictures of the unmoved scene with other seeds: where those are alike, the moved one must be too.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SELFTEST_CHANGE_H
#define PMS_SELFTEST_CHANGE_H

#include "image/image.h"

/* A difference of a channel above this is seen: two steps of an 8-bit display. */
#define CHANGE_VISIBLE (2.0 / 255)

/* So many times what other seeds change within two pixels is hardly chance, and surely none.  Of
 * what is in between, which noise with rare bright spots has, there may be so large a part. */
#define CHANGE_HARDLY 3.0
#define CHANGE_SURELY 10.0
#define CHANGE_ODD_MOST 0.0025

/* Noise may come in rare large spots.  Each seed is judged by the others, as if it were a move: of
 * what the worst of them has, a move may have so many times as much besides. */
#define CHANGE_CHANCES 2

/* At most this part of the pixels may be on the other side of an edge. */
#define CHANGE_EDGES_MOST 0.01

/* The mean of the picture may differ by so much of it, and so many times the range over seeds. */
#define CHANGE_MEAN_PART 0.002
#define CHANGE_MEAN_RANGES 3.0

typedef enum ChangeKind {
    CHANGE_NONE,  /* every bit is the same */
    CHANGE_HOLDS, /* nothing to be seen but chance */
    CHANGE_EDGES, /* pixels at edges show what is beside them */
    CHANGE_SEEN,  /* it looks different */
    CHANGE_BITS   /* it may not differ in any bit, and does */
} ChangeKind;

/* Pixels that look different: all; those explained by edges; others that are hardly chance. */
typedef struct ChangeCounts {
    size_t seen, edges, odd;
} ChangeCounts;

typedef struct Change {
    bool is_exact;       /* no number was rounded by the move: not one bit may change */
    size_t pixels, bits; /* of the picture; those with any other bit */
    ChangeCounts counts;
    ChangeCounts chance;  /* as large as they come by chance alone, each */
    double rmse, largest; /* of the display values of all channels */
    double mean_off;      /* of the means, relative; and how much chance allows */
    double mean_allowed;
    int x, y; /* the pixel that changed most */
} Change;

/* Pictures of the unmoved scene, made ready; of the caller's until change_base_done. */
typedef struct ChangeBase {
    int width, height;
    float *mean, *noise; /* display values, 3 a pixel; noise: the range over the seeds */
    const Image *first;  /* the picture with the first seed, borrowed */
    ChangeCounts chance;
    double light, light_range; /* mean of the first picture; largest difference of another's */
    double seed_rmse;          /* between the first two pictures */
} ChangeBase;

/* pictures: `count`, at least 3, of one size, each with another seed.  ERR_MEMORY or OK. */
Status change_base_init(ChangeBase *base, const Image *pictures, int count, Diag *diag);
void change_base_done(ChangeBase *base);

/* Fill all of `out` but is_exact, which is asked.  ERR_MEMORY or OK. */
Status change_find(const ChangeBase *base, const Image *moved, Diag *diag, Change *out);

/* Put into each pixel of `moved` what `again` has there, another picture of the same with another
 * seed, where that changed less: what is no chance changed in both. */
void change_keep_less(const ChangeBase *base, Image *moved, const Image *again);

/* Return how many pixels differ in any bit, and the largest difference of a channel as a display
 * shows it, of two pictures of one size. */
size_t change_bits(const Image *a, const Image *b);
double change_largest(const Image *a, const Image *b);

/* Return the verdict, and whether that is as it should be. */
ChangeKind change_kind(const Change *change);
bool change_is_good(const Change *change);

#endif
