/* JSON, written by hand.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_JSON_H
#define PMS_BASE_JSON_H

#include <stdio.h>

/* Print a JSON string with its quotes, or a number (null when it is not finite).  A string is UTF-8
 * whatever bytes the text has (names of files may have any): those that make no character become
 * U+FFFD. */
void json_string(FILE *file, const char *text);
void json_number(FILE *file, double number);

/* Print one more member of an object: ", "name": " and its value. */
void json_field(FILE *file, const char *name, double number);
void json_text(FILE *file, const char *name, const char *text);

#endif
