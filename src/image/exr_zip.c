/* A chunk by libdeflate: its bytes in two halves, as differences. OpenEXR has this itself from version 3.2 on. */
#include "image/exr_zip.h"

#include <OpenEXRConfig.h>

#if OPENEXR_VERSION_MAJOR > 3 || OPENEXR_VERSION_MINOR >= 2

exr_result_t exr_zip_begin(exr_encode_pipeline_t *pipe)
{
    (void)pipe;
    return EXR_ERR_SUCCESS;
}

void exr_zip_end(exr_encode_pipeline_t *pipe) { (void)pipe; }

#else

#include <libdeflate.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/real.h"

/* The even bytes, then the odd ones, each as its difference from the one before in this order, plus 128. */
STAGE static void split(size_t half, const uint8_t *restrict from, uint8_t *restrict even, uint8_t *restrict odd)
{
    even[0] = from[0];
    odd[0] = (uint8_t)(from[1] - from[2 * half - 2] + 128);
    for (size_t i = 1; i < half; i++) {
        even[i] = (uint8_t)(from[2 * i] - from[2 * i - 2] + 128);
        odd[i] = (uint8_t)(from[2 * i + 1] - from[2 * i - 1] + 128);
    }
}

static void *reserve(exr_transcoding_pipeline_buffer_id_t id, size_t size)
{
    (void)id;
    return malloc(size);
}

static void release(exr_transcoding_pipeline_buffer_id_t id, void *p)
{
    (void)id;
    free(p);
}

/* At least `size` bytes, for all chunks of a picture. */
static bool make_room(void **buffer, size_t *room, size_t size)
{
    if (*room < size) {
        free(*buffer);
        *buffer = malloc(size);
        *room = *buffer ? size : 0;
    }
    return *room > 0;
}

static exr_result_t compress(exr_encode_pipeline_t *pipe)
{
    const size_t n = (size_t)pipe->packed_bytes, half = n / 2; /* n is even: all samples have 4 bytes */
    if (!make_room(&pipe->scratch_buffer_1, &pipe->scratch_alloc_size_1, n) ||
        !make_room(&pipe->compressed_buffer, &pipe->compressed_alloc_size, n))
        return EXR_ERR_OUT_OF_MEMORY;
    uint8_t *halves = pipe->scratch_buffer_1;
    split(half, pipe->packed_buffer, halves, halves + half);
    pipe->compressed_bytes =
        libdeflate_zlib_compress(pipe->encoding_user_data, halves, n, pipe->compressed_buffer, n - 1);
    if (!pipe->compressed_bytes) { /* as it is: readers see by its size that it is not compressed */
        memcpy(pipe->compressed_buffer, pipe->packed_buffer, n);
        pipe->compressed_bytes = n;
    }
    return EXR_ERR_SUCCESS;
}

exr_result_t exr_zip_begin(exr_encode_pipeline_t *pipe)
{
    pipe->alloc_fn = reserve;
    pipe->free_fn = release;
    pipe->compress_fn = compress;
    pipe->encoding_user_data = libdeflate_alloc_compressor(EXR_ZIP_LEVEL);
    return pipe->encoding_user_data ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
}

void exr_zip_end(exr_encode_pipeline_t *pipe)
{
    libdeflate_free_compressor(pipe->encoding_user_data);
    pipe->encoding_user_data = NULL;
}

#endif
