/* The broad phase of osgode's own: which pairs of geoms are worth a closer look.

   Geoms that move stand in a list sorted along one axis, and are swept. Those that do not, static or asleep, stand in a
   tree of boxes, which changes only when one of them comes, goes, or is moved; nothing looks for pairs among them. But
   ODE wakes what an awake body touches or is joined to, and what that touches in turn, within the same step, and all
   of it needs its contacts then: so from the awake bodies the pairs of every sleeper that is reached are looked for
   too. The order of the pairs follows from the state alone, not from how it came about. */

#include <stdint.h>

#include "internal.h"

enum { OUT, QUIET, MOVING, HUGE_BOX };
enum { NONE = -1 };
enum { HEARD = OO_LISTENED | OO_ASKED | OO_SENSOR }; /* sleeping or not, somebody wants to know what touches it */

#define HUGE_LENGTH 1e6f /* planes, and what is not worth a place in the tree */

typedef struct box { float low[3], high[3]; } box;

typedef struct members { uint64_t inside, left, right; } members; /* a bit for each declared pair of spaces */

typedef struct entry {
    box box;
    members members;
    int leaf; /* in the tree */
    unsigned char state;
} entry;

typedef struct node {
    box box;
    int parent, children[2]; /* of a leaf: NONE and the slot */
} node;

struct oo_broad {
    entry *entries; /* by slot */
    unsigned int entry_capacity;
    members *spaces; /* by slot */
    unsigned int space_capacity;

    unsigned int *moving, *huge, *hits; /* slots */
    unsigned int moving_count, moving_capacity, huge_count, huge_capacity, hit_count, hit_capacity;
    int axis;

    node *nodes;
    unsigned int node_count, node_capacity;
    int root, free_node, moving_root;
    unsigned int node_count_before; /* the tree of the moving ones was added */
    unsigned int leaf_count, changes; /* since it was built */

    unsigned char *reached; /* by body: woken by what is awake, in this step */
    unsigned int reached_capacity;
    unsigned int *queue;
    unsigned int queue_count, queue_capacity;
    unsigned int sleepers;
};

/* ------------------------------------------------------------------ boxes */

static float below(double value) {
    float f = (float)value;
    return (double)f > value ? nextafterf(f, -INFINITY) : f;
}

static float above(double value) {
    float f = (float)value;
    return (double)f < value ? nextafterf(f, INFINITY) : f;
}

static box box_of(dGeomID geom) {
    dReal aabb[6];
    dGeomGetAABB(geom, aabb);
    return (box){{below(aabb[0]), below(aabb[2]), below(aabb[4])}, {above(aabb[1]), above(aabb[3]), above(aabb[5])}};
}

static int overlap(const box *a, const box *b) {
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] && b->low[1] <= a->high[1] &&
           a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static box join(const box *a, const box *b) {
    box out;
    for (int k = 0; k < 3; k++) {
        out.low[k] = fminf(a->low[k], b->low[k]);
        out.high[k] = fmaxf(a->high[k], b->high[k]);
    }
    return out;
}

static float size_of_box(const box *b) {
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x * y + y * z + z * x;
}

static int is_huge(const box *b) {
    for (int k = 0; k < 3; k++)
        if (!(b->high[k] - b->low[k] < HUGE_LENGTH)) return 1;
    return 0;
}

/* ------------------------------------------------------------------ the tree of what does not move */

static int take_node(struct oo_broad *b) {
    int taken = b->free_node;
    if (taken != NONE) {
        b->free_node = b->nodes[taken].parent;
        return taken;
    }
    if (reserve(&b->nodes, &b->node_capacity, b->node_count + 1, sizeof *b->nodes)) return NONE;
    return (int)b->node_count++;
}

static void give_node(struct oo_broad *b, int given) {
    b->nodes[given].parent = b->free_node;
    b->free_node = given;
}

static void grow_upwards(struct oo_broad *b, int at) {
    for (; at != NONE; at = b->nodes[at].parent)
        b->nodes[at].box = join(&b->nodes[b->nodes[at].children[0]].box, &b->nodes[b->nodes[at].children[1]].box);
}

