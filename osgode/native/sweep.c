/* Fast bodies, which would be through a thin wall between one step and the next.

   After a step each flagged body that went farther than half of its thinnest part is followed along its way. Where it
   first touches something it is put there, a little into it, with the velocity that it has: the next step finds the
   contact, and the usual response follows. Turning on the way is left out. */

#include "shapes.h"

#define LITTLE 0.01     /* of the thinnest part: how far it is put into what it hits */
#define AT_MOST 1e-3

typedef struct follower {
    oo_world *world;
    dBodyID body;
    unsigned int slot;      /* of the geom that is followed */
    shape shape;            /* where it was */
    double motion[3], gap;
    double touch;           /* the nearest so far */
    double normal[3];
    double low[3], high[3]; /* of all of its way */
} follower;

static void displacement(const oo_world *w, dBodyID body, double *out) {
    memset(out, 0, 3 * sizeof *out);
    if (!body || !dBodyIsEnabled(body)) return;
    const dReal *v = dBodyGetLinearVel(body);
    const oo_body *own = &w->bodies[(size_t)dBodyGetData(body)];
    for (int k = 0; k < 3; k++) out[k] = v[k] * w->step_size * own->kept; /* less where it was stopped on its way */
}

/* 0 if it is no convex shape. */
static int describe(dGeomID geom, shape *s) {
    memset(s, 0, sizeof *s);
    if (dGeomGetClass(geom) == dPlaneClass) {
        dVector4 plane;
        dGeomPlaneGetParams(geom, plane);
        memcpy(s->half, plane, sizeof s->half);
        s->position[0] = plane[3];
        s->kind = SHAPE_PLANE;
        return 1;
    }
    memcpy(s->position, dGeomGetPosition(geom), sizeof s->position);
    memcpy(s->rotation, dGeomGetRotation(geom), sizeof s->rotation);
    dReal radius, length;
    switch (dGeomGetClass(geom)) {
        case dSphereClass:
            s->kind = SHAPE_SEGMENT;
            s->margin = dGeomSphereGetRadius(geom);
            return 1;
        case dCapsuleClass:
            dGeomCapsuleGetParams(geom, &radius, &length);
            s->kind = SHAPE_SEGMENT;
            s->half[2] = length / 2;
            s->margin = radius;
            return 1;
        case dBoxClass: {
            dVector3 size;
            dGeomBoxGetLengths(geom, size);
            for (int k = 0; k < 3; k++) s->half[k] = size[k] / 2;
            s->kind = SHAPE_BOX;
            return 1;
        }
        case dCylinderClass:
            dGeomCylinderGetParams(geom, &radius, &length);
            s->half[0] = radius;
            s->half[2] = length / 2;
            s->kind = SHAPE_CYLINDER;
            return 1;
    }
    return 0;
}

/* A ball about a mesh or hull that moves. */
static void bounding_ball(dGeomID geom, shape *s) {
    dReal box[6];
    dGeomGetAABB(geom, box);
    double squares = 0;
    for (int k = 0; k < 3; k++) {
        s->position[k] = (box[2 * k] + box[2 * k + 1]) / 2;
        squares += (box[2 * k + 1] - box[2 * k]) * (box[2 * k + 1] - box[2 * k]) / 4;
        s->rotation[5 * k] = 1;
    }
    s->kind = SHAPE_SEGMENT;
    s->margin = sqrt(squares);
}

static void try_shape(follower *f, const shape *other, const double *motion) {
    double normal[3], t = first_touch(&f->shape, motion, other, f->gap, normal);
    if (t >= f->touch) return;
    f->touch = t;
    memcpy(f->normal, normal, sizeof normal);
}

typedef struct triangle_visit {
    follower *follower;
    dGeomID mesh;
    const double *shift; /* back to where it was */
    const double *motion;
} triangle_visit;

static void try_triangle(void *data, const double *corners[3]) {
    const triangle_visit *v = data;
    double points[9];
    const dReal *p = dGeomGetPosition(v->mesh), *r = dGeomGetRotation(v->mesh);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            points[3 * c + k] = p[k] - v->shift[k] + r[4 * k] * corners[c][0] + r[4 * k + 1] * corners[c][1] + r[4 * k + 2] * corners[c][2];
    shape triangle = {.kind = SHAPE_POINTS, .points = points, .count = 3};
    memcpy(triangle.position, points, sizeof triangle.position);
    try_shape(v->follower, &triangle, v->motion);
}

/* The box of the way, as the mesh sees it. */
static int try_mesh(follower *f, const oo_geom *geom, const double *shift, const double *motion) {
    const dReal *p = dGeomGetPosition(geom->id), *r = dGeomGetRotation(geom->id);
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        double middle = 0, reach = 0;
        for (int j = 0; j < 3; j++) {
            middle += r[4 * j + k] * ((f->low[j] + f->high[j]) / 2 - p[j] + shift[j]);
            reach += fabs(r[4 * j + k]) * ((f->high[j] - f->low[j]) / 2 + fabs(shift[j]));
        }
        low[k] = middle - reach;
        high[k] = middle + reach;
    }
    triangle_visit visit = {f, geom->id, shift, motion};
    return triangles_in(geom->mesh, low, high, try_triangle, &visit);
}

