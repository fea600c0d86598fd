/* The program.  SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

int main(void)
{
    return status_exit_code(ERR_USAGE);
}
