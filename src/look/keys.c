/* The table of keys. */
#include "look/keys.h"

#include <stddef.h>

#include "look/state.h"

const view_key view_keys[] = {
    {0, ACT_NONE, NULL, 0, 0, "drag", "turn the eye about the point it looks at"},
    {0, ACT_NONE, NULL, 0, 0, "right drag", "move the eye sideways"},
    {0, ACT_NONE, NULL, 0, 0, "ctrl wheel", "nearer, farther"},
    {0, ACT_NONE, NULL, 0, 0, "shift drag", "move the light; shift wheel: nearer, farther"},
    {0, ACT_NONE, NULL, 0, 0, "wheel", "height of the bump under the mouse, or of all"},
    {'n', ACT_SHADOW, "none", 0, 0, "n", "shadows by none: bump mapping only"},
    {'0', ACT_SHADOW, "0", 0, 0, "0 1 2", "by the paper's order 0, 1 or 2"},
    {'1', ACT_SHADOW, "1", 0, 0, NULL, NULL},
    {'2', ACT_SHADOW, "2", 0, 0, NULL, NULL},
    {'m', ACT_SHADOW, "march:8", 0, 0, "m a e", "by march:8, auto or exact"},
    {'a', ACT_SHADOW, "auto", 0, 0, NULL, NULL},
    {'e', ACT_SHADOW, "exact", 0, 0, NULL, NULL},
    {'s', ACT_SHADE, NULL, 0, 0, "s", "shade at the smooth hit, or where the shadow rays start"},
    {'b', ACT_OWN, NULL, 0, 0, "b", "the bumps' own shadows on or off"},
    {'d', ACT_SURFACE, NULL, 0, 0, "d", "true displacement on or off, for comparison (slow)"},
    {'c', ACT_COMPARE, NULL, 0, 0, "c held", "bump mapping only, as long as it is held"},
    {' ', ACT_SPLIT, NULL, 0, 0, "space", "a split line at the mouse; left of it bump mapping only"},
    {0, ACT_NONE, NULL, 0, 0, "shift n..e", "another method than bump only for c and the split line"},
    {'l', ACT_LAYER, NULL, 0, 0, "l", "layers: picture, tau, order, height"},
    {'i', ACT_READOUT, NULL, 0, 0, "i", "values under the mouse: a line, all methods, nothing"},
    {KEY_LEFT, ACT_TURN, NULL, -1, 0, "arrows", "turn the eye; with shift the light"},
    {KEY_RIGHT, ACT_TURN, NULL, 1, 0, NULL, NULL},
    {KEY_UP, ACT_TURN, NULL, 0, -1, NULL, NULL},
    {KEY_DOWN, ACT_TURN, NULL, 0, 1, NULL, NULL},
    {'=', ACT_NEARER, NULL, 1, 0, "+ -", "nearer, farther"},
    {'+', ACT_NEARER, NULL, 1, 0, NULL, NULL},
    {'-', ACT_NEARER, NULL, -1, 0, NULL, NULL},
    {'[', ACT_HEIGHT, NULL, -1, 0, "[ ]", "height, as the wheel"},
    {']', ACT_HEIGHT, NULL, 1, 0, NULL, NULL},
    {KEY_TAB, ACT_LIGHT, NULL, 0, 0, "Tab", "the next light"},
    {'r', ACT_RESET, NULL, 0, 0, "r", "back to the scene as its file says"},
    {'p', ACT_SAVE, NULL, 0, 0, "p", "save the picture, and the changed scene beside the scene"},
    {KEY_RELOAD, ACT_RELOAD, NULL, 0, 0, "F5", "read the scene again, with its maps and models"},
    {'h', ACT_HELP, NULL, 0, 0, "h F1", "this list"},
    {'/', ACT_HELP, NULL, 0, 0, NULL, NULL},
    {KEY_HELP, ACT_HELP, NULL, 0, 0, NULL, NULL},
    {'q', ACT_QUIT, NULL, 0, 0, "q Esc", "quit"},
    {KEY_ESCAPE, ACT_CLOSE, NULL, 0, 0, NULL, NULL},
};

const int view_key_count = (int)(sizeof view_keys / sizeof *view_keys);

const view_key *view_key_find(int key)
{
    for (int k = 0; k < view_key_count; k++)
        if (key && view_keys[k].key == key)
            return &view_keys[k];
    return NULL;
}
