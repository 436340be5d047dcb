/* How capsules meet meshes: by the line in their middle, where it is nearest to a face or a ridge. */

#include "onmesh.h"

typedef struct line {
    double ends[2][3], way[3];
} line;

static void point_of(const line *l, double at, double *out) {
    for (int k = 0; k < 3; k++) out[k] = l->ends[0][k] + at * l->way[k];
}

static double clamped(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

/* Whether nothing of the mesh is nearer to a point of the line. */
static int is_nearest(const thing *t, const double *c, double away) {
    for (int i = 0; i < t->count; i++) {
        double way[3], q[3];
        between(t->near[i].corners[0], c, way);
        if (fabs(dot(t->near[i].n, way)) >= away) continue;
        nearest_on_triangle(&t->near[i], c, q);
        between(q, c, way);
        if (dot(way, way) < away * away) return 0;
    }
    return 1;
}

/* A point of the line and one on an edge: only what the edge has on its outside, and seen from the front, is a ridge. */
static void try_ridge(const thing *t, const near_triangle *near, const double *outward, const double *c, const double *q,
                      meetings *out) {
    double way[3], p[3];
    between(q, c, way);
    double square = dot(way, way);
    if (square >= t->radius * t->radius || dot(way, near->n) < 0 || dot(way, outward) < 0) return;
    double away = sqrt(square), depth = t->radius - away;
    if (!is_nearest(t, c, (1 - 1e-7) * away - 1e-12 * t->radius)) return; /* but for rounding */
    for (int k = 0; k < 3; k++) {
        way[k] = away > 1e-6 * t->radius ? way[k] / away : near->n[k];
        p[k] = q[k] - depth / 2 * way[k];
    }
    add_meeting(out, p, way, depth, 1);
}

/* Where they are nearest; and where it lies along the edge, at both ends of what they have in common. */
static void try_edge(const thing *t, const near_triangle *near, int e, const line *l, meetings *out) {
    const double *a = near->corners[e], *b = near->corners[(e + 1) % 3];
    double edge[3], outward[3], arm[3], spots[3];
    int count = 1;
    between(a, b, edge);
    between(l->ends[0], a, arm);
    cross(outward, edge, near->n);
    double ll = dot(l->way, l->way), ee = dot(edge, edge), le = dot(l->way, edge), la = dot(l->way, arm), ea = dot(edge, arm);
    double square = ll * ee - le * le;
    spots[0] = square > 0 ? clamped((la * ee - ea * le) / square) : 0;
    double on_edge = clamped((spots[0] * le - ea) / ee);
    if (ll > 0) spots[0] = clamped((la + on_edge * le) / ll);
    if (le * le > FLAT * FLAT * ll * ee) {
        spots[count++] = clamped(la / ll);
        spots[count++] = clamped((la + le) / ll);
    }
    for (int i = 0; i < count; i++) {
        double c[3], q[3];
        point_of(l, spots[i], c);
        between(a, c, arm);
        double at = clamped(dot(edge, arm) / ee);
        for (int k = 0; k < 3; k++) q[k] = a[k] + at * edge[k];
        try_ridge(t, near, outward, c, q, out);
    }
}

/* Whether the line goes in by the front of a triangle that faces about the same way. */
static int comes_through(const thing *t, const line *l, const double *n) {
    for (int i = 0; i < t->count; i++) {
        const near_triangle *near = &t->near[i];
        double from, to, slope = dot(near->n, l->way), start = near->above - slope / 2;
        if (near->above < 0 || start * (start + slope) > 0 || dot(near->n, n) <= 0.5) continue;
        if (!stretch_over(near, l->ends[0], l->ends[1], &from, &to)) continue;
        if ((start + from * slope) * (start + to * slope) <= 0) return 1;
    }
    return 0;
}

/* Along a face it touches at both ends of what they have in common, else where it is lowest. 0 if beyond its edges it may
   come nearer. */
static int try_face(const thing *t, const near_triangle *near, const line *l, meetings *out) {
    double from, to, slope = dot(near->n, l->way), start = near->above - slope / 2;
    if (!stretch_over(near, l->ends[0], l->ends[1], &from, &to)) return 0;
    int along = slope * slope < ALONG * ALONG * dot(l->way, l->way), falls = slope < 0;
    double lowest = falls ? to : from, highest = falls ? from : to;
    if (start + highest * slope < 0 && !comes_through(t, l, near->n)) return 0; /* it is below, from somewhere else */
    int ends = lowest == falls || start + lowest * slope < 0;
    for (int i = 0; i < 2; i++) {
        double at = i ? to : from, height = start + at * slope, p[3];
        if (height > t->radius || !(along || (ends && i == falls))) continue;
        point_of(l, at, p);
        for (int k = 0; k < 3; k++) p[k] -= (height + t->radius) / 2 * near->n[k];
        add_meeting(out, p, near->n, t->radius - height, 1);
    }
    return ends;
}

void meet_capsule(const thing *t, meetings *out) {
    line l;
    for (int k = 0; k < 3; k++) {
        l.way[k] = 2 * t->half[2] * t->r[4 * k + 2];
        l.ends[0][k] = t->p[k] - l.way[k] / 2;
        l.ends[1][k] = t->p[k] + l.way[k] / 2;
    }
    for (int i = 0; i < t->count; i++) {
        const near_triangle *near = &t->near[i];
        if (near->above < 0) continue; /* from behind a mesh is open, as in ODE */
        if (!try_face(t, near, &l, out))
            for (int e = 0; e < 3; e++) try_edge(t, near, e, &l, out);
    }
}
