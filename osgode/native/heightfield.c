/* Heightfields: a geom class of our own.

   Spheres fall through ODE's where the ground is hollow, its box is too small once it is turned, it loses contacts of
   meshes, and takes time and memory by the square of the samples below a geom: a ray of 100 m needs gigabytes. */

#include "heightfield.h"

static const double EDGE = 1e-9; /* samples beyond the border that a ray still meets: it may stand on it but for rounding */
static int field_class;

facet facet_of(const oo_mesh *m, int i, int j, int upper) {
    double b = height_of(m, i + 1, j), c = height_of(m, i, j + 1);
    if (!upper) {
        double a = height_of(m, i, j);
        return (facet){a, b - a, c - a};
    }
    double d = height_of(m, i + 1, j + 1);
    return (facet){b + c - d, d - c, d - b};
}

void facet_normal(const field *f, facet t, double *n) {
    double x = -t.slope_x / f->dx, z = -t.slope_z / f->dz, length = sqrt(x * x + 1 + z * z);
    n[0] = x / length;
    n[1] = 1 / length;
    n[2] = z / length;
}

/* ------------------------------------------------------------------ rays */

typedef struct walk { /* a ray over the cells, in samples along x and z, and metres along y */
    const field *f;
    double o[3], d[3];
    double *hits;          /* distances */
    facet *facets;
    int found, most, cull, closest;
} walk;

/* From a to b (metres along the ray) it is over one triangle: there the height above it changes evenly. */
static void walk_triangle(walk *w, int i, int j, double a, double b) {
    double middle = (a + b) / 2;
    double u = w->o[0] + middle * w->d[0] - i, v = w->o[2] + middle * w->d[2] - j;
    facet t = facet_of(w->f->data, i, j, u + v > 1);
    double rate = w->d[1] - t.slope_x * w->d[0] - t.slope_z * w->d[2];
    double over = w->o[1] - t.level - t.slope_x * (w->o[0] - i) - t.slope_z * (w->o[2] - j);
    double from = over + a * rate, to = over + b * rate;
    if ((from > 0 && to > 0) || (from < 0 && to < 0) || w->found == w->most) return;
    if (w->cull && rate > 0) return; /* from below */
    double hit = from == to ? a : a + (b - a) * from / (from - to);
    if (w->found && hit - w->hits[w->found - 1] < 1e-9 * (1 + hit)) return; /* on the edge of two triangles */
    w->hits[w->found] = hit;
    w->facets[w->found++] = t;
}

static void walk_cell(walk *w, int i, int j, double a, double b) {
    double from = w->o[0] + a * w->d[0] - i + w->o[2] + a * w->d[2] - j - 1;
    double to = from + (b - a) * (w->d[0] + w->d[2]);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) { /* across the diagonal */
        double middle = a + (b - a) * from / (from - to);
        walk_triangle(w, i, j, a, middle);
        a = middle;
    }
    walk_triangle(w, i, j, a, b);
}

/* The part of the ray that is within a slab, metres along it. */
static void clip(double o, double d, double low, double high, double *from, double *to) {
    if (d == 0) {
        if (o < low || o > high) *to = -1;
        return;
    }
    double a = (low - o) / d, b = (high - o) / d;
    *from = fmax(*from, fmin(a, b));
    *to = fmin(*to, fmax(a, b));
}

/* How far along the ray the next cell begins; there is none beyond the last. */
static double next_border(double o, double d, int at, int last) {
    if (d == 0 || at == (d > 0 ? last : 0)) return INFINITY;
    return (at + (d > 0) - o) / d;
}

static void walk_cells(walk *w, double length) {
    const oo_mesh *m = w->f->data;
    int last_i = (int)m->columns - 2, last_j = (int)m->rows - 2;
    double from = 0, to = length;
    clip(w->o[0], w->d[0], -EDGE, last_i + 1 + EDGE, &from, &to);
    clip(w->o[2], w->d[2], -EDGE, last_j + 1 + EDGE, &from, &to);
    double margin = 1e-9 * (1 + fabs(m->lowest) + fabs(m->highest)); /* flat ground is a slab without height */
    clip(w->o[1], w->d[1], m->lowest - margin, m->highest + margin, &from, &to);
    if (from > to) return;
    int i = clamped(floor(w->o[0] + from * w->d[0]), last_i), j = clamped(floor(w->o[2] + from * w->d[2]), last_j);
    for (;;) { /* i and j go one way only, so this ends */
        double next_x = next_border(w->o[0], w->d[0], i, last_i), next_z = next_border(w->o[2], w->d[2], j, last_j);
        double next = fmax(from, fmin(to, fmin(next_x, next_z)));
        walk_cell(w, i, j, from, next);
        if ((w->closest && w->found) || w->found == w->most || fmin(next_x, next_z) >= to) return;
        from = next;
        if (next_x <= next_z)
            i += w->d[0] > 0 ? 1 : -1;
        else
            j += w->d[2] > 0 ? 1 : -1;
    }
}

