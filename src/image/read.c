/* Reads an image by the reader of its format, which its first bytes show; then checks alpha and decodes sRGB. */
#include "image/format.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "image/srgb.h"

static bool read_any(FILE *file, const char *channel, int threads, image_stream *to, bool *is_exr, char *why)
{
    static const unsigned char exr[4] = {0x76, 0x2f, 0x31, 0x01};
    static const unsigned char png[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    static const unsigned char jpeg[3] = {0xff, 0xd8, 0xff};
    unsigned char first[8] = {0};
    errno = 0;
    size_t n = fread(first, 1, sizeof first, file);
    if (ferror(file))
        return image_refuse(why, "%s", strerror(errno));
    *is_exr = n >= sizeof exr && memcmp(first, exr, sizeof exr) == 0;
    if (*is_exr)
        return image_read_exr(file, channel, threads, to, why);
    if (n >= sizeof jpeg && memcmp(first, jpeg, sizeof jpeg) == 0)
        return image_refuse(why, "it is a JPEG, expected a PNG or an OpenEXR file; save it again as a PNG");
    if (n < sizeof png || memcmp(first, png, sizeof png) != 0)
        return image_refuse(why,
                            n ? "its first bytes are those of neither a PNG nor an OpenEXR file" : "the file is empty");
    if (channel)
        return image_refuse(why, "there is no channel '%s': a PNG file has no named channels", channel);
    return image_read_png(file, threads, to, why);
}

static bool read_file(const char *path, const char *channel, int threads, image_stream *to, bool *is_exr, errors *e)
{
    const char *reason;
    FILE *file = files_open_input(path, &reason);
    if (!file)
        return errors_add(e, "%s", reason);
    char why[IMAGE_WHY] = "";
    bool ok = read_any(file, channel, threads, to, is_exr, why);
    fclose(file);
    return ok || errors_add(e, "%s", why);
}

int image_png_bits(const char *path)
{
    unsigned char head[25]; /* the signature, then the chunk IHDR: its size, its name, the image's size, the bits */
    const char *why;
    FILE *file = files_open_input(path, &why);
    const bool good = file && fread(head, 1, sizeof head, file) == sizeof head && memcmp(head + 1, "PNG", 3) == 0 &&
                      memcmp(head + 12, "IHDR", 4) == 0;
    if (file)
        fclose(file);
    return good && head[24] <= 16 ? head[24] : 0;
}

bool image_read(const char *path, const char *channel, int threads, const progress *w, const image_taker *to,
                float range[2], errors *e)
{
    bool is_exr;
    image_stream s = {.to = to, .progress = w, .values = 1};
    const bool ok = read_file(path, channel, threads, &s, &is_exr, e);
    range[0] = s.range[0];
    range[1] = s.range[1];
    return ok;
}

static bool read_memory(const image_array *a, const char *channel, image_stream *to, errors *e)
{
    char why[IMAGE_WHY] = "";
    return image_read_array(a, channel, to, why) || errors_add(e, "%s", why);
}

bool image_array_read(const image_array *a, const char *channel, const progress *w, const image_taker *to,
                      float range[2], errors *e)
{
    image_stream s = {.to = to, .progress = w, .values = 1};
    const bool ok = read_memory(a, channel, &s, e);
    range[0] = s.range[0];
    range[1] = s.range[1];
    return ok;
}

/* ---- in colour: all pixels in memory ---- */

typedef struct colour_pixels {
    image *out;
    const progress *progress;
} colour_pixels;

static const char *begin_pixels(void *user, int width, int height)
{
    const colour_pixels *c = user;
    float *v = memory_new(progress_memory(c->progress), (size_t)width * (size_t)height * 4 * sizeof *v);
    *c->out = (image){width, height, v};
    return v ? NULL : "";
}

static void take_pixels(void *user, int x, int y, int n, const float *v)
{
    const image *out = ((const colour_pixels *)user)->out;
    memcpy(out->v + 4 * ((size_t)y * (size_t)out->width + (size_t)x), v, 4 * (size_t)n * sizeof *v);
}

/* Frees the image unless `good`, which it returns. */
static bool keep_if(bool good, image *out)
{
    if (!good) {
        memory_free(out->v);
        *out = (image){0};
    }
    return good;
}

static bool all_opaque(const image *m, errors *e)
{
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++)
            if (m->v[4 * ((size_t)y * (size_t)m->width + (size_t)x) + 3] != 1)
                return errors_add(
                    e, "the pixel in column %d of row %d (both from 0) is transparent; an opaque image is expected", x,
                    y);
    return true;
}

/* wrong: why samples can't be in sRGB, which are linear in any case. */
static bool finish_color(image_encoding encoding, bool linear, const char *wrong, image *out, errors *e)
{
    if (!all_opaque(out, e))
        return false;
    if (linear && encoding == IMAGE_SRGB)
        return errors_add(e, "%s", wrong);
    return linear || encoding == IMAGE_LINEAR || srgb_decode((size_t)out->width * (size_t)out->height, out->v) ||
           errors_add(e, "there is not enough memory for the image");
}

bool image_read_color(const char *path, image_encoding encoding, int threads, const progress *w, image *out,
                      bool *is_exr, errors *e)
{
    colour_pixels c = {out, w};
    const image_taker to = {&c, begin_pixels, take_pixels};
    image_stream s = {.to = &to, .progress = w, .values = 4};
    *out = (image){0};
    return keep_if(read_file(path, NULL, threads, &s, is_exr, e) &&
                       finish_color(encoding, *is_exr, "an OpenEXR file is linear; srgb is for PNG", out, e),
                   out);
}

bool image_array_read_color(const image_array *a, image_encoding encoding, const progress *w, image *out,
                            bool *is_float, errors *e)
{
    colour_pixels c = {out, w};
    const image_taker to = {&c, begin_pixels, take_pixels};
    image_stream s = {.to = &to, .progress = w, .values = 4};
    *out = (image){0};
    *is_float = a->type >= IMAGE_F32;
    return keep_if(
        read_memory(a, NULL, &s, e) &&
            finish_color(encoding, *is_float, "an array of floats is linear; srgb is for whole numbers", out, e),
        out);
}
