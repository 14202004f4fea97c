/* Which bump goes on which object, as the user wishes. */
#include "import/scene.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

static bool fits(const importer *k, const import_bump *b, int part)
{
    return fnmatch(b->object, k->object[part], 0) == 0 || fnmatch(b->object, k->parts.part[part].name, 0) == 0;
}

/* No object fits: say which there are, as many as there is room for. */
static bool refuse(const importer *k, const import_bump *b, char why[MESH_WHY])
{
    size_t n =
        (size_t)snprintf(why, MESH_WHY, "--bump: no object '%.60s', expected one of the %d: ", b->object, k->parts.n);
    for (int i = 0; i < k->parts.n; i++) {
        if (n + strlen(k->object[i]) + 8 >= MESH_WHY) {
            snprintf(why + n, MESH_WHY - n, "...");
            break;
        }
        n += (size_t)snprintf(why + n, MESH_WHY - n, "%s%s", i ? ", " : "", k->object[i]);
    }
    return false;
}

bool scene_find_bumps(importer *k, char why[MESH_WHY])
{
    for (int i = 0; i < k->parts.n; i++) {
        k->bump[i] = -1;
        for (int b = 0; b < k->wish->bumps; b++)
            if (fits(k, &k->wish->bump[b], i)) {
                k->bump[i] = b; /* the last one that fits */
                k->wish->bump[b].used = true;
            }
        if (k->bump[i] >= 0 && !k->s->mMeshes[k->parts.part[i].mesh]->mTextureCoords[0]) {
            snprintf(why, MESH_WHY,
                     "--bump: object %s has no texture coordinates, expected some, as a map must lie on it; unwrap it",
                     k->object[i]);
            return false;
        }
    }
    for (int b = 0; b < k->wish->bumps; b++)
        if (!k->wish->bump[b].used)
            return refuse(k, &k->wish->bump[b], why);
    return true;
}

/* A key and its value, n bytes long; a pair is written AxB. */
static void add_key(importer *k, const char *key, int name, const char *value, int n)
{
    const char *x = memchr(value, 'x', (size_t)n);
    text_add(&k->out, "      %.*s: ", name, key);
    if (x && x > value && x[-1] >= '0' && x[-1] <= '9')
        text_add(&k->out, "[%.*s, %.*s]\n", (int)(x - value), value, n - (int)(x - value) - 1, x + 1);
    else
        text_add(&k->out, "%.*s\n", n, value);
}

static bool is_key(const char *key, int name, const char *word)
{
    return strlen(word) == (size_t)name && strncmp(key, word, (size_t)name) == 0;
}

/* Scale and the like as they were given: the reader of scenes checks them. `zero` and `sign` have Blender's defaults.
 */
void scene_write_bump(importer *k, const import_bump *b)
{
    bool zero = false, sign = false;
    text_add(&k->out, "    bump:\n      map: {file: ");
    text_string(&k->out, b->map);
    const char *channel = b->rest;
    while (channel && strncmp(channel, "channel=", 8) != 0)
        channel = (channel = strchr(channel, ',')) ? channel + 1 : NULL;
    if (channel)
        text_add(&k->out, ", channel: %.*s", (int)strcspn(channel + 8, ","), channel + 8);
    text_add(&k->out, "}\n");
    for (const char *at = b->rest; *at;) {
        const int n = (int)strcspn(at, ","), name = (int)strcspn(at, "=,");
        zero |= is_key(at, name, "zero");
        sign |= is_key(at, name, "sign");
        if (!is_key(at, name, "channel"))
            add_key(k, at, name, at + name + (name < n), n - name - (name < n));
        at += n + (at[n] == ',');
    }
    if (!zero)
        text_add(&k->out, "      zero: 0.5\n");
    if (!sign)
        text_add(&k->out, "      sign: up\n");
}
