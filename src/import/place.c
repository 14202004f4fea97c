/* What the files share that write a scene: places in its coordinates, and notes. */
#include "import/scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* From the model's coordinates, right-handed with y or z up, to the scene's. */
static void turn(const importer *k, const double v[3], double to[3])
{
    to[0] = v[0];
    to[1] = k->wish->z_up ? v[2] : v[1];
    to[2] = k->wish->z_up ? v[1] : -v[2];
}

void scene_place(const importer *k, const struct aiMatrix4x4 *m, const struct aiVector3D *v, double one, double to[3])
{
    const float *r = &m->a1;
    double x[3];
    for (int a = 0; a < 3; a++)
        x[a] = (double)r[4 * a] * (double)v->x + (double)r[4 * a + 1] * (double)v->y +
               (double)r[4 * a + 2] * (double)v->z + (double)r[4 * a + 3] * one;
    turn(k, x, to);
}

double scene_middle(const importer *k, double middle[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        middle[a] = (k->lo[a] + k->hi[a]) / 2;
        sum += (k->hi[a] - k->lo[a]) * (k->hi[a] - k->lo[a]);
    }
    return sqrt(sum);
}

void scene_tell(importer *k, int indent, const char *fmt, ...)
{
    char line[MESH_WHY];
    va_list args;
    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    for (char *c = line; *c; c++)
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    k->to->note(k->to->user, line);
    text_add(&k->out, "%*s# %s\n", indent, "", line);
}
