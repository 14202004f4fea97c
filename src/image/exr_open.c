/* Opens OpenEXR files for reading: by descriptor, with limits, and with reasons in place of output. */
#include "image/exr_open.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The largest allocation for a (perhaps damaged) header: more than any chunk within our limits needs. */
#define MEMORY_LIMIT ((size_t)1 << 32)

/* Zeroed, as a damaged chunk may fill less of its buffer than it claims: the same file gives the same answer. */
static void *limited_alloc(size_t size) { return size > MEMORY_LIMIT ? NULL : calloc(1, size); }

static void on_read_error(exr_const_context_t ctx, exr_result_t code, const char *message)
{
    void *r = NULL;
    (void)code;
    if (exr_get_user_data(ctx, &r) == EXR_ERR_SUCCESS && r)
        image_refuse(((exr_reader *)r)->why, "OpenEXR: %s", message);
}

bool exr_good(exr_reader *r, exr_result_t result)
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

exr_result_t exr_open(exr_reader *r, exr_context_t *ctx)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_read_error;
    init.alloc_fn = limited_alloc;
    init.free_fn = free;
    init.user_data = r;
    init.read_fn = read_at;
    init.size_fn = size_of_file;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.max_tile_width = init.max_tile_height = IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* an incomplete file is an error */
    return exr_start_read(ctx, "image", &init);
}
