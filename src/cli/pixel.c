/* kage pixel: prints every value that is computed for one pixel, by each method. */
#include "cli/command.h"

#include <stdio.h>
#include <string.h>

static void print_scalar(const char *name, double x) { printf("%-10s %.9g\n", name, x); }

static void print_vector(const char *name, const double v[3])
{
    printf("%-10s %.9g %.9g %.9g\n", name, v[0], v[1], v[2]);
}

static void print_bump(const kage_probe *p)
{
    print_scalar("P", p->P);
    print_scalar("Pu", p->Pu);
    print_scalar("Pw", p->Pw);
    print_scalar("Puu", p->Puu);
    print_scalar("Puw", p->Puw);
    print_scalar("Pww", p->Pww);
    print_scalar("Pmin", p->Pmin);
    print_scalar("Pmax", p->Pmax);
    print_vector("n'", p->n_bump);
    if (!p->regular) {
        printf("|n| is 0 against |Qu| and |Qw|: the smooth normal and order none are used\n");
        return;
    }
    print_scalar("s.n/|n|", p->sn);
    print_scalar("a", p->a);
    print_scalar("b", p->b);
    printf("%-10s %.9g to %.9g in tau\n", "slab", p->slab[0], p->slab[1]);
}

static void print_surface(const kage_probe *p)
{
    print_scalar("t_hit", p->t);
    print_scalar("u", p->u);
    print_scalar("w", p->w);
    print_vector("Q", p->Q);
    print_vector("Qu", p->Qu);
    print_vector("Qw", p->Qw);
    print_vector("Quu", p->Quu);
    print_vector("Quw", p->Quw);
    print_vector("Qww", p->Qww);
    print_vector("n", p->n);
}

static void print_method(const kage_probe_row *x)
{
    char label[32];
    snprintf(label, sizeof label, "%s%s", x->method, x->guard ? "" : " bare");
    printf("%-10s", label);
}

static void print_start(const kage_probe_row *x)
{
    print_method(x);
    printf(" %12.6g %11.6g %12.6g %12.6g %12.6g", x->tau, x->t0, x->origin[0], x->origin[1], x->origin[2]);
    printf(x->fell_back ? "  %s\n" : "\n", x->fell_back);
}

static void print_light(const kage_probe_row *x, int lights)
{
    print_method(x);
    for (int l = 0; l < lights; l++)
        if (x->visible[l] > 0 && x->visible[l] < 1) /* an area light, partly visible */
            printf(" %-9.4g", x->visible[l]);
        else
            printf(" %-9s", x->visible[l] > 0 ? "lit" : "shadow");
    printf("  %.4f %.4f %.4f\n", x->color[0], x->color[1], x->color[2]);
}

/* Where shadow rays start, and what comes of it: two tables, as a terminal has 80 columns. */
static void print_tables(const kage_scene_info *s, const kage_probe *p)
{
    printf("\n%-10s %12s %11s %12s %12s %12s  fell\n", "method", "tau", "t0", "r + s t0: x", "y", "z");
    for (int k = 0; k < p->row_count; k++)
        print_start(&p->rows[k]);
    printf("\n%-10s", "method");
    for (int l = 0; l < s->light_count; l++)
        printf(" %-9.9s", s->lights[l].name);
    printf("  red    green  blue\n");
    for (int k = 0; k < p->row_count; k++)
        print_light(&p->rows[k], s->light_count);
}

static void print_probe(const kage_scene_info *s, int x, int y, const kage_probe *p)
{
    printf("pixel      %d,%d\n", x, y);
    print_vector("r", p->r);
    print_vector("s", p->s);
    if (p->object < 0) {
        printf("meets nothing\n");
        return;
    }
    const kage_object_info *o = &s->objects[p->object];
    printf("object     %s: %s, %s%s\n", o->name, o->shape, o->bump ? "bump by " : "no bump", o->bump ? o->bump : "");
    print_surface(p);
    if (p->undefined)
        printf("no value   of P, n' or the surface: it is smooth here, and no method shifts\n");
    if (p->bumped)
        print_bump(p);
    print_tables(s, p);
    if (p->sends)
        printf("without mirrored and refracted light; such rays start at r + s t0, too\n");
}

static bool read_pixel(const char *text, const kage_scene_info *s, int *x, int *y)
{
    char end;
    if (sscanf(text, "%5d,%5d%c", x, y, &end) != 2 || text[0] == '+' || strpbrk(text, " +-"))
        return usage_error("%s: expected a pixel X,Y, from the top left", text);
    if (*x >= s->width || *y >= s->height)
        return usage_error("%s: the picture is %d x %d pixels, expected 0,0 to %d,%d", text, s->width, s->height,
                           s->width - 1, s->height - 1);
    return true;
}

int command_pixel(const arguments *a)
{
    kage_scene *s = load_scene(a);
    int x = 0, y = 0, status = EXIT_INPUT;
    if (s && read_pixel(a->operand[1], kage_scene_get_info(s), &x, &y)) {
        kage_probe *p;
        kage_errors *e;
        status = kage_scene_probe(s, x, y, &p, &e) == KAGE_OK ? 0 : print_errors(e, EXIT_OUTPUT);
        if (p)
            print_probe(kage_scene_get_info(s), x, y, p);
        kage_probe_free(p);
    }
    kage_scene_free(s);
    return status;
}
