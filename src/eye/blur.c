/* Focal blur: when are there rays enough?
 *
 * The language asks for a variance of the mean and a confidence in it.  The estimate of a
 * variance from n rays scatters like chi-square, so few rays must show a smaller one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

/* Return the value that a standard normal variable exceeds with probability p, by bisection
 * of its distribution. */
static double normal_upper(double p)
{
    double low = -10, high = 10;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (0.5 * erfc(middle / sqrt(2)) > p)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* Return the value that a chi-square variable of n degrees exceeds with the probability whose
 * normal value is z: the cube root of chi-square/n is nearly normal. */
static double chi_square_upper(int n, double z)
{
    double v = 2.0 / (9.0 * n), root = 1 - v + z * sqrt(v);
    return root > 0 ? n * root * root * root : 0;
}

void blur_limits_fill(double *limits, int n, double variance, double confidence)
{
    double z = normal_upper(fmin(fmax(confidence, 1e-9), 1 - 1e-9));
    double whole = chi_square_upper(n > 1 ? n - 1 : 1, z);
    for (int i = 0; i <= n; i++)
        limits[i] = i > 0 && whole > 0 ? variance * chi_square_upper(i, z) / whole : variance;
}
