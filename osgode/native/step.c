/* One step of a World, and what it exports in bulk. */

#include <time.h>

#include "internal.h"

static pthread_mutex_t mesh_lock = PTHREAD_MUTEX_INITIALIZER;
static __thread int holds_mesh_lock;

void lock_meshes(int wanted) {
    if (wanted == holds_mesh_lock) return;
    if (wanted)
        pthread_mutex_lock(&mesh_lock);
    else
        pthread_mutex_unlock(&mesh_lock);
    holds_mesh_lock = wanted;
}

int usable(const dContactGeom *c) {
    double sum = c->pos[0] + c->pos[1] + c->pos[2] + c->depth;
    double normal = c->normal[0] * c->normal[0] + c->normal[1] * c->normal[1] + c->normal[2] * c->normal[2];
    return isfinite(sum) && normal > 0.5 && normal < 2.0;
}

static void note_touch(oo_world *w, unsigned int slot1, unsigned int slot2, unsigned int first, unsigned int count) {
    if (reserve(&w->touching, &w->touching_capacity, w->touching_count + 1, sizeof *w->touching)) {
        w->out_of_memory = 1;
        return;
    }
    oo_touch *touch = &w->touching[w->touching_count++];
    *touch = (oo_touch){.slot1 = slot1 < slot2 ? slot1 : slot2,
                        .slot2 = slot1 < slot2 ? slot2 : slot1,
                        .first = first,
                        .count = count};
}

static int may_touch(const oo_geom *a, const oo_geom *b) {
    if (!(a->category & b->collide) || !(b->category & a->collide)) return 0;
    unsigned int either = a->flags | b->flags;
    if (a->flags & b->flags & OO_IS_RAY) return 0;
    dBodyID body1 = dGeomGetBody(a->id), body2 = dGeomGetBody(b->id);
    if (body1 == body2 && (body1 || !(either & OO_IS_RAY))) return 0; /* a ray that stands still sees what stands still */
    return !(body1 && body2 && dAreConnectedExcluding(body1, body2, dJointTypeContact));
}

void meet_pair(oo_world *w, unsigned int slot1, unsigned int slot2) {
    const oo_geom *a = &w->geoms[slot1], *b = &w->geoms[slot2];
    if (!may_touch(a, b)) return;
    unsigned int either = a->flags | b->flags, both = a->flags & b->flags;
    /* ODE's depth depends on the order of two cylinders; and rays come first */
    if ((both & OO_IS_CYLINDER && slot2 < slot1) || b->flags & OO_IS_RAY) {
        unsigned int slot = slot1;
        slot1 = slot2;
        slot2 = slot;
        a = &w->geoms[slot1];
        b = &w->geoms[slot2];
    }
    unsigned int first = w->contact_count;
    if (reserve(&w->contacts, &w->contact_capacity, first + w->max_contacts, sizeof *w->contacts)) {
        w->out_of_memory = 1;
        return;
    }

    int mesh = (either & OO_IS_MESH) != 0;
    if (mesh) lock_meshes(1);
    int (*meet)(const oo_geom *, const oo_geom *, int, dContactGeom *, int) =
        w->refines && !w->ode_broad ? collide_well : collide_pair;
    int found = meet(a, b, (int)w->max_contacts, &w->contacts[first].geom, sizeof *w->contacts);
    if (mesh) lock_meshes(0);

    unsigned int surface = a->surface ? a->surface : b->surface;
    if (a->surface && b->surface && w->surfaces[b->surface].mu < w->surfaces[a->surface].mu) surface = b->surface;
    if (!surface) surface = MATERIALS * a->material + b->material;
    if (either & OO_IS_RAY) surface = OO_NO_RESPONSE;
    unsigned int kept = first;
    for (unsigned int i = first; i < first + (unsigned int)found; i++) {
        if (!usable(&w->contacts[i].geom)) continue; /* ODE gives NaN for a sphere centred on a cylinder, among others */
        oo_contact *row = &w->contacts[kept];
        if (kept != i) row->geom = w->contacts[i].geom;
        row->slot1 = slot1;
        row->slot2 = slot2;
        row->surface = surface;
        row->feedback = -1;
        row->force[0] = row->force[1] = row->force[2] = 0;
        kept++;
    }
    w->contact_count = kept;
    if (kept > first && either & (OO_LISTENED | OO_ASKED)) note_touch(w, slot1, slot2, first, kept - first);
}