/* Down to the place where the boxes on the way grow least. */
static int best_sibling(const struct oo_broad *b, const box *new) {
    int at = b->root;
    while (b->nodes[at].children[0] != NONE) {
        const node *n = &b->nodes[at];
        box whole = join(&n->box, new);
        float here = 2 * size_of_box(&whole), inherited = 2 * (size_of_box(&whole) - size_of_box(&n->box)), cost[2];
        for (int i = 0; i < 2; i++) {
            const node *child = &b->nodes[n->children[i]];
            box grown = join(&child->box, new);
            cost[i] = inherited + size_of_box(&grown) - (child->children[0] == NONE ? 0 : size_of_box(&child->box));
        }
        if (here < cost[0] && here < cost[1]) break;
        at = n->children[cost[1] < cost[0]];
    }
    return at;
}

static int plant(oo_world *w, unsigned int slot) {
    struct oo_broad *b = w->broad;
    int leaf = take_node(b), between = NONE;
    if (leaf != NONE && b->root != NONE) between = take_node(b);
    if (leaf == NONE || (b->root != NONE && between == NONE)) {
        if (leaf != NONE) give_node(b, leaf);
        w->out_of_memory = 1;
        return 0;
    }
    entry *e = &b->entries[slot];
    b->nodes[leaf] = (node){e->box, NONE, {NONE, (int)slot}};
    e->leaf = leaf;
    b->leaf_count++;
    b->changes++;
    if (b->root == NONE) {
        b->root = leaf;
        return 1;
    }
    int sibling = best_sibling(b, &e->box), parent = b->nodes[sibling].parent;
    b->nodes[between] = (node){e->box, parent, {sibling, leaf}};
    b->nodes[sibling].parent = b->nodes[leaf].parent = between;
    if (parent == NONE)
        b->root = between;
    else
        b->nodes[parent].children[b->nodes[parent].children[1] == sibling] = between;
    grow_upwards(b, between);
    return 1;
}

static void uproot(struct oo_broad *b, entry *e) {
    int leaf = e->leaf, parent = b->nodes[leaf].parent;
    e->leaf = NONE;
    b->leaf_count--;
    b->changes++;
    if (parent == NONE) {
        b->root = NONE;
    } else {
        int sibling = b->nodes[parent].children[b->nodes[parent].children[0] == leaf], above_it = b->nodes[parent].parent;
        b->nodes[sibling].parent = above_it;
        if (above_it == NONE)
            b->root = sibling;
        else
            b->nodes[above_it].children[b->nodes[above_it].children[1] == parent] = sibling;
        grow_upwards(b, above_it);
        give_node(b, parent);
    }
    give_node(b, leaf);
}

static float middle(const struct oo_broad *b, unsigned int slot, int axis) {
    const box *of = &b->entries[slot].box;
    return of->low[axis] + of->high[axis];
}

/* Put the lower half along an axis before the upper one (Hoare's selection). */
static void halve(const struct oo_broad *b, unsigned int *slots, int count, int axis) {
    for (int low = 0, high = count - 1; low < high;) {
        float pivot = middle(b, slots[(low + high) / 2], axis);
        int i = low, j = high;
        while (i <= j) {
            while (middle(b, slots[i], axis) < pivot) i++;
            while (middle(b, slots[j], axis) > pivot) j--;
            if (i > j) break;
            unsigned int slot = slots[i];
            slots[i++] = slots[j];
            slots[j--] = slot;
        }
        if (count / 2 <= j)
            high = j;
        else if (count / 2 >= i)
            low = i;
        else
            break;
    }
}

