/* Writes OpenEXR files with OpenEXRCore. */
#include <openexr.h>

#include <stdlib.h>
#include <string.h>

#include "base/file_writer.h"
#include "base/threads.h"
#include "image/format.h"

/* Empty: return codes are used instead. A handler like the reader's could deadlock, as the library holds a lock while
 * it writes. */
static void on_write_error(exr_const_context_t ctx, exr_result_t code, const char *message)
{
    (void)ctx, (void)code, (void)message;
}

static int64_t write_at(exr_const_context_t ctx, void *data, const void *buffer, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t error)
{
    (void)ctx, (void)error;
    return file_writer_write(data, buffer, (size_t)size, offset) ? (int64_t)size : -1;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const image_channel *)a)->name, ((const image_channel *)b)->name);
}

static exr_result_t write_header(exr_context_t ctx, int width, int height, int channels, const image_channel *channel,
                                 int texts, const image_text *text)
{
    int part;
    size_t longest = 0;
    for (int c = 0; c < channels; c++)
        longest = strlen(channel[c].name) > longest ? strlen(channel[c].name) : longest;
    for (int i = 0; i < texts; i++)
        longest = strlen(text[i].key) > longest ? strlen(text[i].key) : longest;
    /* A flag in the file that old readers refuse: set only where it is needed. */
    exr_result_t rv = exr_set_longname_support(ctx, longest > 31);
    if (!rv)
        rv = exr_add_part(ctx, NULL, EXR_STORAGE_SCANLINE, &part);
    if (!rv)
        rv = exr_initialize_required_attr_simple(ctx, part, width, height, EXR_COMPRESSION_ZIP);
    for (int c = 0; c < channels && !rv; c++)
        rv = exr_add_channel(ctx, part, channel[c].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    for (int i = 0; i < texts && !rv; i++)
        rv = exr_attr_set_string(ctx, part, text[i].key, text[i].value);
    return rv ? rv : exr_write_header(ctx);
}

/* Compress the chunk of lines from y on, without writing it. */
static exr_result_t compress_chunk(exr_context_t ctx, exr_encode_pipeline_t *pipe, bool first, int y, int width,
                                   const image_channel *channel)
{
    exr_chunk_info_t chunk = {0};
    exr_result_t rv = exr_write_scanline_chunk_info(ctx, 0, y, &chunk);
    if (!rv)
        rv = first ? exr_encoding_initialize(ctx, 0, &chunk, pipe) : exr_encoding_update(ctx, 0, &chunk, pipe);
    for (int c = 0; c < pipe->channel_count && !rv; c++) {
        exr_coding_channel_info_t *from = &pipe->channels[c];
        from->user_bytes_per_element = sizeof(float);
        from->user_data_type = EXR_PIXEL_FLOAT;
        from->user_pixel_stride = sizeof(float);
        from->user_line_stride = width * (int)sizeof(float);
        from->encode_from_ptr = (const uint8_t *)(channel[c].v + (size_t)y * (size_t)width);
    }
    if (!rv && first)
        rv = exr_encoding_choose_default_routines(ctx, 0, pipe);
    pipe->yield_until_ready_fn = NULL; /* write_chunks writes in order */
    pipe->write_fn = NULL;
    return rv ? rv : exr_encoding_run(ctx, 0, pipe);
}

/* Compression takes nearly all the time, so the threads share it. They write in order, so that the bytes are the same
 * for any number of threads. */
static exr_result_t write_chunks(exr_context_t ctx, int threads, int width, int height, const image_channel *channel)
{
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(ctx, 0, &lines);
    if (result)
        return result;
    const int chunks = (height + lines - 1) / lines;
    (void)threads; /* without OpenMP */
#pragma omp parallel num_threads(threads)
    {
        exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
        exr_result_t rv = EXR_ERR_SUCCESS; /* of this thread, which stops at its first failure */
        bool first = true;
#pragma omp for ordered schedule(dynamic)
        for (int i = 0; i < chunks; i++) {
            if (!rv)
                rv = compress_chunk(ctx, &pipe, first, i * lines, width, channel);
            first = false;
#pragma omp ordered
            {
                if (!rv && !result)
                    rv = exr_write_scanline_chunk(ctx, 0, i * lines, pipe.compressed_buffer, pipe.compressed_bytes);
                if (!result)
                    result = rv;
            }
        }
        exr_encoding_destroy(ctx, &pipe);
    }
    return result;
}

static exr_result_t encode(file_writer *file, int threads, int width, int height, int channels,
                           const image_channel *channel, int texts, const image_text *text)
{
    exr_context_t ctx = NULL;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_write_error;
    init.user_data = file;
    init.write_fn = write_at;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.zip_level = 4; /* the default of later versions: a third of level 6's time for a few per cent of size */
    exr_result_t rv = exr_start_write(&ctx, "image", EXR_WRITE_FILE_DIRECTLY, &init);
    if (rv)
        return rv;
    rv = write_header(ctx, width, height, channels, channel, texts, text);
    if (!rv)
        rv = write_chunks(ctx, threads_of(threads), width, height, channel);
    exr_result_t end = exr_finish(&ctx); /* writes the table of chunks */
    return rv ? rv : end;
}

/* Why these channels, sorted by name, cannot make a file; NULL: they can. */
static const char *refuse(int width, int height, int channels, const image_channel *sorted)
{
    const char *why = image_refuse_size(width, height);
    if (!why && channels < 1)
        why = "the image has no channels";
    for (int c = 1; c < channels; c++)
        if (strcmp(sorted[c - 1].name, sorted[c].name) == 0)
            why = "two channels have the same name";
    return why;
}

bool image_write_exr(const char *path, int threads, int width, int height, int channels, const image_channel *channel,
                     int texts, const image_text *text, errors *e)
{
    const size_t n = channels > 0 ? (size_t)channels : 0;
    image_channel *sorted = malloc((n + 1) * sizeof *sorted);
    if (!sorted)
        return errors_add(e, "%s: cannot be written: there is not enough memory", path);
    for (size_t c = 0; c < n; c++)
        sorted[c] = channel[c];
    qsort(sorted, n, sizeof *sorted, by_name); /* as the format wants them */

    file_writer file;
    bool ok = false;
    const char *why = refuse(width, height, channels, sorted);
    if (why)
        errors_add(e, "%s: cannot be written: %s", path, why);
    else if (file_writer_open(&file, path, e)) {
        exr_result_t rv = encode(&file, threads, width, height, channels, sorted, texts, text);
        ok = file_writer_close(&file, rv ? exr_get_default_error_message(rv) : NULL, e);
    }
    free(sorted);
    return ok;
}
