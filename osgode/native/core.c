/* Worlds and bodies: owning what ODE makes for them. */

#include "internal.h"

/* ------------------------------------------------------------------ worlds */

int use_own_threading(oo_world *w) {
    dThreadingImplementationID own = dThreadingAllocateSelfThreadedImplementation();
    if (!own) return OO_NO_MEMORY;
    w->threading = own;
    dWorldSetStepThreadingImplementation(w->id, dThreadingImplementationGetFunctions(own), own);
    return OO_OK;
}

oo_world *oo_world_new(void) {
    oo_world *w = calloc(1, sizeof *w);
    if (!w) return NULL;
    w->surfaces = calloc(PAIR_SURFACES, sizeof *w->surfaces);
    w->directions = calloc(3 * PAIR_SURFACES, sizeof *w->directions);
    w->surface_count = PAIR_SURFACES;
    w->bad_body = -1;
    w->max_contacts = 1;
    w->edited = 1;
    int made = 0;
    if (w->surfaces && w->directions && !guard_enter()) {
        w->id = dWorldCreate();
        w->contact_group = dJointGroupCreate(0);
        made = w->id && w->contact_group && use_own_threading(w) == OO_OK;
        guard_leave();
    }
    if (!made) {
        free(w->surfaces);
        free(w->directions);
        free(w);
        return NULL;
    }
    count_live(&live.worlds, 1);
    return w;
}

void oo_world_free(oo_world *w) {
    if (!w->broken) { /* a broken one has a space that is locked for good: its ODE part is leaked on purpose */
        /* Geoms before spaces: a quadtree that still holds some leaves them unusable. */
        for (unsigned int i = 0; i < w->geom_count; i++)
            if ((w->geoms[i].flags & (OO_ALIVE | OO_IS_SPACE)) == OO_ALIVE) oo_geom_free(w, i);
        for (unsigned int i = w->geom_count; i-- > 0;)
            if (w->geoms[i].flags & OO_ALIVE) oo_geom_free(w, i);
        while (w->meshes) oo_mesh_free(w, w->meshes);
        if (!guard_enter()) {
            dJointGroupDestroy(w->contact_group);
            dWorldDestroy(w->id); /* with the bodies and joints that are left */
            dThreadingImplementationShutdownProcessing(w->threading);
            dThreadingFreeImplementation(w->threading);
            guard_leave();
        }
    }
    count_live(&live.bodies, -(long)w->body_count);
    count_live(&live.joints, -(long)w->joint_count);
    for (unsigned int i = 0; i < w->joint_count; i++) free(w->joints[i]);
    free(w->joints);
    broad_free(w);
    free(w->hits);
    free(w->broken_joints);
    count_live(&live.worlds, -1);
    free(w->bodies);
    free(w->glides);
    free(w->geoms);
    free(w->free_slots);
    free(w->retired_slots);
    free(w->pairs);
    free(w->surfaces);
    free(w->directions);
    free(w->contacts);
    free(w->islands);
    free(w->feedback);
    free(w->touching);
    free(w->touched);
    free(w->events);
    free(w);
}

int oo_set_pairs(oo_world *w, const oo_pair *pairs, unsigned int count) {
    oo_pair *copy = malloc(2 * ((size_t)count + 1) * sizeof *copy);
    if (!copy) return OO_NO_MEMORY;
    memcpy(copy, pairs, count * sizeof *copy);
    free(w->pairs);
    w->pairs = copy;
    w->pair_count = count;
    w->declared = copy + count;
    w->declared_count = 0;
    for (unsigned int i = 0; i < count; i++)
        if (!copy[i].nested) w->declared[w->declared_count++] = copy[i];
    w->pairs_are_new = 1;
    return OO_OK;
}

int oo_set_surface(oo_world *w, unsigned int index, const dSurfaceParameters *surface, const double direction[3]) {
    if (index >= w->surface_count) {
        dSurfaceParameters *moved = realloc(w->surfaces, (index + 1) * sizeof *moved);
        if (moved) w->surfaces = moved;
        double *directions = realloc(w->directions, (index + 1) * 3 * sizeof *directions);
        if (directions) w->directions = directions;
        if (!moved || !directions) return OO_NO_MEMORY;
        memset(moved + w->surface_count, 0, (index + 1 - w->surface_count) * sizeof *moved);
        w->surface_count = index + 1;
    }
    w->surfaces[index] = *surface;
    memcpy(w->directions + 3 * index, direction, 3 * sizeof *direction);
    return OO_OK;
}

/* ------------------------------------------------------------------ bodies */

