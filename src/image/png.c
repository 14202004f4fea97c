/* Reads and writes PNG files with libpng. */
#include <errno.h>
#include <png.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include "base/file_writer.h"

#include "base/files.h"
#include "base/real.h"
#include "base/threads.h"
#include "image/format.h"
#include "image/grey.h"
#include "image/srgb.h"

/* Rows on their way from the thread that decodes to one that passes them on, in two halves of job->packed. */
typedef struct png_relay {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool started, ended;
    int first[2], rows[2]; /* that wait in each half; 0: it is free */
} png_relay;

/* libpng's error handler must not return, so it calls longjmp. What is needed after the jump is in this struct, outside
 * the frame of setjmp's function, where the jump cannot change it. */
typedef struct png_job {
    jmp_buf jump;
    char *why; /* IMAGE_WHY */
    png_structp png;
    png_infop info;
    png_bytep packed; /* while reading: rows as the file has them, and one row of samples */
    float *row;
    size_t row_bytes;
    int bytes;   /* of a sample */
    int samples; /* of a row */
    bool colour; /* the file has red, green and blue, and a grey is wanted */
    grey_colours found;
    image_stream *to;
    png_relay relay;
} png_job;

static void on_error(png_structp png, png_const_charp message)
{
    png_job *job = png_get_error_ptr(png);
    image_refuse(job->why, "libpng: %s", message);
    longjmp(job->jump, 1);
}

/* Warnings are about chunks that no sample depends on. */
static void on_warning(png_structp png, png_const_charp message) { (void)png, (void)message; }

/* ------------------------------------------------------------------------------------------------ reading */

static void read_bytes(png_structp png, png_bytep data, size_t size)
{
    FILE *file = png_get_io_ptr(png);
    if (fread(data, 1, size, file) != size)
        png_error(png, ferror(file) ? strerror(errno) : "the file ends too early");
}

STAGE static void png_to_float8(int n, const unsigned char *restrict from, float *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = image_of_u8(from[i]);
}

/* Big-endian. */
STAGE static void png_to_float16(int n, const unsigned char *restrict from, float *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = image_of_u16(from[2 * i] << 8 | from[2 * i + 1]);
}

/* Pass on n rows, from row y on. (The samples are finite, so none is refused.) */
static void pass_rows(png_job *job, int y, int n, const unsigned char *packed)
{
    image_stream *to = job->to;
    for (int k = 0; k < n; k++) {
        (job->bytes == 2 ? png_to_float16 : png_to_float8)(job->samples, packed + (size_t)k * job->row_bytes, job->row);
        if (job->colour)
            grey_take(to->width, job->row, &job->found);
        image_pass(to, 0, y + k, to->width, job->row, to->range, job->why);
    }
}

enum { RELAYED = 32 }; /* rows at a time */

static void *relay_pass(void *user)
{
    png_job *job = user;
    png_relay *r = &job->relay;
    for (int half = 0;; half ^= 1) {
        pthread_mutex_lock(&r->lock);
        while (!r->rows[half] && !r->ended)
            pthread_cond_wait(&r->changed, &r->lock);
        const int n = r->rows[half];
        pthread_mutex_unlock(&r->lock);
        if (n == 0)
            return NULL;
        pass_rows(job, r->first[half], n, job->packed + (size_t)half * RELAYED * job->row_bytes);
        pthread_mutex_lock(&r->lock);
        r->rows[half] = 0;
        pthread_cond_signal(&r->changed);
        pthread_mutex_unlock(&r->lock);
    }
}

/* False: there is no other thread to be had. */
static bool relay_begin(png_job *job)
{
    png_relay *r = &job->relay;
    if (pthread_mutex_init(&r->lock, NULL) != 0)
        return false;
    if (pthread_cond_init(&r->changed, NULL) == 0) {
        r->started = pthread_create(&r->thread, NULL, relay_pass, job) == 0;
        if (r->started)
            return true;
        pthread_cond_destroy(&r->changed);
    }
    pthread_mutex_destroy(&r->lock);
    return false;
}