static int can_stop(const oo_world *w, const follower *f, const oo_geom *other) {
    const oo_geom *own = &w->geoms[f->slot];
    dBodyID body = dGeomGetBody(other->id);
    if (body == f->body || (own->flags | other->flags) & OO_SENSOR) return 0;
    if (!(own->category & other->collide) || !(other->category & own->collide)) return 0;
    return !body || !dAreConnectedExcluding(f->body, body, dJointTypeContact);
}

static void try_geom(void *data, unsigned int slot) {
    follower *f = data;
    const oo_geom *geom = &f->world->geoms[slot];
    if (!can_stop(f->world, f, geom) || !pair_declared(f->world, f->slot, slot)) return;
    double shift[3], motion[3];
    displacement(f->world, dGeomGetBody(geom->id), shift);
    for (int k = 0; k < 3; k++) motion[k] = f->motion[k] - shift[k];
    if (geom->mesh) {
        if (try_mesh(f, geom, shift, motion)) f->world->out_of_memory = 1;
        return;
    }
    shape other;
    if (!describe(geom->id, &other)) return;
    if (other.kind != SHAPE_PLANE)
        for (int k = 0; k < 3; k++) other.position[k] -= shift[k];
    try_shape(f, &other, motion);
}

static void follow_geom(follower *f, dGeomID geom, int as_point) {
    dReal box[6];
    dGeomGetAABB(geom, box);
    if (as_point) {
        const dReal *p = dBodyGetPosition(f->body);
        memset(&f->shape, 0, sizeof f->shape);
        for (int k = 0; k < 3; k++) box[2 * k] = box[2 * k + 1] = f->shape.position[k] = p[k];
        for (int k = 0; k < 3; k++) f->shape.rotation[5 * k] = 1;
        f->shape.kind = SHAPE_SEGMENT;
    } else if (!describe(geom, &f->shape)) {
        bounding_ball(geom, &f->shape);
        for (int k = 0; k < 3; k++) {
            box[2 * k] = f->shape.position[k] - f->shape.margin;
            box[2 * k + 1] = f->shape.position[k] + f->shape.margin;
        }
    }
    for (int k = 0; k < 3; k++) {
        f->shape.position[k] -= f->motion[k];
        f->low[k] = box[2 * k] - fmax(f->motion[k], 0) - f->gap;
        f->high[k] = box[2 * k + 1] - fmin(f->motion[k], 0) + f->gap;
    }
    near_way(f->world, f->low, f->high, try_geom, f);
}

static void follow_body(oo_world *w, oo_body *own) {
    follower f = {.world = w, .body = own->id, .touch = 1, .gap = fmin(LITTLE * own->thin, AT_MOST)};
    displacement(w, own->id, f.motion);
    for (dGeomID geom = dBodyGetFirstGeom(own->id); geom; geom = dBodyGetNextGeom(geom)) {
        f.slot = (unsigned int)(size_t)dGeomGetData(geom);
        if (!dGeomIsEnabled(geom) || !dGeomGetSpace(geom) || w->geoms[f.slot].flags & OO_SENSOR) continue;
        follow_geom(&f, geom, own->tunnelling == OO_TUNNEL_RAY);
    }
    if (f.touch >= 1) return;
    const dReal *p = dBodyGetPosition(own->id);
    double back = 1 - f.touch, into = 2 * f.gap;
    dBodySetPosition(own->id, p[0] - back * f.motion[0] - into * f.normal[0], p[1] - back * f.motion[1] - into * f.normal[1],
                     p[2] - back * f.motion[2] - into * f.normal[2]);
    own->kept = f.touch;
}

static int is_fast(const oo_world *w, const oo_body *body) {
    if (!body->tunnelling || !dBodyIsEnabled(body->id) || dBodyIsKinematic(body->id)) return 0;
    const dReal *v = dBodyGetLinearVel(body->id);
    double way = w->step_size * sqrt(dot(v, v));
    return way > body->thin / 2;
}

int stop_fast_bodies(oo_world *w) {
    int asked = 0;
    for (unsigned int i = 0; i < w->body_count; i++) {
        oo_body *body = &w->bodies[i];
        body->kept = 1;
        if (!is_fast(w, body)) continue;
        if (!asked++ && begin_queries(w, 1)) return OO_NO_MEMORY;
    }
    if (!asked) return OO_OK;
    if (guard_enter()) {
        end_queries(w);
        return OO_ASSERT;
    }
    w->out_of_memory = 0;
    for (unsigned int i = 0; i < w->body_count; i++)
        if (is_fast(w, &w->bodies[i])) follow_body(w, &w->bodies[i]);
    guard_leave();
    end_queries(w);
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}
