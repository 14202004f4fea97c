/* Sets of files, compared by device and inode. */
#define _XOPEN_SOURCE 700 /* fdopen, O_CLOEXEC */

#include "base/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

FILE *files_open_input(const char *path, const char **why)
{
    struct stat about;
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    const bool known = fd >= 0 && fstat(fd, &about) == 0, regular = known && S_ISREG(about.st_mode);
    FILE *f = regular ? fdopen(fd, "rb") : NULL;
    *why = f                                 ? NULL
           : known && S_ISDIR(about.st_mode) ? strerror(EISDIR)
           : known && !regular               ? "no regular file"
                                             : strerror(errno);
    if (fd >= 0 && !f)
        close(fd);
    return f;
}

static bool files_have(const files *f, file_id id)
{
    for (int k = 0; k < f->count; k++)
        if (f->id[k].device == id.device && f->id[k].number == id.number)
            return true;
    return false;
}

bool files_add(files *f, file_id id)
{
    if (files_have(f, id))
        return true;
    file_id *more = realloc(f->id, sizeof *more * (size_t)(f->count + 1));
    if (!more)
        return false;
    f->id = more;
    f->id[f->count++] = id;
    return true;
}

bool files_add_path(files *f, const char *path)
{
    struct stat about;
    return stat(path, &about) != 0 || !S_ISREG(about.st_mode) || files_add(f, file_id_of(&about));
}

bool files_have_path(const files *f, const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && files_have(f, file_id_of(&about));
}

void files_free(files *f)
{
    free(f->id);
    *f = (files){0};
}
