/* "did you mean ...?": the nearest of some words to one that is none of them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_GUESS_H
#define PMS_BASE_GUESS_H

#include <stddef.h>

typedef struct Guess {
    const char *word; /* as written; borrowed */
    size_t length;    /* of word, bytes */
    const char *best; /* the nearest so far, borrowed; NULL: none is near enough */
    int distance;     /* of best; until there is one, one more than is near enough */
} Guess;

/* Begin to look for what `word` was to be; offer words with guess_try, then read `best`. */
Guess guess_begin(const char *word, size_t length);

/* Offer a word.  Near enough is what may be a slip of the fingers; of equally near ones the
 * first by its bytes is kept, in whatever order they come. */
void guess_try(Guess *guess, const char *candidate);

/* Return the edit distance (insert, delete, replace, swap of neighbours) between two words,
 * or `limit` + 1 when it is over `limit`. */
int word_distance(const char *a, size_t a_length, const char *b, size_t b_length, int limit);

#endif
