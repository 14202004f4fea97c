/* SDL's events as those of the view. */
#include "view/events.h"

/* Digits by their place where the layout has them under shift, as French keyboards do, and on the keypad. */
static int key_of(const SDL_Keysym *k)
{
    if (k->scancode >= SDL_SCANCODE_KP_1 && k->scancode <= SDL_SCANCODE_KP_9)
        return '1' + (int)(k->scancode - SDL_SCANCODE_KP_1);
    switch (k->scancode) {
    case SDL_SCANCODE_1:
        return '1';
    case SDL_SCANCODE_2:
        return '2';
    case SDL_SCANCODE_0:
    case SDL_SCANCODE_KP_0:
        return '0';
    case SDL_SCANCODE_KP_PLUS:
        return '+';
    case SDL_SCANCODE_KP_MINUS:
        return '-';
    default:
        break;
    }
    switch (k->sym) {
    case SDLK_LEFT:
        return KEY_LEFT;
    case SDLK_RIGHT:
        return KEY_RIGHT;
    case SDLK_UP:
        return KEY_UP;
    case SDLK_DOWN:
        return KEY_DOWN;
    case SDLK_F1:
        return KEY_HELP;
    case SDLK_F5:
        return KEY_RELOAD;
    default:
        return k->sym < 256 ? (int)k->sym : 0;
    }
}

/* Keys that act again while they are held. */
static bool repeats(int key) { return key >= KEY_LEFT ? key <= KEY_DOWN : key == '[' || key == ']' || key == '-'; }

static bool read_key(const SDL_KeyboardEvent *k, view_event *to)
{
    to->kind = k->type == SDL_KEYDOWN ? EVENT_KEY : EVENT_KEY_UP;
    to->key = key_of(&k->keysym);
    to->shift = (k->keysym.mod & KMOD_SHIFT) != 0;
    to->ctrl = (k->keysym.mod & KMOD_CTRL) != 0;
    return to->key && (!k->repeat || repeats(to->key)) && !(k->keysym.mod & (KMOD_CTRL | KMOD_ALT | KMOD_GUI));
}

static bool read_window(const SDL_WindowEvent *w, view_event *to)
{
    to->kind = w->event == SDL_WINDOWEVENT_LEAVE ? EVENT_LEAVE : EVENT_SIZE;
    to->x = w->data1;
    to->y = w->data2;
    return w->event == SDL_WINDOWEVENT_LEAVE || w->event == SDL_WINDOWEVENT_SIZE_CHANGED;
}

/* Follow shift and ctrl. An event of a key has the others that are held after it. */
static void follow(held_keys *held, const SDL_Event *e)
{
    if (e->type == SDL_KEYDOWN || e->type == SDL_KEYUP)
        held->mod = (SDL_Keymod)e->key.keysym.mod;
    else if (e->type == SDL_WINDOWEVENT &&
             (e->window.event == SDL_WINDOWEVENT_FOCUS_GAINED || e->window.event == SDL_WINDOWEVENT_FOCUS_LOST))
        held->mod = SDL_GetModState();
}

bool events_read(held_keys *held, const SDL_Event *from, view_event *to)
{
    follow(held, from);
    *to = (view_event){.shift = (held->mod & KMOD_SHIFT) != 0, .ctrl = (held->mod & KMOD_CTRL) != 0};
    switch (from->type) {
    case SDL_QUIT:
        *to = (view_event){.kind = EVENT_KEY, .key = 'q'};
        return true;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        to->kind = from->type == SDL_MOUSEBUTTONDOWN ? EVENT_PRESS : EVENT_RELEASE;
        to->button = from->button.button;
        to->x = from->button.x;
        to->y = from->button.y;
        return to->button <= 3;
    case SDL_MOUSEMOTION:
        to->kind = EVENT_MOVE;
        to->x = from->motion.x;
        to->y = from->motion.y;
        return true;
    case SDL_MOUSEWHEEL:
        to->kind = EVENT_WHEEL;
        to->notches = from->wheel.y + from->wheel.x; /* shift makes some systems scroll sideways */
        return to->notches != 0;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        return read_key(&from->key, to);
    case SDL_WINDOWEVENT:
        return read_window(&from->window, to);
    default:
        return false;
    }
}