static int build(struct oo_broad *b, unsigned int *slots, unsigned int count, int parent) {
    int made = (int)b->node_count++;
    node *n = &b->nodes[made];
    *n = (node){b->entries[slots[0]].box, parent, {NONE, (int)slots[0]}};
    if (count == 1) {
        b->entries[slots[0]].leaf = made;
        return made;
    }
    for (unsigned int i = 1; i < count; i++) n->box = join(&n->box, &b->entries[slots[i]].box);
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (n->box.high[k] - n->box.low[k] > n->box.high[axis] - n->box.low[axis]) axis = k;
    halve(b, slots, (int)count, axis);
    n->children[0] = build(b, slots, count / 2, made);
    n->children[1] = build(b, slots + count / 2, count - count / 2, made);
    return made;
}

/* Leaves that come one by one make a lopsided tree, so after many of them it is built anew, from the top, by halves. */
static int rebuild(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (reserve(&b->hits, &b->hit_capacity, b->leaf_count, sizeof *b->hits)) return OO_NO_MEMORY;
    if (reserve(&b->nodes, &b->node_capacity, 2 * b->leaf_count, sizeof *b->nodes)) return OO_NO_MEMORY;
    unsigned int count = 0;
    for (unsigned int slot = 0; slot < w->geom_count; slot++)
        if (b->entries[slot].state == QUIET) b->hits[count++] = slot;
    b->node_count = 0;
    b->free_node = b->root = NONE;
    if (count) b->root = build(b, b->hits, count, NONE);
    b->changes = 0;
    return OO_OK;
}

static int by_number(const void *a, const void *b) {
    unsigned int x = *(const unsigned int *)a, y = *(const unsigned int *)b;
    return x < y ? -1 : x > y;
}

/* The next node that is neither above nor below: without a stack, since a tree may be of any depth. */
static int after(const struct oo_broad *b, int at) {
    int parent = b->nodes[at].parent;
    while (parent != NONE && b->nodes[parent].children[1] == at) {
        at = parent;
        parent = b->nodes[at].parent;
    }
    return parent == NONE ? NONE : b->nodes[parent].children[1];
}

/* The slots of the tree whose boxes a box meets, in order: into hits. */
static int find_quiet(oo_world *w, const box *wanted) {
    struct oo_broad *b = w->broad;
    b->hit_count = 0;
    if (b->root == NONE) return OO_OK;
    for (int at = b->root; at != NONE;) {
        const node *n = &b->nodes[at];
        if (overlap(&n->box, wanted)) {
            if (n->children[0] != NONE) {
                at = n->children[0];
                continue;
            }
            if (reserve(&b->hits, &b->hit_capacity, b->hit_count + 1, sizeof *b->hits)) return OO_NO_MEMORY;
            b->hits[b->hit_count++] = (unsigned int)n->children[1];
        }
        at = after(b, at);
    }
    if (b->hit_count > 1) qsort(b->hits, b->hit_count, sizeof *b->hits, by_number);
    return OO_OK;
}

/* ------------------------------------------------------------------ which spaces were told to collide */

static void mark_space(oo_world *w, dSpaceID space, unsigned int slot) {
    members m = {0};
    for (dSpaceID at = space; at; at = dGeomGetSpace((dGeomID)at)) {
        uint64_t bit = 1;
        for (unsigned int i = 0; i < w->pair_count; i++) {
            if (w->pairs[i].nested) continue;
            if (!w->pairs[i].other && w->pairs[i].space == at) m.inside |= bit;
            if (w->pairs[i].other && w->pairs[i].space == at) m.left |= bit;
            if (w->pairs[i].other && w->pairs[i].other == at) m.right |= bit;
            bit <<= 1;
        }
    }
    w->broad->spaces[slot] = m;
}

static int declared(const members *a, const members *b) {
    return ((a->inside & b->inside) | (a->left & b->right) | (a->right & b->left)) != 0;
}

/* ------------------------------------------------------------------ what has changed since the last step */

