/* Writes OpenEXR files with OpenEXRCore: their header, then chunks of 16 lines, which threads compress side by side. An
 * unfinished file can be gone on with: its header must be the same, and whole chunks are kept. */
#include <openexr.h>

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/file_writer.h"
#include "base/threads.h"
#include "image/exr_write.h"
#include "image/exr_zip.h"
#include "image/format.h"

/* What becomes of the library's bytes: the header is compared with what is there and written behind it; kept chunks are
 * there already. */
enum step { HEADER, KEPT, REST };

typedef struct exr_writer {
    image_writer base;
    file_writer file;
    exr_context_t ctx;
    enum step step;
    uint64_t header; /* its bytes, which are followed by the table of chunks */
    bool differs;    /* from the header that is there */
    int threads, channels;
    int *order; /* channel c of the file, sorted by name, is plane order[c] */
    exr_result_t result;
    const char *why; /* besides `result` */
} exr_writer;

/* Empty: return codes are used instead. A handler like the reader's could deadlock, as the library holds a lock while
 * it writes. */
static void on_write_error(exr_const_context_t ctx, exr_result_t code, const char *message)
{
    (void)ctx, (void)code, (void)message;
}

/* Compare bytes of the header with those that are there. */
static bool is_there(exr_writer *w, const char *bytes, size_t size, uint64_t offset)
{
    char there[256];
    bool same = true;
    for (size_t k = 0, n; same && k < size; k += n) {
        n = size - k < sizeof there ? size - k : sizeof there;
        same = file_writer_read(&w->file, there, n, offset + k) && memcmp(there, bytes + k, n) == 0;
    }
    w->differs = w->differs || !same;
    return same;
}

static int64_t write_at(exr_const_context_t ctx, void *data, const void *buffer, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t error)
{
    (void)ctx, (void)error;
    exr_writer *w = data;
    const char *bytes = buffer;
    uint64_t there = 0;
    if (w->step == HEADER && offset + size > w->header)
        w->header = offset + size;
    if (w->step == HEADER && offset < w->file.size) {
        there = w->file.size - offset < size ? w->file.size - offset : size;
        if (!is_there(w, bytes, (size_t)there, offset))
            return -1;
    } else if (w->step == KEPT)
        there = size;
    return file_writer_write(&w->file, bytes + there, (size_t)(size - there), offset + there) ? (int64_t)size : -1;
}

