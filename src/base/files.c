/* Sets of files, compared by device and inode. */
#include "base/files.h"

#include <stdlib.h>

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
