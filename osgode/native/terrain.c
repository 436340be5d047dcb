/* What lies on heightfields: where it meets them, and how deep. */

#include "heightfield.h"

enum { MOST_SPHERES = 32, RIM = 6 };

static void add_spot(field *f, const double *p, const double *n, double depth) {
    if (reserve(&f->spots, &f->spot_capacity, f->spot_count + 1, sizeof *f->spots)) return;
    f->spots[f->spot_count++] = (spot){{p[0], p[1], p[2]}, {n[0], n[1], n[2]}, depth, INFINITY};
}

static double deepest(const field *f) {
    double depth = 0;
    for (unsigned int k = 0; k < f->spot_count; k++) depth = fmax(depth, f->spots[k].depth);
    return depth;
}

/* The range of samples or cells below a stretch, at most `last`. */
static void range(double low, double high, double step, double extent, int last, int *from, int *to) {
    *from = clamped(floor((low + extent / 2) / step), last);
    *to = clamped(floor((high + extent / 2) / step), last);
}

/* How far a point is above the surface, along y, and the normal there; INFINITY beyond the border or below all. */
static double above_surface(const field *f, const double *p, double *n) {
    const oo_mesh *m = f->data;
    double x = (p[0] + f->width / 2) / f->dx, z = (p[2] + f->depth / 2) / f->dz;
    if (x < 0 || x > m->columns - 1 || z < 0 || z > m->rows - 1 || p[1] < m->lowest - f->thickness) return INFINITY;
    int i = clamped(floor(x), (int)m->columns - 2), j = clamped(floor(z), (int)m->rows - 2);
    facet t = facet_of(m, i, j, x - i + z - j > 1);
    facet_normal(f, t, n);
    return p[1] - t.level - t.slope_x * (x - i) - t.slope_z * (z - j);
}

static void try_point(field *f, const double *p) {
    double n[3], above = above_surface(f, p, n);
    if (above < 0) add_spot(f, p, n, -above * n[1]);
}

static void sample_at(const field *f, int i, int j, double *p) {
    p[0] = i * f->dx - f->width / 2;
    p[1] = height_of(f->data, i, j);
    p[2] = j * f->dz - f->depth / 2;
}

static void sample_normal(const field *f, int i, int j, double *n) {
    const oo_mesh *m = f->data;
    int last_i = (int)m->columns - 1, last_j = (int)m->rows - 1;
    int west = i ? i - 1 : i, east = i < last_i ? i + 1 : i, north = j ? j - 1 : j, south = j < last_j ? j + 1 : j;
    facet t = {0, (height_of(m, east, j) - height_of(m, west, j)) / (east - west),
               (height_of(m, i, south) - height_of(m, i, north)) / (south - north)};
    facet_normal(f, t, n);
}

/* ------------------------------------------------------------------ spheres and capsules */

static void nearest_on_segment(const double *a, const double *b, const double *c, double *q) {
    double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double t = fmin(fmax(dot(ab, ac) / dot(ab, ab), 0), 1);
    for (int k = 0; k < 3; k++) q[k] = a[k] + t * ab[k];
}

static double distance(const double *a, const double *b) {
    double arm[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(arm, arm));
}

/* The point of a triangle nearest to c; 1 if it is within, 0 if it is on its edge. */
static int nearest_on_triangle(const double (*t)[3], const double *c, double *q) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
        w[k] = c[k] - t[0][k];
    }
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v), det = uu * vv - uv * uv;
    double a = (vv * wu - uv * wv) / det, b = (uu * wv - uv * wu) / det;
    if (a >= 0 && b >= 0 && a + b <= 1) {
        for (int k = 0; k < 3; k++) q[k] = t[0][k] + a * u[k] + b * v[k];
        return 1;
    }
    double best = INFINITY;
    for (int e = 0; e < 3; e++) {
        double on[3];
        nearest_on_segment(t[e], t[(e + 1) % 3], c, on);
        if (distance(on, c) >= best) continue;
        best = distance(on, c);
        memcpy(q, on, sizeof on);
    }
    return 0;
}

static void add_from(field *f, unsigned int first, const double *q, const double *c, double r) {
    double d = distance(q, c), n[3];
    for (unsigned int k = first; k < f->spot_count; k++)
        if (distance(f->spots[k].p, q) < 1e-6 * r) return; /* on the edge of two */
    for (int k = 0; k < 3; k++) n[k] = d > 1e-12 ? (c[k] - q[k]) / d : k == 1;
    add_spot(f, q, n, r - d);
}

