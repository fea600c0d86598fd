/* Rows of the table that `make check-physics` prints (table.sh): what was measured, what is
 * expected, and the standard error of the difference; 0 where nothing is random.  Include after
 * cmocka.h.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_TABLE_H
#define PMS_TESTS_TABLE_H

#include <stdbool.h>
#include <stdlib.h>

static inline void table_row(const char *what, double measured, double expected, double error)
{
    print_message("#| %-58.58s %12.6g %12.6g %11.3g\n", what, measured, expected, error);
}

/* Is this the long run of make check-physics, with time for narrow errors? */
static inline bool table_is_long(void)
{
    return getenv("PMS_LONG") != NULL;
}

#endif
