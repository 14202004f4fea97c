/* A chunk by libdeflate, compressed and decompressed: its bytes in two halves, as differences. OpenEXR has this itself
 * from version 3.2 on.
 */
#include "image/exr_zip.h"

#include <OpenEXRConfig.h>

#if OPENEXR_VERSION_MAJOR > 3 || OPENEXR_VERSION_MINOR >= 2

exr_result_t exr_zip_begin(exr_encode_pipeline_t *pipe)
{
    (void)pipe;
    return EXR_ERR_SUCCESS;
}

void exr_zip_end(exr_encode_pipeline_t *pipe) { (void)pipe; }

exr_result_t exr_unzip_begin(exr_decode_pipeline_t *pipe)
{
    (void)pipe;
    return EXR_ERR_SUCCESS;
}

void exr_unzip_end(exr_decode_pipeline_t *pipe) { (void)pipe; }

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

STAGE static uint8_t exr_sum(size_t n, const uint8_t *v)
{
    uint8_t sum = 0;
    for (size_t i = 0; i < n; i++)
        sum = (uint8_t)(sum + v[i]);
    return sum;
}

/* `split` undone. A sum of differences needs the one before it, so this loop is no vector's. The odd bytes' sums go on
 * from the last even one, which is found first: so two sums run side by side. */
static void join(size_t half, const uint8_t *restrict even, const uint8_t *restrict odd, uint8_t *restrict to)
{
    uint8_t e = 128, o = (uint8_t)(128 + exr_sum(half, even) - 128 * half);
    for (size_t i = 0; i < half; i++) {
        to[2 * i] = e = (uint8_t)(e + even[i] - 128);
        to[2 * i + 1] = o = (uint8_t)(o + odd[i] - 128);
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

static exr_result_t decompress(exr_decode_pipeline_t *pipe)
{
    const size_t n = (size_t)pipe->chunk.unpacked_size, half = n / 2; /* n is even: samples have 2 or 4 bytes */
    if (pipe->chunk.packed_size == n) {                               /* as it is; the buffers may be the same one */
        if (pipe->unpacked_buffer != pipe->packed_buffer)
            memcpy(pipe->unpacked_buffer, pipe->packed_buffer, n);
        return EXR_ERR_SUCCESS;
    }
    if (!make_room(&pipe->scratch_buffer_1, &pipe->scratch_alloc_size_1, n))
        return EXR_ERR_OUT_OF_MEMORY;
    uint8_t *halves = pipe->scratch_buffer_1;
    if (libdeflate_zlib_decompress(pipe->decoding_user_data, pipe->packed_buffer, (size_t)pipe->chunk.packed_size,
                                   halves, n, NULL) != LIBDEFLATE_SUCCESS)
        return EXR_ERR_CORRUPT_CHUNK; /* not n bytes is an error, too */
    join(half, halves, halves + half, pipe->unpacked_buffer);
    return EXR_ERR_SUCCESS;
}

exr_result_t exr_unzip_begin(exr_decode_pipeline_t *pipe)
{
    if (pipe->chunk.compression != EXR_COMPRESSION_ZIP && pipe->chunk.compression != EXR_COMPRESSION_ZIPS)
        return EXR_ERR_SUCCESS;
    pipe->decompress_fn = decompress;
    pipe->decoding_user_data = libdeflate_alloc_decompressor();
    return pipe->decoding_user_data ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
}

void exr_unzip_end(exr_decode_pipeline_t *pipe)
{
    libdeflate_free_decompressor(pipe->decoding_user_data);
    pipe->decoding_user_data = NULL;
}

#endif