static int collide_field_with_ray(dGeomID id, dGeomID ray, int flags, dContactGeom *rows, int skip) {
    const field *f = dGeomGetClassData(id);
    enum { MOST_HITS = 256 };
    double hits[MOST_HITS];
    facet facets[MOST_HITS];
    frame at = frame_of(id);
    dVector3 start, direction;
    dGeomRayGet(ray, start, direction);
    int most = flags & 0xffff;
    walk w = {.f = f, .hits = hits, .facets = facets, .most = most < MOST_HITS ? most : MOST_HITS};
    w.cull = dGeomRayGetBackfaceCull(ray);
    w.closest = dGeomRayGetClosestHit(ray) || dGeomRayGetFirstContact(ray);
    to_local(&at, start, w.o);
    turn_back(&at, direction, w.d);
    w.o[0] = (w.o[0] + f->width / 2) / f->dx;
    w.o[2] = (w.o[2] + f->depth / 2) / f->dz;
    w.d[0] /= f->dx;
    w.d[2] /= f->dz;
    walk_cells(&w, dGeomRayGetLength(ray));
    for (int k = 0; k < w.found; k++) {
        dContactGeom *row = row_at(rows, k, skip);
        double n[3];
        facet_normal(f, facets[k], n);
        turn(&at, n, row->normal);
        for (int c = 0; c < 3; c++) row->pos[c] = start[c] + hits[k] * direction[c];
        row->depth = hits[k];
        row->g1 = id;
        row->g2 = ray;
        row->side1 = row->side2 = -1;
    }
    return w.found;
}

static dColliderFn *collider_with(int class) {
    switch (class) {
        case dRayClass: return collide_field_with_ray;
        case dSphereClass:
        case dBoxClass:
        case dCapsuleClass:
        case dCylinderClass: return collide_field_with_shape;
        default: return NULL;
    }
}

/* ------------------------------------------------------------------ being made */

static void find_box(dGeomID id, dReal box[6]) {
    const field *f = dGeomGetClassData(id);
    frame at = frame_of(id);
    double low = f->data->lowest - f->thickness, high = f->data->highest;
    double middle[3] = {0, (low + high) / 2, 0}, half[3] = {f->width / 2, (high - low) / 2, f->depth / 2}, centre[3];
    to_world(&at, middle, centre);
    for (int k = 0; k < 3; k++) {
        const dReal *row = at.r + 4 * k;
        double reach = fabs(row[0]) * half[0] + fabs(row[1]) * half[1] + fabs(row[2]) * half[2];
        box[2 * k] = centre[k] - reach;
        box[2 * k + 1] = centre[k] + reach;
    }
}

static void shape(field *f, const double *d) {
    f->width = d[0];
    f->depth = d[1];
    f->thickness = d[2];
    f->dx = d[0] / (f->data->columns - 1);
    f->dz = d[1] / (f->data->rows - 1);
}

static void release(dGeomID id) { free(((field *)dGeomGetClassData(id))->spots); }

dGeomID heightfield_new(const oo_mesh *data, const double *dimensions) {
    dGeomID id = dCreateGeom(field_class);
    field *f = dGeomGetClassData(id);
    f->data = data;
    shape(f, dimensions);
    return id;
}

int oo_heightfield_resize(dGeomID id, const double *dimensions) {
    if (guard_enter()) return OO_ASSERT;
    shape(dGeomGetClassData(id), dimensions);
    const dReal *p = dGeomGetPosition(id); /* to the same place: ODE notes that its box is another */
    dBodyID body = dGeomGetBody(id);
    if (body) {
        const dReal *at = dBodyGetPosition(body);
        dBodySetPosition(body, at[0], at[1], at[2]);
    } else {
        dGeomSetPosition(id, p[0], p[1], p[2]);
    }
    guard_leave();
    return OO_OK;
}

void init_heightfields(void) {
    dGeomClass class = {.bytes = sizeof(field), .collider = collider_with, .aabb = find_box, .dtor = release};
    field_class = dCreateGeomClass(&class);
}
