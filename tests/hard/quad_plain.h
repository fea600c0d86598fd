/* The numbers that both worlds of the oracle know by the same name (see quad_world.h).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_PLAIN_H
#define PMS_TESTS_QUAD_PLAIN_H

typedef double Plain;
__extension__ typedef _Float128 Quad;

#endif