int geoms_touch(oo_world *w, unsigned int slot1, unsigned int slot2) {
    dContactGeom one;
    if (!may_touch(&w->geoms[slot1], &w->geoms[slot2])) return 0;
    if (guard_enter()) {
        lock_meshes(0);
        return 1;
    }
    const oo_geom *a = &w->geoms[slot1], *b = &w->geoms[slot2];
    int reports = (a->flags | b->flags) & (OO_IS_RAY | OO_SENSOR);
    lock_meshes(((a->flags | b->flags) & OO_IS_MESH) != 0);
    int found = reports ? 0 : collide_pair(a, b, 1, &one, sizeof one);
    lock_meshes(0);
    guard_leave();
    return found > 0;
}

static void on_near(void *data, dGeomID g1, dGeomID g2) {
    if (dGeomIsSpace(g1) || dGeomIsSpace(g2))
        dSpaceCollide2(g1, g2, data, on_near);
    else if (dGeomIsEnabled(g1) && dGeomIsEnabled(g2)) /* of two spaces, ODE asks the geoms of one only */
        meet_pair(data, (unsigned int)(size_t)dGeomGetData(g1), (unsigned int)(size_t)dGeomGetData(g2));
}

/* A slot that was retired before the last step is named by no contact, touch or event any longer. */
static void recycle_slots(oo_world *w) {
    for (unsigned int i = 0; i < w->retired_ripe; i++) w->free_slots[w->free_count++] = w->retired_slots[i];
    w->retired_count -= w->retired_ripe;
    memmove(w->retired_slots, w->retired_slots + w->retired_ripe, w->retired_count * sizeof *w->retired_slots);
    w->retired_ripe = w->retired_count;
}

static int collide(oo_world *w) {
    if (guard_enter()) { /* the space that was being walked stays locked for good */
        lock_meshes(0);
        w->broken = 1;
        return OO_BROKEN;
    }
    w->contact_count = w->event_count = w->touching_count = w->asked_count = 0;
    w->out_of_memory = 0;
    if (!w->ode_broad && w->declared_count <= MOST_DECLARED) {
        int status = find_pairs(w);
        guard_leave();
        return status;
    }
    broad_forget(w);
    for (unsigned int i = 0; i < w->pair_count; i++) {
        if (w->pairs[i].other)
            dSpaceCollide2((dGeomID)w->pairs[i].space, (dGeomID)w->pairs[i].other, w, on_near);
        else
            dSpaceCollide(w->pairs[i].space, w, on_near);
    }
    guard_leave();
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}

static int compare_pairs(const oo_touch *a, const oo_touch *b) {
    if (a->slot1 != b->slot1) return a->slot1 < b->slot1 ? -1 : 1;
    return a->slot2 < b->slot2 ? -1 : a->slot2 > b->slot2;
}

static int by_slots(const void *a, const void *b) { return compare_pairs(a, b); }

/* Whether the touch of two geoms is one that somebody asked for, and whether it is new. */
static void find_asked(oo_world *w) {
    for (unsigned int i = 0; i < w->touching_count; i++) {
        oo_touch *touch = &w->touching[i];
        touch->state = OO_UNASKED;
        if (!((w->geoms[touch->slot1].flags | w->geoms[touch->slot2].flags) & OO_ASKED)) continue;
        w->asked_count++;
        int known = w->touched_count && bsearch(touch, w->touched, w->touched_count, sizeof *touch, by_slots) != NULL;
        touch->state = known ? OO_STAY : OO_BEGIN;
    }
}

