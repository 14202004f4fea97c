/* Passes on the samples of an image in memory. */
#include "image/array.h"

#include "base/real.h"
#include "image/format.h"

static size_t bytes_of(image_type type)
{
    static const size_t bytes[] = {1, 2, sizeof(float), sizeof(double)};
    return bytes[type];
}

size_t image_array_size(const image_array *a)
{
    return bytes_of(a->type) * (size_t)a->channels * (size_t)a->width * (size_t)a->height;
}

static inline float sample(const image_array *a, size_t at)
{
    switch (a->type) {
    case IMAGE_U8:
        return image_of_u8(((const uint8_t *)a->samples)[at]);
    case IMAGE_U16:
        return image_of_u16(((const uint16_t *)a->samples)[at]);
    case IMAGE_F32:
        return ((const float *)a->samples)[at];
    default:
        return (float)((const double *)a->samples)[at];
    }
}

/* The channel of a pixel's value, -1: 1, of a pixel without alpha. */
static int channel_of(const image_array *a, int values, int value)
{
    if (values == 1)
        return 0;
    if (value == 3)
        return a->channels % 2 == 0 ? a->channels - 1 : -1;
    return a->channels < 3 ? 0 : value;
}

static void fill_row(const image_array *a, int y, int values, float *row)
{
    const size_t n = (size_t)a->width, channels = (size_t)a->channels, start = (size_t)y * n * channels;
    for (int v = 0; v < values; v++) {
        const int channel = channel_of(a, values, v);
        for (size_t x = 0; x < n; x++)
            row[x * (size_t)values + (size_t)v] = channel < 0 ? 1 : sample(a, start + x * channels + (size_t)channel);
    }
}

bool image_read_array(const image_array *a, const char *channel, image_stream *to, char *why)
{
    if (channel)
        return image_refuse(why, "there is no channel '%s': an array has no named channels", channel);
    if (to->values == 1 && a->channels > 2)
        return image_refuse(why, "it has %d channels; a height map has one", a->channels);
    if (!image_begin(to, a->width, a->height, why))
        return false;
    float *row = memory_new(progress_memory(to->progress), sizeof *row * (size_t)a->width * (size_t)to->values);
    if (!row)
        return image_refuse_memory(to, why);
    bool good = true;
    for (int y = 0; good && y < a->height; y++) {
        fill_row(a, y, to->values, row);
        good = image_pass(to, 0, y, a->width, row, to->range, why);
    }
    memory_free(row);
    return good;
}
