/* The keys and what each does: one table for the events, for the window's help and for --help. */
#ifndef KAGE_LOOK_KEYS_H
#define KAGE_LOOK_KEYS_H

typedef enum view_act {
    ACT_NONE, /* a line of the help alone */
    ACT_SHADOW,
    ACT_SHADE,
    ACT_OWN,
    ACT_SURFACE,
    ACT_COMPARE,
    ACT_SPLIT,
    ACT_LAYER,
    ACT_READOUT,
    ACT_TURN,
    ACT_NEARER,
    ACT_HEIGHT,
    ACT_LIGHT,
    ACT_RESET,
    ACT_RELOAD,
    ACT_SAVE,
    ACT_HELP,
    ACT_CLOSE,
    ACT_QUIT
} view_act;

typedef struct view_key {
    int key;
    view_act act;
    const char *value; /* the method of ACT_SHADOW */
    int x, y;          /* steps */
    const char *name;  /* in the help; NULL: the line of another key tells of this one, too */
    const char *help;
} view_key;

extern const view_key view_keys[];
extern const int view_key_count;

/* NULL: the key does nothing. */
const view_key *view_key_find(int key);

#endif
