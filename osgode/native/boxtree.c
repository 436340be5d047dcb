/* A tree of boxes that seldom change: the box of each node holds those below it. */

#include "broad.h"

void tree_start(box_tree *t) { *t = (box_tree){.root = NONE, .free = NONE}; }

/* ------------------------------------------------------------------ coming and going */

static box join(const box *a, const box *b) {
    box out;
    for (int k = 0; k < 3; k++) {
        out.low[k] = a->low[k] < b->low[k] ? a->low[k] : b->low[k];
        out.high[k] = a->high[k] > b->high[k] ? a->high[k] : b->high[k];
    }
    return out;
}

static double half_surface(const box *b) {
    double x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x * y + y * z + z * x;
}

static int take_node(box_tree *t) {
    int taken = t->free;
    if (taken != NONE) {
        t->free = t->nodes[taken].parent;
        return taken;
    }
    if (reserve(&t->nodes, &t->capacity, t->count + 1, sizeof *t->nodes)) return NONE;
    return (int)t->count++;
}

static void give_node(box_tree *t, int given) {
    t->nodes[given].parent = t->free;
    t->free = given;
}

static void fit_upwards(box_tree *t, int at) {
    for (; at != NONE; at = t->nodes[at].parent)
        t->nodes[at].box = join(&t->nodes[t->nodes[at].children[0]].box, &t->nodes[t->nodes[at].children[1]].box);
}

/* Down to the place where the boxes on the way grow least. */
static int best_sibling(const box_tree *t, const box *new) {
    int at = t->root;
    while (t->nodes[at].children[0] != NONE) {
        const node *n = &t->nodes[at];
        box whole = join(&n->box, new);
        double here = half_surface(&whole), inherited = here - half_surface(&n->box), cost[2];
        for (int i = 0; i < 2; i++) {
            const node *child = &t->nodes[n->children[i]];
            box grown = join(&child->box, new);
            cost[i] = inherited + half_surface(&grown) - (child->children[0] == NONE ? 0 : half_surface(&child->box));
        }
        if (here < cost[0] && here < cost[1]) break;
        at = n->children[cost[1] < cost[0]];
    }
    return at;
}

static void put_child(box_tree *t, int parent, int old, int new) {
    if (parent == NONE)
        t->root = new;
    else
        t->nodes[parent].children[t->nodes[parent].children[1] == old] = new;
}

int tree_plant(box_tree *t, const box *new, unsigned int slot) {
    int leaf = take_node(t), between = NONE;
    if (leaf != NONE && t->root != NONE) between = take_node(t);
    if (leaf == NONE || (t->root != NONE && between == NONE)) {
        if (leaf != NONE) give_node(t, leaf);
        return NONE;
    }
    t->nodes[leaf] = (node){*new, NONE, {NONE, (int)slot}};
    t->leaves++;
    t->changes++;
    if (t->root == NONE) {
        t->root = leaf;
        return leaf;
    }
    int sibling = best_sibling(t, new), parent = t->nodes[sibling].parent;
    t->nodes[between] = (node){*new, parent, {sibling, leaf}};
    t->nodes[sibling].parent = t->nodes[leaf].parent = between;
    put_child(t, parent, sibling, between);
    fit_upwards(t, between);
    return leaf;
}

void tree_uproot(box_tree *t, int leaf) {
    int parent = t->nodes[leaf].parent;
    t->leaves--;
    t->changes++;
    if (parent == NONE) {
        t->root = NONE;
    } else {
        int sibling = t->nodes[parent].children[t->nodes[parent].children[0] == leaf], above = t->nodes[parent].parent;
        t->nodes[sibling].parent = above;
        put_child(t, above, parent, sibling);
        fit_upwards(t, above);
        give_node(t, parent);
    }
    give_node(t, leaf);
}

/* ------------------------------------------------------------------ building it at once */

typedef struct leaf { box box; unsigned int slot; } leaf;

static double middle(const leaf *l, int axis) { return l->box.low[axis] + l->box.high[axis]; }

/* Put the lower half along an axis before the upper one (Hoare's selection). */
static void halve(leaf *leaves, int count, int axis) {
    for (int low = 0, high = count - 1; low < high;) {
        double pivot = middle(&leaves[(low + high) / 2], axis);
        int i = low, j = high;
        while (i <= j) {
            while (middle(&leaves[i], axis) < pivot) i++;
            while (middle(&leaves[j], axis) > pivot) j--;
            if (i > j) break;
            leaf moved = leaves[i];
            leaves[i++] = leaves[j];
            leaves[j--] = moved;
        }
        if (count / 2 <= j)
            high = j;
        else if (count / 2 >= i)
            low = i;
        else
            break;
    }
}

