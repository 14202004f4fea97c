/* Which code finds tau: the paper's orders, iter and march are formulas of one place (method/shift.c); exact asks the
 * displaced surface; auto looks at what the lights see.
 */
#include "render/tau.h"

#include "method/shift.h"
#include "render/auto.h"
#include "render/bumps.h"

int tau_partials(const tracer *tr, int32_t id, const workspace *v)
{
    const bool flat = v->surface[id]->ops->flat; /* all but 2+ leave its zeros out */
    const bool shift = method_bends(tr->shadow) && !(flat && tr->shadow.kind != METHOD_ORDER);
    const bool own = bumps_cast(tr, id, v);
    if (tr->scene->object[id].bump && (shift || (own && !tr->shifted && !flat)))
        return 2;
    return tr->layers || own;
}

void tau_find(const tracer *tr, int32_t id, workspace *v)
{
    const bump *P = tr->scene->object[id].bump;
    hit_group *g = &v->g;
    int asked = method_code(tr->shadow);
    v->alone = false;
    if (P && tr->shadow.kind == METHOD_AUTO) {
        auto_shift(tr, id, v);
        asked = ORDER_ANY;
    } else if (P && tr->shadow.kind == METHOD_EXACT)
        displaced_shift(&v->displaced[id].base, g);
    else
        v->stats->evaluations += shift_group(g, P, tr->shadow, tr->guard);
    if (P && tr->shadow.kind != METHOD_NONE)
        shift_known(g);
    if (P)
        stats_orders(v->stats, g->n, g->order, asked);
}
