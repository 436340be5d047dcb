/* What the broad phase and its tree of boxes share. */

#ifndef OSGODE_BROAD_H
#define OSGODE_BROAD_H

#include <stdint.h>

#include "internal.h"

enum { NONE = -1 };

typedef struct box { double low[3], high[3]; } box;

static inline box box_around(dGeomID geom) {
    dReal aabb[6];
    dGeomGetAABB(geom, aabb);
    return (box){{aabb[0], aabb[2], aabb[4]}, {aabb[1], aabb[3], aabb[5]}};
}

static inline int overlap(const box *a, const box *b) {
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] && b->low[1] <= a->high[1] &&
           a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static inline int meets_box(const box *b, const void *wanted) { return overlap(b, wanted); }

typedef struct slots { unsigned int *at, count, capacity; } slots;

static inline int put_slot(slots *s, unsigned int slot) {
    if (reserve(&s->at, &s->capacity, s->count + 1, sizeof *s->at)) return OO_NO_MEMORY;
    s->at[s->count++] = slot;
    return OO_OK;
}

typedef struct node {
    box box;
    int parent, children[2]; /* of a leaf: NONE and the slot */
} node;

/* Boxes by slot. It holds as many as it was given, wherever they are; finding is quick where they lie apart. */
typedef struct box_tree {
    node *nodes;
    unsigned int count, capacity;
    int root, free;
    unsigned int leaves, changes; /* since it was built */
} box_tree;

HIDDEN void tree_start(box_tree *);
/* The new leaf, or NONE if memory is out. */
HIDDEN int tree_plant(box_tree *, const box *, unsigned int slot);
HIDDEN void tree_uproot(box_tree *, int leaf);
/* Whether it has been changed so much that it is worth building anew. */
HIDDEN int tree_is_worn(const box_tree *);
/* Built at once of slots 0 to count. */
HIDDEN int tree_build(box_tree *, unsigned int count, void (*box_of)(const void *, unsigned int slot, box *), const void *);
/* Built anew of all its leaves, which get other numbers; leaf_of tells where the number of a slot's leaf is kept. */
HIDDEN int tree_rebuild(box_tree *, int *(*leaf_of)(void *, unsigned int slot), void *);
/* The slots whose boxes meet a box, in their order. */
HIDDEN int tree_find(const box_tree *, const box *, slots *);
/* Visit the slots whose boxes meet what is wanted, which may shrink on the way. */
HIDDEN void tree_visit(const box_tree *, int (*meets)(const box *, const void *), const void *wanted,
                       void (*visit)(void *, unsigned int slot), void *data);
HIDDEN void tree_clear(box_tree *);

/* A node of a tree that will not change any more. All below one follow it, up to `next`: no way back is needed. */
typedef struct twig {
    float low[3], high[3]; /* rounded outwards */
    int next, slot;        /* NONE: it is no leaf */
} twig;

static inline float float_below(double x) {
    float f = (float)x;
    return f > x ? nextafterf(f, -INFINITY) : f;
}
static inline float float_above(double x) { return -float_below(-x); }

/* In as many twigs as the tree has nodes. */
HIDDEN void tree_flatten(const box_tree *, twig *);

enum { OUT, QUIET, MOVING, HUGE_BOX }; /* HUGE_BOX: quiet, and not worth a place in the tree, as planes are */

typedef struct entry {
    box box;
    unsigned int space; /* the slot of the space that it is in */
    int leaf;           /* in the tree */
    unsigned char state;
} entry;

typedef struct members { uint64_t inside, left, right; } members; /* a bit for each declared pair of spaces */

typedef struct mover {
    double low;
    unsigned int slot;
} mover;

/* Across the axis of the list: both lower sides, then both upper ones with their signs turned. */
typedef struct cross_section { float sides[4]; } cross_section;

struct oo_broad {
    entry *entries; /* by slot */
    unsigned int entry_capacity;
    members *spaces; /* by slot */
    unsigned int space_capacity;

    mover *movers;
    unsigned int mover_count, mover_capacity, unsorted; /* the last ones are new in the list */
    int axis;
    cross_section *sections; /* of the movers, in their order */
    unsigned int section_capacity;

    box_tree tree;
    slots huge, heard, hits;
    box_tree mover_tree; /* for as long as questions are asked */

    unsigned char *reached; /* by body: woken by what is awake, in this step */
    unsigned int reached_capacity;
    slots queue;
    unsigned char *asleep; /* by body, when it was looked at last */
    unsigned int asleep_capacity, sleepers;
    int current; /* it saw the last step */
};

/* What has changed since it looked last. */
HIDDEN int broad_update(oo_world *);
/* The pairs among what moves. */
HIDDEN void meet_movers(oo_world *);
/* Contacts of two geoms whose boxes meet, if their spaces were told to collide. */
HIDDEN void try_pair(oo_world *, unsigned int slot1, unsigned int slot2);
/* Whether the spaces that two geoms stand in were told to collide. */
static inline int broad_declares(const struct oo_broad *b, unsigned int slot1, unsigned int slot2) {
    const members *m = &b->spaces[b->entries[slot1].space], *n = &b->spaces[b->entries[slot2].space];
    return ((m->inside & n->inside) | (m->left & n->right) | (m->right & n->left)) != 0;
}

#endif
