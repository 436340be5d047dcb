/* The broad phase of osgode's own: which pairs of geoms are worth a closer look.

   Geoms that move stand in a list sorted along one axis, and are swept. Those that do not, static or asleep, stand in a
   tree of boxes, which changes only when one of them comes, goes, or is moved; nothing looks for pairs among them. But
   ODE wakes what an awake body touches or is joined to, and what that touches in turn, within the same step, and all
   of it needs its contacts then: so from the awake bodies the pairs of every sleeper that is reached are looked for
   too. The order of the pairs follows from where everything is now, not from how it came there. */

#include "broad.h"

enum { HEARD = OO_LISTENED | OO_ASKED | OO_SENSOR }; /* sleeping or not, somebody wants to know what touches it */

#define HUGE_LENGTH 1e6

enum { NEW, WAITING, DONE }; /* sleepers that are reached */

/* ------------------------------------------------------------------ which spaces were told to collide */

static void mark_space(oo_world *w, dSpaceID space, unsigned int slot) {
    members m = {0};
    for (dSpaceID at = space; at; at = dGeomGetSpace((dGeomID)at))
        for (unsigned int i = 0; i < w->declared_count && i < MOST_DECLARED; i++) {
            const oo_pair *pair = &w->declared[i];
            uint64_t bit = (uint64_t)1 << i;
            if (!pair->other && pair->space == at) m.inside |= bit;
            if (pair->other && pair->space == at) m.left |= bit;
            if (pair->other && pair->other == at) m.right |= bit;
        }
    w->broad->spaces[slot] = m;
}

/* Spaces are made before what they hold, so their slots are mostly low ones. */
static int mark_spaces(oo_world *w) {
    struct oo_broad *b = w->broad;
    unsigned int end = 0, had = b->space_capacity;
    for (unsigned int slot = 0; slot < w->geom_count; slot++)
        if (w->geoms[slot].flags & OO_IS_SPACE) end = slot + 1;
    if (reserve(&b->spaces, &b->space_capacity, end, sizeof *b->spaces)) return OO_NO_MEMORY;
    for (unsigned int i = had; i < b->space_capacity; i++) b->spaces[i] = (members){0};
    for (unsigned int slot = 0; slot < w->geom_count; slot++)
        if ((w->geoms[slot].flags & (OO_ALIVE | OO_IS_SPACE)) == (OO_ALIVE | OO_IS_SPACE))
            mark_space(w, (dSpaceID)w->geoms[slot].id, slot);
    w->pairs_are_new = 0;
    return OO_OK;
}

/* ------------------------------------------------------------------ what has changed since the last step */

static int make_room(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b) {
        b = w->broad = calloc(1, sizeof *b);
        if (!b) return OO_NO_MEMORY;
        tree_start(&b->tree);
        tree_start(&b->mover_tree);
    }
    unsigned int had = b->entry_capacity;
    if (reserve(&b->entries, &b->entry_capacity, w->geom_count, sizeof *b->entries)) return OO_NO_MEMORY;
    for (unsigned int i = had; i < b->entry_capacity; i++) b->entries[i] = (entry){.leaf = NONE, .state = OUT};
    if (reserve(&b->movers, &b->mover_capacity, w->geom_count, sizeof *b->movers)) return OO_NO_MEMORY;
    if (reserve(&b->sections, &b->section_capacity, w->geom_count, sizeof *b->sections)) return OO_NO_MEMORY;
    if (reserve(&b->reached, &b->reached_capacity, w->body_count, sizeof *b->reached)) return OO_NO_MEMORY;
    if (reserve(&b->asleep, &b->asleep_capacity, w->body_count, sizeof *b->asleep)) return OO_NO_MEMORY;
    return reserve(&b->queue.at, &b->queue.capacity, w->body_count, sizeof *b->queue.at);
}

static int is_huge(const box *b) {
    for (int k = 0; k < 3; k++)
        if (!(b->high[k] - b->low[k] < HUGE_LENGTH)) return 1;
    return 0;
}

/* The space of a geom that takes part, else NULL. */
static dSpaceID space_of(const oo_geom *geom) {
    int is_geom = (geom->flags & (OO_ALIVE | OO_IS_SPACE)) == OO_ALIVE;
    return is_geom && dGeomIsEnabled(geom->id) ? dGeomGetSpace(geom->id) : NULL;
}

