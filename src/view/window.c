/* The window, and the picture in it. */
#include "view/window.h"

#include <string.h>

static bool make_canvas(window *w, int width, int height)
{
    if (w->to.s && w->to.s->w == width && w->to.s->h == height)
        return true;
    SDL_FreeSurface(w->to.s);
    w->to.s = SDL_CreateRGBSurfaceWithFormat(0, width, height, 32, SDL_PIXELFORMAT_RGBA32);
    if (w->to.s)
        SDL_SetSurfaceBlendMode(w->to.s, SDL_BLENDMODE_NONE);
    return w->to.s != NULL;
}

/* The picture's size such that the window fits the screen, in the same proportions. */
static void fit_screen(int bar, int *width, int *height)
{
    SDL_Rect screen;
    if (SDL_GetDisplayUsableBounds(0, &screen) != 0)
        return;
    const double x = (double)screen.w / *width, y = (double)(screen.h - bar) / *height, scale = x < y ? x : y;
    if (scale < 1) {
        *width = SDL_max(1, (int)(*width * scale));
        *height = SDL_max(1, (int)(*height * scale));
    }
}

/* SDL takes a driver that shows nothing where it finds no screen. That is for those who ask for it. */
static bool has_screen(void)
{
    const char *const driver = SDL_GetCurrentVideoDriver(), *const blind[] = {"offscreen", "dummy", "evdev"};
    if (SDL_GetHint(SDL_HINT_VIDEODRIVER) || !driver)
        return driver;
    for (size_t k = 0; k < SDL_arraysize(blind); k++)
        if (strcmp(driver, blind[k]) == 0) {
            SDL_SetError("no screen was found: DISPLAY or WAYLAND_DISPLAY must name one");
            return false;
        }
    return true;
}

bool window_open(window *w, const char *title, int *width, int *height)
{
    const int letters = 14, least[] = {320, 200};
    *w = (window){0};
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0"); /* the pixels are made here; a copy is all that is needed */
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
    SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
    if (SDL_Init(SDL_INIT_VIDEO) != 0 || !has_screen() || !(w->to.font = font_open(letters)))
        return false;
    w->bar = 2 * font_line(w->to.font) + 8;
    fit_screen(w->bar, width, height);
    *width = SDL_max(*width, least[0]);
    *height = SDL_max(*height, least[1]);
    w->sdl = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, *width, *height + w->bar,
                              SDL_WINDOW_RESIZABLE);
    if (!w->sdl)
        return false;
    SDL_SetWindowMinimumSize(w->sdl, least[0], least[1] + w->bar);
    window_size(w, width, height);
    return make_canvas(w, *width, *height + w->bar);
}

void window_close(window *w)
{
    SDL_FreeSurface(w->to.s);
    font_close(w->to.font);
    if (w->sdl)
        SDL_DestroyWindow(w->sdl);
    SDL_Quit();
}

void window_size(const window *w, int *width, int *height)
{
    SDL_GetWindowSize(w->sdl, width, height);
    *height = SDL_max(1, *height - w->bar);
}

/* ---- the picture ---- */

/* Columns x0 to x1 of the window from one side of the picture. */
static void draw_side(SDL_Surface *to, const frame *f, int side, int x0, int x1, int height)
{
    if (!f->rgba[side] || x0 >= x1)
        return;
    if (f->columns == to->w && f->rows == height) {
        for (int y = 0; y < height; y++)
            memcpy((Uint8 *)to->pixels + (size_t)y * (size_t)to->pitch + 4 * (size_t)x0,
                   f->rgba[side] + 4 * ((size_t)y * (size_t)f->columns + (size_t)x0), 4 * (size_t)(x1 - x0));
        return;
    }
    SDL_Surface *from = SDL_CreateRGBSurfaceWithFormatFrom(f->rgba[side], f->columns, f->rows, 32, 4 * f->columns,
                                                           SDL_PIXELFORMAT_RGBA32);
    if (!from)
        return;
    const double scale = (double)f->columns / to->w;
    const int left = (int)(x0 * scale + 0.5), right = SDL_max(left + 1, (int)(x1 * scale + 0.5));
    const SDL_Rect part = {left, 0, SDL_min(right, f->columns) - left, f->rows}, place = {x0, 0, x1 - x0, height};
    if (part.w > 0)
        SDL_SoftStretchLinear(from, &part, to, &place);
    SDL_FreeSurface(from);
}

/* The column of the split line; 0: there is none. */
static int draw_picture(SDL_Surface *to, const frame *f, const view_state *v, int height)
{
    if (f->sides < 2) {
        draw_side(to, f, 0, 0, to->w, height);
        return 0;
    }
    const int wish = f->whole ? v->x : f->width ? f->split * to->w / f->width : 0;
    const int line = SDL_min(SDL_max(wish, 0), to->w);
    draw_side(to, f, 1, 0, line, height);
    draw_side(to, f, 0, line, to->w, height);
    return line;
}

void window_draw(window *w, const shown *x, const view_state *v, const kage_scene_info *s)
{
    char left[2 * VIEW_METHOD], right[2 * VIEW_METHOD];
    int width, height;
    const frame *f = &x->picture;
    window_size(w, &width, &height);
    SDL_Surface *screen = SDL_GetWindowSurface(w->sdl);
    if (!screen || !make_canvas(w, width, height + w->bar))
        return;
    canvas *c = &w->to;
    const int line = draw_picture(c->s, f, v, height);
    if (f->sides == 2)
        panel_split(c, width, height, line, bar_method(f->beside, left), bar_method(f->shadow, right));
    if (f->legend.layer != LAYER_PICTURE)
        panel_legend(c, width, height, &f->legend);
    if (v->readout == READOUT_TABLE && v->over)
        panel_table(c, width, height, &x->news.under);
    if (x->news.errors)
        panel_errors(c, width, height, x->news.errors, x->news.of_file);
    if (v->help)
        panel_help(c, width, height);
    bar_draw(c, height, width, w->bar, x, v, s);
    SDL_BlitSurface(c->s, NULL, screen, NULL);
    SDL_UpdateWindowSurface(w->sdl);
}
