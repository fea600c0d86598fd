/* A change of sign between two places.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bracket.h"

#include <math.h>
#include <stdbool.h>

enum { STEPS_MAX = 1000, STEPS_CHECKED = 3 };

double bracket_zero(BracketFn f, const void *ctx, double a, double fa, double b, double fb,
                    double small)
{
    int stayed = 0;         /* which end did in the last step: 1 b, -1 a */
    double checked = b - a; /* how wide it was a few steps ago */
    bool is_slow = false;
    for (int i = 1; i <= STEPS_MAX; i++) {
        double x = is_slow ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
        if (!(x > a && x < b))
            x = 0.5 * (a + b);
        if (!(x > a && x < b))
            break;
        double fx = f(ctx, x);
        if (fabs(fx) <= small)
            return x;
        bool is_as_a = (fx > 0) == (fa > 0);
        if (is_as_a) {
            a = x;
            fa = fx;
            fb *= stayed > 0 ? 0.5 : 1;
        } else {
            b = x;
            fb = fx;
            fa *= stayed < 0 ? 0.5 : 1;
        }
        stayed = is_as_a ? 1 : -1;
        is_slow = i % STEPS_CHECKED == 0 && b - a > 0.5 * checked;
        if (i % STEPS_CHECKED == 0)
            checked = b - a;
    }
    return 0.5 * (a + b);
}
