/* How hulls and boxes meet each other. ODE has one contact for two convex geoms, on which nothing lies still, and
   meshes that lie face on face burst apart. Here the direction is that of the face that is overlapped least; contacts are
   corners of one over the other, and crossings of their edges, as deep as the line through both along that direction. */

#include "internal.h"

enum { MOST_SPOTS = 512, MOST_KEPT = 8 };

typedef struct spot {
    double x[2], middle, depth, apart;
} spot;

typedef struct meeting {
    double n[3], u[3], v[3]; /* n from b to a */
    double size;
    spot spots[MOST_SPOTS];
    int count;
} meeting;

void polytope_of(dGeomID id, const oo_mesh *mesh, polytope *out) {
    out->at = frame_of(id);
    if (mesh) {
        out->vertices = mesh->vertices;
        out->vertex_count = mesh->vertex_count;
        out->planes = mesh->planes;
        out->plane_count = mesh->plane_count;
        return;
    }
    dVector3 size;
    dGeomBoxGetLengths(id, size);
    memset(out->box_planes, 0, sizeof out->box_planes);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) out->box_vertices[3 * i + k] = (i >> k & 1 ? 0.5 : -0.5) * size[k];
    for (int i = 0; i < 6; i++) {
        out->box_planes[4 * i + i / 2] = i % 2 ? 1 : -1;
        out->box_planes[4 * i + 3] = size[i / 2] / 2;
    }
    out->vertices = out->box_vertices;
    out->vertex_count = 8;
    out->planes = out->box_planes;
    out->plane_count = 6;
}

/* The least of n . p over its corners. */
static double lowest(const polytope *p, const double *n) {
    double local[3], least = INFINITY;
    turn_back(&p->at, n, local);
    for (unsigned int i = 0; i < p->vertex_count; i++) least = fmin(least, dot(local, p->vertices + 3 * i));
    return least + dot(n, p->at.p);
}

/* The face of a that b is least beyond: how far, below 0 where they overlap, and its normal. */
static double least_overlap(const polytope *a, const polytope *b, double *normal) {
    double best = -INFINITY;
    for (unsigned int i = 0; i < a->plane_count; i++) {
        const double *plane = a->planes + 4 * i;
        double n[3];
        turn(&a->at, plane, n);
        double apart = lowest(b, n) - plane[3] - dot(n, a->at.p);
        if (apart > best) {
            best = apart;
            memcpy(normal, n, sizeof n);
        }
        if (best > 0) break;
    }
    return best;
}

static int by_place(const void *a, const void *b) {
    const double *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return p[1] < q[1] ? -1 : p[1] > q[1];
}

double side_of(const double *o, const double *a, const double *b) {
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/* The convex outline of points of the plane (A. M. Andrew's monotone chain, 1979). */
void outline_of(double (*points)[2], int count, outline *out) {
    qsort(points, (size_t)count, sizeof *points, by_place);
    double chain[2 * MOST_CORNERS][2];
    int n = 0;
    for (int pass = 0; pass < 2; pass++) { /* below from left to right, then above and back */
        int start = n;
        for (int k = 0; k < count; k++) {
            const double *p = points[pass ? count - 1 - k : k];
            while (n >= start + 2 && side_of(chain[n - 2], chain[n - 1], p) <= 0) n--;
            memcpy(chain[n++], p, sizeof *chain);
        }
        n--; /* the last is the first of the other half */
    }
    out->count = n < 1 ? 1 : n > MOST_CORNERS ? MOST_CORNERS : n;
    if (n < 1) memcpy(chain[0], points[0], sizeof *chain);
    memcpy(out->corners, chain, (size_t)out->count * sizeof *chain);
}

/* The corners within `reach` of the farthest along n, seen along the meeting's direction. */
static void face_towards(const polytope *p, const meeting *m, const double *n, double reach, outline *out) {
    double local[3], points[MOST_CORNERS][2], least = INFINITY;
    int count = 0;
    turn_back(&p->at, n, local);
    for (unsigned int i = 0; i < p->vertex_count; i++) least = fmin(least, dot(local, p->vertices + 3 * i));
    for (unsigned int i = 0; i < p->vertex_count && count < MOST_CORNERS; i++) {
        const double *corner = p->vertices + 3 * i;
        if (dot(local, corner) > least + reach) continue;
        double world[3];
        to_world(&p->at, corner, world);
        points[count][0] = dot(m->u, world);
        points[count++][1] = dot(m->v, world);
    }
    outline_of(points, count, out);
}

/* Where the line through x along n is inside: 0 if nowhere. */
static int span(const polytope *p, const meeting *m, const double *x, double *from, double *to) {
    double start[3], o[3], d[3];
    for (int k = 0; k < 3; k++) start[k] = x[0] * m->u[k] + x[1] * m->v[k];
    to_local(&p->at, start, o);
    turn_back(&p->at, m->n, d);
    *from = -INFINITY;
    *to = INFINITY;
    for (unsigned int i = 0; i < p->plane_count; i++) {
        const double *plane = p->planes + 4 * i;
        double distance = dot(plane, o) - plane[3], speed = dot(plane, d);
        if (fabs(speed) < 1e-6) {
            if (distance > 1e-6 * m->size) return 0;
        } else if (speed < 0) {
            *from = fmax(*from, -distance / speed);
        } else {
            *to = fmin(*to, -distance / speed);
        }
    }
    return *from <= *to + 1e-6 * m->size;
}

static void try_spot(const polytope *a, const polytope *b, meeting *m, const double *x) {
    double a_from, a_to, b_from, b_to;
    if (m->count == MOST_SPOTS) return;
    for (int k = 0; k < m->count; k++)
        if (hypot(m->spots[k].x[0] - x[0], m->spots[k].x[1] - x[1]) < 1e-4 * m->size) return;
    if (!span(a, m, x, &a_from, &a_to) || !span(b, m, x, &b_from, &b_to) || b_to <= a_from) return;
    double from = fmax(a_from, b_from), to = fmin(a_to, b_to);
    if (from > to + 1e-6 * m->size) return; /* a line through a corner may have but a point inside, give or take a rounding */
    m->spots[m->count++] = (spot){{x[0], x[1]}, (from + to) / 2, b_to - a_from, INFINITY};
}

static void try_crossings(const polytope *a, const polytope *b, meeting *m, const outline *one, const outline *other) {
    for (int i = 0; i < one->count; i++)
        for (int j = 0; j < other->count; j++) {
            const double *p = one->corners[i], *q = one->corners[(i + 1) % one->count];
            const double *r = other->corners[j], *s = other->corners[(j + 1) % other->count];
            double before = side_of(r, s, p), after = side_of(r, s, q);
            if (before * after >= 0 || side_of(p, q, r) * side_of(p, q, s) >= 0) continue;
            double t = before / (before - after), x[2] = {p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])};
            try_spot(a, b, m, x);
        }
}

