/* Fast bodies, which would be through a thin wall between one step and the next.

   After a step each flagged body that went farther than half of its thinnest part is followed along its way. Where it
   first touches something it is put there, a little into it, with the velocity that it has: the next step finds the
   contact, and the usual response follows. Turning on the way is left out. */

#include "heightfield.h"
#include "shapes.h"

#define LITTLE 0.01     /* of the thinnest part: how far it is put into what it hits */
#define AT_MOST 1e-3
#define WATCHED 30      /* steps after a stop: it may have been turned into the wall, and go on from there slowly */
#define ROUNDED 0.1     /* of the thinnest part: how much edges and corners are rounded off */

typedef struct follower {
    oo_world *world;
    const oo_body *own;
    dBodyID body;
    unsigned int slot;      /* of the geom that is followed */
    shape shape;            /* where it was */
    shape middle;           /* its centre of mass, where that was */
    double motion[3], gap, thin;
    double rounded;         /* of its shape's margin, what is rounded off or may sink in */
    int pressed;            /* it touched something when the step began */
    unsigned int other;     /* the slot of what is tried */
    int met;                /* what came of touching that, or UNKNOWN */
    int carried_along;      /* it is followed on the way that it is carried by `carrier`; all others are where they end */
    unsigned int carrier;   /* a slot */
    double touch;           /* the nearest so far */
    unsigned int touched;   /* the slot of what it touches there */
    int (*wanted)(void *, unsigned int slot); /* of a question: what counts, all of it standing still; NULL: of a step */
    void *asker;
    double normal[3], into; /* how far it is put into that */
    double carried;         /* by that, along the normal, for the rest of the step */
    double shift[3];        /* of what is tried */
    double low[3], high[3]; /* of all of its way */
} follower;

/* The way of the centre of mass in this step: the table still has the pose before it. Velocities don't tell, since
   damping has slowed them down, and those of a glide that has arrived are 0. */
static double find_motion(const oo_world *w, unsigned int index, double *out) {
    const oo_body *own = &w->bodies[index];
    const double *before = w->poses + 7 * index;
    const dReal *now = dBodyGetPosition(own->id);
    double arm[3];
    rotate_by(arm, before + 3, own->com);
    for (int k = 0; k < 3; k++) out[k] = now[k] - (before[k] + arm[k]);
    return sqrt(dot(out, out));
}

