/* Where things lie flat on the triangles of a mesh. */

#include "onmesh.h"

enum { RIM = 8, MOST_CUT = RIM + 3 };

typedef struct cut { /* a piece of a triangle, in the axes of the thing */
    double corners[MOST_CUT][3];
    int count;
} cut;

/* What is on the left of the way from a to b, seen along axis k. */
static void cut_left(cut *c, const double *a, const double *b, int i, int j) {
    cut out;
    out.count = 0;
    double u = b[0] - a[0], v = b[1] - a[1], sides[MOST_CUT];
    int all = 1;
    for (int m = 0; m < c->count; m++) {
        sides[m] = u * (c->corners[m][j] - a[1]) - v * (c->corners[m][i] - a[0]);
        all &= sides[m] >= 0;
    }
    if (all) return;
    for (int m = 0; m < c->count; m++) {
        int next = m + 1 == c->count ? 0 : m + 1;
        if (sides[m] >= 0 && out.count < MOST_CUT) memcpy(out.corners[out.count++], c->corners[m], sizeof *out.corners);
        if ((sides[m] >= 0) == (sides[next] >= 0) || sides[m] == 0 || sides[next] == 0 || out.count == MOST_CUT) continue;
        double t = sides[m] / (sides[m] - sides[next]);
        for (int k = 0; k < 3; k++)
            out.corners[out.count][k] = c->corners[m][k] + t * (c->corners[next][k] - c->corners[m][k]);
        out.count++;
    }
    *c = out;
}

/* A side of a box, or an end of a cylinder, that stands square to its axis k. */
static void lie_on_side(const thing *t, const near_triangle *near, const double *n, int k, double deepest, meetings *out) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double s = n[k] < 0 ? 1 : -1, high = t->half[k], outline[RIM][2];
    double wide = t->class == dBoxClass ? t->half[i] : t->radius, tall = t->class == dBoxClass ? t->half[j] : t->radius;
    int count = t->class == dBoxClass ? 4 : RIM;
    cut c;
    c.count = 3;
    for (int m = 0; m < 3; m++) to_local(&t->at, near->corners[m], c.corners[m]);
    int left = 1, right = 1, below = 1, above = 1, deep = 1;
    for (int m = 0; m < 3; m++) {
        const double *p = c.corners[m];
        left &= p[i] < -wide;
        right &= p[i] > wide;
        below &= p[j] < -tall;
        above &= p[j] > tall;
        deep &= s * p[k] > high;
    }
    if (left | right | below | above | deep) return;
    static const double SQUARE[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int m = 0; m < count; m++) {
        outline[m][0] = count == 4 ? SQUARE[m][0] * wide : t->radius * cos(2 * M_PI * m / RIM);
        outline[m][1] = count == 4 ? SQUARE[m][1] * tall : t->radius * sin(2 * M_PI * m / RIM);
    }
    for (int m = 0; m < count && c.count; m++) cut_left(&c, outline[m], outline[m + 1 == count ? 0 : m + 1], i, j);
    for (int m = 0; m < c.count; m++) {
        double gap = high - s * c.corners[m][k], depth = gap * fabs(n[k]);
        if (gap < 0 || depth > deepest) continue;
        double p[3];
        c.corners[m][k] += s * gap / 2;
        to_world(&t->at, c.corners[m], p);
        add_meeting(out, p, near->n, depth, 1);
    }
}

int stretch_over(const near_triangle *near, const double *a, const double *b, double *from, double *to) {
    double way[3], edge[3], out[3], arm[3];
    between(a, b, way);
    *from = 0;
    *to = 1;
    for (int e = 0; e < 3; e++) {
        between(near->corners[e], near->corners[(e + 1) % 3], edge);
        cross(out, edge, near->n);
        between(near->corners[e], a, arm);
        double start = dot(out, arm), rate = dot(out, way), t = -start / rate;
        if (rate > 0) {
            if (t < *to) *to = t;
        } else if (rate < 0) {
            if (t > *from) *from = t;
        } else if (start > 0) {
            return 0;
        }
    }
    return *from <= *to;
}

/* The line along which a cylinder is lowest. */
static void lie_along(const thing *t, const near_triangle *near, const double *n, double deepest, meetings *out) {
    double ends[2][3], from, to, length = sqrt(1 - n[2] * n[2]);
    for (int e = 0; e < 2; e++) {
        double local[3] = {-t->radius * n[0] / length, -t->radius * n[1] / length, e ? t->half[2] : -t->half[2]};
        to_world(&t->at, local, ends[e]);
    }
    if (!stretch_over(near, ends[0], ends[1], &from, &to)) return;
    for (int e = 0; e < 2; e++) {
        double at = e ? to : from, arm[3], point[3];
        for (int k = 0; k < 3; k++) point[k] = ends[0][k] + at * (ends[1][k] - ends[0][k]);
        between(point, near->corners[0], arm);
        double depth = dot(near->n, arm);
        if (depth < 0 || depth > deepest) continue;
        for (int k = 0; k < 3; k++) point[k] += depth / 2 * near->n[k];
        add_meeting(out, point, near->n, depth, 1);
    }
}

void lie_on_triangle(const thing *t, const near_triangle *near, double deepest, meetings *out) {
    double n[3];
    turn_back(&t->at, near->n, n);
    int round = t->class == dCylinderClass;
    if (round && fabs(n[2]) < ALONG) lie_along(t, near, n, deepest, out);
    for (int k = round ? 2 : 0; k < 3; k++)
        if (fabs(n[k]) > FLAT) lie_on_side(t, near, n, k, deepest, out);
}
