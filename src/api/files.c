/* Files of pictures: before they are written, and what is left of them. */
#include "api/api.h"

#include "base/aside.h"
#include "base/file_writer.h"

#include <stdio.h>
#include <stdlib.h>

kage_status kage_file_probe(const char *path, kage_errors **to)
{
    errors e = {0};
    const bool good = file_writer_probe(path, &e);
    return errors_give(&e, good ? KAGE_OK : KAGE_NOT_WRITTEN, NULL, to);
}

int kage_file_is_picture(const char *path) { return image_png_is_from(path, SOFTWARE); }

size_t kage_file_part(const char *path, char *name, size_t size)
{
    char *part = file_writer_part(path);
    const int n = part ? snprintf(name, size, "%s", part) : 0;
    free(part);
    return n > 0 ? (size_t)n : 0;
}

void kage_file_tidy(const char *path, kage_errors **notes)
{
    errors e = {0};
    aside_remove_stale(path, &e);
    errors_give(&e, e.items ? KAGE_NOT_WRITTEN : KAGE_OK, NULL, notes);
}
