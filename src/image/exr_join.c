/* Copies chunks of one OpenEXR file to another with OpenEXRCore. A chunk is compressed by itself, so its bytes do not
 * depend on where in the picture it is; only the line's number before it does, which the library writes. */
#include "image/exr_join.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image/exr_open.h"
#include "image/exr_write.h"

struct exr_band {
    const char *path;
    exr_reader reader;
    exr_context_t ctx;
    image_form form;
    const char **name; /* form.name and form.text, in the library's memory */
    image_text *text;
    void *chunk; /* room for the largest chunk that there can be */
    uint64_t room;
    char why[IMAGE_WHY];
};

/* As exr_good; a lack of memory, which the library reports by one code or another, is told in our words. */
static bool good(exr_band *b, exr_result_t result)
{
    if (exr_good(&b->reader, result))
        return true;
    if (!strstr(b->why, exr_get_default_error_message(EXR_ERR_OUT_OF_MEMORY)))
        return false;
    b->why[0] = 0;
    return image_refuse(b->why, "there is not enough memory");
}

static bool refuse(exr_band *b, const char *what)
{
    return image_refuse(b->why, "it is no EXR that kage has written: %s", what);
}

/* The size, from a data window that begins at 0,0. */
static bool read_size(exr_band *b)
{
    exr_attr_box2i_t window;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    int parts = 0;
    int32_t lines = 0;
    if (!good(b, exr_get_count(b->ctx, &parts)) || !good(b, exr_get_storage(b->ctx, 0, &storage)))
        return false;
    if (parts != 1 || storage != EXR_STORAGE_SCANLINE)
        return refuse(b, "it has tiles, deep samples or several parts");
    if (!good(b, exr_get_compression(b->ctx, 0, &compression)) ||
        !good(b, exr_get_scanlines_per_chunk(b->ctx, 0, &lines)) || !good(b, exr_get_data_window(b->ctx, 0, &window)))
        return false;
    if (compression != EXR_COMPRESSION_ZIP || lines != IMAGE_ROWS || window.min.x != 0 || window.min.y != 0)
        return refuse(b, "its compression or its data window is another one");
    b->form.width = window.max.x + 1; /* the library has checked it against its limits */
    b->form.height = window.max.y + 1;
    return true;
}

static bool read_channels(exr_band *b)
{
    const exr_attr_chlist_t *list = NULL;
    if (!good(b, exr_get_channels(b->ctx, 0, &list)))
        return false;
    b->name = calloc((size_t)list->num_channels + 1, sizeof *b->name);
    b->room = (uint64_t)b->form.width * (uint64_t)list->num_channels * IMAGE_ROWS * sizeof(float);
    b->chunk = malloc((size_t)b->room + 1);
    if (!b->name || !b->chunk)
        return image_refuse(b->why, "there is not enough memory");
    for (int c = 0; c < list->num_channels; c++) {
        const exr_attr_chlist_entry_t *channel = &list->entries[c];
        if (channel->pixel_type != EXR_PIXEL_FLOAT || channel->x_sampling != 1 || channel->y_sampling != 1)
            return refuse(b, "a channel has other samples than float");
        b->name[c] = channel->name.str;
    }
    b->form.channels = list->num_channels;
    b->form.name = b->name;
    return true;
}

/* The attributes that are texts, in the order of the file. */
static bool read_texts(exr_band *b)
{
    const exr_attribute_t *a = NULL;
    int32_t count = 0;
    if (!good(b, exr_get_attribute_count(b->ctx, 0, &count)))
        return false;
    b->text = calloc((size_t)count + 1, sizeof *b->text);
    if (!b->text)
        return image_refuse(b->why, "there is not enough memory");
    for (int32_t k = 0; k < count; k++) {
        if (!good(b, exr_get_attribute_by_index(b->ctx, 0, EXR_ATTR_LIST_FILE_ORDER, k, &a)))
            return false;
        if (a->type != EXR_ATTR_STRING || strcmp(a->name, "type") == 0) /* which the library writes itself */
            continue;
        if (!a->string->str && a->string->length > 0)
            return image_refuse(b->why, "there is not enough memory");
        b->text[b->form.texts++] = (image_text){a->name, a->string->str ? a->string->str : ""};
    }
    b->form.text = b->text;
    return true;
}

exr_band *exr_band_open(const char *path, errors *e)
{
    exr_band *b = calloc(1, sizeof *b);
    struct stat st;
    if (!b) {
        errors_add(e, "%s: cannot be read: there is not enough memory", path);
        return NULL;
    }
    b->path = path;
    b->reader = (exr_reader){open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC), b->why};
    if (b->reader.fd < 0 || fstat(b->reader.fd, &st) != 0)
        image_refuse(b->why, "%s", strerror(errno));
    else if (!S_ISREG(st.st_mode))
        image_refuse(b->why, "a band must be a regular file");
    else if (good(b, exr_open(&b->reader, &b->ctx)) && read_size(b) && read_channels(b) && read_texts(b))
        return b;
    errors_add(e, "%s: cannot be read: %s", path, b->why);
    exr_band_close(b);
    return NULL;
}

const image_form *exr_band_form(const exr_band *b) { return &b->form; }

/* The chunk of the lines from y on, into b->chunk. */
static bool read_chunk(exr_band *b, int y, uint64_t *size)
{
    exr_chunk_info_t chunk = {0};
    if (!good(b, exr_read_scanline_chunk_info(b->ctx, 0, y, &chunk)))
        return false;
    if (chunk.start_y != y || chunk.packed_size > b->room)
        return image_refuse(b->why, "OpenEXR: a chunk has a wrong size");
    *size = chunk.packed_size;
    return good(b, exr_read_chunk(b->ctx, 0, &chunk, b->chunk));
}

bool exr_band_copy(exr_band *b, image_writer *to, const progress *p, errors *e)
{
    const int height = b->form.height;
    for (int y = 0; y < height; y += IMAGE_ROWS) {
        uint64_t size = 0;
        if (!progress_show(p, "writing", (double)y / height))
            return false;
        if (!read_chunk(b, y, &size))
            return errors_add(e, "%s: cannot be read: %s", b->path, b->why);
        if (!exr_writer_add_chunk(to, b->chunk, size))
            return false;
    }
    return progress_show(p, "writing", 1);
}

void exr_band_close(exr_band *b)
{
    if (!b)
        return;
    if (b->ctx)
        exr_finish(&b->ctx);
    if (b->reader.fd >= 0)
        close(b->reader.fd);
    free(b->name);
    free(b->text);
    free(b->chunk);
    free(b);
}
