/* Text in the system's monospaced font: each letter is drawn once and then copied. */
#include "view/font.h"

#include <SDL_ttf.h>
#include <fontconfig/fontconfig.h>
#include <stdbool.h>
#include <stdlib.h>

enum { LETTERS = 0x2600 }; /* those of Unicode that are kept; others are shown as '?' */

struct font {
    TTF_Font *ttf;
    int advance, line;
    SDL_Surface *letter[LETTERS]; /* NULL: not drawn yet */
};

/* Open the file of the best match for "monospace". */
static TTF_Font *open_monospace(int pixels)
{
    FcConfig *config = FcInitLoadConfigAndFonts();
    FcPattern *wish = config ? FcNameParse((const FcChar8 *)"monospace") : NULL;
    TTF_Font *ttf = NULL;
    SDL_SetError("no monospaced font, expected one that fontconfig knows, such as DejaVu Sans Mono");
    if (wish && FcConfigSubstitute(config, wish, FcMatchPattern)) {
        FcResult result;
        FcChar8 *file;
        int index = 0;
        FcDefaultSubstitute(wish);
        FcPattern *match = FcFontMatch(config, wish, &result);
        if (match && FcPatternGetString(match, FC_FILE, 0, &file) == FcResultMatch) {
            FcPatternGetInteger(match, FC_INDEX, 0, &index);
            ttf = TTF_OpenFontIndex((const char *)file, pixels, index);
        }
        if (match)
            FcPatternDestroy(match);
    }
    if (wish)
        FcPatternDestroy(wish);
    if (config)
        FcConfigDestroy(config);
    return ttf;
}

font *font_open(int pixels)
{
    font *f = calloc(1, sizeof *f);
    if (!f || TTF_Init() != 0) {
        free(f);
        return NULL;
    }
    f->ttf = open_monospace(pixels);
    if (!f->ttf) {
        font_close(f);
        return NULL;
    }
    TTF_SizeUTF8(f->ttf, "m", &f->advance, NULL);
    f->line = TTF_FontLineSkip(f->ttf);
    return f;
}

void font_close(font *f)
{
    if (!f)
        return;
    for (int k = 0; k < LETTERS; k++)
        SDL_FreeSurface(f->letter[k]);
    if (f->ttf)
        TTF_CloseFont(f->ttf);
    TTF_Quit();
    free(f);
}

int font_advance(const font *f) { return f->advance; }

int font_line(const font *f) { return f->line; }

/* The next letter of a text in UTF-8; 0 at its end. What is no UTF-8 is '?'. */
static Uint32 next_letter(const char **text)
{
    const unsigned char *s = (const unsigned char *)*text;
    const int more = *s < 0x80 ? 0 : *s >= 0xf0 ? 3 : *s >= 0xe0 ? 2 : *s >= 0xc0 ? 1 : -1;
    if (more < 0 || !*s) {
        *text += *s ? 1 : 0;
        return *s ? '?' : 0;
    }
    Uint32 letter = more ? (Uint32)(*s & (0x3f >> more)) : *s;
    int k = 1;
    for (; k <= more && (s[k] & 0xc0) == 0x80; k++)
        letter = letter << 6 | (s[k] & 0x3f);
    *text += k;
    return k > more && letter < LETTERS ? letter : '?';
}

int font_letters(const char *text)
{
    int n = 0;
    while (next_letter(&text))
        n++;
    return n;
}

/* White, with the letter's shape as alpha. NULL: it has none, or there is no memory. */
static SDL_Surface *surface_of(font *f, Uint32 letter)
{
    if (!f->letter[letter])
        f->letter[letter] = TTF_RenderGlyph32_Blended(f->ttf, letter, (SDL_Color){255, 255, 255, 255});
    return f->letter[letter];
}

int font_draw(font *f, SDL_Surface *to, int x, int y, int x1, SDL_Color color, const char *text)
{
    Uint32 letter;
    while ((letter = next_letter(&text)) != 0) {
        if (x + f->advance > x1)
            break;
        SDL_Surface *s = letter == ' ' ? NULL : surface_of(f, letter);
        SDL_Rect place = {x, y, 0, 0};
        if (s) {
            SDL_SetSurfaceColorMod(s, color.r, color.g, color.b);
            SDL_BlitSurface(s, NULL, to, &place);
        }
        x += f->advance;
    }
    return x;
}
