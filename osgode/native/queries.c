/* Questions to a World between its steps: what a ray hits, what a shape overlaps. */

#include "shapes.h"

typedef struct asked {
    oo_world *world;
    const oo_query *query;
    const oo_geom *geom; /* the ray or the shape */
    unsigned int own;
    ray *ray;
    const double *row; /* what the ray was made from */
    oo_hit *nearest; /* or NULL: keep all */
} asked;

static int compare_numbers(const void *a, const void *b) {
    unsigned int x = *(const unsigned int *)a, y = *(const unsigned int *)b;
    return x < y ? -1 : x > y;
}

static int wanted(const asked *a, unsigned int slot) {
    const oo_query *q = a->query;
    const oo_geom *geom = &a->world->geoms[slot];
    if (slot == a->own || geom->flags & OO_IS_RAY || !(geom->category & q->kinds)) return 0;
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

/* ODE loses rays that leave a capsule nearly along its axis, so these are ours. A capsule is convex: where a line is in it
   is one span, that of its two balls and the cylinder between them together. */
static int meet_capsule(const asked *a, dGeomID capsule, dContactGeom *out) {
    const ray *r = a->ray;
    const dReal *at = dGeomGetPosition(capsule), *turn = dGeomGetRotation(capsule);
    dReal radius, length;
    dGeomCapsuleGetParams(capsule, &radius, &length);
    double axis[3] = {turn[2], turn[6], turn[10]}, from[3], low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 3; k++) from[k] = r->origin[k] - at[k];
    double along = dot(from, axis), rate = dot(r->direction, axis), half = length / 2;
    double b = dot(from, r->direction), c = dot(from, from) - radius * radius;
    for (int end = -1; end <= 1; end += 2) { /* |from + t direction - end half axis| = radius */
        double b_end = b - end * half * rate, c_end = c - 2 * end * half * along + half * half;
        double under = b_end * b_end - c_end;
        if (under <= 0) continue;
        low = fmin(low, -b_end - sqrt(under));
        high = fmax(high, -b_end + sqrt(under));
    }
    double across = 1 - rate * rate, b_across = b - along * rate, c_across = c - along * along;
    double under = b_across * b_across - across * c_across, first = -INFINITY, last = INFINITY;
    if (across > 1e-12) {
        first = under > 0 ? (-b_across - sqrt(under)) / across : INFINITY;
        last = under > 0 ? (-b_across + sqrt(under)) / across : -INFINITY;
    } else if (c_across >= 0) {
        first = INFINITY;
    }
    if (rate != 0) {
        double one = (-half - along) / rate, other = (half - along) / rate;
        first = fmax(first, fmin(one, other));
        last = fmin(last, fmax(one, other));
    } else if (fabs(along) > half) {
        first = INFINITY;
    }
    if (first < last) {
        low = fmin(low, first);
        high = fmax(high, last);
    }
    double t = low >= 0 ? low : high;
    if (!(low < high) || t < 0 || t > a->row[6]) return 0;
    double on_axis = fmax(-half, fmin(half, along + t * rate));
    out->depth = t;
    for (int k = 0; k < 3; k++) {
        out->pos[k] = r->origin[k] + t * r->direction[k];
        out->normal[k] = (from[k] + t * r->direction[k] - on_axis * axis[k]) / radius;
    }
    return 1;
}

static int meet_ray(const asked *a, const oo_geom *geom, dContactGeom *out) {
    if (dGeomGetClass(geom->id) == dCapsuleClass) return meet_capsule(a, geom->id, out);
    return collide_pair(a->geom, geom, 1, out, sizeof *out);
}

static void try_ray(void *data, unsigned int slot) {
    asked *a = data;
    dContactGeom contact;
    if (!wanted(a, slot) || !meet_ray(a, &a->world->geoms[slot], &contact)) return;
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
        oo_geom ray_geom = {.id = geom, .flags = OO_IS_RAY};
        dGeomRaySetClosestHit(geom, 1);
        lock_meshes(1);
        for (unsigned int i = 0; i < count; i++) {
            const double *row = rays + 7 * i;
            ray r = follow(row);
            dGeomRaySetLength(geom, row[6]);
            dGeomRaySet(geom, row[0], row[1], row[2], row[3], row[4], row[5]);
            if (out) out[i] = (oo_hit){.slot = -1};
            asked a = {w, query, &ray_geom, ~0u, &r, row, out ? &out[i] : NULL};
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
    int found = collide_pair(a->geom, &w->geoms[slot], 64, contacts, sizeof *contacts), deepest = -1;
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
        asked a = {w, query, &w->geoms[slot], slot, NULL, NULL, NULL};
        in_box_of(w, a.geom->id, try_overlap, &a);
        end_queries(w);
        if (w->out_of_memory) status = OO_NO_MEMORY;
    }
    guard_leave();
    if (status != OO_OK) return status;
    if (w->hit_count) qsort(w->hits, w->hit_count, sizeof *w->hits, by_slot);
    return (int)w->hit_count;
}

/* A plane is, but it has no farthest point. */
static int is_convex(const oo_geom *geom) { return dGeomGetClass(geom->id) != dPlaneClass && !(geom->flags & OO_IS_RAY); }

static int wanted_slot(void *data, unsigned int slot) { return wanted(data, slot); }

int oo_sweep(oo_world *w, const oo_query *query, unsigned int slot, const double motion[3], oo_hit *out) {
    shape s;
    w->out_of_memory = 0;
    int convex = is_convex(&w->geoms[slot]) ? shape_of(&w->geoms[slot], &s) : 0;
    if (convex != 1) return convex ? convex : OO_BAD_BODY;
    int status = begin_queries(w, 1);
    if (status == OO_OK) {
        asked a = {w, query, &w->geoms[slot], slot, NULL, NULL, NULL};
        unsigned int touched = 0;
        *out = (oo_hit){.slot = -1};
        out->distance = follow_shape(w, &s, motion, wanted_slot, &a, &touched, out->normal);
        if (out->distance <= 1) out->slot = (int)touched;
        end_queries(w);
        status = w->out_of_memory ? OO_NO_MEMORY : out->slot >= 0;
    }
    shape_done(&s);
    return status;
}

int oo_closest(oo_world *w, unsigned int slot1, unsigned int slot2, double out[7]) {
    shape a, b;
    int convex = is_convex(&w->geoms[slot1]) ? shape_of(&w->geoms[slot1], &a) : 0;
    if (convex != 1) return convex ? convex : OO_BAD_BODY;
    int status = w->geoms[slot2].flags & OO_IS_RAY ? OO_BAD_BODY : shape_of(&w->geoms[slot2], &b);
    if (status == 1) {
        out[6] = closest_points(&a, &b, out, out + 3);
        shape_done(&b);
        status = OO_OK;
    } else if (status == 0) {
        status = nearest_on_surface(&a, &w->geoms[slot2], &out[6], out, out + 3);
    }
    shape_done(&a);
    return status;
}