static int make_room(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b) {
        b = w->broad = calloc(1, sizeof *b);
        if (!b) return OO_NO_MEMORY;
        b->root = b->free_node = NONE;
    }
    unsigned int had = b->entry_capacity;
    if (reserve(&b->entries, &b->entry_capacity, w->geom_count, sizeof *b->entries)) return OO_NO_MEMORY;
    for (unsigned int i = had; i < b->entry_capacity; i++) b->entries[i] = (entry){.leaf = NONE, .state = OUT};
    if (reserve(&b->spaces, &b->space_capacity, w->geom_count, sizeof *b->spaces)) return OO_NO_MEMORY;
    if (reserve(&b->moving, &b->moving_capacity, w->geom_count, sizeof *b->moving)) return OO_NO_MEMORY;
    if (reserve(&b->huge, &b->huge_capacity, w->geom_count, sizeof *b->huge)) return OO_NO_MEMORY;
    if (reserve(&b->reached, &b->reached_capacity, w->body_count, sizeof *b->reached)) return OO_NO_MEMORY;
    return reserve(&b->queue, &b->queue_capacity, w->body_count, sizeof *b->queue);
}

/* A ray looks at all there is, wherever it stands. */
static int awake_geom(const oo_geom *geom) {
    if (geom->flags & OO_IS_RAY) return 1;
    dBodyID body = dGeomGetBody(geom->id);
    return body && dBodyIsEnabled(body);
}

/* Moving ones that were there before keep their places in the sorted list; new ones come behind. */
static int refresh(oo_world *w) {
    struct oo_broad *b = w->broad;
    for (unsigned int slot = 0; slot < w->geom_count; slot++)
        if ((w->geoms[slot].flags & (OO_ALIVE | OO_IS_SPACE)) == (OO_ALIVE | OO_IS_SPACE))
            mark_space(w, (dSpaceID)w->geoms[slot].id, slot);
    unsigned int kept = 0;
    for (unsigned int i = 0; i < b->moving_count; i++) {
        unsigned int slot = b->moving[i];
        const oo_geom *geom = &w->geoms[slot];
        entry *e = &b->entries[slot];
        dSpaceID space = geom->flags & OO_ALIVE && !(geom->flags & OO_IS_SPACE) ? dGeomGetSpace(geom->id) : NULL;
        if (e->state == MOVING && space && awake_geom(geom) && dGeomIsEnabled(geom->id))
            b->moving[kept++] = slot;
        else
            e->state = OUT; /* until it is looked at below */
    }
    b->moving_count = kept;
    b->huge_count = 0;
    b->sleepers = 0;
    for (unsigned int slot = 0; slot < w->geom_count; slot++) {
        const oo_geom *geom = &w->geoms[slot];
        entry *e = &b->entries[slot];
        dSpaceID space = (geom->flags & (OO_ALIVE | OO_IS_SPACE)) == OO_ALIVE ? dGeomGetSpace(geom->id) : NULL;
        if (!space || !dGeomIsEnabled(geom->id)) {
            if (e->leaf != NONE) uproot(b, e);
            e->state = OUT;
            continue;
        }
        e->members = b->spaces[(size_t)dGeomGetData((dGeomID)space)];
        box now = box_of(geom->id);
        int moving = awake_geom(geom), state = moving ? MOVING : is_huge(&now) ? HUGE_BOX : QUIET;
        if (!moving && dGeomGetBody(geom->id)) b->sleepers++;
        if (e->leaf != NONE && (state != QUIET || memcmp(&now, &e->box, sizeof now))) uproot(b, e);
        if (state == MOVING && e->state != MOVING) b->moving[b->moving_count++] = slot;
        e->box = now;
        e->state = (unsigned char)state;
        if (state == HUGE_BOX) b->huge[b->huge_count++] = slot;
        if (state == QUIET && e->leaf == NONE && !plant(w, slot)) return OO_NO_MEMORY;
    }
    return b->changes > b->leaf_count / 2 + 64 ? rebuild(w) : OO_OK;
}

/* ------------------------------------------------------------------ pairs */

static void try_pair(oo_world *w, unsigned int slot1, unsigned int slot2) {
    const struct oo_broad *b = w->broad;
    unsigned int first = slot1 < slot2 ? slot1 : slot2, second = slot1 < slot2 ? slot2 : slot1;
    if (declared(&b->entries[first].members, &b->entries[second].members)) meet_pair(w, first, second);
}