static int note_quiet(struct oo_broad *b, unsigned int slot, const box *now) {
    entry *e = &b->entries[slot];
    if (e->state == HUGE_BOX) return put_slot(&b->huge, slot);
    if (e->leaf == NONE) e->leaf = tree_plant(&b->tree, now, slot);
    return e->leaf == NONE ? OO_NO_MEMORY : OO_OK;
}

/* A ray looks at all there is, wherever it stands. */
static int is_mover(const oo_geom *geom) {
    dBodyID body = dGeomGetBody(geom->id);
    return geom->flags & OO_IS_RAY || (body && dBodyIsEnabled(body));
}

static int update_entry(oo_world *w, unsigned int slot) {
    struct oo_broad *b = w->broad;
    entry *e = &b->entries[slot];
    dGeomID geom = w->geoms[slot].id;
    dSpaceID space = space_of(&w->geoms[slot]);
    if (!space) {
        if (e->leaf != NONE) tree_uproot(&b->tree, e->leaf);
        e->leaf = NONE;
        e->state = OUT;
        return OO_OK;
    }
    int moving = is_mover(&w->geoms[slot]), was_moving = e->state == MOVING;
    box now = box_around(geom);
    e->state = moving ? MOVING : is_huge(&now) ? HUGE_BOX : QUIET;
    e->space = (unsigned int)(size_t)dGeomGetData((dGeomID)space);
    if (e->leaf != NONE && (e->state != QUIET || memcmp(&now, &e->box, sizeof now))) {
        tree_uproot(&b->tree, e->leaf);
        e->leaf = NONE;
    }
    e->box = now;
    if (!moving) return note_quiet(b, slot, &now);
    if (!was_moving) {
        b->movers[b->mover_count++].slot = slot;
        b->unsorted++;
    }
    return OO_OK;
}

static int *leaf_of(void *b, unsigned int slot) { return &((struct oo_broad *)b)->entries[slot].leaf; }

static int update_all(oo_world *w) {
    struct oo_broad *b = w->broad;
    b->huge.count = b->heard.count = b->sleepers = 0;
    for (unsigned int slot = 0; slot < w->geom_count; slot++) {
        if (update_entry(w, slot)) return OO_NO_MEMORY;
        if (w->geoms[slot].flags & HEARD && put_slot(&b->heard, slot)) return OO_NO_MEMORY;
    }
    for (unsigned int i = 0; i < w->body_count; i++) {
        b->asleep[i] = !dBodyIsEnabled(w->bodies[i].id);
        b->sleepers += b->asleep[i];
    }
    return OO_OK;
}

/* What nobody has touched and what sleeps as before stands as before: only bodies that are awake or were are looked at.
   `huge` tells if the list of huge boxes is no longer true, which is rare enough to look at everything then. */
static int update_awake(oo_world *w, int *huge) {
    struct oo_broad *b = w->broad;
    b->sleepers = 0;
    for (unsigned int i = 0; i < w->body_count; i++) {
        dBodyID body = w->bodies[i].id;
        int asleep = !dBodyIsEnabled(body);
        b->sleepers += (unsigned int)asleep;
        if (asleep && b->asleep[i]) continue;
        b->asleep[i] = (unsigned char)asleep;
        for (dGeomID geom = dBodyGetFirstGeom(body); geom; geom = dBodyGetNextGeom(geom)) {
            unsigned int slot = (unsigned int)(size_t)dGeomGetData(geom);
            int before = b->entries[slot].state;
            if (update_entry(w, slot)) return OO_NO_MEMORY;
            *huge |= (before == HUGE_BOX) != (b->entries[slot].state == HUGE_BOX);
        }
    }
    return OO_OK;
}

/* Movers that were there before keep their places in the list, since they are nearly sorted; new ones come behind. */
int broad_update(oo_world *w) {
    if (make_room(w)) return OO_NO_MEMORY;
    struct oo_broad *b = w->broad;
    int all = w->edited;
    w->edited = 1; /* until this is done */
    if (w->pairs_are_new && mark_spaces(w)) return OO_NO_MEMORY;
    unsigned int kept = 0;
    for (unsigned int i = 0; i < b->mover_count; i++) {
        unsigned int slot = b->movers[i].slot;
        if (space_of(&w->geoms[slot]) && is_mover(&w->geoms[slot]))
            b->movers[kept++].slot = slot;
        else
            b->entries[slot].state = OUT; /* until it is looked at below */
    }
    b->mover_count = kept;
    b->unsorted = 0;
    if (!all && update_awake(w, &all)) return OO_NO_MEMORY;
    if (all && update_all(w)) return OO_NO_MEMORY;
    w->edited = 0;
    return tree_is_worn(&b->tree) ? tree_rebuild(&b->tree, leaf_of, b) : OO_OK;
}