static void displacement(const oo_world *w, dBodyID body, double *out) {
    static const double still[3];
    memcpy(out, body ? w->bodies[(size_t)dBodyGetData(body)].moved : still, 3 * sizeof *out);
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

/* The corners of a hull, or of a mesh as if it were one, in the world; to be freed. half[0] is how much can be rounded
   off: no more than its faces go inwards when it is made smaller about the middle of its corners. */
static int describe_hull(const oo_geom *geom, shape *s) {
    const oo_mesh *hull = geom->mesh;
    frame at = frame_of(geom->id);
    double *points = malloc(3 * sizeof *points * hull->vertex_count);
    if (!points) return OO_NO_MEMORY;
    memset(s, 0, sizeof *s);
    for (unsigned int i = 0; i < hull->vertex_count; i++) to_world(&at, hull->vertices + 3 * i, points + 3 * i);
    s->kind = SHAPE_POINTS;
    s->points = points;
    s->count = (int)hull->vertex_count;
    double middle[3] = {0, 0, 0}, nearest = INFINITY;
    for (unsigned int i = 0; i < 3 * hull->vertex_count; i++) middle[i % 3] += hull->vertices[i] / hull->vertex_count;
    for (unsigned int i = 0; hull->planes && i < hull->plane_count; i++)
        nearest = fmin(nearest, hull->planes[4 * i + 3] - dot(hull->planes + 4 * i, middle));
    if (isfinite(nearest)) s->half[0] = ROUNDED * fmax(nearest, 0);
    return OO_OK;
}

static int is_hull(const oo_geom *geom) { return geom->mesh && geom->mesh->planes; }

static void move_back(shape *s, const double *by) {
    if (s->kind == SHAPE_PLANE) return;
    for (int k = 0; k < 3; k++) s->position[k] -= by[k];
    double *points = (double *)s->points;
    for (int i = 0; i < 3 * s->count; i++) points[i] -= by[i % 3];
}

enum { UNKNOWN, UNMET, REFUSED, PUSHED };

/* What came of it in this step that two geoms touched when it began. */
static int find_met(const follower *f) {
    const oo_world *w = f->world;
    int met = UNMET;
    for (unsigned int i = 0; i < w->contact_count; i++) {
        const oo_contact *row = &w->contacts[i];
        if (!(row->slot1 == f->slot && row->slot2 == f->other) && !(row->slot1 == f->other && row->slot2 == f->slot)) continue;
        if (row_acts(w, row)) return PUSHED;
        met = REFUSED;
    }
    return met;
}

static void keep(follower *f, double t, const double *normal) {
    if (t >= f->touch) return;
    f->touch = t;
    memcpy(f->normal, normal, sizeof f->normal);
}

/* What a listener lets pass stops nothing. And where nothing came of it that it was stopped before, it goes on little by
   little, until something does: into a hollow, whose hull it touched, or through the wrong side of a mesh. */
static void note(follower *f, double t, const double *normal, double into) {
    if (!(t <= 1 && t < f->touch)) return;
    if (f->met == UNKNOWN) f->met = find_met(f);
    if (f->met == REFUSED) return;
    if (t == 0 && f->met == UNMET && f->own->held) {
        t = f->thin / 2 / sqrt(dot(f->motion, f->motion));
        into = 0;
        if (t >= f->touch) return;
    }
    keep(f, t, normal);
    f->into = into;
    f->carried = (1 - t) * dot(f->shift, normal);
}

/* Whether more of it than may sink in would get there. */
static int goes_into(const follower *f, const shape *other, const double *motion) {
    shape core = f->shape;
    double normal[3];
    core.margin = fmax(core.margin - f->rounded, 0);
    return first_touch(&core, motion, other, f->gap, normal) <= 1;
}

static int middle_meets(const follower *f, const shape *other, const double *motion, double *normal) {
    static const double here[3];
    if (shape_distance(&f->middle, here, other, normal) <= f->gap) return 0;
    return first_touch(&f->middle, motion, other, f->gap, normal) <= 1;
}

/* A body that has hit with a corner turns, and its middle goes on as fast: what it touches already stops it too, if it
   would go far into that, or its middle through it. Along it, it may slide, from one triangle or tile of a floor to the
   next. */
static void try_shape(follower *f, const shape *other, const double *motion) {
    static const double here[3];
    double normal[3], distance = shape_distance(&f->shape, here, other, normal);
    if (f->wanted) {
        keep(f, distance > 0 ? first_touch(&f->shape, motion, other, f->gap, normal) : 0, normal);
    } else if (distance > f->gap) {
        double t = first_touch(&f->shape, motion, other, f->gap, normal);
        if (t <= 1 && (!f->pressed || goes_into(f, other, motion))) note(f, t, normal, 2 * f->gap);
    } else if (dot(normal, normal) > 0) {
        int far = -dot(motion, normal) > f->thin / 2 && goes_into(f, other, motion);
        double way_out[3];
        if (far || middle_meets(f, other, motion, way_out)) note(f, 0, normal, fmax(distance + f->gap, 0));
    } else if (middle_meets(f, other, motion, normal)) { /* too deep to tell which way is out */
        note(f, 0, normal, 0);
    }
}

typedef struct surface {
    follower *follower;
    frame at;
    const double *shift; /* back to where it was */
    const double *motion;
} surface;

static void try_triangle(void *data, const double *corners[3]) {
    const surface *v = data;
    double points[9];
    for (int c = 0; c < 3; c++) {
        to_world(&v->at, corners[c], points + 3 * c);
        for (int k = 0; k < 3; k++) points[3 * c + k] -= v->shift[k];
    }
    shape triangle = {.kind = SHAPE_POINTS, .points = points, .count = 3};
    memcpy(triangle.position, points, sizeof triangle.position);
    try_shape(v->follower, &triangle, v->motion);
}

static void visit_heights(const field *f, const double *low, const double *high, void (*visit)(void *, const double *[3]),
                          void *data) {
    const oo_mesh *m = f->data;
    int last_i = (int)m->columns - 2, last_j = (int)m->rows - 2;
    int i0 = clamped((low[0] + f->width / 2) / f->dx, last_i), i1 = clamped((high[0] + f->width / 2) / f->dx, last_i);
    int j0 = clamped((low[2] + f->depth / 2) / f->dz, last_j), j1 = clamped((high[2] + f->depth / 2) / f->dz, last_j);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            double corner[4][3]; /* (0, 0), (1, 0), (0, 1), (1, 1): divided from the second to the third */
            for (int c = 0; c < 4; c++) {
                corner[c][0] = (i + c % 2) * f->dx - f->width / 2;
                corner[c][1] = height_of(m, i + c % 2, j + c / 2);
                corner[c][2] = (j + c / 2) * f->dz - f->depth / 2;
            }
            double lowest = fmin(fmin(corner[0][1], corner[1][1]), fmin(corner[2][1], corner[3][1]));
            double highest = fmax(fmax(corner[0][1], corner[1][1]), fmax(corner[2][1], corner[3][1]));
            if (lowest > high[1] || highest < low[1]) continue;
            const double *lower[3] = {corner[0], corner[1], corner[2]}, *upper[3] = {corner[1], corner[2], corner[3]};
            visit(data, lower);
            visit(data, upper);
        }
}

