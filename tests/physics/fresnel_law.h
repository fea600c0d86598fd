/* Fresnel's equations as textbooks have them.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_FRESNEL_LAW_H
#define PMS_TESTS_FRESNEL_LAW_H

#include <math.h>

/* Reflectance of unpolarised light from a medium of ior n1 onto one of n2, by the sine of its angle
 * to the normal. */
static inline double reflectance(double n1, double n2, double sine1)
{
    double sine2 = n1 / n2 * sine1;
    if (sine2 >= 1)
        return 1;
    double c1 = sqrt(1 - sine1 * sine1), c2 = sqrt(1 - sine2 * sine2);
    double rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    double rp = (n1 * c2 - n2 * c1) / (n1 * c2 + n2 * c1);
    return 0.5 * (rs * rs + rp * rp);
}

#endif
