/* Reasons, size limits and the way of the samples, for all formats. */
#include "image/format.h"

#include <math.h>
#include <stdarg.h>

#include "base/real.h"

bool image_refuse(char *why, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    if (!why[0])
        vsnprintf(why, IMAGE_WHY, fmt, args);
    va_end(args);
    return false;
}

bool image_refuse_memory(const image_stream *s, char *why)
{
    char words[MEMORY_WORDS];
    return image_refuse(why, "%s", memory_words(progress_memory(s->progress), words));
}

/* width and height are those of a file, up to 2^32. False, with a reason. */
static bool size_is_good(const image_stream *s, int64_t width, int64_t height, char *why)
{
    const cap side = progress_limit(s->progress, LIMIT_SIDE, IMAGE_MAX_SIDE);
    const cap all = progress_limit(s->progress, LIMIT_SAMPLES, IMAGE_MAX_PIXELS);
    if (width < 1 || height < 1)
        return image_refuse(why, "the image has no samples");
    if (width > side.most || height > side.most)
        return image_refuse(why, "the image is too large: it has %lld x %lld samples, expected at most %lld a side%s",
                            (long long)width, (long long)height, (long long)side.most, side.by);
    const long long samples = width * height;
    return samples <= all.most ||
           image_refuse(why, "the image is too large: it has %lld samples, expected at most %lld%s", samples,
                        (long long)all.most, all.by);
}

bool image_begin(image_stream *s, int64_t width, int64_t height, char *why)
{
    if (!size_is_good(s, width, height, why))
        return false;
    s->width = (int)width;
    s->height = (int)height;
    s->range[0] = INFINITY;
    s->range[1] = -INFINITY;
    const char *refused = s->to->begin(s->to->user, s->width, s->height);
    return !refused || (*refused ? image_refuse(why, "%s", refused) : image_refuse_memory(s, why));
}

/* What is found so far, each of some columns by itself. unknown: 0, or NaN by a value that is NaN or infinite. */
enum { BESIDE = 64 };

typedef struct extremes {
    float low[BESIDE], high[BESIDE], unknown[BESIDE];
} extremes;

STAGE static void image_extremes(int n, const float *restrict v, extremes *restrict x)
{
    for (int i = 0; i < n; i++) {
        x->low[i] = v[i] < x->low[i] ? v[i] : x->low[i];
        x->high[i] = v[i] > x->high[i] ? v[i] : x->high[i];
        x->unknown[i] += 0 * v[i];
    }
}

static bool refuse_value(const image_stream *s, int x, int y, const float *v, char *why)
{
    int k = 0;
    while (isfinite(v[k]))
        k++;
    return image_refuse(why, "the sample in column %d of row %d (both from 0) is %s", x + k / s->values, y,
                        isnan(v[k]) ? "NaN"
                        : v[k] > 0  ? "infinite"
                                    : "-infinite");
}

bool image_pass(const image_stream *s, int x, int y, int n, const float *v, float range[2], char *why)
{
    extremes found;
    for (int i = 0; i < BESIDE; i++) {
        found.low[i] = range[0];
        found.high[i] = range[1];
        found.unknown[i] = 0;
    }
    for (int i = 0; i < n * s->values; i += BESIDE)
        image_extremes(n * s->values - i < BESIDE ? n * s->values - i : BESIDE, v + i, &found);
    for (int i = 0; i < BESIDE; i++) {
        range[0] = fminf(range[0], found.low[i]);
        range[1] = fmaxf(range[1], found.high[i]);
        if (found.unknown[i] != 0)
            return refuse_value(s, x, y, v, why);
    }
    s->to->take(s->to->user, x, y, n, v);
    return true;
}

/* ---- writing ---- */

const char *image_refuse_form(const image_form *form)
{
    if (form->width < 1 || form->height < 1)
        return "the image has no samples";
    if (form->width > IMAGE_MAX_SIDE || form->height > IMAGE_MAX_SIDE)
        return "the image is too large: the limit is 65536 samples a side";
    return form->channels < 1 ? "the image has no channels" : NULL;
}

int image_writer_rows(const image_writer *w) { return w->rows; }

bool image_goes_on(const image_stream *s, int rows, char *why)
{
    return progress_show(s->progress, "reading", (double)rows / s->height) || image_refuse(why, "cancelled");
}

bool image_writer_add(image_writer *w, int rows, const float *const *plane, const progress *p)
{
    w->failed = w->failed || !w->add(w, rows, plane, p);
    if (!w->failed)
        w->rows += rows;
    return !w->failed;
}

bool image_writer_close(image_writer *w, bool whole, errors *e)
{
    return w->close(w, whole && !w->failed && w->rows == w->height, e);
}
