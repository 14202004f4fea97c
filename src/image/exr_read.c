/* Reads OpenEXR files with OpenEXRCore: one channel, or a colour. Chunks are independent, so that threads decode them
 * side by side, each with a context of its own.
 */
#include <openexr.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/real.h"
#include "base/threads.h"
#include "image/exr_open.h"
#include "image/exr_zip.h"

static const exr_attr_chlist_entry_t *find(const exr_attr_chlist_t *list, const char *name)
{
    for (int c = 0; c < list->num_channels; c++)
        if (strcmp(list->entries[c].name.str, name) == 0)
            return &list->entries[c];
    return NULL;
}

static bool is_full(exr_reader *r, const exr_attr_chlist_entry_t *channel)
{
    return (channel->x_sampling == 1 && channel->y_sampling == 1) ||
           image_refuse(r->why, "a channel is subsampled; one sample a pixel is expected");
}

/* The channel of that name, or the only one, or Y. */
static bool choose(exr_reader *r, const exr_attr_chlist_t *list, const char *name, const exr_attr_chlist_entry_t **out)
{
    *out = !name && list->num_channels == 1 ? list->entries : find(list, name ? name : "Y");
    if (*out)
        return is_full(r, *out);
    size_t n = (size_t)(name ? snprintf(r->why, IMAGE_WHY, "there is no channel '%s'; the file has", name)
                             : snprintf(r->why, IMAGE_WHY, "which channel is meant? The file has"));
    for (int c = 0; c < list->num_channels && n < IMAGE_WHY; c++)
        n += (size_t)snprintf(r->why + n, IMAGE_WHY - n, "%s %s", c ? "," : "", list->entries[c].name.str);
    if (n >= IMAGE_WHY)
        memcpy(r->why + IMAGE_WHY - 4, "...", 4);
    return false;
}

/* The channels of red, green, blue and alpha; the last NULL where there is none. */
static bool choose_colors(exr_reader *r, const exr_attr_chlist_t *list, const exr_attr_chlist_entry_t *out[4])
{
    static const char *const names[] = {"R", "G", "B", "A"};
    for (int k = 0; k < 4; k++) {
        out[k] = find(list, names[k]);
        if (out[k] && !is_full(r, out[k]))
            return false;
    }
    if (out[0] && out[1] && out[2])
        return true;
    if (out[0] || out[1] || out[2])
        return image_refuse(r->why, "not all of the channels R, G and B are there");
    if (!choose(r, list, "Y", out))
        return false;
    out[1] = out[2] = out[0];
    return true;
}

/* What is read: the channels of a pixel's values, NULL where there is none, and the chunks that hold them. */
typedef struct exr_plan {
    image_stream *to;
    const exr_attr_chlist_entry_t *channel[4];
    bool tiled;
    int first_y;           /* of scanlines */
    int32_t width, height; /* of a chunk; scanlines are as wide as the image */
    int across, chunks;
} exr_plan;

/* A thread's decoding, chunk by chunk. */
typedef struct exr_worker {
    exr_reader reader;
    const exr_plan *plan;
    exr_context_t ctx;
    exr_decode_pipeline_t pipe;
    bool started;
    int64_t counted; /* bytes for chunks, in the budget */
    float *line;     /* a chunk's line of pixels */
    float range[2];
} exr_worker;

