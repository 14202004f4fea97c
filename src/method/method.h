/* The methods that decide where shadow rays start on a bump-mapped surface. include/bumpshadow.h has the formulas. */
#ifndef KAGE_METHOD_METHOD_H
#define KAGE_METHOD_METHOD_H

#include <stdbool.h>

typedef enum method_kind {
    METHOD_NONE,  /* at the smooth hit, as every renderer does */
    METHOD_ORDER, /* n = 0, 1, 2: the paper's orders; 3: 2+ */
    METHOD_ITER,  /* order 0, n times */
    METHOD_MARCH, /* n steps through the slab between Pmin and Pmax */
    METHOD_EXACT, /* at the first hit of the displaced surface (displaced.h) */
    METHOD_AUTO,  /* order 0, and where that may change what a light sees, a bracket (bracket.h); n: the error */
} method_kind;

typedef struct method {
    method_kind kind;
    int n;
} method;

enum { METHOD_STEPS_MAX = 1024, METHOD_NAME_SIZE = 24 };

/* The error of auto is kept in millionths of a pixel, so that its name is exact. */
enum { METHOD_PIXEL = 1000000, METHOD_ERROR = METHOD_PIXEL / 4, METHOD_ERROR_MAX = 1000 * METHOD_PIXEL };

/* Read a method's name: none 0 1 2 2+ iter:K march:N exact auto auto:E, with K and N in 1..METHOD_STEPS_MAX, and E in
 * pixels, above 0 and up to 1000, with six decimals at most; `bump` is another name for none. False: not a method. */
bool method_parse(const char *text, method *m);

/* Write its name. */
void method_name(method m, char name[METHOD_NAME_SIZE]);

/* The derivatives of P it needs, as bump_ops.eval counts them: 1 the gradient (always, for n'), 2 also the pure second
 * ones, 3 also the mixed one. */
int method_order(method m);

/* Whether it needs the smooth surface's curvature: Quu, Quw and Qww. */
bool method_bends(method m);

/* Its number in the layer `order` and in the statistics, if it does not fall back: none -1; 0, 1, 2; 2+ 3; iter 4;
 * march 5; exact 6. auto: 0, its first try. */
int method_code(method m);
enum { ORDER_EXACT = 6, ORDER_CODES = 8 /* from none on */ };

/* The name for such a number, -1..6: without K or N. */
const char *method_code_name(int code);

/* The names of all methods, for messages. */
extern const char method_expected[];

/* One line of help for each method. */
typedef struct method_help {
    const char *name, *text;
} method_help;
extern const method_help method_helps[];
extern const int method_help_count;

#endif
