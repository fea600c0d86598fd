/* "did you mean ...?"  SPDX-License-Identifier: Apache-2.0 */
#include "base/guess.h"

#include <stdbool.h>
#include <string.h>

enum { WORD_MAX = 64 };

static int min3(int a, int b, int c)
{
    int m = a < b ? a : b;
    return m < c ? m : c;
}

/* Optimal string alignment distance, by rows. */
int word_distance(const char *a, size_t a_length, const char *b, size_t b_length, int limit)
{
    int rows[3][WORD_MAX + 1];
    size_t gap = a_length > b_length ? a_length - b_length : b_length - a_length;
    if (a_length > WORD_MAX || b_length > WORD_MAX || gap > (size_t)limit)
        return limit + 1;
    int *before = rows[0], *above = rows[1], *row = rows[2];
    for (size_t j = 0; j <= b_length; j++)
        above[j] = (int)j;
    for (size_t i = 1; i <= a_length; i++) {
        row[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            int replace = above[j - 1] + (a[i - 1] != b[j - 1]);
            row[j] = min3(replace, above[j] + 1, row[j - 1] + 1);
            bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (is_swap && before[j - 2] + 1 < row[j])
                row[j] = before[j - 2] + 1;
        }
        int *spare = before;
        before = above;
        above = row;
        row = spare;
    }
    return above[b_length] > limit ? limit + 1 : above[b_length];
}

Guess guess_begin(const char *word, size_t length)
{
    int limit = length < 4 ? 1 : length < 8 ? 2 : 3;
    int most = (int)length - 1; /* some of it must stand in the other one */
    return (Guess){.word = word, .length = length, .distance = (limit < most ? limit : most) + 1};
}

void guess_try(Guess *guess, const char *candidate)
{
    int distance =
        word_distance(guess->word, guess->length, candidate, strlen(candidate), guess->distance);
    bool is_nearer = distance < guess->distance || (distance == guess->distance && guess->best &&
                                                    strcmp(candidate, guess->best) < 0);
    if (!is_nearer)
        return;
    guess->distance = distance;
    guess->best = candidate;
}