/* ------------------------------------------------------------------ pairs that are near enough */

/* Whether spheres with these boxes are apart for sure: where rounding could decide, they are left to ODE. */
static int spheres_apart(const box *a, const box *b) {
    double reach = a->high[0] - a->low[0] + b->high[0] - b->low[0], square = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        double way = a->low[k] + a->high[k] - b->low[k] - b->high[k];
        square += way * way;
        sum += fabs(a->low[k]) + fabs(a->high[k]) + fabs(b->low[k]) + fabs(b->high[k]);
    }
    reach = reach * (1 + 1e-12) + 1e-14 * sum;
    return square > reach * reach;
}

void try_pair(oo_world *w, unsigned int slot1, unsigned int slot2) {
    const struct oo_broad *b = w->broad;
    unsigned int first = slot1 < slot2 ? slot1 : slot2, second = slot1 < slot2 ? slot2 : slot1;
    if (!broad_declares(b, first, second)) return;
    int round = (w->geoms[first].flags & w->geoms[second].flags & OO_IS_SPHERE) != 0;
    if (round && spheres_apart(&b->entries[first].box, &b->entries[second].box)) return;
    meet_pair(w, first, second);
}

/* ------------------------------------------------------------------ against what does not move */

/* What is quiet and where a box is: into hits, those of the tree in the order of their slots, then the huge ones. */
static int find_quiet(struct oo_broad *b, const box *wanted) {
    if (tree_find(&b->tree, wanted, &b->hits)) return OO_NO_MEMORY;
    for (unsigned int i = 0; i < b->huge.count; i++)
        if (overlap(&b->entries[b->huge.at[i]].box, wanted) && put_slot(&b->hits, b->huge.at[i])) return OO_NO_MEMORY;
    return OO_OK;
}

static int is_done(const oo_world *w, unsigned int slot) {
    dBodyID body = dGeomGetBody(w->geoms[slot].id);
    return body && w->broad->reached[(size_t)dBodyGetData(body)] == DONE;
}

static int meet_quiet_from_movers(oo_world *w) {
    struct oo_broad *b = w->broad;
    for (unsigned int i = 0; i < b->mover_count; i++) {
        unsigned int slot = b->movers[i].slot;
        if (find_quiet(b, &b->entries[slot].box)) return OO_NO_MEMORY;
        for (unsigned int k = 0; k < b->hits.count; k++) try_pair(w, slot, b->hits.at[k]);
    }
    return OO_OK;
}

/* ------------------------------------------------------------------ sleepers that are about to be woken */

static void reach(oo_world *w, dBodyID body) {
    struct oo_broad *b = w->broad;
    if (!body || dBodyIsEnabled(body)) return;
    size_t index = (size_t)dBodyGetData(body);
    if (b->reached[index] != NEW) return;
    b->reached[index] = WAITING;
    b->queue.at[b->queue.count++] = (unsigned int)index;
}

static void reach_over_joints(oo_world *w, dBodyID body) {
    for (int i = 0; i < dBodyGetNumJoints(body); i++) {
        dJointID joint = dBodyGetJoint(body, i);
        if (!dJointIsEnabled(joint)) continue;
        reach(w, dJointGetBody(joint, 0));
        reach(w, dJointGetBody(joint, 1));
    }
}

static void reach_over_joints_of_awake(oo_world *w) {
    for (unsigned int i = 0; i < w->joint_count; i++) {
        dJointID joint = w->joints[i]->id;
        dBodyID one = dJointGetBody(joint, 0), other = dJointGetBody(joint, 1);
        if (!one || !other || !dJointIsEnabled(joint) || dBodyIsEnabled(one) == dBodyIsEnabled(other)) continue;
        reach(w, one);
        reach(w, other);
    }
}

/* The pairs of a sleeper with all that is quiet; two sleepers that are both reached are tried by the first alone. */
static int meet_quiet_from_sleeper(oo_world *w, dBodyID body) {
    struct oo_broad *b = w->broad;
    for (dGeomID geom = dBodyGetFirstGeom(body); geom; geom = dBodyGetNextGeom(geom)) {
        unsigned int slot = (unsigned int)(size_t)dGeomGetData(geom);
        if (b->entries[slot].state == OUT) continue;
        if (find_quiet(b, &b->entries[slot].box)) return OO_NO_MEMORY;
        for (unsigned int i = 0; i < b->hits.count; i++)
            if (!is_done(w, b->hits.at[i])) try_pair(w, slot, b->hits.at[i]);
    }
    return OO_OK;
}

