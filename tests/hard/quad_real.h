/* Compiles the geometry a second time with quad precision: included before anything else, by the
 * compiler's option, it lets `double` mean _Float128, and the names of the mathematical functions
 * those of that type.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_REAL_H
#define PMS_TESTS_QUAD_REAL_H

#define __STDC_WANT_IEC_60559_TYPES_EXT__ 1

/* What the sources include of the system: read while `double` still has its meaning. */
#include <assert.h>
#include <complex.h>
#include <embree3/rtcore.h>
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "quad_plain.h"

#define PMS_QUAD
#define double _Float128

#undef DBL_EPSILON
#undef DBL_MANT_DIG
#undef DBL_MAX
#undef DBL_MIN
#define DBL_EPSILON FLT128_EPSILON
#define DBL_MANT_DIG FLT128_MANT_DIG
#define DBL_MAX FLT128_MAX
#define DBL_MIN FLT128_MIN

#define acos acosf128
#define acosh acoshf128
#define asin asinf128
#define asinh asinhf128
#define atan atanf128
#define atan2 atan2f128
#define atanh atanhf128
#define cbrt cbrtf128
#define ceil ceilf128
#define copysign copysignf128
#define cos cosf128
#define cosh coshf128
#define erf erff128
#define exp expf128
#define exp2 exp2f128
#define expm1 expm1f128
#define fabs fabsf128
#define floor floorf128
#define fma fmaf128
#define fmax fmaxf128
#define fmin fminf128
#define fmod fmodf128
#define frexp frexpf128
#define hypot hypotf128
#define ilogb ilogbf128
#define ldexp ldexpf128
#define log logf128
#define log1p log1pf128
#define log2 log2f128
#define logb logbf128
#define modf modff128
#define nearbyint nearbyintf128
#define nextafter nextafterf128
#define pow powf128
#define rint rintf128
#define round roundf128
#define scalbn scalbnf128
#define sin sinf128
#define sinh sinhf128
#define sqrt sqrtf128
#define tan tanf128
#define tanh tanhf128
#define trunc truncf128

#define cabs cabsf128
#define cacos cacosf128
#define cacosh cacoshf128
#define carg cargf128
#define casin casinf128
#define casinh casinhf128
#define catan catanf128
#define catanh catanhf128
#define ccos ccosf128
#define ccosh ccoshf128
#define cexp cexpf128
#define cimag cimagf128
#define clog clogf128
#define conj conjf128
#define cpow cpowf128
#define cproj cprojf128
#define creal crealf128
#define csin csinf128
#define csinh csinhf128
#define csqrt csqrtf128
#define ctan ctanf128
#define ctanh ctanhf128

#endif
