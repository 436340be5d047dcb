/* Heightfields: a geom class of our own around ODE's.

   ODE's has a box that is too small once it is turned, takes time and memory by the square of the samples below a geom
   (a ray of 100 m needs gigabytes), and loses contacts of meshes. So the box, rays and meshes are done here, and
   spheres, boxes, capsules and cylinders by ODE's heightfield, which stands in no space and is put where ours is. */

#include "internal.h"

enum {
    MOST_CELLS = 1600,      /* above ODE's lowest point of a geom: 10 ms and 40 MB */
    MOST_LOOKED_AT = 200000 /* below a geom altogether: 40 MB */
};

typedef struct spot { /* where a mesh meets a heightfield, in the axes of the heightfield */
    double p[3], n[3], depth, apart;
} spot;

typedef struct field {
    const oo_mesh *data;
    double width, depth, thickness;
    double dx, dz;              /* from sample to sample */
    dHeightfieldDataID heights;
    dGeomID inner;
    spot *spots;                /* room to work in */
    unsigned int spot_count, spot_capacity;
} field;

static const double EDGE = 1e-9; /* samples beyond the border that a ray still meets: it may stand on it but for rounding */
static int field_class;
static __thread int too_fine;

static double height(const oo_mesh *m, int i, int j) { return m->vertices[(size_t)j * m->columns + (size_t)i]; }

/* The plane y = level + slope_x u + slope_z v of a triangle of cell (i, j), u and v from 0 to 1 across the cell.
   ODE divides a cell from its (1, 0) corner to its (0, 1) corner. */
typedef struct facet {
    double level, slope_x, slope_z;
} facet;

static facet facet_of(const oo_mesh *m, int i, int j, int upper) {
    double b = height(m, i + 1, j), c = height(m, i, j + 1);
    if (!upper) {
        double a = height(m, i, j);
        return (facet){a, b - a, c - a};
    }
    double d = height(m, i + 1, j + 1);
    return (facet){b + c - d, d - c, d - b};
}

static void facet_normal(const field *f, facet t, double *n) {
    double x = -t.slope_x / f->dx, z = -t.slope_z / f->dz, length = sqrt(x * x + 1 + z * z);
    n[0] = x / length;
    n[1] = 1 / length;
    n[2] = z / length;
}

static int clamped(double value, int high) { return value < 0 ? 0 : value > high ? high : (int)value; }

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

/* ------------------------------------------------------------------ what ODE's heightfield does */

/* The box of another geom in the axes of the heightfield: middle and half the edges. */
static void local_box(const frame *at, dGeomID other, double *centre, double *half) {
    dReal box[6];
    dGeomGetAABB(other, box);
    double middle[3], edges[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = (box[2 * k] + box[2 * k + 1]) / 2;
        edges[k] = (box[2 * k + 1] - box[2 * k]) / 2;
    }
    to_local(at, middle, centre);
    for (int k = 0; k < 3; k++)
        half[k] = fabs(at->r[k]) * edges[0] + fabs(at->r[4 + k]) * edges[1] + fabs(at->r[8 + k]) * edges[2];
}

/* Whether ODE can do it: 1, 0 if there is nothing to do, -1 if the samples are too fine. */
static int can_collide(const field *f, const frame *at, dGeomID other) {
    double centre[3], half[3];
    local_box(at, other, centre, half);
    double low_x = (centre[0] - half[0] + f->width / 2) / f->dx, high_x = (centre[0] + half[0] + f->width / 2) / f->dx;
    double low_z = (centre[2] - half[2] + f->depth / 2) / f->dz, high_z = (centre[2] + half[2] + f->depth / 2) / f->dz;
    if (fmax(fmax(-low_x, high_x), fmax(-low_z, high_z)) > 1e9) return -1; /* ODE counts them in an int */
    int last_i = (int)f->data->columns - 2, last_j = (int)f->data->rows - 2;
    int i0 = clamped(low_x - 1, last_i), i1 = clamped(high_x + 1, last_i);
    int j0 = clamped(low_z - 1, last_j), j1 = clamped(high_z + 1, last_j);
    long cells = (long)(i1 - i0 + 1) * (j1 - j0 + 1);
    if (cells <= MOST_CELLS) return 1;
    long reached = 0;
    double lowest = centre[1] - half[1];
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const oo_mesh *m = f->data;
            double top = fmax(fmax(height(m, i, j), height(m, i + 1, j)), fmax(height(m, i, j + 1), height(m, i + 1, j + 1)));
            reached += top > lowest;
        }
    return !reached ? 0 : reached > MOST_CELLS || cells > MOST_LOOKED_AT ? -1 : 1;
}