static int flood(oo_world *w) {
    struct oo_broad *b = w->broad;
    memset(b->reached, NEW, w->body_count);
    b->queue.count = 0;
    reach_over_joints_of_awake(w);
    unsigned int row = 0, at = 0;
    while (row < w->contact_count || at < b->queue.count) {
        if (row < w->contact_count) {
            const oo_contact *contact = &w->contacts[row++];
            if (!row_acts(w, contact)) continue;
            reach(w, dGeomGetBody(contact->geom.g1));
            reach(w, dGeomGetBody(contact->geom.g2));
            continue;
        }
        unsigned int index = b->queue.at[at++];
        reach_over_joints(w, w->bodies[index].id);
        if (meet_quiet_from_sleeper(w, w->bodies[index].id)) return OO_NO_MEMORY;
        b->reached[index] = DONE;
    }
    return OO_OK;
}

/* What somebody listens to is told that it still touches, though all of it sleeps. */
static int meet_listened(oo_world *w) {
    struct oo_broad *b = w->broad;
    for (unsigned int h = 0; h < b->heard.count; h++) {
        unsigned int slot = b->heard.at[h];
        const entry *e = &b->entries[slot];
        int quiet = e->state == QUIET || e->state == HUGE_BOX;
        if (!quiet || is_done(w, slot)) continue;
        if (find_quiet(b, &e->box)) return OO_NO_MEMORY;
        for (unsigned int i = 0; i < b->hits.count; i++) {
            unsigned int other = b->hits.at[i];
            int had_its_turn = other < slot && w->geoms[other].flags & HEARD;
            if (other != slot && !had_its_turn && !is_done(w, other)) try_pair(w, slot, other);
        }
    }
    return OO_OK;
}

int find_pairs(oo_world *w) {
    if (broad_update(w)) return OO_NO_MEMORY;
    meet_movers(w);
    if (meet_quiet_from_movers(w)) return OO_NO_MEMORY;
    if (w->broad->sleepers && (flood(w) || meet_listened(w))) return OO_NO_MEMORY;
    w->broad->current = 1;
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}

/* ------------------------------------------------------------------ between steps */

void broad_forget(oo_world *w) {
    if (w->broad) w->broad->current = 0;
    w->edited = 1;
}

/* Sleepers touch what they lie on without a contact that says so. */
void wake_sleepers_on(oo_world *w, unsigned int slot) {
    struct oo_broad *b = w->broad;
    if (!b || !b->current || !b->sleepers || slot >= b->entry_capacity || b->entries[slot].state == OUT) return;
    if (find_quiet(b, &b->entries[slot].box)) return;
    for (unsigned int i = 0; i < b->hits.count; i++) {
        unsigned int other = b->hits.at[i];
        dBodyID body = other != slot && w->geoms[other].flags & OO_ALIVE ? dGeomGetBody(w->geoms[other].id) : NULL;
        if (!body || dBodyIsEnabled(body) || !broad_declares(b, slot, other)) continue;
        if (geoms_touch(w, slot, other)) dBodyEnable(body);
    }
}

unsigned long long oo_broad_bytes(const oo_world *w) {
    const struct oo_broad *b = w->broad;
    if (!b) return 0;
    return sizeof *b + b->entry_capacity * sizeof *b->entries + b->space_capacity * sizeof *b->spaces +
           b->mover_capacity * sizeof *b->movers + b->section_capacity * sizeof *b->sections +
           (b->tree.capacity + b->mover_tree.capacity) * sizeof *b->tree.nodes + b->reached_capacity + b->asleep_capacity +
           (b->huge.capacity + b->heard.capacity + b->hits.capacity + b->queue.capacity) * sizeof(unsigned int);
}

void broad_free(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b) return;
    free(b->entries);
    free(b->spaces);
    free(b->movers);
    free(b->sections);
    free(b->tree.nodes);
    free(b->mover_tree.nodes);
    free(b->huge.at);
    free(b->heard.at);
    free(b->hits.at);
    free(b->reached);
    free(b->asleep);
    free(b->queue.at);
    free(b);
}