int row_acts(const oo_world *w, const oo_contact *row) {
    const oo_geom *a = &w->geoms[row->slot1], *b = &w->geoms[row->slot2];
    int silent = row->surface == OO_REFUSED || row->surface == OO_NO_RESPONSE || (a->flags | b->flags) & OO_SENSOR;
    return !silent && a->flags & b->flags & OO_ALIVE &&
           dGeomGetBody(a->id) != dGeomGetBody(b->id); /* they may have been put into one body since they were found */
}

/* A row counts as touching if it acts, or if it would but for a sensor. */
static int row_touches(const oo_world *w, const oo_contact *row) {
    const oo_geom *a = &w->geoms[row->slot1], *b = &w->geoms[row->slot2];
    return row->surface != OO_REFUSED && a->flags & b->flags & OO_ALIVE && dGeomGetBody(a->id) != dGeomGetBody(b->id);
}

/* What was refused, or is gone since it was asked about, does not touch. */
static void drop_refused(oo_world *w) {
    unsigned int kept = 0;
    for (unsigned int i = 0; i < w->touching_count; i++) {
        int touches = 0;
        for (unsigned int k = 0; k < w->touching[i].count; k++)
            touches |= row_touches(w, &w->contacts[w->touching[i].first + k]);
        if (touches) w->touching[kept++] = w->touching[i];
    }
    w->touching_count = kept;
}

/* A direction along the axes of a geom, in the world. */
static void from_geom(const oo_geom *geom, const double *own, double *world) {
    memcpy(world, own, 3 * sizeof *world);
    if (dGeomGetClass(geom->id) == dPlaneClass) return; /* it stands in world axes */
    const dReal *r = dGeomGetRotation(geom->id);
    for (int k = 0; k < 3; k++) world[k] = r[4 * k] * own[0] + r[4 * k + 1] * own[1] + r[4 * k + 2] * own[2];
}

static void add_velocity(const oo_geom *geom, double sign, double *sum) {
    if (!(geom->flags & OO_IS_BELT)) return;
    double own[3] = {geom->velocity[0], geom->velocity[1], geom->velocity[2]}, velocity[3];
    from_geom(geom, own, velocity);
    for (int k = 0; k < 3; k++) sum[k] += sign * velocity[k];
}

/* Which way the friction of a contact acts, where it is not the same all round, or where a surface moves by itself. */
static void direct(const oo_world *w, const oo_contact *row, dContact *contact) {
    const oo_geom *a = &w->geoms[row->slot1], *b = &w->geoms[row->slot2];
    const double *own = w->directions + 3 * row->surface;
    int directed = own[0] != 0 || own[1] != 0 || own[2] != 0;
    if (!directed && !((a->flags | b->flags) & OO_IS_BELT)) return;
    /* ODE turns the normal round, and means body 2 against the world, where body 1 is static. */
    double side = dGeomGetBody(row->geom.g1) ? 1 : -1, belt[3] = {0}, normal[3], first[3], second[3];
    add_velocity(b, side, belt);
    add_velocity(a, -side, belt);
    for (int k = 0; k < 3; k++) normal[k] = side * row->geom.normal[k];
    if (directed)
        from_geom(a->surface == row->surface ? a : b, own, first);
    else
        memcpy(first, belt, sizeof first);
    double off = dot(first, normal), length = 0;
    for (int k = 0; k < 3; k++) {
        first[k] -= off * normal[k];
        length += first[k] * first[k];
    }
    if (length < 1e-12) return; /* it points into the ground: nothing to go by */
    for (int k = 0; k < 3; k++) first[k] /= sqrt(length);
    cross(second, normal, first);
    memcpy(contact->fdir1, first, sizeof first);
    contact->surface.mode |= dContactFDir1 | dContactMotion1 | dContactMotion2;
    contact->surface.motion1 = dot(belt, first);
    contact->surface.motion2 = dot(belt, second);
}

