/* What events make of the state. */
#include "look/state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "look/keys.h"
#include "look/orbit.h"

static const double PI = 3.14159265358979323846;

void view_start(view_state *s, int width, int height)
{
    memset(s, 0, sizeof *s);
    s->look.width = width;
    s->look.height = height;
    strcpy(s->other, "none");
}

/* Replace a text, with no bytes of the old one left behind it. */
static void put(char *to, size_t size, const char *text)
{
    memset(to, 0, size);
    snprintf(to, size, "%s", text);
}

/* ---- the eye ---- */

static void begin_eye(look *l, const kage_scene_info *s)
{
    if (l->moved)
        return;
    memcpy(l->from, s->camera.eye, sizeof l->from);
    memcpy(l->at, s->camera.at, sizeof l->at);
    l->moved = 1;
}

static void turn_eye(look *l, const kage_scene_info *s, double turn, double tilt)
{
    begin_eye(l, s);
    orbit_turn(l->from, l->at, s->camera.up, turn, tilt);
}

/* The width of the picture at the point looked at, in scene units. */
static double width_there(const look *l, const kage_scene_info *s)
{
    if (s->camera.width > 0)
        return l->zoomed ? l->across : s->camera.width;
    return 2 * orbit_distance(l->from, l->at) * tan(s->camera.fov * PI / 360);
}

static void pan_eye(look *l, const kage_scene_info *s, int dx, int dy)
{
    begin_eye(l, s);
    const double pixel = width_there(l, s) / l->width;
    orbit_pan(l->from, l->at, s->camera.up, -dx * pixel, dy * pixel);
}

static double limited(double x, double least, double most) { return fmin(fmax(x, least), most); }

static void approach_eye(look *l, const kage_scene_info *s, int notches)
{
    const double factor = pow(VIEW_NOTCH, -notches);
    if (s->camera.width > 0) {
        l->across = limited((l->zoomed ? l->across : s->camera.width) * factor, 1e-4, 1e5);
        l->zoomed = 1;
        return;
    }
    begin_eye(l, s);
    const double d = orbit_distance(l->from, l->at);
    orbit_approach(l->from, l->at, limited(d * factor, 1e-3, 1e5) / d);
}

/* ---- lights ---- */

static int moved_index(const look *l, const char *name)
{
    for (int k = 0; k < l->lights; k++)
        if (strcmp(l->light[k].name, name) == 0)
            return k;
    return -1;
}

void view_light(const view_state *v, const kage_scene_info *s, int light, double at[3])
{
    const int k = moved_index(&v->look, s->lights[light].name);
    memcpy(at, k < 0 ? s->lights[light].at : v->look.light[k].at, sizeof v->look.light[0].at);
}

/* The chosen light, as one that is moved. NULL: there is none, or too many are moved. */
static moved_light *begin_light(view_state *v, const kage_scene_info *s)
{
    look *l = &v->look;
    if (!s->light_count)
        return NULL;
    v->chosen %= s->light_count;
    v->named = true;
    const kage_light_info *x = &s->lights[v->chosen];
    const int k = moved_index(l, x->name);
    if (k >= 0)
        return &l->light[k];
    if (l->lights == VIEW_MOST)
        return NULL;
    moved_light *m = &l->light[l->lights++];
    put(m->name, sizeof m->name, x->name);
    memcpy(m->at, x->at, sizeof m->at);
    return m;
}

/* About the point that the eye looks at. */
static const double *middle(const look *l, const kage_scene_info *s) { return l->moved ? l->at : s->camera.at; }

static void turn_light(view_state *v, const kage_scene_info *s, double turn, double tilt)
{
    moved_light *m = begin_light(v, s);
    if (m)
        orbit_turn(m->at, middle(&v->look, s), s->camera.up, turn, tilt);
}

