/* The methods: where shadow rays start on a bump-mapped surface. The formulas are bumpshadow.h's. */
#ifndef KAGE_METHOD_METHOD_H
#define KAGE_METHOD_METHOD_H

#include <stdbool.h>

typedef enum method_kind {
    METHOD_NONE,  /* at the smooth hit, as every renderer does */
    METHOD_ORDER, /* n = 0, 1, 2: the paper's; 3: 2+ */
    METHOD_ITER,  /* n times order 0 */
    METHOD_MARCH, /* n steps through the slab */
    METHOD_EXACT, /* at the first hit of the displaced surface (displaced.h) */
} method_kind;

typedef struct method {
    method_kind kind;
    int n;
} method;

enum { METHOD_STEPS_MAX = 1024, METHOD_NAME_SIZE = 16 };

/* Read a method's name: none 0 1 2 2+ iter:K march:N exact, with K and N in 1..METHOD_STEPS_MAX. False where text is
 * none. */
bool method_parse(const char *text, method *m);

/* Write its name. */
void method_name(method m, char name[METHOD_NAME_SIZE]);

/* The derivatives of P that it needs: 1 the gradient (for n', always), 2 also the second ones. */
int method_order(method m);

/* Whether it uses the smooth surface's curvature, so Quu, Quw and Qww. */
bool method_bends(method m);

/* How its order is written in the layer `order` and counted in the statistics, if it does not fall back:
 * METHOD_NONE -1; 0, 1, 2; 2+ 3; iter 4; march 5; exact 6. */
int method_code(method m);
enum { ORDER_EXACT = 6, ORDER_CODES = 8 /* from none on */ };

/* The name of what a code stands for. */
const char *method_code_name(int code);

/* What may be written for a method, for messages. */
extern const char method_expected[];

/* One line of help a method. */
typedef struct method_help {
    const char *name, *text;
} method_help;
extern const method_help method_helps[];
extern const int method_help_count;

#endif