/* Each triangle that it touches within; and the nearest point of all where that is an edge. Other points on edges are
   those over which it lies on the triangles beside. What has its middle below the surface is pushed out along its normal. */
static void meet_sphere(field *f, const double *c, double r) {
    const oo_mesh *m = f->data;
    double n[3], above = above_surface(f, c, n);
    if (above < 0) {
        double p[3] = {c[0] - r * n[0], c[1] - r * n[1], c[2] - r * n[2]};
        add_spot(f, p, n, r - above * n[1]);
        return;
    }
    if (c[1] - r > m->highest || c[1] < m->lowest - f->thickness) return;
    unsigned int first = f->spot_count;
    int i0, i1, j0, j1;
    range(c[0] - r, c[0] + r, f->dx, f->width, (int)m->columns - 2, &i0, &i1);
    range(c[2] - r, c[2] + r, f->dz, f->depth, (int)m->rows - 2, &j0, &j1);
    double nearest[3], least = r;
    int on_edge = 0;
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            double at[4][3];
            for (int k = 0; k < 4; k++) sample_at(f, i + k % 2, j + k / 2, at[k]);
            if (fmax(fmax(at[0][1], at[1][1]), fmax(at[2][1], at[3][1])) < c[1] - r) continue;
            for (int half = 0; half < 2; half++) {
                double q[3];
                int within = nearest_on_triangle((const double (*)[3])at + half, c, q);
                double d = distance(q, c);
                if (d >= r) continue;
                if (within) add_from(f, first, q, c, r);
                if (d > least - 1e-9 * r && (d > least || !within)) continue;
                least = d;
                on_edge = !within;
                memcpy(nearest, q, sizeof q);
            }
        }
    if (on_edge) add_from(f, first, nearest, c, r);
}

/* A row of spheres: both ends, and those between that are deeper. */
static void meet_capsule(field *f, const double *c, const double *axis, double r, double length) {
    int gaps = clamped(ceil(length / r), MOST_SPHERES);
    for (int pass = 0; pass < 2; pass++) {
        double depth = deepest(f) + 1e-4 * r;
        for (int k = 0; k <= gaps; k++) {
            if ((k == 0 || k == gaps) == pass) continue;
            double t = gaps ? length * ((double)k / gaps - 0.5) : 0, at[3];
            for (int x = 0; x < 3; x++) at[x] = c[x] + t * axis[x];
            unsigned int before = f->spot_count, kept = before;
            meet_sphere(f, at, r);
            for (unsigned int s = before; s < f->spot_count; s++)
                if (!pass || f->spots[s].depth > depth) f->spots[kept++] = f->spots[s];
            f->spot_count = kept;
        }
    }
}

/* ------------------------------------------------------------------ cylinders */

/* How far from a point inside it is out along a direction; below 0 if it is not inside. */
static double depth_in_cylinder(const double *p, const double *d, double r, double length) {
    double inside = r * r - p[0] * p[0] - p[1] * p[1], half = length / 2 - fabs(p[2]);
    if (inside <= 0 || half <= 0) return -1;
    double dd = d[0] * d[0] + d[1] * d[1], pd = p[0] * d[0] + p[1] * d[1];
    double side = dd < 1e-12 ? INFINITY : (-pd + sqrt(pd * pd + dd * inside)) / dd;
    double end = fabs(d[2]) < 1e-12 ? INFINITY : (length / 2 - (d[2] > 0 ? p[2] : -p[2])) / fabs(d[2]);
    return fmin(side, end);
}