/* The axis along which the moving ones are spread most: along another most of them would overlap. */
static int widest_axis(const struct oo_broad *b) {
    double sum[3] = {0}, squares[3] = {0}, widest = -1;
    int axis = 0;
    for (unsigned int i = 0; i < b->moving_count; i++)
        for (int k = 0; k < 3; k++) {
            double m = middle(b, b->moving[i], k);
            sum[k] += m;
            squares[k] += m * m;
        }
    for (int k = 0; k < 3; k++) {
        double spread = squares[k] - sum[k] * sum[k] / b->moving_count;
        if (spread > widest) {
            widest = spread;
            axis = k;
        }
    }
    return axis;
}

static void sort_moving(struct oo_broad *b) {
    int axis = widest_axis(b);
    for (unsigned int i = 1; i < b->moving_count; i++) {
        unsigned int slot = b->moving[i], k = i;
        float low = b->entries[slot].box.low[axis];
        for (; k > 0; k--) {
            unsigned int before = b->moving[k - 1];
            float other = b->entries[before].box.low[axis];
            if (other < low || (other == low && before < slot)) break;
            b->moving[k] = before;
        }
        b->moving[k] = slot;
    }
    b->axis = axis;
}

static void sweep(oo_world *w) {
    struct oo_broad *b = w->broad;
    sort_moving(b);
    for (unsigned int i = 0; i < b->moving_count; i++) {
        const box *own = &b->entries[b->moving[i]].box;
        for (unsigned int k = i + 1; k < b->moving_count; k++) {
            const box *other = &b->entries[b->moving[k]].box;
            if (other->low[b->axis] > own->high[b->axis]) break;
            if (overlap(own, other)) try_pair(w, b->moving[i], b->moving[k]);
        }
    }
}

/* One geom against all that does not move. A pair of two sleepers that are both reached is tried from one side only. */
static int meet_quiet(oo_world *w, unsigned int slot, int but_reached) {
    struct oo_broad *b = w->broad;
    if (find_quiet(w, &b->entries[slot].box)) return OO_NO_MEMORY;
    for (unsigned int i = 0; i < b->hit_count + b->huge_count; i++) {
        unsigned int other = i < b->hit_count ? b->hits[i] : b->huge[i - b->hit_count];
        if (other == slot) continue;
        dBodyID body = dGeomGetBody(w->geoms[other].id);
        if (but_reached && body && b->reached[(size_t)dBodyGetData(body)] == 2) continue;
        try_pair(w, slot, other);
    }
    return OO_OK;
}

/* ------------------------------------------------------------------ sleepers that are about to be woken */

static void reach(oo_world *w, dBodyID body) {
    struct oo_broad *b = w->broad;
    if (!body || dBodyIsEnabled(body)) return;
    size_t index = (size_t)dBodyGetData(body);
    if (b->reached[index]) return;
    b->reached[index] = 1;
    b->queue[b->queue_count++] = (unsigned int)index;
}

static void reach_over_joints(oo_world *w, dBodyID body) {
    for (int i = 0; i < dBodyGetNumJoints(body); i++) {
        dJointID joint = dBodyGetJoint(body, i);
        if (!dJointIsEnabled(joint)) continue;
        reach(w, dJointGetBody(joint, 0));
        reach(w, dJointGetBody(joint, 1));
    }
}

static int flood(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b->sleepers) return OO_OK;
    memset(b->reached, 0, w->body_count);
    b->queue_count = 0;
    for (unsigned int i = 0; i < w->body_count; i++)
        if (dBodyIsEnabled(w->bodies[i].id)) reach_over_joints(w, w->bodies[i].id);
    unsigned int row = 0;
    for (unsigned int at = 0; at < b->queue_count || row < w->contact_count;) {
        if (row < w->contact_count) {
            const oo_contact *contact = &w->contacts[row++];
            if (!row_acts(w, contact)) continue;
            reach(w, dGeomGetBody(contact->geom.g1));
            reach(w, dGeomGetBody(contact->geom.g2));
            continue;
        }
        dBodyID body = w->bodies[b->queue[at]].id;
        reach_over_joints(w, body);
        for (dGeomID geom = dBodyGetFirstGeom(body); geom; geom = dBodyGetNextGeom(geom)) {
            unsigned int slot = (unsigned int)(size_t)dGeomGetData(geom);
            if (b->entries[slot].state != OUT && meet_quiet(w, slot, 1)) return OO_NO_MEMORY;
        }
        b->reached[b->queue[at++]] = 2;
    }
    return OO_OK;
}