static int respond(oo_world *w) {
    if (w->asked_count) drop_refused(w);
    unsigned int listened = 0;
    for (unsigned int i = 0; i < w->touching_count; i++) listened += w->touching[i].count;
    if (reserve(&w->feedback, &w->feedback_capacity, listened, sizeof *w->feedback)) return OO_NO_MEMORY;
    if (listened) memset(w->feedback, 0, listened * sizeof *w->feedback); /* ODE writes none for what sleeps */
    w->feedback_count = 0;
    for (unsigned int i = 0; i < w->touching_count; i++)
        for (unsigned int k = 0; k < w->touching[i].count; k++) {
            oo_contact *row = &w->contacts[w->touching[i].first + k];
            if (row_acts(w, row)) row->feedback = (int)w->feedback_count++;
        }
    /* ODE writes only what its solver sees: nothing where all sleeps. */
    if (w->feedback_count) memset(w->feedback, 0, w->feedback_count * sizeof *w->feedback);
    int selects = w->ode_broad && w->asleep_count; /* osgode's own way finds few contacts of sleepers */
    if (selects && find_islands(w)) return OO_NO_MEMORY;
    if (guard_enter()) return OO_ASSERT;
    dContact contact;
    memset(&contact, 0, sizeof contact);
    for (unsigned int i = 0; i < w->contact_count; i++) {
        oo_contact *row = &w->contacts[i];
        if (!row_acts(w, row)) continue;
        dBodyID body1 = dGeomGetBody(row->geom.g1), body2 = dGeomGetBody(row->geom.g2);
        if (selects && !is_awake(w, body1) && !is_awake(w, body2)) continue;
        contact.surface = w->surfaces[row->surface];
        contact.geom = row->geom;
        direct(w, row, &contact);
        dJointID joint = dJointCreateContact(w->id, w->contact_group, &contact);
        dJointAttach(joint, body1, body2);
        if (row->feedback >= 0) dJointSetFeedback(joint, &w->feedback[row->feedback]);
    }
    guard_leave();
    return OO_OK;
}

static int integrate(oo_world *w) {
    int done;
    random_begin(w);
    if (guard_enter()) {
        done = OO_ASSERT;
    } else {
        done = (w->exact ? dWorldStep(w->id, w->step_size) : dWorldQuickStep(w->id, w->step_size)) ? OO_OK : OO_NO_MEMORY;
        guard_leave();
    }
    random_end(w);
    /* After an assert the implementation is left in the middle of its work: a fresh one takes its place, and
       the old one is leaked on purpose (about 66 kB). */
    if (done == OO_ASSERT) use_own_threading(w);
    return done;
}

/* Without being followed it may go through what is thinner than it. */
static void warn_if_too_fast(oo_world *w, oo_body *body) {
    if (body->tunnelling || body->warned || dBodyIsKinematic(body->id)) return;
    const dReal *v = dBodyGetLinearVel(body->id);
    double thick = 2 * body->thin, way = w->step_size * w->step_size * dot(v, v);
    if (way <= thick * thick) return;
    body->warned = 1;
    w->too_fast_count++;
}

static int out_of_bounds(dBodyID id) {
    const dReal *p = dBodyGetPosition(id), *v = dBodyGetLinearVel(id), *a = dBodyGetAngularVel(id);
    const dReal *q = dBodyGetQuaternion(id);
    for (int k = 0; k < 3; k++)
        if (!(fabs(p[k]) <= POSITION_LIMIT && fabs(v[k]) <= VELOCITY_LIMIT && fabs(a[k]) <= VELOCITY_LIMIT)) return 1;
    return !isfinite(q[0] + q[1] + q[2] + q[3]);
}

static void find_bad_body(oo_world *w) {
    w->bad_body = -1;
    for (unsigned int i = 0; i < w->body_count && w->bad_body < 0; i++)
        if (out_of_bounds(w->bodies[i].id)) w->bad_body = (int)i;
}