/* Triangles in the box of the way, as the surface sees it. */
static int try_surface(follower *f, const oo_geom *geom, const double *shift, const double *motion) {
    surface v = {f, frame_of(geom->id), shift, motion};
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        double middle = 0, reach = 0;
        for (int j = 0; j < 3; j++) {
            middle += v.at.r[4 * j + k] * ((f->low[j] + f->high[j]) / 2 - v.at.p[j] + shift[j]);
            reach += fabs(v.at.r[4 * j + k]) * ((f->high[j] - f->low[j]) / 2 + fabs(shift[j]));
        }
        low[k] = middle - reach;
        high[k] = middle + reach;
    }
    if (!(geom->flags & OO_IS_HEIGHTFIELD)) return triangles_in(geom->mesh, low, high, try_triangle, &v);
    const field *heights = dGeomGetClassData(geom->id);
    if (low[1] <= heights->data->highest && high[0] >= -heights->width / 2 && low[0] <= heights->width / 2 &&
        high[2] >= -heights->depth / 2 && low[2] <= heights->depth / 2)
        visit_heights(heights, low, high, try_triangle, &v);
    return OO_OK;
}

static int can_stop(const oo_world *w, const follower *f, const oo_geom *other) {
    const oo_geom *own = &w->geoms[f->slot];
    dBodyID body = dGeomGetBody(other->id);
    if (body == f->body || (own->flags | other->flags) & (OO_SENSOR | OO_IS_RAY)) return 0;
    if (!(own->category & other->collide) || !(other->category & own->collide)) return 0;
    return !body || !dAreConnectedExcluding(f->body, body, dJointTypeContact);
}

static void try_geom(void *data, unsigned int slot) {
    follower *f = data;
    const oo_geom *geom = &f->world->geoms[slot];
    double shift[3] = {0}, motion[3], before = f->touch;
    if (f->wanted) {
        if (!f->wanted(f->asker, slot)) return;
    } else {
        if (!can_stop(f->world, f, geom) || !pair_declared(f->world, f->slot, slot)) return;
        if (f->carried_along && slot == f->carrier) return;
        if (!f->carried_along) displacement(f->world, dGeomGetBody(geom->id), shift);
    }
    for (int k = 0; k < 3; k++) motion[k] = f->motion[k] - shift[k];
    if (!isfinite(dot(motion, motion))) return; /* the step will say so */
    memcpy(f->shift, shift, sizeof f->shift);
    f->other = slot;
    f->met = UNKNOWN;
    shape other;
    if (geom->mesh && !is_hull(geom)) {
        if (try_surface(f, geom, shift, motion)) f->world->out_of_memory = 1;
    } else if (geom->mesh) {
        if (describe_hull(geom, &other)) {
            f->world->out_of_memory = 1;
            return;
        }
        move_back(&other, shift);
        try_shape(f, &other, motion);
        free((void *)other.points);
    } else if (describe(geom->id, &other)) {
        move_back(&other, shift);
        try_shape(f, &other, motion);
    }
    if (f->touch < before) f->touched = slot;
}

static void find_way(follower *f) {
    shape *s = &f->shape;
    for (int k = 0; k < 3; k++) {
        f->low[k] = INFINITY;
        f->high[k] = -INFINITY;
    }
    for (int k = 0; k < 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double way[3] = {0, 0, 0}, end[3];
            way[k] = sign;
            support(s, way, end);
            f->low[k] = fmin(f->low[k], end[k] - s->margin);
            f->high[k] = fmax(f->high[k], end[k] + s->margin);
        }
    for (int k = 0; k < 3; k++) {
        f->low[k] += fmin(f->motion[k], 0) - f->gap;
        f->high[k] += fmax(f->motion[k], 0) + f->gap;
    }
}