static int is_reached(const oo_world *w, unsigned int slot) {
    dBodyID body = dGeomGetBody(w->geoms[slot].id);
    return body && w->broad->reached[(size_t)dBodyGetData(body)] == 2;
}

/* What somebody listens to is told that it still touches, though all of it sleeps. */
static int meet_listened(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b->sleepers) return OO_OK;
    for (unsigned int slot = 0; slot < w->geom_count; slot++) {
        const entry *e = &b->entries[slot];
        if (!(w->geoms[slot].flags & HEARD) || (e->state != QUIET && e->state != HUGE_BOX) || is_reached(w, slot)) continue;
        if (find_quiet(w, &e->box)) return OO_NO_MEMORY;
        for (unsigned int i = 0; i < b->hit_count + b->huge_count; i++) {
            unsigned int other = i < b->hit_count ? b->hits[i] : b->huge[i - b->hit_count];
            int done = other < slot && w->geoms[other].flags & HEARD;
            if (other != slot && !done && !is_reached(w, other)) try_pair(w, slot, other);
        }
    }
    return OO_OK;
}

int find_pairs(oo_world *w) {
    if (make_room(w) || refresh(w)) return OO_NO_MEMORY;
    struct oo_broad *b = w->broad;
    if (b->moving_count) sweep(w);
    for (unsigned int i = 0; i < b->moving_count; i++)
        if (meet_quiet(w, b->moving[i], 0)) return OO_NO_MEMORY;
    if (flood(w) || meet_listened(w)) return OO_NO_MEMORY;
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}

/* Sleepers touch what they lie on without a contact that says so. */
void wake_sleepers_on(oo_world *w, unsigned int slot) {
    struct oo_broad *b = w->broad;
    if (!b || slot >= b->entry_capacity || b->entries[slot].state == OUT || !b->sleepers) return;
    if (find_quiet(w, &b->entries[slot].box)) return;
    for (unsigned int i = 0; i < b->hit_count; i++) {
        const oo_geom *other = &w->geoms[b->hits[i]];
        dBodyID body = b->hits[i] != slot && other->flags & OO_ALIVE ? dGeomGetBody(other->id) : NULL;
        if (body && !dBodyIsEnabled(body) && geoms_touch(w, slot, b->hits[i])) dBodyEnable(body);
    }
}

void broad_free(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b) return;
    free(b->entries);
    free(b->spaces);
    free(b->moving);
    free(b->huge);
    free(b->hits);
    free(b->nodes);
    free(b->reached);
    free(b->queue);
    free(b);
}

/* ------------------------------------------------------------------ questions between steps */

enum { FEW = 4 }; /* questions for which no tree is worth its while */

int begin_queries(oo_world *w, unsigned int count) {
    if (make_room(w) || refresh(w)) return OO_NO_MEMORY;
    struct oo_broad *b = w->broad;
    if (reserve(&b->nodes, &b->node_capacity, b->node_count + 2 * b->moving_count + 2, sizeof *b->nodes)) return OO_NO_MEMORY;
    b->moving_root = NONE;
    b->node_count_before = b->node_count;
    if (b->moving_count && count > FEW) { /* in a tree of their own, for as long as questions are asked */
        sort_moving(b); /* the list is halved on the way, and is wanted in order again */
        b->moving_root = build(b, b->moving, b->moving_count, NONE);
    }
    return OO_OK;
}