/* Wait until all rows are passed on; also after an error. */
static void relay_end(png_relay *r)
{
    if (!r->started)
        return;
    pthread_mutex_lock(&r->lock);
    r->ended = true;
    pthread_cond_signal(&r->changed);
    pthread_mutex_unlock(&r->lock);
    pthread_join(r->thread, NULL);
    pthread_cond_destroy(&r->changed);
    pthread_mutex_destroy(&r->lock);
}

/* Decode rows y to y + n - 1 into a half that is free. The lock is not held in libpng, which may jump out. */
static void relay_rows(png_job *job, int y, int n, int half)
{
    png_relay *r = &job->relay;
    unsigned char *to = job->packed + (size_t)half * RELAYED * job->row_bytes;
    pthread_mutex_lock(&r->lock);
    while (r->rows[half])
        pthread_cond_wait(&r->changed, &r->lock);
    pthread_mutex_unlock(&r->lock);
    for (int k = 0; k < n; k++)
        png_read_row(job->png, to + (size_t)k * job->row_bytes, NULL);
    pthread_mutex_lock(&r->lock);
    r->first[half] = y;
    r->rows[half] = n;
    pthread_cond_signal(&r->changed);
    pthread_mutex_unlock(&r->lock);
}

/* An interlaced image comes in several passes, so all its rows are kept. Otherwise some are, and another thread, if
 * there may be one, passes them on meanwhile. */
static bool read_rows(png_job *job, int passes, int threads)
{
    const int height = job->to->height;
    const bool relayed = passes == 1 && height > 2 * RELAYED && threads_of(threads) > 1;
    memory *m = progress_memory(job->to->progress);
    job->packed = memory_new(m, job->row_bytes * (size_t)(relayed ? 2 * RELAYED : passes > 1 ? height : 1));
    job->row = memory_new(m, (size_t)job->samples * sizeof *job->row);
    if (!job->packed || !job->row)
        return image_refuse_memory(job->to, job->why);
    if (relayed && relay_begin(job)) {
        for (int y = 0; y < height && image_goes_on(job->to, y, job->why); y += RELAYED)
            relay_rows(job, y, height - y < RELAYED ? height - y : RELAYED, y / RELAYED % 2);
        return !*job->why;
    }
    for (int pass = 1; pass <= passes; pass++)
        for (int y = 0; y < height; y++) {
            if (y % IMAGE_ROWS == 0 && !image_goes_on(job->to, y, job->why))
                return false;
            unsigned char *row = job->packed + (passes > 1 ? (size_t)y * job->row_bytes : 0);
            png_read_row(job->png, row, NULL);
            if (pass == passes)
                pass_rows(job, y, 1, row);
        }
    return true;
}

/* Every kind of PNG as red, green, blue and alpha of 8 or 16 bits. */
static void expand_to_color(png_job *job, int colour)
{
    if (colour == PNG_COLOR_TYPE_PALETTE)
        png_set_palette_to_rgb(job->png);
    if (colour == PNG_COLOR_TYPE_GRAY || colour == PNG_COLOR_TYPE_GRAY_ALPHA) {
        png_set_expand_gray_1_2_4_to_8(job->png);
        png_set_gray_to_rgb(job->png);
    }
    if (png_get_valid(job->png, job->info, PNG_INFO_tRNS))
        png_set_tRNS_to_alpha(job->png);
    png_set_add_alpha(job->png, 0xffff, PNG_FILLER_AFTER); /* where there is none */
}

/* Read all before the samples: from the start of the file with its texts, or after the signature without. */
static bool read_header(png_job *job, FILE *file, bool texts)
{
    job->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info)
        return image_refuse(job->why, "libpng does not start");
    png_set_read_fn(job->png, file, read_bytes);
    png_set_sig_bytes(job->png, texts ? 0 : 8);
    png_set_user_limits(job->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* image_begin has the limits */
    if (!texts)
        png_set_keep_unknown_chunks(job->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1); /* nor gamma and colour profiles */
    png_read_info(job->png, job->info);
    return true;
}