int heightfield_was_too_fine(void) {
    int was = too_fine;
    too_fine = 0;
    return was;
}

static int collide_field_with_shape(dGeomID id, dGeomID other, int flags, dContactGeom *rows, int skip) {
    const field *f = dGeomGetClassData(id);
    frame at = frame_of(id);
    int can = can_collide(f, &at, other);
    too_fine = can < 0;
    if (can <= 0) return 0;
    dGeomSetPosition(f->inner, at.p[0], at.p[1], at.p[2]);
    dGeomSetRotation(f->inner, at.r);
    int found = dCollide(f->inner, other, flags, rows, skip);
    for (int k = 0; k < found; k++) row_at(rows, k, skip)->g1 = id;
    return found;
}

static dColliderFn *collider_with(int class) {
    switch (class) {
        case dRayClass: return collide_field_with_ray;
        case dSphereClass:
        case dBoxClass:
        case dCapsuleClass:
        case dCylinderClass:
        case dConvexClass:
        case dTriMeshClass: return collide_field_with_shape;
        default: return NULL;
    }
}

/* ------------------------------------------------------------------ meshes and hulls */

static void add_spot(field *f, const double *p, const double *n, double depth) {
    if (reserve(&f->spots, &f->spot_capacity, f->spot_count + 1, sizeof *f->spots)) return;
    f->spots[f->spot_count++] = (spot){{p[0], p[1], p[2]}, {n[0], n[1], n[2]}, depth, INFINITY};
}

/* Corners of the mesh below the surface. */
static void find_corners(field *f, const frame *at, const oo_geom *geom, double *low, double *high) {
    frame mesh_at = frame_of(geom->id);
    const oo_mesh *m = f->data;
    for (unsigned int k = 0; k < geom->mesh->vertex_count; k++) {
        double world[3], p[3], n[3];
        to_world(&mesh_at, geom->mesh->vertices + 3 * k, world);
        to_local(at, world, p);
        for (int c = 0; c < 3; c++) {
            low[c] = fmin(low[c], p[c]);
            high[c] = fmax(high[c], p[c]);
        }
        double x = (p[0] + f->width / 2) / f->dx, z = (p[2] + f->depth / 2) / f->dz;
        if (x < 0 || x > m->columns - 1 || z < 0 || z > m->rows - 1) continue;
        if (p[1] >= m->highest || p[1] < m->lowest - f->thickness) continue;
        int i = clamped(floor(x), (int)m->columns - 2), j = clamped(floor(z), (int)m->rows - 2);
        facet t = facet_of(m, i, j, x - i + z - j > 1);
        double above = p[1] - t.level - t.slope_x * (x - i) - t.slope_z * (z - j);
        if (above >= 0) continue;
        facet_normal(f, t, n);
        add_spot(f, p, n, -above * n[1]);
    }
}

/* How deep a point is in a hull, out along -n, or below 0. */
static double depth_in_hull(const oo_mesh *hull, const double *p, const double *n) {
    double depth = INFINITY;
    for (unsigned int k = 0; k < hull->plane_count; k++) {
        const double *plane = hull->planes + 4 * k;
        double inside = plane[3] - dot(plane, p), speed = -dot(plane, n);
        if (inside <= 0) return -1;
        if (speed > 1e-12) depth = fmin(depth, inside / speed);
    }
    return depth;
}