void end_queries(oo_world *w) {
    struct oo_broad *b = w->broad;
    b->node_count = b->node_count_before;
    if (b->moving_root == NONE) return;
    for (unsigned int i = 0; i < b->moving_count; i++) b->entries[b->moving[i]].leaf = NONE;
}

static int meets_ray(const box *b, const ray *r) {
    double near = 0, far = r->length;
    for (int k = 0; k < 3; k++) {
        double one = (b->low[k] - r->origin[k]) * r->inverse[k], other = (b->high[k] - r->origin[k]) * r->inverse[k];
        if (one != one || other != other) { /* 0 * infinity: along a face, inside or not */
            if (r->origin[k] < b->low[k] || r->origin[k] > b->high[k]) return 0;
            continue;
        }
        near = fmax(near, fmin(one, other));
        far = fmin(far, fmax(one, other));
    }
    return near <= far;
}

static int meets_box(const box *b, const box *wanted) { return overlap(b, wanted); }

#define VISIT(root, meets, wanted)                                              \
    for (int at = (root); at != NONE;) {                                        \
        const node *n = &b->nodes[at];                                          \
        if (meets(&n->box, wanted)) {                                           \
            if (n->children[0] != NONE) {                                       \
                at = n->children[0];                                            \
                continue;                                                       \
            }                                                                   \
            visit(data, (unsigned int)n->children[1]);                          \
        }                                                                       \
        at = after(b, at);                                                      \
    }

void along_ray(oo_world *w, ray *r, void (*visit)(void *, unsigned int), void *data) {
    const struct oo_broad *b = w->broad;
    for (unsigned int i = 0; i < b->huge_count; i++) visit(data, b->huge[i]);
    VISIT(b->root, meets_ray, r)
    VISIT(b->moving_root, meets_ray, r)
    if (b->moving_root != NONE) return;
    for (unsigned int i = 0; i < b->moving_count; i++)
        if (meets_ray(&b->entries[b->moving[i]].box, r)) visit(data, b->moving[i]);
}

void in_box_of(oo_world *w, dGeomID geom, void (*visit)(void *, unsigned int), void *data) {
    const struct oo_broad *b = w->broad;
    box wanted = box_of(geom);
    for (unsigned int i = 0; i < b->huge_count; i++) visit(data, b->huge[i]);
    VISIT(b->root, meets_box, &wanted)
    VISIT(b->moving_root, meets_box, &wanted)
    if (b->moving_root != NONE) return;
    for (unsigned int i = 0; i < b->moving_count; i++)
        if (overlap(&b->entries[b->moving[i]].box, &wanted)) visit(data, b->moving[i]);
}

void near_way(oo_world *w, const double low[3], const double high[3], void (*visit)(void *, unsigned int), void *data) {
    const struct oo_broad *b = w->broad;
    box wanted;
    for (int k = 0; k < 3; k++) {
        wanted.low[k] = below(low[k]);
        wanted.high[k] = above(high[k]);
    }
    for (unsigned int i = 0; i < b->huge_count; i++) visit(data, b->huge[i]);
    VISIT(b->root, meets_box, &wanted)
    for (unsigned int i = 0; i < b->moving_count; i++) { /* they stand where they went to */
        unsigned int slot = b->moving[i];
        if (w->geoms[slot].flags & OO_IS_RAY) continue;
        const dReal *v = dBodyGetLinearVel(dGeomGetBody(w->geoms[slot].id));
        box way = b->entries[slot].box;
        for (int k = 0; k < 3; k++) {
            double back = v[k] * w->step_size;
            if (back > 0)
                way.low[k] = below(way.low[k] - back);
            else
                way.high[k] = above(way.high[k] - back);
        }
        if (overlap(&way, &wanted)) visit(data, slot);
    }
}

int pair_declared(const oo_world *w, unsigned int slot1, unsigned int slot2) {
    const struct oo_broad *b = w->broad;
    return w->declared_count > MOST_DECLARED || declared(&b->entries[slot1].members, &b->entries[slot2].members);
}
