/* What the EXR writer and reader share: a file behind the library's streams, and the message
 * of whatever went wrong in it.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_EXR_INT_H
#define PMS_IMAGE_EXR_INT_H

#include "base/diag.h"

#include <openexr.h>
#include <stdbool.h>

typedef struct ExrStream {
    int fd;
    int error;         /* errno of the first failed read or write, 0: none */
    bool is_truncated; /* a read went past the end of the file */
    bool is_memory;    /* the library ran out of memory */
    char message[256]; /* first complaint of the library */
} ExrStream;

/* Return the library's settings for `stream`: our memory, our streams, our messages, and no
 * image or tile larger than IMAGE_SIDE_MAX. */
exr_context_initializer_t exr_stream_settings(ExrStream *stream, bool is_reading);

/* Report why `path` could not be read or written (`verb`), as found in `stream` or from the
 * library's code; returns ERR_FILE or ERR_MEMORY. */
Status exr_refuse(Diag *diag, const char *verb, const char *path, const ExrStream *stream,
                  exr_result_t code);

#endif
