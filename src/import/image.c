/* The images of a model's materials: files beside it, or bytes in it. What kage reads is used as it is; a JPEG, an
 * image with an alpha channel that is used, and one that a colour multiplies become PNG files beside the scene.
 */
#include "import/scene.h"

#include "base/files.h"

#include "import/picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- names ---- */

static int hex(char c)
{
    const char low = (char)(c | 0x20);
    return c >= '0' && c <= '9' ? c - '0' : low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

/* A file's name from a model: glTF writes %20 for a blank, Windows \ for /. To be freed. */
static char *file_name(const importer *k, const char *uri)
{
    char *name = malloc(strlen(uri) + 1), *to = name;
    for (const char *c = uri; name && *c; c++)
        if (k->gltf && *c == '%' && hex(c[1]) >= 0 && hex(c[2]) >= 0) {
            *to++ = (char)(16 * hex(c[1]) + hex(c[2]));
            c += 2;
        } else
            *to++ = *c == '\\' ? '/' : *c;
    if (name)
        *to = 0;
    return name;
}

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* a and b, n bytes of it, in one. NULL: out of memory. */
static char *join(const char *a, size_t n, const char *b)
{
    char *s = malloc(n + strlen(b) + 1);
    if (s) {
        memcpy(s, a, n);
        strcpy(s + n, b);
    }
    return s;
}

/* ---- bytes ---- */

static unsigned char *read_whole(const char *path, size_t *size)
{
    enum { MOST = 1 << 29 };
    const char *why;
    FILE *f = files_open_input(path, &why);
    long n = f && fseek(f, 0, SEEK_END) == 0 ? ftell(f) : -1;
    unsigned char *bytes = n > 0 && n < MOST && fseek(f, 0, SEEK_SET) == 0 ? malloc((size_t)n) : NULL;
    if (bytes && fread(bytes, 1, (size_t)n, f) != (size_t)n) {
        free(bytes);
        bytes = NULL;
    }
    if (f)
        fclose(f);
    *size = bytes ? (size_t)n : 0;
    return bytes;
}

/* A file beside the model, or, if its folder is another machine's, by its last name alone. *name is shortened then. */
static unsigned char *read_beside(const importer *k, char *name, size_t *size)
{
    const size_t folder = (size_t)(base_of(k->path) - k->path);
    for (int turn = 0; turn < 2; turn++) {
        char *path = *name == '/' ? join("", 0, name) : join(k->path, folder, name);
        unsigned char *bytes = path ? read_whole(path, size) : NULL;
        free(path);
        if (bytes || base_of(name) == name)
            return bytes;
        memmove(name, base_of(name), strlen(base_of(name)) + 1);
    }
    return NULL;
}

static bool is_image(const unsigned char *bytes, size_t size) { return picture_kind_of(bytes, size) != PICTURE_OTHER; }

/* ---- files that are written ---- */

/* Whether a file of this name was written for another image. */
static bool is_taken(const importer *k, const char *file)
{
    for (int i = 0; i < k->images; i++)
        if (k->image[i].file && strcmp(k->image[i].file, file) == 0)
            return true;
    return false;
}

/* Send a file that is called after the scene and the image. Returns its name, to be freed. */
static char *send_file(importer *k, const char *name, const char *ending, const void *bytes, size_t size)
{
    char part[TEXT_NAME], *stem = join(name, strcspn(name, "."), "");
    char *file = stem ? malloc(strlen(k->wish->stem) + TEXT_NAME + 32) : NULL;
    if (file) {
        text_scene_name(part, *stem ? stem : "image");
        const bool after =
            strncmp(part, k->wish->stem, strlen(k->wish->stem)) != 0; /* it has the scene's name not yet */
        const char *first = after ? k->wish->stem : "", *dash = after ? "-" : "";
        sprintf(file, "%s%s%s%s", first, dash, part, ending);
        for (int n = 2; is_taken(k, file); n++)
            sprintf(file, "%s%s%s-%d%s", first, dash, part, n, ending);
        k->to->file(k->to->user, file, bytes, size);
    }
    free(stem);
    return file;
}

static char *send_picture(importer *k, const char *name, picture *p, const double factor[3])
{
    size_t size = 0;
    picture_tint(p, factor);
    unsigned char *bytes = picture_encode(p, &size);
    char *file = bytes ? send_file(k, name, ".png", bytes, size) : NULL;
    free(bytes);
    free(p->v);
    return file;
}

/* ---- from a model's image to the scene's ---- */

static bool is_white(const double f[3]) { return f[0] >= 1 && f[1] >= 1 && f[2] >= 1; }

/* The bytes of an image: as they are if that will do, else converted. kept: the name of the file that has them, if any.
 * NULL: `why`. */
static char *make_file(importer *k, const unsigned char *bytes, size_t size, const char *name, const char *kept,
                       const double factor[3], char why[PICTURE_WHY])
{
    const picture_kind kind = picture_kind_of(bytes, size);
    if (kind == PICTURE_EXR && is_white(factor))
        return kept ? join("", 0, kept) : send_file(k, name, ".exr", bytes, size);
    if (kind == PICTURE_EXR) {
        snprintf(why, PICTURE_WHY, "a colour multiplies it, and it is an OpenEXR, which is not converted");
        return NULL;
    }
    picture p;
    if (!picture_decode(bytes, size, &p, why))
        return NULL;
    if (p.clear)
        scene_tell(k, 2, "image %.100s is transparent in places, which is left out", name);
    if (kind == PICTURE_PNG && !p.clear && is_white(factor)) {
        free(p.v);
        return kept ? join("", 0, kept) : send_file(k, name, ".png", bytes, size);
    }
    return send_picture(k, name, &p, factor);
}

static const struct aiTexture *embedded(const importer *k, const char *uri)
{
    const struct aiScene *s = k->s;
    const unsigned long i = *uri == '*' ? strtoul(uri + 1, NULL, 10) : s->mNumTextures;
    if (i < s->mNumTextures)
        return s->mTextures[i];
    for (unsigned n = 0; n < s->mNumTextures; n++) /* an FBX names the files that it has in it */
        if (s->mTextures[n]->mFilename.length && strcmp(s->mTextures[n]->mFilename.data, uri) == 0)
            return s->mTextures[n];
    return NULL;
}

static char *file_of_embedded(importer *k, const struct aiTexture *t, const double factor[3], char why[PICTURE_WHY])
{
    char *given = file_name(k, t->mFilename.length ? t->mFilename.data : "image"), *file = NULL;
    const char *name = given ? base_of(given) : "image";
    picture p;
    if (t->mHeight == 0)
        file = make_file(k, (const unsigned char *)t->pcData, t->mWidth, name, NULL, factor, why);
    else if (t->mWidth < 1 << 16 && t->mHeight < 1 << 16 &&
             picture_of_texels((const unsigned char *)t->pcData, (int)t->mWidth, (int)t->mHeight, &p))
        file = send_picture(k, name, &p, factor);
    free(given);
    return file;
}

static char *file_beside(importer *k, const char *uri, const double factor[3], char why[PICTURE_WHY])
{
    size_t size = 0;
    char *name = file_name(k, uri), *file = NULL;
    unsigned char *bytes = name ? read_beside(k, name, &size) : NULL;
    char *kept = name ? join(k->wish->folder, *name == '/' ? 0 : strlen(k->wish->folder), name) : NULL;
    if (!bytes)
        snprintf(why, PICTURE_WHY, "there is no such file");
    else if (!is_image(bytes, size))
        snprintf(why, PICTURE_WHY, "no PNG, JPEG or OpenEXR");
    else if (kept)
        file = make_file(k, bytes, size, base_of(name), kept, factor, why);
    free(bytes);
    free(kept);
    free(name);
    return file;
}

const char *scene_image_file(importer *k, const char *uri, const double factor[3], const char *owner)
{
    char why[PICTURE_WHY] = "out of memory";
    text key = {0};
    text_add(&key, "%s %g %g %g", uri, factor[0], factor[1], factor[2]);
    for (int i = 0; i < k->images && key.s; i++)
        if (strcmp(k->image[i].key, key.s) == 0) {
            free(key.s);
            return k->image[i].file;
        }
    scene_image *more = key.s ? realloc(k->image, sizeof *more * (size_t)(k->images + 1)) : NULL;
    if (!more) {
        k->out.failed = true;
        free(key.s);
        return NULL;
    }
    k->image = more;
    const struct aiTexture *t = embedded(k, uri);
    char *file = t ? file_of_embedded(k, t, factor, why) : file_beside(k, uri, factor, why);
    k->image[k->images++] = (scene_image){key.s, file};
    if (!file)
        scene_tell(k, 2, "material %.60s: its image %.200s can't be used: %s", owner,
                   *uri == '*' ? "in the model" : uri, why);
    return file;
}
