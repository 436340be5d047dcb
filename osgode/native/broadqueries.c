/* What is where, asked of the broad phase: between steps, and of what has just moved. */

#include "broad.h"

enum { FEW = 4 }; /* questions for which no tree is worth its while */

int begin_queries(oo_world *w, unsigned int count) {
    if (broad_update(w)) return OO_NO_MEMORY;
    struct oo_broad *b = w->broad;
    for (unsigned int i = 0; i < b->mover_count && count > FEW; i++) {
        unsigned int slot = b->movers[i].slot;
        if (tree_plant(&b->mover_tree, &b->entries[slot].box, slot) == NONE) {
            end_queries(w);
            return OO_NO_MEMORY;
        }
    }
    return OO_OK;
}

void end_queries(oo_world *w) { tree_clear(&w->broad->mover_tree); }

static int meets_ray(const box *b, const void *wanted) {
    const ray *r = wanted;
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

static void visit_all(const struct oo_broad *b, int (*meets)(const box *, const void *), const void *wanted,
                      void (*visit)(void *, unsigned int), void *data) {
    for (unsigned int i = 0; i < b->huge.count; i++) visit(data, b->huge.at[i]);
    tree_visit(&b->tree, meets, wanted, visit, data);
    tree_visit(&b->mover_tree, meets, wanted, visit, data);
    if (b->mover_tree.root != NONE) return;
    for (unsigned int i = 0; i < b->mover_count; i++)
        if (meets(&b->entries[b->movers[i].slot].box, wanted)) visit(data, b->movers[i].slot);
}

void along_ray(oo_world *w, ray *r, void (*visit)(void *, unsigned int), void *data) {
    visit_all(w->broad, meets_ray, r, visit, data);
}

void in_box_of(oo_world *w, dGeomID geom, void (*visit)(void *, unsigned int), void *data) {
    box wanted = box_around(geom);
    visit_all(w->broad, meets_box, &wanted, visit, data);
}

void in_box(oo_world *w, const double low[3], const double high[3], void (*visit)(void *, unsigned int), void *data) {
    box wanted = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    visit_all(w->broad, meets_box, &wanted, visit, data);
}

void near_way(oo_world *w, const double low[3], const double high[3], void (*visit)(void *, unsigned int), void *data) {
    const struct oo_broad *b = w->broad;
    box wanted = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    for (unsigned int i = 0; i < b->huge.count; i++) visit(data, b->huge.at[i]);
    tree_visit(&b->tree, meets_box, &wanted, visit, data);
    for (unsigned int i = 0; i < b->mover_count; i++) { /* they stand where they went to */
        unsigned int slot = b->movers[i].slot;
        if (w->geoms[slot].flags & OO_IS_RAY) continue;
        const oo_body *body = &w->bodies[(size_t)dBodyGetData(dGeomGetBody(w->geoms[slot].id))];
        box way = b->entries[slot].box;
        for (int k = 0; k < 3; k++) { /* or where they were stopped, which the boxes don't know */
            double start = -body->way[k], stop = body->moved[k] - body->way[k];
            way.low[k] += fmin(fmin(start, stop), 0);
            way.high[k] += fmax(fmax(start, stop), 0);
        }
        if (overlap(&way, &wanted)) visit(data, slot);
    }
}

static int is_within(const oo_world *w, unsigned int slot, dSpaceID space) {
    dSpaceID at = dGeomGetSpace(w->geoms[slot].id);
    while (at && at != space) at = dGeomGetSpace((dGeomID)at);
    return at != NULL;
}

int pair_declared(const oo_world *w, unsigned int slot1, unsigned int slot2) {
    if (w->declared_count <= MOST_DECLARED) return broad_declares(w->broad, slot1, slot2);
    for (unsigned int i = 0; i < w->declared_count; i++) {
        dSpaceID space = w->declared[i].space, other = w->declared[i].other ? w->declared[i].other : space;
        if (is_within(w, slot1, space) && is_within(w, slot2, other)) return 1;
        if (is_within(w, slot2, space) && is_within(w, slot1, other)) return 1;
    }
    return 0;
}