static void approach_light(view_state *v, const kage_scene_info *s, int notches)
{
    moved_light *m = begin_light(v, s);
    const double d = m ? orbit_distance(m->at, middle(&v->look, s)) : 0;
    if (d > 0)
        orbit_approach(m->at, middle(&v->look, s), limited(d * pow(VIEW_NOTCH, -notches), 1e-3, 1e5) / d);
}

/* ---- bumps ---- */

static void scale_bump(look *l, const char *name, int notches)
{
    int k = 0;
    while (k < l->bumps && strcmp(l->bump[k].name, name) != 0)
        k++;
    if (k == VIEW_MOST)
        return;
    if (k == l->bumps) {
        l->bumps++;
        put(l->bump[k].name, VIEW_NAME, name);
    }
    l->bump[k].notches = (int)limited(l->bump[k].notches + notches, -100, 60);
}

/* The bump under the mouse, or each of them once. */
static void scale_bumps(look *l, const kage_scene_info *s, const char *pointed, int notches)
{
    if (*pointed) {
        scale_bump(l, pointed, notches);
        return;
    }
    for (int k = 0; k < s->object_count; k++) {
        const char *owner = s->objects[k].bump_of;
        bool first = owner != NULL;
        for (int j = 0; j < k && first; j++)
            first = !s->objects[j].bump_of || strcmp(s->objects[j].bump_of, owner) != 0;
        if (first)
            scale_bump(l, owner, notches);
    }
}

/* ---- events ---- */

static unsigned move(view_state *v, const kage_scene_info *s, const view_event *e)
{
    const int dx = e->x - v->x, dy = e->y - v->y;
    const double step = PI / v->look.width; /* across the window is half a turn */
    v->x = e->x;
    v->y = e->y;
    v->over = e->x >= 0 && e->y >= 0 && e->x < v->look.width && e->y < v->look.height;
    if (v->drag == DRAG_NONE || (dx == 0 && dy == 0))
        return ASK_WINDOW;
    if (v->drag == DRAG_EYE)
        turn_eye(&v->look, s, dx * step, dy * step);
    else if (v->drag == DRAG_PAN)
        pan_eye(&v->look, s, dx, dy);
    else
        turn_light(v, s, -dx * step, -dy * step);
    return ASK_PICTURE | ASK_WINDOW;
}

static unsigned wheel(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e)
{
    if (e->ctrl)
        approach_eye(&v->look, s, e->notches);
    else if (e->shift)
        approach_light(v, s, e->notches);
    else
        scale_bumps(&v->look, s, pointed, e->notches);
    return ASK_PICTURE | ASK_WINDOW;
}

/* One of two words for a setting; which of them the scene has. */
static void toggle(char to[VIEW_METHOD], bool on, const char *yes, const char *no)
{
    const bool is = *to ? strcmp(to, no) != 0 : on;
    put(to, VIEW_METHOD, is ? no : yes);
}

static void toggle_own(look *l, const kage_scene_info *s)
{
    const bool scene = strcmp(s->bump_shadow, "none") != 0;
    toggle(l->own, scene, scene ? s->bump_shadow : KAGE_RELIEF_BUMP_SHADOW, "none");
}

static void choose_method(view_state *v, const view_event *e, const char *name)
{
    if (e->shift)
        put(v->other, sizeof v->other, name);
    else if (v->held)
        put(v->kept, sizeof v->kept, name);
    else
        put(v->look.shadow, sizeof v->look.shadow, name);
}

static void hold(view_state *v, bool held)
{
    if (held == v->held)
        return;
    v->held = held;
    if (held)
        put(v->kept, sizeof v->kept, v->look.shadow);
    put(v->look.shadow, sizeof v->look.shadow, held ? v->other : v->kept);
}

static unsigned reset(view_state *v)
{
    const look before = v->look;
    view_state fresh;
    view_start(&fresh, before.width, before.height);
    v->look = fresh.look;
    v->held = v->split = v->named = false;
    memcpy(v->other, fresh.other, sizeof v->other);
    return ASK_PICTURE | ASK_WINDOW;
}

