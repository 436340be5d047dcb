/* Which contacts can do anything in a step. ODE wakes what an awake body touches or is joined to, and what that touches in
   turn; contacts of what sleeps on are passed over by its solver, but they would cost a joint each, made and unmade. */

#include "internal.h"

static unsigned int root_of(oo_island *all, unsigned int i) {
    while (all[i].parent != i) i = all[i].parent = all[all[i].parent].parent;
    return i;
}

static void unite(oo_island *all, dBodyID one, dBodyID other) {
    if (!one || !other) return;
    unsigned int a = root_of(all, (unsigned int)(size_t)dBodyGetData(one));
    unsigned int b = root_of(all, (unsigned int)(size_t)dBodyGetData(other));
    all[a > b ? a : b].parent = a > b ? b : a;
}

int find_islands(oo_world *w) {
    if (reserve(&w->islands, &w->island_capacity, w->body_count, sizeof *w->islands)) return OO_NO_MEMORY;
    for (unsigned int i = 0; i < w->body_count; i++) w->islands[i] = (oo_island){.parent = i};
    for (unsigned int i = 0; i < w->contact_count; i++) {
        const oo_contact *row = &w->contacts[i];
        dBodyID one = dGeomGetBody(row->geom.g1), other = one ? dGeomGetBody(row->geom.g2) : NULL;
        if (other && row_acts(w, row)) unite(w->islands, one, other);
    }
    for (unsigned int i = 0; i < w->joint_count; i++) {
        dJointID joint = w->joints[i]->id;
        if (dJointIsEnabled(joint)) unite(w->islands, dJointGetBody(joint, 0), dJointGetBody(joint, 1));
    }
    for (unsigned int i = 0; i < w->body_count; i++)
        if (dBodyIsEnabled(w->bodies[i].id)) w->islands[root_of(w->islands, i)].awake = 1;
    return OO_OK;
}

int is_awake(const oo_world *w, dBodyID body) {
    return body && w->islands[root_of(w->islands, (unsigned int)(size_t)dBodyGetData(body))].awake;
}
