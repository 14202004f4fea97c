/* What lies over the picture: help, errors, the table of values, the legend, the split line. */
#include "view/window.h"

#include <stdio.h>
#include <string.h>

#include "look/keys.h"

static const SDL_Color white = {255, 255, 255, 255}, pale = {190, 200, 215, 255}, warm = {255, 205, 120, 255};

/* A rectangle made dark, so that text is legible on it. */
static void dim(canvas *c, int x, int y, int width, int height)
{
    const int x0 = SDL_max(x, 0), y0 = SDL_max(y, 0);
    const int x1 = SDL_min(x + width, c->s->w), y1 = SDL_min(y + height, c->s->h);
    for (int row = y0; row < y1; row++) {
        Uint8 *to = (Uint8 *)c->s->pixels + (size_t)row * (size_t)c->s->pitch + 4 * (size_t)x0;
        for (int k = 0; k < x1 - x0; k++, to += 4)
            for (int i = 0; i < 3; i++)
                to[i] = (Uint8)(to[i] / 5);
    }
}

static void fill(canvas *c, int x, int y, int width, int height, SDL_Color color)
{
    const SDL_Rect place = {x, y, width, height};
    SDL_FillRect(c->s, &place, SDL_MapRGB(c->s->format, color.r, color.g, color.b));
}

void panel_help(canvas *c, int width, int height)
{
    const int line = font_line(c->font), advance = font_advance(c->font), names = 13, columns = 74;
    int lines = 0;
    for (int k = 0; k < view_key_count; k++)
        lines += view_keys[k].name != NULL;
    const int fit = SDL_max(1, (height - 8) / line - 1), rows = SDL_min(lines, fit);
    const int w = SDL_min(columns * advance, width), x = (width - w) / 2;
    const int y = SDL_max(4, (height - (rows + 1) * line) / 2);
    dim(c, x, y - 4, w, (rows + 1) * line + 8);
    for (int k = 0, row = 0; k < view_key_count && row < rows; k++) {
        if (!view_keys[k].name)
            continue;
        font_draw(c->font, c->s, x + advance, y + row * line, x + w, warm, view_keys[k].name);
        font_draw(c->font, c->s, x + names * advance, y + row * line, x + w, white, view_keys[k].help);
        row++;
    }
    font_draw(c->font, c->s, x + names * advance, y + rows * line, x + w, pale,
              rows < lines ? "h closes this; the rest: kage view --help" : "h closes this list");
}

/* The bytes of the text's first line, at most `letters` long: it ends at a space where there is one. */
static int line_bytes(const char *text, int letters)
{
    const int n = (int)strcspn(text, "\n");
    int space = 0, k = 0;
    for (int seen = 0; k < n; k++) {
        seen += ((unsigned char)text[k] & 0xc0) != 0x80;
        if (seen > letters)
            return space ? space : k;
        if (text[k] == ' ')
            space = k;
    }
    return n;
}

/* A message goes on in the next line where it is longer than the window; a line of the file, with its caret, is cut. */
void panel_errors(canvas *c, int width, int height, const char *errors, bool of_file)
{
    const int line = font_line(c->font), margin = font_advance(c->font), most = (height - 3 * line) / line;
    bool begins = true, quoted = false;
    dim(c, 0, 0, width, height);
    int y = line / 2;
    font_draw(c->font, c->s, margin, y, width, warm,
              of_file ? "The scene has errors; this is the last good picture."
                      : "This look of the scene has errors; r takes all changes back.");
    y += 2 * line;
    for (int k = 0; *errors && k < most; k++) {
        char text[256];
        quoted = begins ? *errors == ' ' : quoted;
        const int x = begins ? margin : 5 * margin;
        const int n = quoted ? (int)strcspn(errors, "\n") : line_bytes(errors, SDL_max(1, (width - x) / margin));
        snprintf(text, sizeof text, "%.*s", SDL_min(n, (int)sizeof text - 1), errors);
        font_draw(c->font, c->s, x, y, width, quoted ? pale : white, text);
        begins = errors[n] == '\n';
        errors += n + (errors[n] == '\n' || errors[n] == ' ');
        y += line;
    }
}

void panel_table(canvas *c, int width, int height, const readout *r)
{
    const int line = font_line(c->font), advance = font_advance(c->font);
    int columns = 0;
    for (int k = 0; k < r->lines; k++)
        columns = SDL_max(columns, font_letters(r->table[k]));
    if (!r->lines)
        return;
    const int w = SDL_min((columns + 2) * advance, width), h = r->lines * line + 8;
    /* On the side away from the mouse. */
    const int x = r->x > width / 2 ? 0 : width - w, y = SDL_max(0, height - h);
    dim(c, x, y, w, h);
    for (int k = 0; k < r->lines; k++)
        font_draw(c->font, c->s, x + advance, y + 4 + k * line, x + w, k ? white : warm, r->table[k]);
}

/* The orders, each with its colour. */
static void legend_of_orders(canvas *c, int x, int y, const legend *l)
{
    const int line = font_line(c->font), advance = font_advance(c->font);
    for (int k = -1; colours_order(k); k++) {
        uint8_t rgb[3];
        colours_of(l, k, rgb);
        fill(c, x, y + 2, 2 * advance, line - 4, (SDL_Color){rgb[0], rgb[1], rgb[2], 255});
        font_draw(c->font, c->s, x + 3 * advance, y, c->s->w, white, colours_order(k));
        y += line;
    }
}

/* A bar from the highest value down to the lowest. */
static void legend_of_values(canvas *c, int x, int y, int height, const legend *l)
{
    const int line = font_line(c->font), advance = font_advance(c->font);
    for (int k = 0; k < height; k++) {
        uint8_t rgb[3];
        colours_of(l, l->high + (l->low - l->high) * k / (height - 1), rgb);
        fill(c, x, y + k, 2 * advance, 1, (SDL_Color){rgb[0], rgb[1], rgb[2], 255});
    }
    for (int k = 0; k < 3; k++) {
        char text[32];
        const double value = l->high + (l->low - l->high) * k / 2;
        snprintf(text, sizeof text, "%.3g", value);
        font_draw(c->font, c->s, x + 3 * advance, y + (height - line) * k / 2, c->s->w, white, text);
    }
}

void panel_legend(canvas *c, int width, int height, const legend *l)
{
    const int line = font_line(c->font), advance = font_advance(c->font), w = 14 * advance;
    const int h = SDL_min(height, 10 * line + 8), x = width - w;
    dim(c, x, 0, w, h);
    font_draw(c->font, c->s, x + advance, 4, width, warm, colours_title(l->layer));
    if (l->layer == LAYER_ORDER)
        legend_of_orders(c, x + advance, 4 + 3 * line / 2, l);
    else
        legend_of_values(c, x + advance, 4 + 3 * line / 2, h - 2 * line - 8, l);
}

void panel_split(canvas *c, int width, int height, int line, const char *left, const char *right)
{
    const int advance = font_advance(c->font), high = font_line(c->font) + 4, y = 8;
    const int lw = (font_letters(left) + 2) * advance, rw = (font_letters(right) + 2) * advance;
    fill(c, line - 1, 0, 2, height, white);
    if (line - 1 - lw >= 0) {
        dim(c, line - 1 - lw, y, lw, high);
        font_draw(c->font, c->s, line - 1 - lw + advance, y + 2, width, white, left);
    }
    if (line + 1 + rw <= width) {
        dim(c, line + 1, y, rw, high);
        font_draw(c->font, c->s, line + 1 + advance, y + 2, width, white, right);
    }
}
