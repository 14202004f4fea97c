/* The samples of a tile, from rays to the film's planes. */
#include "film/tile.h"

#include "film/stream.h"
#include "render/trace.h"

/* -1..1 over the picture, of n pixels in a row or column from `first` on, each at `offset` of it. */
STAGE static void screen(int n, int first, double offset, int size, real *restrict to)
{
    for (int k = 0; k < n; k++)
        to[k] = camera_screen(first + k + offset, size);
}

static inline void spread_rows(int width, int height, const real *restrict column, const real *restrict row,
                               real *restrict x, real *restrict y)
{
    for (int k = 0; k < height; k++)
        for (int c = 0; c < width; c++) {
            x[k * width + c] = column[c];
            y[k * width + c] = -row[k];
        }
}

/* Most tiles have the constant width, whose rows are a few vectors. */
STAGE static void spread(int width, int height, const real *column, const real *row, real *x, real *y)
{
    if (width == TILE)
        spread_rows(TILE, height, column, row, x, y);
    else
        spread_rows(width, height, column, row, x, y);
}

static void tile_rays(const scene *s, const tile *b, int aa, int i, int j, workspace *v)
{
    real x[LANES], y[LANES], column[TILE], row[TILE_ROWS];
    screen(b->width, b->x0, (i + 0.5) / aa, s->width, column);
    screen(b->height, b->y0, (j + 0.5) / aa, s->height, row);
    spread(b->width, b->height, column, row, x, y);
    camera_rays(&s->camera, b->width * b->height, x, y, &v->x);
}

/* Store the values of a tile's lanes in a plane, or add them. */
static inline void lay_rows(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                            float weight, bool add)
{
    for (int k = 0; k < height; k++)
#pragma omp simd
        for (int c = 0; c < width; c++) {
            float x = (float)v[k * width + c] * weight, *p = &to[(size_t)k * stride + (size_t)c];
            *p = add ? *p + x : x;
        }
}

STAGE static void lay_first(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                            float weight)
{
    if (width == TILE)
        lay_rows(to, stride, TILE, height, v, weight, false);
    else
        lay_rows(to, stride, width, height, v, weight, false);
}

STAGE static void lay_more(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                           float weight)
{
    lay_rows(to, stride, width, height, v, weight, true);
}

static void lay(film *f, int plane, const tile *b, const real *v, float weight, bool add)
{
    float *to = f->plane[plane] + film_index(f, b->x0, b->y0);
    const size_t stride = film_width(f);
    if (weight == 1 && !add && b->width == STREAM_ROW && stream_fits(to, stride))
        stream_rows(to, stride, b->height, v); /* nothing is added later */
    else
        (add ? lay_more : lay_first)(to, stride, b->width, b->height, v, weight);
}

static void lay_layers(film *f, const tile *b, const workspace *v)
{
    const samples *o = &v->out;
    const real *const plane[] = {o->depth,    o->position.x, o->position.y, o->position.z, o->normal.x, o->normal.y,
                                 o->normal.z, o->u,          o->w,          o->height,     o->tau};
    for (int k = FILM_Z; k < FILM_ORDER; k++)
        lay(f, k, b, plane[k - FILM_Z], 1, false);
    real order[LANES];
    for (int i = 0; i < b->width * b->height; i++)
        order[i] = (real)o->order[i];
    lay(f, FILM_ORDER, b, order, 1, false);
}

void tile_render(const tracer *tr, int aa, const tile *b, film *f, workspace *v)
{
    const float weight = 1.0f / (float)(aa * aa);
    for (int j = 0; j < aa; j++)
        for (int i = 0; i < aa; i++) {
            const bool add = i + j > 0;
            if (add && !pulse_beats(v->pulse))
                return;
            tile_rays(tr->scene, b, aa, i, j, v);
            stats_stage(v->stats, STAGE_CAMERA);
            trace(tr, b->width * b->height, v);
            lay(f, FILM_R, b, v->out.rgb.x, weight, add);
            lay(f, FILM_G, b, v->out.rgb.y, weight, add);
            lay(f, FILM_B, b, v->out.rgb.z, weight, add);
            if (tr->layers) {
                for (int l = 0; l < tr->scene->lights; l++)
                    lay(f, FILM_LIGHTS + l, b, v->visibility[l], weight, add);
                if (i == aa / 2 && j == aa / 2)
                    lay_layers(f, b, v);
            }
            stats_stage(v->stats, STAGE_FILM);
        }
}

/* The marked pixels of a tile. */
typedef struct selection {
    int count, x[LANES], y[LANES];
    size_t place[LANES]; /* film_index */
} selection;

static void select_marked(const tile *b, const film *f, const unsigned char *marked, selection *p)
{
    p->count = 0;
    for (int y = b->y0; y < b->y0 + b->height; y++)
        for (int x = b->x0; x < b->x0 + b->width; x++) {
            const size_t at = film_index(f, x, y);
            p->x[p->count] = x;
            p->y[p->count] = y;
            p->place[p->count] = at;
            p->count += marked[at];
        }
}

/* Add a wave's n samples to the pixels; pixel k has samples k * each and so on, the wave begins with sample `first`. */
static void add_samples(film *f, const selection *p, int each, int first, int n, int plane, const real *v)
{
    const float weight = 1.0f / (float)each;
    for (int i = 0; i < n; i++) {
        float *to = &f->plane[plane][p->place[(first + i) / each]], x = (float)v[i] * weight;
        *to = (first + i) % each > 0 ? *to + x : x;
    }
}

void tile_refine(const tracer *tr, int aa, const tile *b, const unsigned char *marked, film *f, workspace *v)
{
    const scene *s = tr->scene;
    const int each = aa * aa;
    selection p;
    select_marked(b, f, marked, &p);
    for (int first = 0; first < p.count * each && (first == 0 || pulse_beats(v->pulse)); first += LANES) {
        const int n = p.count * each - first < LANES ? p.count * each - first : LANES;
        real x[LANES], y[LANES];
        for (int i = 0; i < n; i++) {
            const int pixel = (first + i) / each, sample = (first + i) % each;
            x[i] = camera_screen(p.x[pixel] + (sample % aa + 0.5) / aa, s->width);
            y[i] = -camera_screen(p.y[pixel] + (sample / aa + 0.5) / aa, s->height);
        }
        camera_rays(&s->camera, n, x, y, &v->x);
        stats_stage(v->stats, STAGE_CAMERA);
        trace(tr, n, v);
        add_samples(f, &p, each, first, n, FILM_R, v->out.rgb.x);
        add_samples(f, &p, each, first, n, FILM_G, v->out.rgb.y);
        add_samples(f, &p, each, first, n, FILM_B, v->out.rgb.z);
        for (int l = 0; tr->layers && l < s->lights; l++)
            add_samples(f, &p, each, first, n, FILM_LIGHTS + l, v->visibility[l]);
        stats_stage(v->stats, STAGE_FILM);
    }
}