/* Points of both rims, the lowest first; and peaks of the ground inside. */
static void meet_cylinder(field *f, const frame *at, dGeomID id, const double *c, const double *axis) {
    dReal r, length;
    dGeomCylinderGetParams(id, &r, &length);
    double n[3] = {0, 1, 0}, down[3], across[3];
    above_surface(f, c, n);
    double along = dot(n, axis);
    for (int k = 0; k < 3; k++) down[k] = along * axis[k] - n[k];
    double size = sqrt(dot(down, down));
    if (size < 1e-9) { /* upright: any direction will do */
        double other[3] = {fabs(axis[0]) < 0.6, fabs(axis[0]) >= 0.6, 0}, part = dot(other, axis);
        for (int k = 0; k < 3; k++) down[k] = other[k] - part * axis[k];
        size = sqrt(dot(down, down));
    }
    for (int k = 0; k < 3; k++) down[k] /= size;
    for (int k = 0; k < 3; k++) across[k] = axis[(k + 1) % 3] * down[(k + 2) % 3] - axis[(k + 2) % 3] * down[(k + 1) % 3];
    for (int k = 0; k < 2 * RIM; k++) {
        double angle = k / 2 * (2 * M_PI / RIM), end = k % 2 ? length / 2 : -length / 2, p[3];
        for (int x = 0; x < 3; x++) p[x] = c[x] + end * axis[x] + r * (cos(angle) * down[x] + sin(angle) * across[x]);
        try_point(f, p);
    }
    frame own = frame_of(id);
    double reach = sqrt(r * r + length * length / 4), floor_of_it = c[1] - reach;
    int i0, i1, j0, j1;
    range(c[0] - reach, c[0] + reach, f->dx, f->width, (int)f->data->columns - 1, &i0, &i1);
    range(c[2] - reach, c[2] + reach, f->dz, f->depth, (int)f->data->rows - 1, &j0, &j1);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            double p[3], up[3], world[3], local[3], out[3];
            sample_at(f, i, j, p);
            if (p[1] < floor_of_it) continue;
            sample_normal(f, i, j, up);
            to_world(at, p, world);
            to_local(&own, world, local);
            turn(at, up, world);
            turn_back(&own, world, out);
            for (int k = 0; k < 3; k++) out[k] = -out[k];
            double depth = depth_in_cylinder(local, out, r, length);
            if (depth > 0) add_spot(f, p, up, depth);
        }
}

/* ------------------------------------------------------------------ boxes, hulls, meshes */

/* How deep a point is in a polytope, out along -n, or below 0. */
static double depth_in_polytope(const polytope *b, const double *p, const double *n) {
    double depth = INFINITY;
    for (unsigned int k = 0; k < b->plane_count; k++) {
        const double *plane = b->planes + 4 * k;
        double inside = plane[3] - dot(plane, p), speed = -dot(plane, n);
        if (inside <= 0) return -1;
        if (speed > 1e-12) depth = fmin(depth, inside / speed);
    }
    return depth;
}

static void try_inside(field *f, const frame *at, const polytope *b, const double *p, const double *n, double least) {
    double world[3], local[3], turned[3], down[3];
    to_world(at, p, world);
    to_local(&b->at, world, local);
    turn(at, n, turned);
    turn_back(&b->at, turned, down);
    double depth = depth_in_polytope(b, local, down);
    if (depth > least) add_spot(f, p, n, depth);
}

/* The middle of the part of an edge of the ground that is inside; what has an end inside has been met there. */
static void try_edge(field *f, const frame *at, const polytope *b, const int *from, const int *to, double least) {
    double ends[2][3], local[2][3], world[3], first = 0, last = 1;
    for (int k = 0; k < 2; k++) {
        sample_at(f, k ? to[0] : from[0], k ? to[1] : from[1], ends[k]);
        to_world(at, ends[k], world);
        to_local(&b->at, world, local[k]);
    }
    for (unsigned int k = 0; k < b->plane_count; k++) {
        const double *plane = b->planes + 4 * k;
        double d0 = dot(plane, local[0]) - plane[3], d1 = dot(plane, local[1]) - plane[3];
        if (d0 > 0 && d1 > 0) return;
        if (d0 > 0) first = fmax(first, d0 / (d0 - d1));
        if (d1 > 0) last = fmin(last, d0 / (d0 - d1));
    }
    if (first >= last || first == 0 || last == 1) return;
    double t = (first + last) / 2, p[3], n[3], m[3];
    sample_normal(f, from[0], from[1], n);
    sample_normal(f, to[0], to[1], m);
    for (int k = 0; k < 3; k++) {
        p[k] = ends[0][k] + t * (ends[1][k] - ends[0][k]);
        n[k] += m[k];
    }
    double size = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) n[k] /= size;
    try_inside(f, at, b, p, n, least);
}

