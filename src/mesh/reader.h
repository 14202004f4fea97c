/* Running the program kage-import on a model, in a process of its own. */
#ifndef KAGE_MESH_READER_H
#define KAGE_MESH_READER_H

#include "mesh/letter.h"

/* The pipe from the program, and the last letter that came through it. */
typedef struct reader_pipe {
    int from;
    letter letter;
    const progress *show;
    bool stopped;      /* waiting for it has ended; the letter says why */
    double share;      /* of the file, that is read */
    double end, asked; /* by the monotonic clock: when the time is over, and when `show` was last asked */
} reader_pipe;

typedef struct reader_call {
    const char *path;
    const char *reader; /* the program; NULL: reader.c finds it */
    int count;          /* of arguments behind the path; 0: triangles are asked for, else a scene */
    const char *const *argument;
    const progress *show;
    files *opened; /* the model's file and those that it refers to are added */

    /* Called for each letter that is a LETTER_NOTE, LETTER_FILE or LETTER_DONE, to take what follows it. False: it
     * can't be taken (reader_receive or reader_fails says why). */
    bool (*take)(void *user, reader_pipe *p);
    void *user;
} reader_call;

/* False, with the reason in one line. Reentrant. */
bool reader_run(const reader_call *c, char why[MESH_WHY]);

/* For `take`: the next `size` bytes; a reason why it fails. */
bool reader_receive(reader_pipe *p, void *to, size_t size);
bool reader_fails(reader_pipe *p, const char *why); /* false */

#endif
