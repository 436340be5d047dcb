/* Kinematic bodies that glide to a pose: in each step they have the velocities of the way that they go. */

#include "internal.h"

static oo_glide *find(const oo_world *w, unsigned int body) {
    for (unsigned int i = 0; i < w->glide_count; i++)
        if (w->glides[i].body == body) return &w->glides[i];
    return NULL;
}

int oo_glide_start(oo_world *w, unsigned int body, const double target[7], double seconds) {
    oo_glide *glide = find(w, body);
    if (!glide) {
        if (reserve(&w->glides, &w->glide_capacity, w->glide_count + 1, sizeof *w->glides)) return OO_NO_MEMORY;
        glide = &w->glides[w->glide_count++];
    }
    memset(glide, 0, sizeof *glide);
    glide->body = body;
    glide->seconds = seconds;
    memcpy(glide->target, target, 7 * sizeof *target);
    dBodyEnable(w->bodies[body].id);
    return OO_OK;
}

int oo_glides(const oo_world *w, unsigned int body) { return find(w, body) != NULL; }

static void set_velocity(dBodyID id, const double velocity[6]) {
    dBodySetLinearVel(id, velocity[0], velocity[1], velocity[2]);
    dBodySetAngularVel(id, velocity[3], velocity[4], velocity[5]);
}

static const double STILL[6];

void oo_glide_stop(oo_world *w, unsigned int body, int halt) {
    oo_glide *glide = find(w, body);
    if (!glide) return;
    if (halt) set_velocity(w->bodies[body].id, STILL);
    *glide = w->glides[--w->glide_count];
}

void forget_glide(oo_world *w, unsigned int body, unsigned int last) {
    oo_glide_stop(w, body, 0);
    oo_glide *moved = find(w, last);
    if (moved) moved->body = body;
}

static void multiply(double out[4], const double a[4], const double b[4]) {
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3];
    out[3] = a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1];
}

/* out = v turned by q: v + 2 u x (u x v + w v) */
void rotate_by(double out[3], const double q[4], const double v[3]) {
    const double *u = q + 1;
    double t[3] = {u[1] * v[2] - u[2] * v[1] + q[0] * v[0], u[2] * v[0] - u[0] * v[2] + q[0] * v[1],
                   u[0] * v[1] - u[1] * v[0] + q[0] * v[2]};
    out[0] = v[0] + 2 * (u[1] * t[2] - u[2] * t[1]);
    out[1] = v[1] + 2 * (u[2] * t[0] - u[0] * t[2]);
    out[2] = v[2] + 2 * (u[0] * t[1] - u[1] * t[0]);
}

/* The part 1/left of the shorter turn from now to target: the rotation after it, and the angular velocity meanwhile. */
static void turn_part(double next[4], double spin[3], const double now[4], const double target[4], double left, double h) {
    double back[4] = {now[0], -now[1], -now[2], -now[3]}, whole[4];
    multiply(whole, target, back);
    double sine = sqrt(whole[1] * whole[1] + whole[2] * whole[2] + whole[3] * whole[3]);
    double sign = whole[0] < 0 ? -1 : 1; /* q and -q are the same rotation */
    double angle = 2 * atan2(sine, fabs(whole[0])) / left;
    double part[4] = {cos(angle / 2), 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double axis = sine > 0 ? sign * whole[k + 1] / sine : 0;
        part[k + 1] = axis * sin(angle / 2);
        spin[k] = axis * angle / h;
    }
    multiply(next, part, now);
}

/* Always on from where the body is now: what has put it elsewhere meanwhile is made up for on the rest of the way. */
void begin_glides(oo_world *w) {
    for (unsigned int i = 0; i < w->glide_count; i++) {
        oo_glide *glide = &w->glides[i];
        const oo_body *body = &w->bodies[glide->body];
        const dReal *centre = dBodyGetPosition(body->id);
        double now[7], arm[3], h = w->step_size;
        write_pose(body, now);
        double left = rint(glide->seconds / h);
        glide->arrives = !(left > 1);
        if (glide->arrives) left = 1;
        for (int k = 0; k < 3; k++) glide->next[k] = now[k] + (glide->target[k] - now[k]) / left;
        turn_part(glide->next + 3, glide->velocity + 3, now + 3, glide->target + 3, left, h);
        if (glide->arrives) memcpy(glide->next, glide->target, sizeof glide->next);
        rotate_by(arm, glide->next + 3, body->com);
        for (int k = 0; k < 3; k++) glide->velocity[k] = (glide->next[k] + arm[k] - centre[k]) / h;
        set_velocity(body->id, glide->velocity);
        dBodyEnable(body->id);
    }
}

/* ODE has moved them nearly to where they belong; its turn is rounded, and damping has slowed them down. */
void end_glides(oo_world *w) {
    for (unsigned int i = w->glide_count; i-- > 0;) {
        oo_glide *glide = &w->glides[i];
        put_frame(&w->bodies[glide->body], glide->next);
        set_velocity(w->bodies[glide->body].id, glide->arrives ? STILL : glide->velocity);
        glide->seconds -= w->step_size;
        if (glide->arrives) *glide = w->glides[--w->glide_count];
    }
}