static exr_result_t write_header(exr_context_t ctx, const image_form *form, const int *order)
{
    int part;
    size_t longest = 0;
    for (int c = 0; c < form->channels; c++)
        longest = strlen(form->name[c]) > longest ? strlen(form->name[c]) : longest;
    for (int i = 0; i < form->texts; i++)
        longest = strlen(form->text[i].key) > longest ? strlen(form->text[i].key) : longest;
    /* A flag in the file that old readers refuse: set only where it is needed. */
    exr_result_t rv = exr_set_longname_support(ctx, longest > 31);
    if (!rv)
        rv = exr_add_part(ctx, NULL, EXR_STORAGE_SCANLINE, &part);
    if (!rv)
        rv = exr_initialize_required_attr_simple(ctx, part, form->width, form->height, EXR_COMPRESSION_ZIP);
    for (int c = 0; c < form->channels && !rv; c++)
        rv = exr_add_channel(ctx, part, form->name[order[c]], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    for (int i = 0; i < form->texts && !rv; i++)
        rv = exr_attr_set_string(ctx, part, form->text[i].key, form->text[i].value);
    return rv ? rv : exr_write_header(ctx);
}

/* Compress the chunk of the lines from y on; plane[c] begins with line `top`. */
static exr_result_t compress_chunk(exr_writer *w, exr_encode_pipeline_t *pipe, bool first, int y, int top,
                                   const float *const *plane)
{
    const size_t width = (size_t)w->base.width;
    exr_chunk_info_t chunk = {0};
    exr_result_t rv = exr_write_scanline_chunk_info(w->ctx, 0, y, &chunk);
    if (!rv)
        rv = first ? exr_encoding_initialize(w->ctx, 0, &chunk, pipe) : exr_encoding_update(w->ctx, 0, &chunk, pipe);
    for (int c = 0; c < pipe->channel_count && !rv; c++) {
        exr_coding_channel_info_t *from = &pipe->channels[c];
        from->user_bytes_per_element = sizeof(float);
        from->user_data_type = EXR_PIXEL_FLOAT;
        from->user_pixel_stride = sizeof(float);
        from->user_line_stride = (int32_t)(width * sizeof(float));
        from->encode_from_ptr = (const uint8_t *)(plane[w->order[c]] + (size_t)(y - top) * width);
    }
    if (!rv && first)
        rv = exr_encoding_choose_default_routines(w->ctx, 0, pipe);
    if (!rv && first)
        rv = exr_zip_begin(pipe);
    pipe->yield_until_ready_fn = NULL; /* add_chunks writes in order */
    pipe->write_fn = NULL;
    return rv ? rv : exr_encoding_run(w->ctx, 0, pipe);
}

/* The chunks of a call: threads take one after the other, and write them in this order. */
typedef struct chunks {
    int top, count;
    pthread_mutex_t lock; /* of the rest */
    pthread_cond_t changed;
    int taken, done;
    bool stop; /* by the caller's progress, or after a failure */
} chunks;

/* The next chunk; count: there is none. (A loop of OpenMP would give each chunk its turn after a stop, too, which takes
 * long on a busy machine.) */
static int take_chunk(chunks *k)
{
    pthread_mutex_lock(&k->lock);
    const int i = k->stop || k->taken == k->count ? k->count : k->taken++;
    pthread_mutex_unlock(&k->lock);
    return i;
}

/* Write chunk i, whose compression returned rv, when it is its turn. Only the caller's thread shows progress. */
static void write_chunk(exr_writer *w, chunks *k, int i, const exr_encode_pipeline_t *pipe, exr_result_t rv,
                        const progress *p)
{
    pthread_mutex_lock(&k->lock);
    while (k->done != i && !k->stop)
        pthread_cond_wait(&k->changed, &k->lock);
    if (!k->stop) {
        w->result = rv ? rv
                       : exr_write_scanline_chunk(w->ctx, 0, k->top + i * IMAGE_ROWS, pipe->compressed_buffer,
                                                  pipe->compressed_bytes);
        k->done++;
        k->stop = w->result || (is_callers_thread() && !progress_show(p, "writing", (double)k->done / k->count));
    }
    pthread_cond_broadcast(&k->changed);
    pthread_mutex_unlock(&k->lock);
}

/* Compression takes nearly all the time, so the threads share it. They write in order, so that the bytes are the same
 * for any number of threads. */
static void add_chunks(exr_writer *w, chunks *k, const float *const *plane, const progress *p)
{
#pragma omp parallel num_threads(w->threads)
    {
        exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
        bool first = true;
        for (int i = take_chunk(k); i < k->count; i = take_chunk(k)) {
            const exr_result_t rv = compress_chunk(w, &pipe, first, k->top + i * IMAGE_ROWS, k->top, plane);
            first = false;
            write_chunk(w, k, i, &pipe, rv, p);
        }
        exr_zip_end(&pipe);
        exr_encoding_destroy(w->ctx, &pipe);
    }
}

static bool add(image_writer *base, int rows, const float *const *plane, const progress *p)
{
    exr_writer *w = (exr_writer *)base;
    chunks k = {.top = base->rows,
                .count = (rows + IMAGE_ROWS - 1) / IMAGE_ROWS,
                .lock = PTHREAD_MUTEX_INITIALIZER,
                .changed = PTHREAD_COND_INITIALIZER};
    if (!progress_show(p, "writing", 0))
        return false;
    add_chunks(w, &k, plane, p);
    return !k.stop;
}

bool exr_writer_add_chunk(image_writer *base, const void *bytes, uint64_t size)
{
    exr_writer *w = (exr_writer *)base;
    const int left = base->height - base->rows;
    if (!w->result)
        w->result = exr_write_scanline_chunk(w->ctx, 0, base->rows, bytes, size);
    if (!w->result)
        base->rows += left < IMAGE_ROWS ? left : IMAGE_ROWS;
    base->failed = base->failed || w->result;
    return !w->result;
}

static bool close_exr(image_writer *base, bool whole, errors *e)
{
    exr_writer *w = (exr_writer *)base;
    const exr_result_t end = w->ctx ? exr_finish(&w->ctx) : EXR_ERR_SUCCESS; /* writes the table of chunks */
    if (!w->result && whole)
        w->result = end;
    if (!w->why && w->result)
        w->why = w->result == EXR_ERR_OUT_OF_MEMORY ? "there is not enough memory"
                                                    : exr_get_default_error_message(w->result);
    const bool ok = file_writer_close(&w->file, whole && !w->why ? NULL : w->why ? w->why : "", e);
    free(w->order);
    free(w);
    return ok;
}

/* ---- beginning, and going on ---- */

static uint32_t little_endian(const uint8_t *v)
{
    return v[0] | (uint32_t)v[1] << 8 | (uint32_t)v[2] << 16 | (uint32_t)v[3] << 24;
}

/* The size of the chunk of line y at `at` in the file that was there. 0: it is not whole. */
static uint32_t whole_chunk(const exr_writer *w, int y, uint64_t at)
{
    uint8_t leader[8]; /* the line and the size */
    const uint64_t most = (uint64_t)w->base.width * (uint64_t)w->channels * sizeof(float) * IMAGE_ROWS;
    if (at + sizeof leader > w->file.size || !file_writer_read(&w->file, leader, sizeof leader, at) ||
        little_endian(leader) != (uint32_t)y)
        return 0;
    const uint32_t size = little_endian(leader + 4);
    return size <= most && at + sizeof leader + size <= w->file.size ? size : 0;
}

/* Keep the chunks that are whole in the file that was there; the library takes them as written. At least one chunk is
 * left to add, so that there is always a last band. */
static exr_result_t keep_chunks(exr_writer *w)
{
    const int height = w->base.height;
    exr_result_t rv = EXR_ERR_SUCCESS;
    uint64_t at = w->header + (uint64_t)((height + IMAGE_ROWS - 1) / IMAGE_ROWS) * sizeof(uint64_t);
    uint32_t size;
    w->step = KEPT;
    for (int y = 0; !rv && y + IMAGE_ROWS < height && (size = whole_chunk(w, y, at)) > 0; y += IMAGE_ROWS) {
        rv = exr_write_scanline_chunk(w->ctx, 0, y, w, size); /* write_at does not look at the bytes */
        at += 8 + size;
        w->base.rows = y + IMAGE_ROWS;
    }
    w->step = REST;
    return rv || !w->file.size || file_writer_cut(&w->file, w->base.rows ? at : w->header) ? rv : EXR_ERR_WRITE_IO;
}

static void begin(exr_writer *w, const image_form *form)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_write_error;
    init.user_data = w;
    init.write_fn = write_at;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.zip_level = EXR_ZIP_LEVEL;
    w->result = exr_start_write(&w->ctx, "image", EXR_WRITE_FILE_DIRECTLY, &init);
    if (!w->result)
        w->result = write_header(w->ctx, form, w->order);
    int32_t lines = 0;
    if (!w->result)
        w->result = exr_get_scanlines_per_chunk(w->ctx, 0, &lines);
    if (w->differs)
        w->why = "there is a part of another picture, of another scene, options or version";
    else if (!w->result && lines != IMAGE_ROWS)
        w->why = "OpenEXR has chunks of another size";
    else if (!w->result)
        w->result = keep_chunks(w);
}