/* p_frame = p_centre - R com */
void write_pose(const oo_body *body, double *row) {
    const dReal *p = dBodyGetPosition(body->id), *q = dBodyGetQuaternion(body->id);
    const double *c = body->com;
    memcpy(row, p, 3 * sizeof *row);
    if (c[0] != 0 || c[1] != 0 || c[2] != 0) {
        const dReal *r = dBodyGetRotation(body->id);
        for (int k = 0; k < 3; k++) row[k] -= r[4 * k] * c[0] + r[4 * k + 1] * c[1] + r[4 * k + 2] * c[2];
    }
    memcpy(row + 3, q, 4 * sizeof *row);
}

/* The same the other way: as if position and rotation were set, to the bit. */
void put_frame(const oo_body *body, const double *row) {
    const double *c = body->com;
    double p[3] = {row[0], row[1], row[2]};
    dBodySetQuaternion(body->id, row + 3);
    if (c[0] != 0 || c[1] != 0 || c[2] != 0) {
        const dReal *r = dBodyGetRotation(body->id);
        for (int k = 0; k < 3; k++) p[k] += r[4 * k] * c[0] + r[4 * k + 1] * c[1] + r[4 * k + 2] * c[2];
    }
    dBodySetPosition(body->id, p[0], p[1], p[2]);
}

void oo_body_snap(oo_world *w, unsigned int index) {
    w->bodies[index].settled = 0;
    write_pose(&w->bodies[index], w->poses + 7 * index);
    memcpy(w->previous + 7 * index, w->poses + 7 * index, 7 * sizeof(double));
}

int oo_body_new(oo_world *w) {
    if (w->body_count >= w->table_capacity || reserve(&w->bodies, &w->body_capacity, w->body_count + 1, sizeof *w->bodies))
        return OO_NO_MEMORY;
    if (guard_enter()) return OO_ASSERT;
    oo_body *body = &w->bodies[w->body_count];
    memset(body, 0, sizeof *body);
    body->id = dBodyCreate(w->id);
    guard_leave();
    if (!body->id) return OO_NO_MEMORY;
    dBodySetData(body->id, (void *)(size_t)w->body_count);
    body->thin = INFINITY;
    count_live(&live.bodies, 1);
    oo_body_snap(w, w->body_count);
    return (int)w->body_count++;
}

void oo_body_set_tunnelling(oo_world *w, unsigned int index, int tunnelling) {
    oo_body *body = &w->bodies[index];
    w->flagged_count += (unsigned int)((tunnelling != OO_TUNNEL) - (body->tunnelling != OO_TUNNEL));
    body->tunnelling = tunnelling;
}

int oo_body_take_warning(oo_world *w, unsigned int index) {
    oo_body *body = &w->bodies[index];
    if (body->warned != 1) return 0;
    body->warned = 2;
    w->too_fast_count--;
    return 1;
}

void oo_body_free(oo_world *w, unsigned int index) {
    oo_body_set_tunnelling(w, index, OO_TUNNEL);
    oo_body_take_warning(w, index);
    if (!guard_enter()) {
        dBodyDestroy(w->bodies[index].id);
        guard_leave();
    }
    unsigned int last = --w->body_count;
    forget_glide(w, index, last);
    w->bodies[index] = w->bodies[last];
    if (index < last) dBodySetData(w->bodies[index].id, (void *)(size_t)index);
    memcpy(w->poses + 7 * index, w->poses + 7 * last, 7 * sizeof(double));
    memcpy(w->previous + 7 * index, w->previous + 7 * last, 7 * sizeof(double));
    count_live(&live.bodies, -1);
}

void oo_body_read_raw(const oo_world *w, unsigned int index, double raw[19]) {
    dBodyID id = w->bodies[index].id;
    memcpy(raw, dBodyGetPosition(id), 3 * sizeof *raw);
    memcpy(raw + 3, dBodyGetQuaternion(id), 4 * sizeof *raw);
    memcpy(raw + 7, dBodyGetRotation(id), 12 * sizeof *raw);
}

void oo_body_write_raw(oo_world *w, unsigned int index, const double raw[19]) {
    dBodyID id = w->bodies[index].id;
    memcpy((dReal *)dBodyGetQuaternion(id), raw + 3, 4 * sizeof *raw);
    memcpy((dReal *)dBodyGetRotation(id), raw + 7, 12 * sizeof *raw);
    dBodySetPosition(id, raw[0], raw[1], raw[2]); /* tells the geoms that they have moved */
}

int oo_body_set_mass(oo_world *w, unsigned int index, double mass, const double inertia[9]) {
    dMass m = {.mass = mass};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) m.I[4 * row + column] = inertia[3 * row + column];
    if (guard_enter()) return OO_ASSERT;
    dBodySetMass(w->bodies[index].id, &m);
    guard_leave();
    return OO_OK;
}
