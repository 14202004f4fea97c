/* Reads OpenEXR files with OpenEXRCore: one channel, or a colour. */
#include <openexr.h>

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image/format.h"

/* The largest allocation for a (perhaps damaged) header: more than any chunk within our limits needs. */
#define MEMORY_LIMIT ((size_t)1 << 32)

/* Zeroed, as a damaged chunk may fill less of its buffer than it claims: the same file gives the same answer. */
static void *limited_alloc(size_t size) { return size > MEMORY_LIMIT ? NULL : calloc(1, size); }

typedef struct exr_reader {
    int fd;
    char *why; /* IMAGE_WHY; the first reason counts */
} exr_reader;

static void on_read_error(exr_const_context_t ctx, exr_result_t code, const char *message)
{
    void *r = NULL;
    (void)code;
    if (exr_get_user_data(ctx, &r) == EXR_ERR_SUCCESS && r)
        image_refuse(((exr_reader *)r)->why, "OpenEXR: %s", message);
}

/* Whether a call of the library succeeded; if not, there is a reason. */
static bool good(exr_reader *r, exr_result_t result)
{
    return result == EXR_ERR_SUCCESS || image_refuse(r->why, "OpenEXR: %s", exr_get_default_error_message(result));
}

static int64_t read_at(exr_const_context_t ctx, void *data, void *buffer, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t error)
{
    exr_reader *r = data;
    uint64_t done = 0;
    (void)ctx, (void)error;
    while (done < size) {
        ssize_t n = pread(r->fd, (char *)buffer + done, (size_t)(size - done), (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            image_refuse(r->why, "%s", strerror(errno));
            return -1;
        }
        if (n == 0)
            break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t size_of_file(exr_const_context_t ctx, void *data)
{
    struct stat st;
    (void)ctx;
    return fstat(((exr_reader *)data)->fd, &st) == 0 ? (int64_t)st.st_size : -1;
}

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

/* The image being read, and the pipeline that decompresses it chunk by chunk. */
typedef struct exr_plane {
    exr_context_t ctx;
    exr_decode_pipeline_t pipe;
    bool started;
    const char *channel;
    image *out;
    int values, which; /* a pixel's values, and the one that the channel is */
} exr_plane;

static float half_to_float(unsigned h)
{
    const int exponent = (int)(h >> 10 & 31);
    const float mantissa = (float)(h & 1023);
    const float magnitude = exponent == 31 ? (mantissa > 0 ? NAN : INFINITY)
                            : exponent > 0 ? ldexpf(mantissa + 1024, exponent - 25)
                                           : ldexpf(mantissa, -24);
    return h >> 15 ? -magnitude : magnitude;
}

/* n samples as the file has them, little-endian, to every `step`th place. */
static void to_float(float *to, int step, const uint8_t *from, int n, int type)
{
    for (int x = 0; x < n; x++, to += step) {
        if (type == EXR_PIXEL_HALF) {
            *to = half_to_float((unsigned)from[2 * x + 1] << 8 | from[2 * x]);
            continue;
        }
        const uint8_t *b = from + 4 * (size_t)x;
        uint32_t bits = (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
        if (type == EXR_PIXEL_UINT)
            *to = (float)bits;
        else
            memcpy(to, &bits, sizeof bits);
    }
}

/* From a decompressed chunk, which holds line after line and in each line channel after channel, take the one
 * channel. (The library's own unpacking writes through NULL for channels that are not wanted: 3.1.5, three or
 * four channels of type half.) */
static bool unpack(exr_reader *r, exr_plane *p, int x, int y)
{
    const exr_chunk_info_t *chunk = &p->pipe.chunk;
    const uint8_t *from = p->pipe.unpacked_buffer ? p->pipe.unpacked_buffer : p->pipe.packed_buffer;
    uint64_t left = chunk->unpacked_size;
    for (int line = 0; line < chunk->height; line++)
        for (int c = 0; c < p->pipe.channel_count; c++) {
            const exr_coding_channel_info_t *ch = &p->pipe.channels[c];
            if (ch->y_samples > 1 && (chunk->start_y + line) % ch->y_samples != 0)
                continue;
            const uint64_t size = (uint64_t)ch->width * (uint64_t)ch->bytes_per_element;
            const bool wanted = strcmp(ch->channel_name, p->channel) == 0;
            if (size > left || (wanted && ch->width != chunk->width))
                return image_refuse(r->why, "OpenEXR: a chunk has a wrong size");
            if (wanted)
                to_float(p->out->v + ((size_t)(y + line) * (size_t)p->out->width + (size_t)x) * (size_t)p->values +
                             p->which,
                         p->values, from, ch->width, ch->data_type);
            from += size;
            left -= size;
        }
    return true;
}

/* Decode one chunk, whose first sample is (x, y) of the image. */
static bool decode_chunk(exr_reader *r, exr_plane *p, const exr_chunk_info_t *chunk, int x, int y)
{
    if (chunk->width < 1 || chunk->height < 1 || chunk->width > p->out->width - x || chunk->height > p->out->height - y)
        return image_refuse(r->why, "OpenEXR: a chunk does not lie within the image");
    if (chunk->packed_size == 0 ||
        (chunk->compression == EXR_COMPRESSION_NONE && chunk->packed_size != chunk->unpacked_size))
        return image_refuse(r->why, "OpenEXR: a chunk has a wrong size");
    if (!good(r, p->started ? exr_decoding_update(p->ctx, 0, chunk, &p->pipe)
                            : exr_decoding_initialize(p->ctx, 0, chunk, &p->pipe)))
        return false;
    if (!p->started && !good(r, exr_decoding_choose_default_routines(p->ctx, 0, &p->pipe)))
        return false;
    p->started = true;
    p->pipe.unpack_and_convert_fn = NULL;
    return good(r, exr_decoding_run(p->ctx, 0, &p->pipe)) && unpack(r, p, x, y);
}

static bool decode_scanlines(exr_reader *r, exr_plane *p, int first_y)
{
    int32_t lines = 0;
    if (!good(r, exr_get_scanlines_per_chunk(p->ctx, 0, &lines)))
        return false;
    if (lines < 1)
        return image_refuse(r->why, "OpenEXR: chunks without lines");
    for (int y = 0; y < p->out->height; y += lines) {
        exr_chunk_info_t chunk = {0};
        if (!good(r, exr_read_scanline_chunk_info(p->ctx, 0, first_y + y, &chunk)) || !decode_chunk(r, p, &chunk, 0, y))
            return false;
    }
    return true;
}

/* Of a pyramid, the finest level. */
static bool decode_tiles(exr_reader *r, exr_plane *p)
{
    int32_t w = 0, h = 0;
    if (!good(r, exr_get_tile_sizes(p->ctx, 0, 0, 0, &w, &h)))
        return false;
    if (w < 1 || h < 1)
        return image_refuse(r->why, "OpenEXR: tiles without samples");
    for (int64_t y = 0; y < p->out->height; y += h)
        for (int64_t x = 0; x < p->out->width; x += w) {
            exr_chunk_info_t chunk = {0};
            if (!good(r, exr_read_tile_chunk_info(p->ctx, 0, (int)(x / w), (int)(y / h), 0, 0, &chunk)) ||
                !decode_chunk(r, p, &chunk, (int)x, (int)y))
                return false;
        }
    return true;
}

static bool all_finite(exr_reader *r, const image *m, int values)
{
    const int width = values * m->width;
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < width; x++) {
            float v = m->v[(size_t)y * (size_t)width + (size_t)x];
            if (!isfinite(v))
                return image_refuse(r->why, "the sample in column %d of row %d (both from 0) is %s", x / values, y,
                                    isnan(v) ? "NaN"
                                    : v > 0  ? "infinite"
                                             : "-infinite");
        }
    return true;
}

static bool decode_channel(exr_reader *r, exr_plane *p, const exr_attr_chlist_entry_t *channel, int which,
                           exr_storage_t storage, int first_y)
{
    p->channel = channel->name.str;
    p->which = which;
    return storage == EXR_STORAGE_TILED ? decode_tiles(r, p) : decode_scanlines(r, p, first_y);
}

static bool decode(exr_reader *r, exr_plane *p, const char *name, bool color)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *list = NULL;
    const exr_attr_chlist_entry_t *channel[4] = {NULL};
    if (!good(r, exr_get_count(p->ctx, &parts)))
        return false;
    if (parts != 1)
        return image_refuse(r->why, "the OpenEXR file has several parts; one is expected");
    if (!good(r, exr_get_storage(p->ctx, 0, &storage)))
        return false;
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return image_refuse(r->why, "the OpenEXR file holds deep samples; a flat image is expected");
    if (!good(r, exr_get_channels(p->ctx, 0, &list)) ||
        !(color ? choose_colors(r, list, channel) : choose(r, list, name, channel)) ||
        !good(r, exr_get_data_window(p->ctx, 0, &window)))
        return false;
    p->values = color ? 4 : 1;
    if (!image_alloc(p->out, (int64_t)window.max.x - window.min.x + 1, (int64_t)window.max.y - window.min.y + 1,
                     p->values, r->why))
        return false;
    for (size_t k = 0; color && k < (size_t)p->out->width * (size_t)p->out->height; k++)
        p->out->v[4 * k + 3] = 1;
    for (int k = 0; k < p->values; k++)
        if (channel[k] && !decode_channel(r, p, channel[k], k, storage, window.min.y))
            return false;
    return all_finite(r, p->out, p->values);
}

bool image_read_exr(FILE *file, const char *channel, bool color, image *out, char *why)
{
    exr_reader r = {.fd = fileno(file), .why = why};
    struct stat st;
    if (fstat(r.fd, &st) != 0 || !S_ISREG(st.st_mode))
        return image_refuse(r.why, "an OpenEXR file is read out of order, so not from a pipe or a device");
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_read_error;
    init.alloc_fn = limited_alloc;
    init.free_fn = free;
    init.user_data = &r;
    init.read_fn = read_at;
    init.size_fn = size_of_file;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.max_tile_width = init.max_tile_height = IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* an incomplete file is an error */
    exr_plane p = {.pipe = EXR_DECODE_PIPELINE_INITIALIZER, .out = out};
    bool ok = good(&r, exr_start_read(&p.ctx, "image", &init)) && decode(&r, &p, channel, color);
    if (p.ctx) {
        exr_decoding_destroy(p.ctx, &p.pipe);
        exr_finish(&p.ctx);
    }
    return ok;
}
