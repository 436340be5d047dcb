/* Questions to a World between its steps: what a ray hits, what a shape overlaps. */

#include "internal.h"

typedef struct asked {
    oo_world *world;
    const oo_query *query;
    dGeomID geom; /* the ray or the shape */
    unsigned int own;
    ray *ray;
    oo_hit *nearest; /* or NULL: keep all */
} asked;

static int compare_numbers(const void *a, const void *b) {
    unsigned int x = *(const unsigned int *)a, y = *(const unsigned int *)b;
    return x < y ? -1 : x > y;
}

static int wanted(const asked *a, unsigned int slot) {
    const oo_query *q = a->query;
    const oo_geom *geom = &a->world->geoms[slot];
    if (slot == a->own || !(geom->category & q->kinds)) return 0;
    if (q->excluded_count && bsearch(&slot, q->excluded, q->excluded_count, sizeof slot, compare_numbers)) return 0;
    if (!q->space) return 1;
    for (dSpaceID at = dGeomGetSpace(geom->id); at; at = dGeomGetSpace((dGeomID)at))
        if (at == q->space) return 1;
    return 0;
}

static oo_hit hit_of(unsigned int slot, const dContactGeom *c, double sign) {
    oo_hit hit = {.slot = (int)slot, .distance = c->depth};
    for (int k = 0; k < 3; k++) {
        hit.point[k] = c->pos[k];
        hit.normal[k] = sign * c->normal[k];
    }
    return hit;
}

static void keep_hit(oo_world *w, oo_hit hit) {
    if (reserve(&w->hits, &w->hit_capacity, w->hit_count + 1, sizeof *w->hits)) {
        w->out_of_memory = 1;
        return;
    }
    w->hits[w->hit_count++] = hit;
}

/* Boxes are tested a little farther than the geoms in them, lest rounding decide. */
static double reaching(double length) { return length * (1 + 1e-9) + 1e-9; }

static void try_ray(void *data, unsigned int slot) {
    asked *a = data;
    dContactGeom contact;
    if (!wanted(a, slot) || !dCollide(a->geom, a->world->geoms[slot].id, 1, &contact, sizeof contact)) return;
    if (!usable(&contact)) return;
    oo_hit hit = hit_of(slot, &contact, dot(contact.normal, a->ray->direction) > 0 ? -1 : 1);
    if (!a->nearest) {
        keep_hit(a->world, hit);
        return;
    }
    int nearer = a->nearest->slot < 0 || hit.distance < a->nearest->distance;
    if (nearer || (hit.distance == a->nearest->distance && hit.slot < a->nearest->slot)) *a->nearest = hit;
    a->ray->length = fmin(a->ray->length, reaching(hit.distance)); /* what begins farther away needs no look */
}

static ray follow(const double *row) {
    ray r = {.length = reaching(row[6])};
    for (int k = 0; k < 3; k++) {
        r.origin[k] = row[k];
        r.direction[k] = row[3 + k];
        r.inverse[k] = 1 / row[3 + k];
    }
    return r;
}

/* Ray by ray; the lock of the meshes is held for all of them. */
static int cast(oo_world *w, const oo_query *query, const double *rays, unsigned int count, oo_hit *out) {
    w->hit_count = 0;
    w->out_of_memory = 0;
    volatile int begun = 0;
    if (guard_enter()) {
        lock_meshes(0);
        if (begun) end_queries(w);
        return OO_ASSERT;
    }
    int status = begin_queries(w, count);
    begun = status == OO_OK;
    if (begun) {
        dGeomID geom = dCreateRay(0, 1);
        dGeomRaySetClosestHit(geom, 1);
        lock_meshes(1);
        for (unsigned int i = 0; i < count; i++) {
            const double *row = rays + 7 * i;
            ray r = follow(row);
            dGeomRaySetLength(geom, row[6]);
            dGeomRaySet(geom, row[0], row[1], row[2], row[3], row[4], row[5]);
            if (out) out[i] = (oo_hit){.slot = -1};
            asked a = {w, query, geom, ~0u, &r, out ? &out[i] : NULL};
            along_ray(w, &r, try_ray, &a);
        }
        lock_meshes(0);
        dGeomDestroy(geom);
        end_queries(w);
        if (w->out_of_memory) status = OO_NO_MEMORY;
    }
    guard_leave();
    return status;
}

int oo_cast_rays(oo_world *w, const oo_query *query, const double *rays, unsigned int count, oo_hit *out) {
    return cast(w, query, rays, count, out);
}

static int by_distance(const void *a, const void *b) {
    const oo_hit *x = a, *y = b;
    if (x->distance != y->distance) return x->distance < y->distance ? -1 : 1;
    return x->slot - y->slot;
}

int oo_cast_ray_through(oo_world *w, const oo_query *query, const double row[7]) {
    int status = cast(w, query, row, 1, NULL);
    if (status != OO_OK) return status;
    if (w->hit_count) qsort(w->hits, w->hit_count, sizeof *w->hits, by_distance);
    return (int)w->hit_count;
}

static void try_overlap(void *data, unsigned int slot) {
    asked *a = data;
    oo_world *w = a->world;
    if (!wanted(a, slot)) return;
    dContactGeom contacts[64];
    lock_meshes(((w->geoms[slot].flags | w->geoms[a->own].flags) & OO_IS_MESH) != 0);
    int found = dCollide(a->geom, w->geoms[slot].id, 64, contacts, sizeof *contacts), deepest = -1;
    lock_meshes(0);
    for (int i = 0; i < found; i++)
        if (usable(&contacts[i]) && (deepest < 0 || contacts[i].depth > contacts[deepest].depth)) deepest = i;
    if (deepest >= 0) keep_hit(w, hit_of(slot, &contacts[deepest], 1));
}

static int by_slot(const void *a, const void *b) { return ((const oo_hit *)a)->slot - ((const oo_hit *)b)->slot; }

int oo_find_overlaps(oo_world *w, const oo_query *query, unsigned int slot) {
    w->hit_count = 0;
    w->out_of_memory = 0;
    volatile int begun = 0;
    if (guard_enter()) {
        lock_meshes(0);
        if (begun) end_queries(w);
        return OO_ASSERT;
    }
    int status = begin_queries(w, 1);
    begun = status == OO_OK;
    if (begun) {
        asked a = {w, query, w->geoms[slot].id, slot, NULL, NULL};
        in_box_of(w, a.geom, try_overlap, &a);
        end_queries(w);
        if (w->out_of_memory) status = OO_NO_MEMORY;
    }
    guard_leave();
    if (status != OO_OK) return status;
    if (w->hit_count) qsort(w->hits, w->hit_count, sizeof *w->hits, by_slot);
    return (int)w->hit_count;
}