/* Acts that change the picture. */
static void change(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e, const view_key *k)
{
    look *l = &v->look;
    const double step = PI / 36;
    if (k->act == ACT_SHADOW)
        choose_method(v, e, k->value);
    else if (k->act == ACT_SHADE)
        toggle(l->shade, s->shifted, "shifted", "smooth");
    else if (k->act == ACT_OWN)
        toggle_own(l, s);
    else if (k->act == ACT_SURFACE)
        toggle(l->surface, s->displaced, "displaced", "smooth");
    else if (k->act == ACT_COMPARE)
        hold(v, true);
    else if (k->act == ACT_SPLIT)
        v->split = !v->split;
    else if (k->act == ACT_LAYER)
        l->layer = (view_layer)((l->layer + (e->shift ? LAYERS - 1 : 1)) % LAYERS);
    else if (k->act == ACT_TURN && e->shift)
        turn_light(v, s, -k->x * step, -k->y * step);
    else if (k->act == ACT_TURN)
        turn_eye(l, s, k->x * step, k->y * step);
    else if (k->act == ACT_NEARER)
        approach_eye(l, s, k->x);
    else
        scale_bumps(l, s, pointed, k->x);
}

static unsigned press_key(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e)
{
    const view_key *k = view_key_find(e->key);
    if (!k)
        return 0;
    switch (k->act) {
    case ACT_QUIT:
        return ASK_QUIT;
    case ACT_CLOSE:
        if (!v->help)
            return ASK_QUIT;
        v->help = false;
        return ASK_WINDOW;
    case ACT_HELP:
        v->help = !v->help;
        return ASK_WINDOW;
    case ACT_READOUT:
        v->readout = (view_readout)((v->readout + 1) % READOUTS);
        return ASK_WINDOW;
    case ACT_LIGHT:
        v->chosen = s->light_count ? (v->chosen + (v->named ? 1 : 0)) % s->light_count : 0;
        v->named = true;
        return ASK_WINDOW;
    case ACT_SAVE:
        return ASK_SAVE;
    case ACT_RELOAD:
        return ASK_RELOAD;
    case ACT_RESET:
        return reset(v);
    default:
        change(v, s, pointed, e, k);
        return ASK_PICTURE | ASK_WINDOW;
    }
}

static unsigned resize(view_state *v, int width, int height)
{
    if (width == v->look.width && height == v->look.height)
        return ASK_WINDOW;
    v->look.width = width;
    v->look.height = height;
    return ASK_PICTURE | ASK_WINDOW;
}

static unsigned press(view_state *v, const view_event *e)
{
    v->x = e->x;
    v->y = e->y;
    v->drag = e->button == 1 ? (e->shift ? DRAG_LIGHT : DRAG_EYE) : DRAG_PAN;
    return ASK_WINDOW;
}

static unsigned take(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e)
{
    switch (e->kind) {
    case EVENT_PRESS:
        return press(v, e);
    case EVENT_RELEASE:
        v->drag = DRAG_NONE;
        return ASK_WINDOW;
    case EVENT_MOVE:
        return move(v, s, e);
    case EVENT_LEAVE:
        v->over = false;
        return ASK_WINDOW;
    case EVENT_WHEEL:
        return wheel(v, s, pointed, e);
    case EVENT_KEY:
        return press_key(v, s, pointed, e);
    case EVENT_KEY_UP:
        if (e->key != 'c' || !v->held)
            return 0;
        hold(v, false);
        return ASK_PICTURE | ASK_WINDOW;
    default:
        return resize(v, e->x, e->y);
    }
}

unsigned view_take(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e)
{
    if (e->kind == EVENT_KEY || e->kind == EVENT_WHEEL)
        v->named = v->named && e->kind == EVENT_KEY && e->key == KEY_TAB;
    const unsigned asked = take(v, s, pointed, e);
    put(v->look.beside, sizeof v->look.beside, v->split ? v->other : "");
    return asked;
}