/* Its corners below the surface; peaks of the ground inside it; and ridges inside it that are deeper than those. */
static void meet_polytope(field *f, const frame *at, const polytope *b) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (unsigned int k = 0; k < b->vertex_count; k++) {
        double world[3], p[3];
        to_world(&b->at, b->vertices + 3 * k, world);
        to_local(at, world, p);
        for (int c = 0; c < 3; c++) {
            low[c] = fmin(low[c], p[c]);
            high[c] = fmax(high[c], p[c]);
        }
        try_point(f, p);
    }
    if (!b->planes || low[1] > f->data->highest) return;
    int i0, i1, j0, j1, last_i = (int)f->data->columns - 1, last_j = (int)f->data->rows - 1;
    range(low[0], high[0], f->dx, f->width, last_i, &i0, &i1);
    range(low[2], high[2], f->dz, f->depth, last_j, &j0, &j1);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            double p[3], n[3];
            sample_at(f, i, j, p);
            if (p[1] <= low[1] || p[1] >= high[1]) continue;
            sample_normal(f, i, j, n);
            try_inside(f, at, b, p, n, 0);
        }
    double least = deepest(f) + 1e-4 * (high[1] - low[1]);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const int here[2] = {i, j}, east[2] = {i + 1, j}, south[2] = {i, j + 1};
            if (i < last_i) try_edge(f, at, b, here, east, least);
            if (j < last_j) try_edge(f, at, b, here, south, least);
            if (i < last_i && j < last_j) try_edge(f, at, b, east, south, least);
        }
}

/* ------------------------------------------------------------------ contacts */

/* The deepest first, then always the one that is farthest from those taken: few contacts must hold up the whole. */
static const spot *next_spot(field *f, const spot *taken) {
    spot *best = f->spots;
    for (unsigned int k = 0; k < f->spot_count; k++) {
        spot *s = &f->spots[k];
        if (taken) s->apart = fmin(s->apart, distance(s->p, taken->p));
        if (taken ? s->apart > best->apart : s->depth > best->depth) best = s;
    }
    return best;
}

/* Contact rows of the spots, their normals out of the ground. */
static int tell(field *f, const frame *at, dGeomID first, dGeomID second, int most, dContactGeom *rows, int skip) {
    int all = f->spot_count <= (unsigned int)most, count = all ? (int)f->spot_count : most;
    const spot *s = NULL;
    for (int k = 0; k < count; k++) {
        s = all ? &f->spots[k] : next_spot(f, s);
        dContactGeom *row = row_at(rows, k, skip);
        to_world(at, s->p, row->pos);
        turn(at, s->n, row->normal);
        row->depth = s->depth;
        row->g1 = first;
        row->g2 = second;
        row->side1 = row->side2 = -1;
    }
    return count;
}

int collide_mesh_with_heightfield(const oo_geom *geom, const oo_geom *field_geom, int most, dContactGeom *rows, int skip) {
    field *f = dGeomGetClassData(field_geom->id);
    frame at = frame_of(field_geom->id);
    polytope b;
    polytope_of(geom->id, geom->mesh, &b);
    f->spot_count = 0;
    meet_polytope(f, &at, &b);
    return tell(f, &at, geom->id, field_geom->id, most, rows, skip);
}

int collide_field_with_shape(dGeomID id, dGeomID other, int flags, dContactGeom *rows, int skip) {
    field *f = dGeomGetClassData(id);
    frame at = frame_of(id), own = frame_of(other);
    double c[3], axis[3], along[3] = {own.r[2], own.r[6], own.r[10]};
    dReal radius, length;
    polytope b;
    to_local(&at, own.p, c);
    turn_back(&at, along, axis);
    f->spot_count = 0;
    switch (dGeomGetClass(other)) {
        case dSphereClass: meet_sphere(f, c, dGeomSphereGetRadius(other)); break;
        case dCapsuleClass:
            dGeomCapsuleGetParams(other, &radius, &length);
            meet_capsule(f, c, axis, radius, length);
            break;
        case dCylinderClass: meet_cylinder(f, &at, other, c, axis); break;
        case dBoxClass:
            polytope_of(other, NULL, &b);
            meet_polytope(f, &at, &b);
            break;
    }
    int count = tell(f, &at, id, other, flags & 0xffff, rows, skip);
    for (int k = 0; k < count; k++)
        for (int x = 0; x < 3; x++) row_at(rows, k, skip)->normal[x] *= -1; /* into the first: down into the ground */
    return count;
}