/* Sort the channels by name, as the format wants them. False: two have the same. */
static bool sort_channels(const image_form *form, int *order)
{
    bool good = true;
    for (int c = 0; c < form->channels; c++) {
        int k = c;
        for (; k > 0 && strcmp(form->name[order[k - 1]], form->name[c]) >= 0; k--) {
            good = good && strcmp(form->name[order[k - 1]], form->name[c]) != 0;
            order[k] = order[k - 1];
        }
        order[k] = c;
    }
    return good;
}

image_writer *image_writer_exr(const char *path, const image_form *form, errors *e)
{
    static const char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    const char *why = image_refuse_form(form);
    exr_writer *w = why ? NULL : calloc(1, sizeof *w);
    int *order = w ? calloc((size_t)form->channels, sizeof *order) : NULL;
    if (!why && !order)
        why = "there is not enough memory";
    else if (!why && !sort_channels(form, order))
        why = "two channels have the same name";
    if (!why) {
        *w = (exr_writer){{form->width, form->height, 0, false, add, close_exr},
                          .threads = threads_of(form->threads),
                          .channels = form->channels,
                          .order = order};
        if (form->keep || form->resume ? file_writer_open_part(&w->file, path, form->resume, magic, e)
                                       : file_writer_open(&w->file, path, e)) {
            begin(w, form);
            if (!w->result && !w->why)
                return &w->base;
            close_exr(&w->base, false, e);
            return NULL;
        }
    } else
        errors_add(e, "%s: cannot be written: %s", path, why);
    free(order);
    free(w);
    return NULL;
}
