/* Opens models by assimp. It reads files through functions of ours, so that it sees only the model and those that the
 * model cannot do without: a glTF's buffers, and an OBJ's materials.
 */
#include "import/open.h"

#include "base/files.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct reading {
    const char *path;
    bool buffers;      /* glTF: other files may be opened, too */
    bool materials;    /* OBJ: and so may .mtl files */
    size_t size, done; /* bytes of the model */
    double shown;      /* the last share that was reported */
    const import_listener *to;
} reading;

/* An open file. assimp passes `base` to the functions below. */
typedef struct source {
    struct aiFile base;
    FILE *file;
    reading *of;
} source;

static void report_share(reading *k)
{
    const double share = k->done < k->size ? (double)k->done / (double)k->size : 1;
    if (share < k->shown + 0.01 && share < 1)
        return;
    k->shown = share;
    k->to->read(k->to->user, share);
}

static size_t read_some(struct aiFile *base, char *to, size_t size, size_t count)
{
    enum { PIECE = 1 << 20 };
    source *s = (source *)(void *)base->UserData;
    size_t all = size * count, got = 0, n = 1;
    while (got < all && n > 0) {
        n = fread(to + got, 1, all - got < PIECE ? all - got : PIECE, s->file);
        got += n;
        s->of->done += n;
        report_share(s->of);
    }
    return size ? got / size : 0;
}

static size_t write_none(struct aiFile *base, const char *from, size_t size, size_t count)
{
    (void)base, (void)from, (void)size, (void)count;
    return 0;
}

static size_t tell(struct aiFile *base)
{
    const long at = ftell(((source *)(void *)base->UserData)->file);
    return at < 0 ? 0 : (size_t)at;
}

static size_t size_of(struct aiFile *base)
{
    struct stat about;
    return fstat(fileno(((source *)(void *)base->UserData)->file), &about) == 0 ? (size_t)about.st_size : 0;
}

static enum aiReturn seek(struct aiFile *base, size_t offset, enum aiOrigin origin)
{
    const int from = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
    return fseek(((source *)(void *)base->UserData)->file, (long)offset, from) == 0 ? aiReturn_SUCCESS
                                                                                    : aiReturn_FAILURE;
}

static void flush(struct aiFile *base) { (void)base; }

/* Whether f is a regular file. If so, report it. */
static bool report_file(FILE *f, const import_listener *to)
{
    struct stat about;
    if (fstat(fileno(f), &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    to->open(to->user, file_id_of(&about));
    return true;
}

static struct aiFile *open_one(struct aiFileIO *io, const char *path, const char *mode)
{
    reading *of = (reading *)(void *)io->UserData;
    const bool may = of->buffers || strcmp(path, of->path) == 0 || (of->materials && import_ends_with(path, ".mtl"));
    const char *why;
    FILE *f = mode[0] == 'r' && may ? files_open_input(path, &why) : NULL;
    source *s = f && report_file(f, of->to) ? malloc(sizeof *s) : NULL;
    if (!s) {
        if (f)
            fclose(f);
        return NULL;
    }
    *s = (source){{.FileSizeProc = size_of,
                   .FlushProc = flush,
                   .ReadProc = read_some,
                   .SeekProc = seek,
                   .TellProc = tell,
                   .WriteProc = write_none},
                  f,
                  of};
    s->base.UserData = (aiUserData)(void *)s;
    return &s->base;
}

static void close_one(struct aiFileIO *io, struct aiFile *base)
{
    source *s = (source *)(void *)base->UserData;
    (void)io;
    fclose(s->file);
    free(s);
}

bool import_ends_with(const char *path, const char *end)
{
    const size_t n = strlen(path), m = strlen(end);
    for (size_t k = 0; n >= m && k < m; k++)
        if ((path[n - m + k] | 0x20) != (end[k] | 0x20))
            return false;
    return n >= m;
}

const struct aiScene *import_open(const char *path, const import_listener *to, char why[MESH_WHY])
{
    struct stat about;
    reading of = {path,
                  import_ends_with(path, ".gltf"),
                  import_ends_with(path, ".obj"),
                  stat(path, &about) == 0 ? (size_t)about.st_size : 0,
                  0,
                  0,
                  to};
    struct aiFileIO io = {.OpenProc = open_one, .CloseProc = close_one, .UserData = (aiUserData)(void *)&of};
    struct aiPropertyStore *how = aiCreatePropertyStore();
    aiSetImportPropertyInteger(how, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    aiSetImportPropertyInteger(how, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    const struct aiScene *s = aiImportFileExWithProperties(
        path, aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType, &io, how);
    const char *text = aiGetErrorString();
    if (!s)
        snprintf(why, MESH_WHY, "%s", *text ? text : "it can't be read");
    aiReleasePropertyStore(how);
    return s;
}