/* A little smaller, with a margin that makes up for it: how deep it is in something can be told within the margin. */
static void round_off(shape *s, double by) {
    if (s->kind == SHAPE_POINTS && by <= 0) return;
    double middle[3] = {0, 0, 0}, *points = (double *)s->points;
    for (int k = 0; k < 3; k++) s->half[k] = fmax(s->half[k] - by, 0);
    for (int i = 0; i < 3 * s->count; i++) middle[i % 3] += points[i] / s->count;
    for (int i = 0; i < 3 * s->count; i++) points[i] = middle[i % 3] + (1 - ROUNDED) * (points[i] - middle[i % 3]);
    s->margin += by;
}

static void follow_geom(follower *f, const oo_geom *geom, int as_point) {
    shape *s = &f->shape;
    if (as_point) {
        *s = f->middle;
    } else {
        if (geom->mesh) {
            if (describe_hull(geom, s)) {
                f->world->out_of_memory = 1;
                return;
            }
        } else if (!describe(geom->id, s)) {
            return;
        }
        f->rounded = s->kind == SHAPE_POINTS ? fmin(s->half[0], ROUNDED * f->thin) : ROUNDED * f->thin;
        if (s->margin == 0) round_off(s, f->rounded);
        move_back(s, f->motion);
    }
    find_way(f);
    near_way(f->world, f->low, f->high, try_geom, f);
    if (s->kind == SHAPE_POINTS) free((void *)s->points);
}

static int has_contacts(dBodyID body) {
    for (int i = 0; i < dBodyGetNumJoints(body); i++)
        if (dJointGetType(dBodyGetJoint(body, i)) == dJointTypeContact) return 1;
    return 0;
}

static void follow_geoms(follower *f, int as_point) {
    for (dGeomID geom = dBodyGetFirstGeom(f->body); geom; geom = dBodyGetNextGeom(geom)) {
        f->slot = (unsigned int)(size_t)dGeomGetData(geom);
        if (!dGeomIsEnabled(geom) || !dGeomGetSpace(geom) || f->world->geoms[f->slot].flags & (OO_SENSOR | OO_IS_RAY)) continue;
        follow_geom(f, &f->world->geoms[f->slot], as_point);
    }
}

/* What it hits goes on for the rest of the step, and takes it along as far as there is room: not through a wall. */
static void carry_along(const follower *hit, int as_point, double at[3]) {
    follower f = {.world = hit->world, .own = hit->own, .body = hit->body, .touch = 2, .thin = hit->thin, .gap = hit->gap,
                  .pressed = hit->pressed, .middle = hit->middle, .carried_along = 1, .carrier = hit->touched};
    for (int k = 0; k < 3; k++) {
        f.motion[k] = hit->carried * hit->normal[k];
        f.middle.position[k] = at[k];
        at[k] += f.motion[k];
    }
    dBodySetPosition(f.body, at[0], at[1], at[2]);
    follow_geoms(&f, as_point);
    if (f.touch > 1) return;
    for (int k = 0; k < 3; k++) at[k] = f.middle.position[k] + f.touch * f.motion[k] - f.into * f.normal[k];
}

static void follow_body(oo_world *w, oo_body *own) {
    follower f = {.world = w, .own = own, .body = own->id, .touch = 2, .thin = own->thin,
                  .gap = fmin(LITTLE * own->thin, AT_MOST), .pressed = has_contacts(own->id)};
    memcpy(f.motion, own->way, sizeof f.motion);
    const dReal *p = dBodyGetPosition(own->id);
    f.middle.kind = SHAPE_SEGMENT;
    for (int k = 0; k < 3; k++) {
        f.middle.position[k] = p[k] - f.motion[k];
        f.middle.rotation[5 * k] = 1;
    }
    int as_point = own->tunnelling == OO_TUNNEL_RAY;
    follow_geoms(&f, as_point);
    own->held = f.touch <= 1;
    own->watched = own->held ? WATCHED : own->watched - (own->watched > 0);
    if (!own->held) return;
    /* A little into what it hits; the centre of mass alone stops before it, by most of the body's thickness. */
    double into = as_point ? (ROUNDED - 1) * f.thin : f.into, at[3];
    for (int k = 0; k < 3; k++) at[k] = f.middle.position[k] + f.touch * f.motion[k] - into * f.normal[k];
    if (f.carried != 0) carry_along(&f, as_point, at);
    dBodySetPosition(own->id, at[0], at[1], at[2]);
    for (int k = 0; k < 3; k++) own->moved[k] = at[k] - f.middle.position[k];
}