static uint32_t exr_uint(const uint8_t *b)
{
    return (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static float exr_float(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* n samples as the file has them, little-endian. Where a half's exponent and mantissa are moved to a float's place,
 * 2^112 is missing, of subnormal numbers, too. Infinite ones and NaN have all bits of the exponent. */
STAGE static void exr_halves(int n, const uint8_t *restrict from, float *restrict to)
{
    for (int x = 0; x < n; x++) {
        const uint32_t h = (uint32_t)from[2 * x + 1] << 8 | from[2 * x], moved = (h & 0x7fff) << 13;
        const float finite = exr_float(moved) * 0x1p112f, other = exr_float(moved | 0x7f800000);
        const float size = (h & 0x7c00) == 0x7c00 ? other : finite;
        to[x] = h & 0x8000 ? -size : size;
    }
}

STAGE static void exr_floats(int n, const uint8_t *restrict from, float *restrict to)
{
    for (int x = 0; x < n; x++)
        to[x] = exr_float(exr_uint(from + 4 * (size_t)x));
}

STAGE static void exr_uints(int n, const uint8_t *restrict from, float *restrict to)
{
    for (int x = 0; x < n; x++)
        to[x] = (float)exr_uint(from + 4 * (size_t)x);
}

static void to_floats(const exr_coding_channel_info_t *ch, const uint8_t *from, float *to)
{
    (ch->data_type == EXR_PIXEL_HALF   ? exr_halves
     : ch->data_type == EXR_PIXEL_UINT ? exr_uints
                                       : exr_floats)(ch->width, from, to);
}

/* Value k of each pixel of a line, from a channel's samples. */
static void put_value(exr_worker *w, int k, const exr_coding_channel_info_t *ch, const uint8_t *from)
{
    const int values = w->plan->to->values;
    float *const one = values > 1 ? w->line + (size_t)values * (size_t)w->plan->width : w->line;
    to_floats(ch, from, one);
    for (int x = 0; values > 1 && x < ch->width; x++)
        w->line[x * values + k] = one[x];
}

/* Pass on the channels of a line. *from goes on behind it. */
static bool unpack_line(exr_worker *w, int line, const uint8_t **from, uint64_t *left)
{
    const exr_chunk_info_t *chunk = &w->pipe.chunk;
    const exr_plan *plan = w->plan;
    for (int c = 0; c < w->pipe.channel_count; c++) {
        const exr_coding_channel_info_t *ch = &w->pipe.channels[c];
        if (ch->y_samples > 1 && (chunk->start_y + line) % ch->y_samples != 0)
            continue;
        const uint64_t size = (uint64_t)ch->width * (uint64_t)ch->bytes_per_element;
        if (size > *left)
            return image_refuse(w->reader.why, "OpenEXR: a chunk has a wrong size");
        for (int k = 0; k < plan->to->values; k++) {
            if (!plan->channel[k] || strcmp(ch->channel_name, plan->channel[k]->name.str) != 0)
                continue;
            if (ch->width != chunk->width)
                return image_refuse(w->reader.why, "OpenEXR: a chunk has a wrong size");
            put_value(w, k, ch, *from);
        }
        *from += size;
        *left -= size;
    }
    return true;
}

/* From a decompressed chunk, which holds line after line and in each line channel after channel, take the channels
 * of the plan. (The library's own unpacking writes through NULL for channels that are not wanted: 3.1.5, three or
 * four channels of type half.) */
static bool unpack(exr_worker *w, int x, int y)
{
    const exr_chunk_info_t *chunk = &w->pipe.chunk;
    const uint8_t *from = w->pipe.unpacked_buffer ? w->pipe.unpacked_buffer : w->pipe.packed_buffer;
    uint64_t left = chunk->unpacked_size;
    for (int line = 0; line < chunk->height; line++)
        if (!unpack_line(w, line, &from, &left) ||
            !image_pass(w->plan->to, x, y + line, chunk->width, w->line, w->range, w->reader.why))
            return false;
    return true;
}

/* Count what the library takes for a chunk: the samples as they are in the file, as they are, and on the way. */
static bool count_chunk(exr_worker *w, const exr_chunk_info_t *chunk)
{
    memory *m = progress_memory(w->plan->to->progress);
    const int64_t bytes = (int64_t)(chunk->packed_size + 2 * chunk->unpacked_size);
    if (!m || bytes <= w->counted)
        return true;
    if (!memory_count(m, m->from, bytes - w->counted))
        return image_refuse_memory(w->plan->to, w->reader.why);
    w->counted = bytes;
    return true;
}

/* Decode one chunk, whose first sample is (x, y) of the image. */
static bool decode_chunk(exr_worker *w, const exr_chunk_info_t *chunk, int x, int y)
{
    exr_reader *r = &w->reader;
    const image_stream *to = w->plan->to;
    if (chunk->width < 1 || chunk->height < 1 || chunk->width > to->width - x || chunk->height > to->height - y ||
        chunk->width > w->plan->width)
        return image_refuse(r->why, "OpenEXR: a chunk does not lie within the image");
    if (chunk->packed_size == 0 ||
        (chunk->compression == EXR_COMPRESSION_NONE && chunk->packed_size != chunk->unpacked_size))
        return image_refuse(r->why, "OpenEXR: a chunk has a wrong size");
    if (!count_chunk(w, chunk))
        return false;
    if (!exr_good(r, w->started ? exr_decoding_update(w->ctx, 0, chunk, &w->pipe)
                                : exr_decoding_initialize(w->ctx, 0, chunk, &w->pipe)))
        return false;
    if (!w->started && !(exr_good(r, exr_decoding_choose_default_routines(w->ctx, 0, &w->pipe)) &&
                         exr_good(r, exr_unzip_begin(&w->pipe))))
        return false;
    w->started = true;
    w->pipe.unpack_and_convert_fn = NULL;
    return exr_good(r, exr_decoding_run(w->ctx, 0, &w->pipe)) && unpack(w, x, y);
}

/* Of a pyramid, the finest level. */
static bool decode_numbered(exr_worker *w, int k)
{
    const exr_plan *p = w->plan;
    exr_chunk_info_t chunk = {0};
    const int row = k / p->across, column = k % p->across;
    return exr_good(&w->reader, p->tiled
                                    ? exr_read_tile_chunk_info(w->ctx, 0, column, row, 0, 0, &chunk)
                                    : exr_read_scanline_chunk_info(w->ctx, 0, p->first_y + row * p->height, &chunk)) &&
           decode_chunk(w, &chunk, column * p->width, row * p->height);
}

/* ---- the plan ---- */

static bool plan_channels(exr_reader *r, exr_context_t ctx, const char *name, exr_plan *p)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    const exr_attr_chlist_t *list = NULL;
    if (!exr_good(r, exr_get_count(ctx, &parts)))
        return false;
    if (parts != 1)
        return image_refuse(r->why, "the OpenEXR file has several parts; one is expected");
    if (!exr_good(r, exr_get_storage(ctx, 0, &storage)))
        return false;
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return image_refuse(r->why, "the OpenEXR file holds deep samples; a flat image is expected");
    p->tiled = storage == EXR_STORAGE_TILED;
    return exr_good(r, exr_get_channels(ctx, 0, &list)) &&
           (p->to->values > 1 ? choose_colors(r, list, p->channel) : choose(r, list, name, p->channel));
}

static bool plan_chunks(exr_reader *r, exr_context_t ctx, exr_plan *p)
{
    exr_attr_box2i_t window;
    if (!exr_good(r, exr_get_data_window(ctx, 0, &window)) ||
        !image_begin(p->to, (int64_t)window.max.x - window.min.x + 1, (int64_t)window.max.y - window.min.y + 1, r->why))
        return false;
    p->first_y = window.min.y;
    p->width = p->to->width;
    if (!exr_good(r, p->tiled ? exr_get_tile_sizes(ctx, 0, 0, 0, &p->width, &p->height)
                              : exr_get_scanlines_per_chunk(ctx, 0, &p->height)))
        return false;
    if (p->width < 1 || p->height < 1)
        return image_refuse(r->why, "OpenEXR: chunks without samples");
    p->across = (p->to->width - 1) / p->width + 1;
    p->chunks = p->across * ((p->to->height - 1) / p->height + 1);
    return true;
}

/* ---- threads ---- */

/* The first chunk that could not be read, and why: the same for any number of threads. */
typedef struct exr_failure {
    int chunk;
    char why[IMAGE_WHY];
} exr_failure;

static bool begin_worker(exr_worker *w)
{
    const size_t values = (size_t)w->plan->to->values, width = (size_t)w->plan->width;
    w->range[0] = INFINITY;
    w->range[1] = -INFINITY;
    w->line = memory_new(progress_memory(w->plan->to->progress), (values + 1) * width * sizeof *w->line);
    if (!w->line)
        return image_refuse_memory(w->plan->to, w->reader.why);
    for (size_t k = 0; k < values * width; k++)
        w->line[k] = 1; /* alpha, where there is no such channel */
    return exr_good(&w->reader, exr_open(&w->reader, &w->ctx));
}

static void end_worker(exr_worker *w)
{
    exr_unzip_end(&w->pipe);
    if (w->ctx) {
        exr_decoding_destroy(w->ctx, &w->pipe);
        exr_finish(&w->ctx);
    }
    memory_free(w->line);
    if (w->counted > 0)
        memory_count(NULL, w->plan->to->progress->memory->from, -w->counted);
}

static void decode_all(int fd, const exr_plan *p, int threads, exr_failure *bad)
{
    float *const all = p->to->range;
    bad->chunk = p->chunks;
    (void)threads; /* without OpenMP */
#pragma omp parallel num_threads(threads < p->chunks ? threads : p->chunks)
    {
        char why[IMAGE_WHY] = "";
        exr_worker w = {.reader = {fd, why}, .plan = p, .pipe = EXR_DECODE_PIPELINE_INITIALIZER};
        const bool ready = begin_worker(&w);
#pragma omp for schedule(dynamic)
        for (int k = 0; k < p->chunks; k++) {
            int first;
            if (is_callers_thread() && !image_goes_on(p->to, (int)((double)k / p->chunks * p->to->height), why))
#pragma omp critical
            {
                bad->chunk = -1;
                memcpy(bad->why, why, sizeof why);
            }
#pragma omp critical
            first = bad->chunk;
            if (k < first && !(ready && decode_numbered(&w, k)))
#pragma omp critical
                if (k < bad->chunk) {
                    bad->chunk = k;
                    memcpy(bad->why, why, sizeof why);
                }
        }
#pragma omp critical
        {
            all[0] = fminf(all[0], w.range[0]);
            all[1] = fmaxf(all[1], w.range[1]);
        }
        end_worker(&w);
    }
}

bool image_read_exr(FILE *file, const char *channel, int threads, image_stream *to, char *why)
{
    exr_reader r = {.fd = fileno(file), .why = why};
    struct stat st;
    if (fstat(r.fd, &st) != 0 || !S_ISREG(st.st_mode))
        return image_refuse(r.why, "an OpenEXR file is read out of order, so not from a pipe or a device");
    exr_context_t ctx = NULL;
    exr_plan p = {.to = to};
    exr_failure bad;
    bool ok = exr_good(&r, exr_open(&r, &ctx)) && plan_channels(&r, ctx, channel, &p) && plan_chunks(&r, ctx, &p);
    if (ok && st.st_size / (off_t)sizeof(uint64_t) < p.chunks) /* else each of up to 2^28 chunks would be refused */
        ok = image_refuse(why, "OpenEXR: the file is shorter than its table of chunks");
    if (ok) {
        decode_all(r.fd, &p, threads_of(threads), &bad);
        ok = bad.chunk == p.chunks || image_refuse(why, "%s", bad.why);
    }
    if (ctx)
        exr_finish(&ctx);
    return ok;
}