/* What sleeps on is where it was, and as sound as it was. */
static void export_poses(oo_world *w) {
    w->bad_body = -1;
    w->asleep_count = 0;
    for (unsigned int i = 0; i < w->body_count; i++) {
        oo_body *body = &w->bodies[i];
        int asleep = !dBodyIsEnabled(body->id);
        w->asleep_count += (unsigned int)asleep;
        if (asleep && body->settled) continue;
        body->settled = asleep;
        memcpy(w->previous + 7 * i, w->poses + 7 * i, 7 * sizeof(double));
        write_pose(body, w->poses + 7 * i);
        if (w->bad_body < 0 && out_of_bounds(body->id)) w->bad_body = (int)i;
        warn_if_too_fast(w, body);
    }
}

void oo_export_velocities(const oo_world *w, double *out) {
    for (unsigned int i = 0; i < w->body_count; i++, out += 6) {
        const oo_body *body = &w->bodies[i];
        const dReal *r = dBodyGetRotation(body->id), *v = dBodyGetLinearVel(body->id), *a = dBodyGetAngularVel(body->id);
        double arm[3];
        for (int k = 0; k < 3; k++)
            arm[k] = r[4 * k] * body->com[0] + r[4 * k + 1] * body->com[1] + r[4 * k + 2] * body->com[2];
        /* v_frame = v_centre - w x arm */
        out[0] = v[0] - (a[1] * arm[2] - a[2] * arm[1]);
        out[1] = v[1] - (a[2] * arm[0] - a[0] * arm[2]);
        out[2] = v[2] - (a[0] * arm[1] - a[1] * arm[0]);
        memcpy(out + 3, a, 3 * sizeof *out);
    }
}

void oo_export_enabled(const oo_world *w, unsigned char *out) {
    for (unsigned int i = 0; i < w->joint_count; i++) out[i] = dJointIsEnabled(w->joints[i]->id) != 0;
}

void oo_export_bodies(const oo_world *w, oo_body_state *out) {
    for (unsigned int i = 0; i < w->body_count; i++, out++) {
        memcpy(out->com, w->bodies[i].com, sizeof out->com);
        out->asleep = !dBodyIsEnabled(w->bodies[i].id);
        out->kinematic = dBodyIsKinematic(w->bodies[i].id);
    }
}

void oo_export_geoms(const oo_world *w, oo_geom_state *out) {
    for (unsigned int i = 0; i < w->geom_count; i++, out++) {
        const oo_geom *geom = &w->geoms[i];
        memset(out, 0, sizeof *out);
        if (!(geom->flags & OO_ALIVE)) continue;
        out->flags = geom->flags;
        out->enabled = dGeomIsEnabled(geom->id);
        if (geom->flags & OO_IS_SPACE) continue;
        dReal box[6];
        dGeomGetAABB(geom->id, box);
        for (int k = 0; k < 3; k++) {
            out->low[k] = box[2 * k];
            out->high[k] = box[2 * k + 1];
        }
    }
}

static int add_event(oo_world *w, const oo_touch *touch, int state) {
    if (reserve(&w->events, &w->event_capacity, w->event_count + 1, sizeof *w->events)) return OO_NO_MEMORY;
    w->events[w->event_count] = *touch;
    w->events[w->event_count].state = state;
    w->event_count++;
    return OO_OK;
}

/* What touches now is what the next step compares with. Only here, at the end of a step that was done: one that
   fails leaves everything as the last one left it. */
static void keep_touches(oo_world *w) {
    oo_touch *last = w->touched;
    unsigned int capacity = w->touched_capacity;
    w->touched = w->touching;
    w->touched_count = w->touching_count;
    w->touched_capacity = w->touching_capacity;
    w->touching = last;
    w->touching_capacity = capacity;
    w->touching_count = 0;
    recycle_slots(w);
}