static int is_fast(oo_world *w, unsigned int index) {
    oo_body *body = &w->bodies[index];
    if (!body->tunnelling || dBodyIsKinematic(body->id)) return 0;
    double way = find_motion(w, index, body->way);
    if (!(way <= 2 * POSITION_LIMIT)) return 0; /* it is about to be complained of */
    return way > body->thin / 2 || body->watched;
}

int stop_fast_bodies(oo_world *w) {
    int fast = 0;
    for (unsigned int i = 0; i < w->body_count && !fast; i++) fast = is_fast(w, i);
    if (!fast) {
        for (unsigned int i = 0; i < w->body_count; i++) w->bodies[i].held = 0;
        return OO_OK;
    }
    for (unsigned int i = 0; i < w->body_count; i++) {
        find_motion(w, i, w->bodies[i].way);
        memcpy(w->bodies[i].moved, w->bodies[i].way, sizeof w->bodies[i].moved);
    }
    if (begin_queries(w, 1)) return OO_NO_MEMORY;
    if (guard_enter()) {
        end_queries(w);
        return OO_ASSERT;
    }
    w->out_of_memory = 0;
    for (unsigned int i = 0; i < w->body_count; i++)
        if (w->bodies[i].tunnelling == OO_TUNNEL || !is_fast(w, i))
            w->bodies[i].held = 0;
        else
            follow_body(w, &w->bodies[i]);
    guard_leave();
    end_queries(w);
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}

int shape_of(const oo_geom *geom, shape *s) {
    if (is_hull(geom)) return describe_hull(geom, s) ? OO_NO_MEMORY : 1;
    return describe(geom->id, s);
}

void shape_done(shape *s) {
    if (s->kind == SHAPE_POINTS) free((void *)s->points);
}

double follow_shape(oo_world *w, shape *s, const double motion[3], int (*wanted)(void *, unsigned int), void *asker,
                    unsigned int *slot, double normal[3]) {
    follower f = {.world = w, .shape = *s, .touch = 2, .wanted = wanted, .asker = asker, .gap = 1e-7};
    memcpy(f.motion, motion, sizeof f.motion);
    find_way(&f);
    in_box(w, f.low, f.high, try_geom, &f);
    *slot = f.touched;
    memcpy(normal, f.normal, sizeof f.normal);
    return f.touch;
}

typedef struct nearest {
    const shape *shape;
    frame at;
    double distance, on_shape[3], on_other[3];
} nearest;

static void try_nearest(void *data, const double *corners[3]) {
    nearest *n = data;
    double points[9], on_shape[3], on_other[3];
    for (int c = 0; c < 3; c++) to_world(&n->at, corners[c], points + 3 * c);
    shape triangle = {.kind = SHAPE_POINTS, .points = points, .count = 3};
    double distance = closest_points(n->shape, &triangle, on_shape, on_other);
    if (distance >= n->distance) return;
    n->distance = distance;
    memcpy(n->on_shape, on_shape, sizeof on_shape);
    memcpy(n->on_other, on_other, sizeof on_other);
}

/* All triangles: for a question that is asked now and then. */
int nearest_on_surface(const shape *s, const oo_geom *geom, double *distance, double *on_shape, double *on_other) {
    nearest n = {.shape = s, .at = frame_of(geom->id), .distance = INFINITY};
    double low[3] = {-INFINITY, -INFINITY, -INFINITY}, high[3] = {INFINITY, INFINITY, INFINITY};
    if (geom->flags & OO_IS_HEIGHTFIELD)
        visit_heights(dGeomGetClassData(geom->id), low, high, try_nearest, &n);
    else if (triangles_in(geom->mesh, low, high, try_nearest, &n))
        return OO_NO_MEMORY;
    *distance = n.distance;
    memcpy(on_shape, n.on_shape, sizeof n.on_shape);
    memcpy(on_other, n.on_other, sizeof n.on_other);
    return OO_OK;
}