static int build(box_tree *t, leaf *leaves, int count, int parent) {
    int made = (int)t->count++;
    node *n = &t->nodes[made]; /* there is room for all */
    *n = (node){leaves[0].box, parent, {NONE, (int)leaves[0].slot}};
    if (count == 1) return made;
    for (int i = 1; i < count; i++) n->box = join(&n->box, &leaves[i].box);
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (n->box.high[k] - n->box.low[k] > n->box.high[axis] - n->box.low[axis]) axis = k;
    halve(leaves, count, axis);
    n->children[0] = build(t, leaves, count / 2, made);
    n->children[1] = build(t, leaves + count / 2, count - count / 2, made);
    return made;
}

/* Leaves that come one by one make a lopsided tree. */
int tree_is_worn(const box_tree *t) { return t->changes > t->leaves / 2 + 64; }

/* The next node that is neither above nor below: without a stack, since a tree may be of any depth. */
static int after(const box_tree *t, int at) {
    int parent = t->nodes[at].parent;
    while (parent != NONE && t->nodes[parent].children[1] == at) {
        at = parent;
        parent = t->nodes[at].parent;
    }
    return parent == NONE ? NONE : t->nodes[parent].children[1];
}

static int build_all(box_tree *t, leaf *leaves, unsigned int count) {
    if (reserve(&t->nodes, &t->capacity, 2 * (size_t)count, sizeof *t->nodes)) return OO_NO_MEMORY;
    t->count = t->changes = 0;
    t->leaves = count;
    t->free = NONE;
    t->root = count ? build(t, leaves, (int)count, NONE) : NONE;
    return OO_OK;
}

int tree_build(box_tree *t, unsigned int count, void (*box_of)(const void *, unsigned int slot, box *), const void *keeper) {
    leaf *leaves = malloc(count * sizeof *leaves);
    if (!leaves) return OO_NO_MEMORY;
    for (unsigned int i = 0; i < count; i++) {
        leaves[i].slot = i;
        box_of(keeper, i, &leaves[i].box);
    }
    int status = build_all(t, leaves, count);
    free(leaves);
    return status;
}

int tree_rebuild(box_tree *t, int *(*leaf_of)(void *, unsigned int slot), void *keeper) {
    leaf *leaves = malloc((t->leaves + 1) * sizeof *leaves);
    if (!leaves) return OO_NO_MEMORY;
    unsigned int found = 0;
    for (int at = t->root; at != NONE;) {
        const node *n = &t->nodes[at];
        if (n->children[0] != NONE) {
            at = n->children[0];
            continue;
        }
        leaves[found++] = (leaf){n->box, (unsigned int)n->children[1]};
        at = after(t, at);
    }
    int status = build_all(t, leaves, found);
    free(leaves);
    for (unsigned int i = 0; !status && i < t->count; i++)
        if (t->nodes[i].children[0] == NONE) *leaf_of(keeper, (unsigned int)t->nodes[i].children[1]) = (int)i;
    return status;
}

/* Where `at` and all below it end. */
static int flatten(const box_tree *t, int at, twig *out, int next) {
    const node *n = &t->nodes[at];
    int here = next++, leaf = n->children[0] == NONE;
    for (int k = 0; k < 3; k++) {
        out[here].low[k] = float_below(n->box.low[k]);
        out[here].high[k] = float_above(n->box.high[k]);
    }
    for (int i = 0; i < 2 && !leaf; i++) next = flatten(t, n->children[i], out, next);
    out[here].next = next;
    out[here].slot = leaf ? n->children[1] : NONE;
    return next;
}

void tree_flatten(const box_tree *t, twig *out) {
    if (t->root != NONE) flatten(t, t->root, out, 0);
}

/* ------------------------------------------------------------------ finding */

static int by_number(const void *a, const void *b) {
    unsigned int x = *(const unsigned int *)a, y = *(const unsigned int *)b;
    return x < y ? -1 : x > y;
}

int tree_find(const box_tree *t, const box *wanted, slots *hits) {
    hits->count = 0;
    for (int at = t->root; at != NONE;) {
        const node *n = &t->nodes[at];
        if (overlap(&n->box, wanted)) {
            if (n->children[0] != NONE) {
                at = n->children[0];
                continue;
            }
            if (put_slot(hits, (unsigned int)n->children[1])) return OO_NO_MEMORY;
        }
        at = after(t, at);
    }
    if (hits->count > 1) qsort(hits->at, hits->count, sizeof *hits->at, by_number);
    return OO_OK;
}

void tree_visit(const box_tree *t, int (*meets)(const box *, const void *), const void *wanted,
                void (*visit)(void *, unsigned int), void *data) {
    for (int at = t->root; at != NONE;) {
        const node *n = &t->nodes[at];
        if (meets(&n->box, wanted)) {
            if (n->children[0] != NONE) {
                at = n->children[0];
                continue;
            }
            visit(data, (unsigned int)n->children[1]);
        }
        at = after(t, at);
    }
}

void tree_clear(box_tree *t) {
    t->count = t->leaves = t->changes = 0;
    t->root = t->free = NONE;
}