/* Forces into the listened rows, and this step's listened pairs against the last step's. */
static int compare_touches(oo_world *w) {
    for (unsigned int i = 0; i < w->touching_count; i++) {
        oo_touch *touch = &w->touching[i];
        for (unsigned int k = touch->first; k < touch->first + touch->count; k++) {
            oo_contact *row = &w->contacts[k];
            if (row->feedback < 0) continue;
            const dReal *force = w->feedback[row->feedback].f1;
            /* f1 is what acts on the first body that there is: on that of geom 2 where geom 1 is static */
            double sign = dGeomGetBody(row->geom.g1) ? 1.0 : -1.0;
            for (int c = 0; c < 3; c++) row->force[c] = sign * force[c];
            touch->impulse += sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]) * w->step_size;
        }
    }
    if (w->touching_count) qsort(w->touching, w->touching_count, sizeof *w->touching, by_slots);
    unsigned int now = 0, last = 0;
    while (now < w->touching_count || last < w->touched_count) {
        const oo_touch *a = now < w->touching_count ? &w->touching[now] : NULL;
        const oo_touch *b = last < w->touched_count ? &w->touched[last] : NULL;
        int order = !a ? 1 : !b ? -1 : compare_pairs(a, b);
        if (order > 0) { /* only then: it has ended, and the rows it had are gone */
            oo_touch gone = *b;
            gone.first = gone.count = 0;
            gone.impulse = 0;
            if (add_event(w, &gone, OO_END)) return OO_NO_MEMORY;
            last++;
        } else {
            if (add_event(w, a, order ? OO_BEGIN : OO_STAY)) return OO_NO_MEMORY;
            now++;
            if (!order) last++;
        }
    }
    keep_touches(w);
    return OO_OK;
}

/* After an assert in the middle of ODE's step: gravity is in the accumulators already and must not act twice, and
   the body that caused it is to be named. */
static void clean_up(oo_world *w) {
    for (unsigned int i = 0; i < w->body_count; i++) {
        dBodySetForce(w->bodies[i].id, 0, 0, 0);
        dBodySetTorque(w->bodies[i].id, 0, 0, 0);
    }
    find_bad_body(w);
}

/* The seconds since `last`, which is now. */
static double lap(struct timespec *last) {
    struct timespec before = *last;
    clock_gettime(CLOCK_MONOTONIC, last);
    return (double)(last->tv_sec - before.tv_sec) + 1e-9 * (double)(last->tv_nsec - before.tv_nsec);
}

int oo_run(oo_world *w, unsigned int count) {
    unsigned int done = 0;
    struct timespec clock;
    if (w->broken) return OO_BROKEN;
    if (w->bad_body >= 0) find_bad_body(w);
    if (w->bad_body >= 0) return OO_BAD_BODY;
    dAllocateODEDataForThread(dAllocateMaskAll);
    w->broken_count = 0;
    clock_gettime(CLOCK_MONOTONIC, &clock);
    while (done < count) {
        int status = OO_OK;
        if (!w->asking) {
            if (w->servo_count) drive_servos(w);
            if (w->gear_count) mesh_gears(w);
            status = collide(w);
            if (status == OO_OK) find_asked(w);
            w->asking = status == OO_OK && w->asked_count;
            w->timings.collide += lap(&clock);
            if (w->asking) break;
        }
        w->asking = 0;
        if (status == OO_OK) status = respond(w);
        w->timings.respond += lap(&clock);
        if (status == OO_OK) {
            if (w->glide_count) w->edited = 1; /* they may have fallen asleep on the way */
            begin_glides(w);
            status = integrate(w);
            if (status == OO_OK) end_glides(w);
            if (status == OO_OK && w->flagged_count) status = stop_fast_bodies(w);
            if (status == OO_ASSERT) clean_up(w);
        }
        w->timings.solve += lap(&clock);
        if (status == OO_OK) status = compare_touches(w);
        dJointGroupEmpty(w->contact_group);
        if (status != OO_OK) {
            w->edited = 1;
            return status;
        }
        export_poses(w);
        w->steps++;
        w->timings.steps++;
        done++;
        if (w->bad_body >= 0) return OO_BAD_BODY;
        if (w->gear_count) count_gears(w);
        if (w->breakable_count) find_broken_joints(w);
        w->timings.report += lap(&clock);
        if (w->event_count || w->broken_count || w->too_fast_count) break;
    }
    return (int)done;
}

void oo_abandon(oo_world *w) {
    w->asking = 0;
    w->contact_count = w->touching_count = w->asked_count = 0;
}