/* Samples of the surface inside the hull: peaks that its corners don't meet. */
static void find_peaks(field *f, const frame *at, const oo_geom *geom, const double *low, const double *high) {
    frame hull_at = frame_of(geom->id);
    const oo_mesh *m = f->data;
    int last_i = (int)m->columns - 1, last_j = (int)m->rows - 1;
    int i0 = clamped((low[0] + f->width / 2) / f->dx, last_i), i1 = clamped((high[0] + f->width / 2) / f->dx, last_i);
    int j0 = clamped((low[2] + f->depth / 2) / f->dz, last_j), j1 = clamped((high[2] + f->depth / 2) / f->dz, last_j);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            double p[3] = {i * f->dx - f->width / 2, height(m, i, j), j * f->dz - f->depth / 2};
            if (p[1] <= low[1] || p[1] >= high[1]) continue;
            int west = i ? i - 1 : i, east = i < last_i ? i + 1 : i, north = j ? j - 1 : j, south = j < last_j ? j + 1 : j;
            facet t = {0, (height(m, east, j) - height(m, west, j)) / (east - west),
                       (height(m, i, south) - height(m, i, north)) / (south - north)};
            double n[3], world[3], turned[3], local[3], down[3];
            facet_normal(f, t, n);
            to_world(at, p, world);
            turn(at, n, turned);
            to_local(&hull_at, world, local);
            turn_back(&hull_at, turned, down);
            double depth = depth_in_hull(geom->mesh, local, down);
            if (depth > 0) add_spot(f, p, n, depth);
        }
}

/* The deepest first, then always the one that is farthest from those taken: few contacts must hold up the whole. */
static unsigned int next_spot(field *f, const spot *taken) {
    unsigned int best = 0;
    for (unsigned int k = 0; k < f->spot_count; k++) {
        spot *s = &f->spots[k];
        if (taken) {
            double arm[3] = {s->p[0] - taken->p[0], s->p[1] - taken->p[1], s->p[2] - taken->p[2]};
            s->apart = fmin(s->apart, dot(arm, arm));
        }
        if (taken ? s->apart > f->spots[best].apart : s->depth > f->spots[best].depth) best = k;
    }
    return best;
}

int collide_mesh_with_heightfield(const oo_geom *geom, const oo_geom *field_geom, int most, dContactGeom *rows, int skip) {
    field *f = dGeomGetClassData(field_geom->id);
    frame at = frame_of(field_geom->id);
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    f->spot_count = 0;
    find_corners(f, &at, geom, low, high);
    if (geom->mesh->planes) find_peaks(f, &at, geom, low, high);
    int all = f->spot_count <= (unsigned int)most, count = all ? (int)f->spot_count : most;
    const spot *last = NULL;
    for (int k = 0; k < count; k++) {
        const spot *s = &f->spots[all ? (unsigned int)k : next_spot(f, last)];
        last = s;
        dContactGeom *row = row_at(rows, k, skip);
        to_world(&at, s->p, row->pos);
        turn(&at, s->n, row->normal);
        row->depth = s->depth;
        row->g1 = geom->id;
        row->g2 = field_geom->id;
        row->side1 = row->side2 = -1;
    }
    return count;
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

/* ODE asserts where its rounding finds a geom at the very edge to be beyond the last sample. */
static double safe_extent(double extent, unsigned int samples) {
    double cells = (double)samples - 1;
    while (extent * (1.0 / (extent / cells)) > cells) extent = nextafter(extent, 0);
    return extent;
}

static void shape(field *f, const double *d) {
    const oo_mesh *m = f->data;
    f->width = safe_extent(d[0], m->columns);
    f->depth = safe_extent(d[1], m->rows);
    f->thickness = d[2];
    f->dx = f->width / (m->columns - 1);
    f->dz = f->depth / (m->rows - 1);
    dGeomHeightfieldDataBuildDouble(f->heights, m->vertices, 0, f->width, f->depth, (int)m->columns, (int)m->rows, 1, 0,
                                    f->thickness, 0);
}

static void release(dGeomID id) {
    field *f = dGeomGetClassData(id);
    if (f->inner) dGeomDestroy(f->inner);
    if (f->heights) dGeomHeightfieldDataDestroy(f->heights);
    free(f->spots);
}

dGeomID heightfield_new(const oo_mesh *data, const double *dimensions) {
    dGeomID id = dCreateGeom(field_class);
    field *f = dGeomGetClassData(id);
    f->data = data;
    f->heights = dGeomHeightfieldDataCreate();
    shape(f, dimensions);
    f->inner = dCreateHeightfield(0, f->heights, 1);
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