static spot *next_spot(meeting *m, const spot *taken) {
    spot *best = m->spots;
    for (int k = 0; k < m->count; k++) {
        spot *s = &m->spots[k];
        if (taken) s->apart = fmin(s->apart, hypot(s->x[0] - taken->x[0], s->x[1] - taken->x[1]));
        if (taken ? s->apart > best->apart : s->depth > best->depth) best = s;
    }
    return best;
}

void axes_across(const double *n, double *u, double *v) {
    int k = fabs(n[0]) < 0.6 ? 0 : 1; /* an axis well aside from n */
    double axis[3] = {k == 0, k == 1, 0}, along = dot(axis, n);
    for (int c = 0; c < 3; c++) u[c] = axis[c] - along * n[c];
    double length = sqrt(dot(u, u));
    for (int c = 0; c < 3; c++) u[c] /= length;
    for (int c = 0; c < 3; c++) v[c] = n[(c + 1) % 3] * u[(c + 2) % 3] - n[(c + 2) % 3] * u[(c + 1) % 3];
}

int collide_polytopes(const oo_geom *first, const oo_geom *second, int most, dContactGeom *rows, int skip) {
    polytope a, b;
    meeting m;
    polytope_of(first->id, first->mesh, &a);
    polytope_of(second->id, second->mesh, &b);
    double of_a[3], of_b[3];
    double apart_a = least_overlap(&a, &b, of_a);
    if (apart_a > 0) return 0;
    double apart_b = least_overlap(&b, &a, of_b);
    if (apart_b > 0) return 0;
    int by_a = apart_a > 0.95 * apart_b; /* where both are as good, always the same */
    for (int k = 0; k < 3; k++) m.n[k] = by_a ? -of_a[k] : of_b[k];
    double back[3] = {-m.n[0], -m.n[1], -m.n[2]};
    double depth = by_a ? -apart_a : -apart_b;
    double tall_a = -lowest(&a, back) - lowest(&a, m.n), tall_b = -lowest(&b, back) - lowest(&b, m.n);
    m.size = fmin(tall_a, tall_b);
    m.count = 0;
    axes_across(m.n, m.u, m.v);
    outline low, high;
    face_towards(&a, &m, m.n, depth + 0.05 * m.size, &low);
    face_towards(&b, &m, back, depth + 0.05 * m.size, &high);
    for (int i = 0; i < low.count; i++) try_spot(&a, &b, &m, low.corners[i]);
    for (int i = 0; i < high.count; i++) try_spot(&a, &b, &m, high.corners[i]);
    try_crossings(&a, &b, &m, &low, &high);
    if (!m.count && low.count && high.count) { /* deep in one another, and no corner of a face in the other */
        double middle[2] = {0, 0};
        for (int i = 0; i < 2 * low.count; i++) middle[i % 2] += low.corners[i / 2][i % 2] / low.count / 2;
        for (int i = 0; i < 2 * high.count; i++) middle[i % 2] += high.corners[i / 2][i % 2] / high.count / 2;
        try_spot(&a, &b, &m, middle);
    }
    int limit = most < MOST_KEPT ? most : MOST_KEPT, count = m.count < limit ? m.count : limit;
    const spot *last = NULL;
    for (int k = 0; k < count; k++) {
        const spot *s = m.count <= limit ? &m.spots[k] : next_spot(&m, last);
        last = s;
        dContactGeom *row = row_at(rows, k, skip);
        for (int c = 0; c < 3; c++) {
            row->pos[c] = s->x[0] * m.u[c] + s->x[1] * m.v[c] + s->middle * m.n[c];
            row->normal[c] = m.n[c];
        }
        row->depth = fmin(s->depth, depth);
        row->g1 = first->id;
        row->g2 = second->id;
        row->side1 = row->side2 = -1;
    }
    return count;
}
