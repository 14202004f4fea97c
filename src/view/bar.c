/* The two lines below the picture: how it is made, and what is under the mouse. */
#include "view/window.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

const char *bar_method(const char *method, char text[2 * VIEW_METHOD])
{
    if (strcmp(method, "none") == 0)
        snprintf(text, 2 * VIEW_METHOD, "bump only");
    else
        snprintf(text, 2 * VIEW_METHOD, "%s%s", isdigit((unsigned char)*method) ? "order " : "", method);
    return text;
}

/* On the left: the method and what else changes the picture. */
static void make_left(char *text, size_t size, const frame *f)
{
    char method[2 * VIEW_METHOD];
    bar_method(f->shadow, method);
    if (f->displaced)
        snprintf(text, size, "true displacement");
    else
        snprintf(text, size, "shadows %s \xc2\xb7 shade %s \xc2\xb7 own %s", method, f->shifted ? "shifted" : "smooth",
                 strcmp(f->own, "none") == 0 ? "off" : f->own);
}

/* On the right: how far the picture is, its time, the frames a second, the key for help. */
static void make_right(char *text, size_t size, const shown *x)
{
    const frame *f = &x->picture;
    *text = 0;
    if (x->news.busy && x->news.share > 0 && !f->last && f->seconds > 0.1)
        snprintf(text, size, "%.0f %%  ", 100 * x->news.share);
    if (x->rate > 0 && x->timed)
        snprintf(text + strlen(text), size - strlen(text), "%.0f fps  ", x->rate);
    snprintf(text + strlen(text), size - strlen(text), "%s",
             f->stage > STAGE_FULL    ? "coarse"
             : f->stage == STAGE_FINE ? "fine"
                                      : "full");
    if (x->timed)
        snprintf(text + strlen(text), size - strlen(text), " %.1f ms", 1e3 * f->seconds);
    snprintf(text + strlen(text), size - strlen(text), "  h: help");
}

/* The second line: a message, the light that moves, or the values under the mouse. */
static void make_second(char *text, size_t size, const shown *x, const view_state *v, const kage_scene_info *s)
{
    *text = 0;
    if (*x->message)
        snprintf(text, size, "%s", x->message);
    else if (v->named && s->light_count) {
        double at[3];
        const int light = v->chosen % s->light_count;
        view_light(v, s, light, at);
        snprintf(text, size, "light %s at [%.4g, %.4g, %.4g]", s->lights[light].name, at[0], at[1], at[2]);
    } else if (v->readout != READOUT_NONE && v->over)
        snprintf(text, size, "%s", x->news.under.line);
}

void bar_draw(canvas *c, int y, int width, int height, const shown *x, const view_state *v, const kage_scene_info *s)
{
    const SDL_Color white = {235, 238, 242, 255}, pale = {170, 180, 195, 255};
    const int margin = font_advance(c->font), line = font_line(c->font);
    char text[SAVE_TEXT];
    SDL_FillRect(c->s, &(SDL_Rect){0, y, width, height}, SDL_MapRGB(c->s->format, 28, 32, 40));
    make_right(text, sizeof text, x);
    const int right = width - margin - font_letters(text) * margin;
    font_draw(c->font, c->s, right, y + 4, width, pale, text);
    make_left(text, sizeof text, &x->picture);
    font_draw(c->font, c->s, margin, y + 4, right - margin, white, text);
    make_second(text, sizeof text, x, v, s);
    font_draw(c->font, c->s, margin, y + 4 + line, width - margin, *x->message ? white : pale, text);
}