/* A grey of 8 or 16 bits; of a file in colour all three, so that it is seen whether they are one grey. */
static void expand_to_grey(png_job *job, int type)
{
    job->colour = (type & PNG_COLOR_MASK_COLOR) != 0;
    if (type == PNG_COLOR_TYPE_PALETTE)
        png_set_palette_to_rgb(job->png);
    png_set_expand_gray_1_2_4_to_8(job->png); /* x 255, 85, 17: sample / maximum stays what it was */
    png_set_strip_alpha(job->png);
}

static bool decode(png_job *job, FILE *file, int threads)
{
    if (setjmp(job->jump))
        return false;
    if (!read_header(job, file, false))
        return false;
    image_stream *to = job->to;
    const int type = png_get_color_type(job->png, job->info);
    if (!image_begin(to, png_get_image_width(job->png, job->info), png_get_image_height(job->png, job->info), job->why))
        return false;
    job->bytes = png_get_bit_depth(job->png, job->info) == 16 ? 2 : 1;
    if (to->values > 1)
        expand_to_color(job, type);
    else
        expand_to_grey(job, type);
    const int passes = png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    job->samples = to->width * (job->colour ? 3 : to->values);
    job->row_bytes = (size_t)job->samples * (size_t)job->bytes;
    if (png_get_rowbytes(job->png, job->info) != job->row_bytes)
        return image_refuse(job->why, "libpng: unexpected size of a row");
    if (!read_rows(job, passes, threads))
        return false;
    png_read_end(job->png, NULL);
    return true;
}

bool image_read_png(FILE *file, int threads, image_stream *to, char *why)
{
    png_job job = {.why = why, .to = to};
    bool ok = decode(&job, file, threads);
    relay_end(&job.relay);
    ok = ok && grey_found(&job.found, why);
    png_destroy_read_struct(&job.png, &job.info, NULL);
    memory_free(job.packed);
    memory_free(job.row);
    return ok;
}

static const char *find_text(const png_job *job, const char *key)
{
    png_textp text = NULL;
    const int n = png_get_text(job->png, job->info, &text, NULL);
    for (int k = 0; k < n; k++)
        if (strcmp(text[k].key, key) == 0)
            return text[k].text;
    return NULL;
}

/* The text Software, owned by libpng. NULL: none before the samples. */
static const char *software(png_job *job, FILE *file)
{
    if (setjmp(job->jump))
        return NULL;
    return read_header(job, file, true) ? find_text(job, "Software") : NULL;
}

bool image_png_is_from(const char *path, const char *program)
{
    char why[IMAGE_WHY] = "";
    png_job job = {.why = why};
    const char *reason;
    FILE *file = files_open_input(path, &reason);
    if (!file)
        return false;
    const char *text = software(&job, file);
    const size_t n = strlen(program);
    const bool is = text && strncmp(text, program, n) == 0 && text[n] == ' ';
    png_destroy_read_struct(&job.png, &job.info, NULL);
    fclose(file);
    return is;
}

/* ------------------------------------------------------------------------------------------------ writing */

typedef struct png_writer {
    image_writer base;
    png_job job;
    char why[IMAGE_WHY];
    file_writer file;
    uint64_t size; /* so far */
    int bits;
    srgb *curve;
    uint16_t *code; /* of a row, one channel */
    png_bytep row;
    png_textp text;
} png_writer;

static void write_bytes(png_structp png, png_bytep data, size_t size)
{
    png_writer *o = png_get_io_ptr(png);
    if (!file_writer_write(&o->file, data, size, o->size))
        png_error(png, "the file cannot be written");
    o->size += size;
}

static void flush_nothing(png_structp png) { (void)png; }

static bool is_ascii(const char *s)
{
    while (*s > 0)
        s++;
    return !*s;
}

