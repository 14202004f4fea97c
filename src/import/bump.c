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

/* Scale and the like as they were given: the reader of scenes checks them. `zero` and `sign` have Blender's defaults.
 */
void scene_write_bump(importer *k, const import_bump *b)
{
    bool zero = false, sign = false;
    text_add(&k->out, "    bump:\n      map: {file: ");
    text_string(&k->out, b->map);
    text_add(&k->out, "}\n");
    for (const char *at = b->rest; *at;) {
        const int n = (int)strcspn(at, ","), name = (int)strcspn(at, "=,");
        zero |= name == 4 && strncmp(at, "zero", 4) == 0;
        sign |= name == 4 && strncmp(at, "sign", 4) == 0;
        text_add(&k->out, "      %.*s: %.*s\n", name, at, n > name ? n - name - 1 : 0, at + name + 1);
        at += n + (at[n] == ',');
    }
    if (!zero)
        text_add(&k->out, "      zero: 0.5\n");
    if (!sign)
        text_add(&k->out, "      sign: up\n");
}
