/* Displaced objects with a map, or with a function that POV-Ray cannot evaluate, as meshes.
 *
 * The tessellation's lattice has the map's samples, between which the map is bilinear. Cells are divided until facets
 * cover less than half a pixel. Of an unbounded plane only what the camera sees, and what casts shadows there, is made,
 * and far cells are joined. If there are too many triangles, coarser settings are tried in order: the rungs.
 */
#include "pov_text/flat.h"
#include "povray/parts.h"
#include "tessellate/tessellation.h"

#include <stdlib.h>

enum { FIRST_MET = 7, FIRST_STEEP = 14, FIRST_WIDE = 22, FIRST_JOINED = 28, RUNGS = 60 }; /* see rung() */

#define SHAPE 0.005 /* allowed error of heights, in sides of a cell */
#define TILT 0.003  /* allowed error of a facet's unit normals: less than a step of 1/255 */
#define COARSER 1.4

static void all_parts(tessellation *x)
{
    x->before = 0;
    x->full = false;
    for (int part = 0; part < x->o->shape->ops->parts && !x->full; part++) {
        if (pov_rim(&x->o->shape_spec, part) == 0)
            continue;
        tessellate(x, part);
        x->before += x->faces;
    }
}

/* The settings of rung k. Up to FIRST_MET normals get less exact. Then, if rays go through pixel centres only, cells
 * that no ray meets keep only the shape that casts shadows, and less of it with each rung. From FIRST_STEEP on the mesh
 * is coarse: normals, then facets, then cells. The last rung is one quad for a part. */
static fineness rung(const tessellation *x, int k)
{
    fineness f = {.tolerance = FINE, .tilt = TILT, .shape = SHAPE};
    if (k < FIRST_MET) {
        f.tilt *= pow(COARSER, k);
        return f;
    }
    f.met = x->points;
    f.shape *= ldexp(1, k - FIRST_MET);
    if (k >= FIRST_STEEP)
        f.tilt *= ldexp(1, (k < FIRST_WIDE ? k : FIRST_WIDE) - FIRST_STEEP + 1);
    if (k >= FIRST_WIDE)
        f.tolerance *= ldexp(1, k - FIRST_WIDE + 1);
    if (k >= FIRST_JOINED)
        f.level = k - FIRST_JOINED + 1;
    return f;
}

static bool fits(tessellation *x, int k)
{
    x->fine = rung(x, k);
    x->counting = true;
    all_parts(x);
    x->counting = false;
    return !x->full;
}

/* The finest rung that fits, by bisection in at most 8 rounds. Counting ends at MOST_TRIANGLES. */
static int fit(tessellation *x)
{
    if (fits(x, 0))
        return 0;
    const bool loose = fits(x, FIRST_MET - 1);
    int full = loose ? 0 : FIRST_MET - 1, good = loose ? FIRST_MET - 1 : RUNGS - 1;
    while (good - full > 1) {
        const int middle = (full + good) / 2;
        if (fits(x, middle))
            good = middle;
        else
            full = middle;
    }
    x->full = false;
    x->fine = rung(x, good);
    if (good >= FIRST_MET) {
        x->measuring = true;
        all_parts(x);
        x->measuring = false;
    }
    return good;
}

static void put_note(pov_text *t, const tessellation *x, int k)
{
    if (x->unbounded)
        pov_print(t, "// The plane has no end; here it is cut to what the camera sees and what can shade that.\n");
    pov_print(t, "// a mesh made for %d x %d pixels", x->s->width, x->s->height);
    if (k >= FIRST_MET && x->fine.met)
        pov_print(t, ", fine where the rays through their middles meet it");
    if (k >= FIRST_STEEP)
        pov_print(t, "; COARSE: finer ones are above %d triangles", MOST_TRIANGLES);
    pov_print(t, "\n");
    if (k >= FIRST_MET)
        pov_print(t, "// its heights are off by up to %s, which is %s pixels\n", pov_number(x->height, 3).text,
                  pov_number(x->pixels, 3).text);
    if (k >= FIRST_JOINED)
        pov_print(t, "// %g x %g samples of its map are one cell\n", ldexp(1, x->fine.level), ldexp(1, x->fine.level));
    else if (k >= FIRST_STEEP)
        pov_print(t, "// its normals are off by up to %s, its facets up to %s pixels wide\n",
                  pov_number(fmin(x->fine.tilt, 1), 2).text, pov_number(x->fine.tolerance, 2).text);
}

bool pov_mesh(pov_text *t, const scene *s, const pov_options *how, const object *o, pov_report *report)
{
    const int parts = o->shape->ops->parts;
    tessellation x = {.s = s,
                      .o = o,
                      .progress = how->progress,
                      .share = how->share,
                      .memory = true,
                      .unbounded = o->shape_spec.form == &form_plane};
    x.v.f = o->shape;
    x.v.P = o->bump;
    x.v.memory = progress_memory(how->progress);
    x.points = o->map.file && !s->sends && s->aa == 1;
    const int k = fit(&x);
    put_note(t, &x, k);
    if (k >= FIRST_STEEP && (!report->coarse || x.pixels > report->pixels))
        *report = (pov_report){o->name, x.height, x.pixels};
    if (parts > 1)
        pov_print(t, "union {\n");
    for (int part = 0; part < parts && x.memory; part++) {
        const double rim = pov_rim(&o->shape_spec, part);
        if (rim == 0)
            continue;
        tessellate(&x, part);
        pov_mesh2(t, x.v.vertex, x.v.count, pov_by_uv(s, o), (int)x.faces, (const int32_t(*)[3])x.face);
        if (pov_by_parts(s, o))
            pov_texture(t, s, o, part);
        if (rim > 0)
            pov_clip_rim(t, o, part);
        if (parts > 1)
            pov_print(t, "}\n");
    }
    memory_free(x.face);
    pov_vertices_free(&x.v);
    return x.memory;
}