/* tEXt holds Latin-1; other text is UTF-8, which goes into iTXt. */
static void put_texts(png_job *job, png_writer *o, int texts, const image_text *text)
{
    for (int i = 0; i < texts; i++) {
        png_textp t = &o->text[i];
        t->compression = is_ascii(text[i].value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        t->key = (png_charp)text[i].key; /* not const by libpng's history only */
        t->text = (png_charp)text[i].value;
    }
    png_set_text(job->png, job->info, o->text, texts);
}

static void put_row(png_writer *o, const float *const plane[3], size_t start)
{
    const int width = o->base.width;
    for (int c = 0; c < 3; c++) {
        srgb_encode(o->curve, width, plane[c] + start, o->code);
        if (o->bits == 8) {
            for (int x = 0; x < width; x++)
                o->row[3 * x + c] = (png_byte)o->code[x];
        } else {
            for (int x = 0; x < width; x++) {
                o->row[6 * x + 2 * c] = (png_byte)(o->code[x] >> 8);
                o->row[6 * x + 2 * c + 1] = (png_byte)(o->code[x] & 255);
            }
        }
    }
}

/* Begin, add rows, end: each sets its own jump, which is not used after it. */
static bool begin(png_writer *o, const image_form *form)
{
    png_job *job = &o->job;
    if (setjmp(job->jump))
        return false;
    job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    o->curve = srgb_create(o->bits);
    o->code = malloc((size_t)form->width * sizeof *o->code);
    o->row = malloc((size_t)form->width * 3 * (size_t)(o->bits / 8));
    o->text = calloc((size_t)form->texts + 1, sizeof *o->text);
    if (!job->info || !o->curve || !o->code || !o->row || !o->text)
        return image_refuse(job->why, "there is not enough memory");
    png_set_write_fn(job->png, o, write_bytes, flush_nothing);
    png_set_compression_level(job->png, 2); /* with one filter: a third of the usual time, a fifth more bytes */
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(job->png, job->info, (png_uint_32)form->width, (png_uint_32)form->height, o->bits, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    put_texts(job, o, form->texts, form->text);
    png_write_info(job->png, job->info);
    return true;
}

static bool add(image_writer *base, int rows, const float *const *plane, const progress *p)
{
    png_writer *o = (png_writer *)base;
    if (setjmp(o->job.jump))
        return false;
    for (int y = 0; y < rows; y++) {
        if (y % IMAGE_ROWS == 0 && !progress_show(p, "writing", (double)y / rows))
            return false;
        put_row(o, plane, (size_t)y * (size_t)base->width);
        png_write_row(o->job.png, o->row);
    }
    return progress_show(p, "writing", 1);
}

static bool end(png_writer *o)
{
    if (setjmp(o->job.jump))
        return false;
    png_write_end(o->job.png, NULL);
    return true;
}

static bool close_png(image_writer *base, bool whole, errors *e)
{
    png_writer *o = (png_writer *)base;
    whole = whole && end(o);
    const bool ok = file_writer_close(&o->file, whole ? NULL : o->why, e);
    png_destroy_write_struct(&o->job.png, &o->job.info);
    free(o->curve);
    free(o->code);
    free(o->row);
    free(o->text);
    free(o);
    return ok;
}

image_writer *image_writer_png(const char *path, const image_form *form, errors *e)
{
    const char *why = image_refuse_form(form);
    if (!why && form->bits != 8 && form->bits != 16)
        why = "a PNG has 8 or 16 bits";
    png_writer *o = why ? NULL : calloc(1, sizeof *o);
    if (!why && !o)
        why = "there is not enough memory";
    if (why) {
        errors_add(e, "%s: cannot be written: %s", path, why);
        return NULL;
    }
    o->base = (image_writer){form->width, form->height, 0, false, add, close_png};
    o->job.why = o->why;
    o->bits = form->bits;
    if (!file_writer_open(&o->file, path, e)) {
        free(o);
        return NULL;
    }
    if (begin(o, form))
        return &o->base;
    close_png(&o->base, false, e);
    return NULL;
}
