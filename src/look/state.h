/* What the user has changed, and what events make of it: plain structs and pure functions, without a window. */
#ifndef KAGE_LOOK_STATE_H
#define KAGE_LOOK_STATE_H

#include <stdbool.h>

#include "kage.h"

enum { VIEW_NAME = 64, VIEW_METHOD = 24, VIEW_MOST = 64 };

/* The layers that are shown: the picture, or one as false colours. */
typedef enum view_layer { LAYER_PICTURE, LAYER_TAU, LAYER_ORDER, LAYER_HEIGHT, LAYERS } view_layer;

typedef struct moved_light {
    char name[VIEW_NAME];
    double at[3];
} moved_light;

/* A bump whose scale is the scene's times VIEW_NOTCH for each notch of the wheel. */
#define VIEW_NOTCH 1.1
typedef struct scaled_bump {
    char name[VIEW_NAME]; /* of the object that owns it */
    int notches;
} scaled_bump;

/* What the picture is made by: the changes of the scene. Texts that are empty, and zeros: as the scene says. All bytes
 * that are not used are 0, so that looks can be compared. */
typedef struct look {
    int width, height; /* of the picture, in pixels */
    int moved, zoomed; /* whether from and at, and across, are changed */
    double from[3], at[3];
    double across; /* of an orthographic camera */
    int lights, bumps;
    moved_light light[VIEW_MOST];
    scaled_bump bump[VIEW_MOST];
    char shadow[VIEW_METHOD], own[VIEW_METHOD]; /* render.shadow, render.bump_shadow */
    char shade[VIEW_METHOD], surface[VIEW_METHOD];
    char beside[VIEW_METHOD]; /* the method left of the split line; empty: there is no line */
    view_layer layer;
} look;

typedef enum view_drag { DRAG_NONE, DRAG_EYE, DRAG_LIGHT, DRAG_PAN } view_drag;
typedef enum view_readout { READOUT_LINE, READOUT_TABLE, READOUT_NONE, READOUTS } view_readout;

typedef struct view_state {
    look look;
    char other[VIEW_METHOD]; /* the method to compare with: left of the split line, or while `c` is held */
    char kept[VIEW_METHOD];  /* look.shadow while `c` is held */
    bool held, split, help;
    view_readout readout;
    view_drag drag;
    int x, y;   /* the mouse, in pixels of the picture */
    bool over;  /* it is over the picture */
    int chosen; /* the light that shift-drag moves */
    bool named; /* its name and place are shown, until something else happens */
} view_state;

typedef enum view_event_kind {
    EVENT_PRESS,
    EVENT_RELEASE,
    EVENT_MOVE,
    EVENT_LEAVE,
    EVENT_WHEEL,
    EVENT_KEY,
    EVENT_KEY_UP,
    EVENT_SIZE
} view_event_kind;

/* Keys without a character. */
enum { KEY_LEFT = 256, KEY_RIGHT, KEY_UP, KEY_DOWN, KEY_HELP, KEY_RELOAD, KEY_ESCAPE = 27, KEY_TAB = 9 };

typedef struct view_event {
    view_event_kind kind;
    int x, y;   /* the mouse, in pixels of the picture; the size, of EVENT_SIZE */
    int button; /* 1: left, 2: middle, 3: right */
    int notches;
    int key; /* its character without shift, or one of the above */
    bool shift, ctrl;
} view_event;

/* What an event asks for, as bits. */
enum { ASK_PICTURE = 1, ASK_WINDOW = 2, ASK_SAVE = 4, ASK_RELOAD = 8, ASK_QUIT = 16 };

void view_start(view_state *s, int width, int height);

/* Take an event. s: the scene as read from its file. pointed: the owner of the bump under the mouse; empty: none. */
unsigned view_take(view_state *v, const kage_scene_info *s, const char *pointed, const view_event *e);

/* The place of a light, moved or not. */
void view_light(const view_state *v, const kage_scene_info *s, int light, double at[3]);

#endif
