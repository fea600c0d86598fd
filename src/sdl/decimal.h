/* Decimals that arithmetic turns into the nearest double: both of its numbers are exact, so that
 * there is one rounding.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_DECIMAL_H
#define PMS_SDL_DECIMAL_H

#include <stdbool.h>
#include <stdint.h>

enum {
    DECIMAL_DIGITS = 15, /* so many are exact in a double */
    DECIMAL_POWER = 22   /* so is a power of ten up to this */
};

/* Is `count` digits times ten to the exponent such a decimal? */
static inline bool decimal_is_exact(int64_t count, int exponent)
{
    return count <= DECIMAL_DIGITS && exponent >= -DECIMAL_POWER && exponent <= DECIMAL_POWER;
}

/* Return its value. */
static inline double decimal_value(uint64_t digits, int exponent)
{
    static const double powers[DECIMAL_POWER + 1] = {
        1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
        1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    return exponent < 0 ? (double)digits / powers[-exponent] : (double)digits * powers[exponent];
}

#endif
