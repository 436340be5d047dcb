/* Distance between two convex shapes, and when one that moves without turning first touches the other.

   The distance is that of the origin from the difference of the two shapes, by the method of Gilbert, Johnson and
   Keerthi (1988); the closest point of a simplex is found by the regions of its corners, edges and faces (C. Ericson,
   "Real-Time Collision Detection", 2005, chapters 5 and 9). Spheres and capsules are a point and a segment with a
   margin. The first touch is approached by steps of distance / closing speed, none of which can pass it, since both
   shapes are convex (B. Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems", 1996, conservative
   advancement). */

#include "shapes.h"

static void add_scaled(double *out, const double *a, double scale, const double *b) {
    for (int k = 0; k < 3; k++) out[k] = a[k] + scale * b[k];
}

/* The point of the shape that lies farthest along a direction of the world. */
void support(const shape *s, const double *way, double *out) {
    double own[3], local[3] = {0, 0, 0};
    const double *r = s->rotation;
    if (s->kind == SHAPE_POINTS) {
        const double *best = s->points;
        double farthest = dot(best, way);
        for (int i = 1; i < s->count; i++) {
            double here = dot(s->points + 3 * i, way);
            if (here > farthest) {
                farthest = here;
                best = s->points + 3 * i;
            }
        }
        memcpy(out, best, 3 * sizeof *out);
        return;
    }
    for (int k = 0; k < 3; k++) own[k] = r[k] * way[0] + r[4 + k] * way[1] + r[8 + k] * way[2];
    if (s->kind == SHAPE_BOX) {
        for (int k = 0; k < 3; k++) local[k] = own[k] < 0 ? -s->half[k] : s->half[k];
    } else if (s->kind == SHAPE_SEGMENT) {
        local[2] = own[2] < 0 ? -s->half[2] : s->half[2];
    } else if (s->kind == SHAPE_CYLINDER) {
        double across = sqrt(own[0] * own[0] + own[1] * own[1]);
        if (across > 0) {
            local[0] = s->half[0] * own[0] / across;
            local[1] = s->half[0] * own[1] / across;
        }
        local[2] = own[2] < 0 ? -s->half[2] : s->half[2];
    }
    for (int k = 0; k < 3; k++) out[k] = s->position[k] + r[4 * k] * local[0] + r[4 * k + 1] * local[1] + r[4 * k + 2] * local[2];
}

typedef struct simplex {
    double corner[4][3];
    double on_a[4][3]; /* the points of the first shape that they came from */
    int count;
} simplex;

static void keep(simplex *s, const int *which, int count) {
    simplex old = *s;
    for (int i = 0; i < count; i++) {
        memcpy(s->corner[i], old.corner[which[i]], sizeof s->corner[i]);
        memcpy(s->on_a[i], old.on_a[which[i]], sizeof s->on_a[i]);
    }
    s->count = count;
}

static void nearest_on_segment(simplex *s, double *out) {
    double ab[3];
    add_scaled(ab, s->corner[1], -1, s->corner[0]);
    double t = -dot(s->corner[0], ab), length = dot(ab, ab);
    if (t <= 0 || length <= 0) {
        keep(s, (int[]){0}, 1);
        memcpy(out, s->corner[0], 3 * sizeof *out);
    } else if (t >= length) {
        keep(s, (int[]){1}, 1);
        memcpy(out, s->corner[0], 3 * sizeof *out);
    } else {
        add_scaled(out, s->corner[0], t / length, ab);
    }
}

static void nearest_on_triangle(simplex *s, double *out) {
    const double *a = s->corner[0], *b = s->corner[1], *c = s->corner[2];
    double ab[3], ac[3];
    add_scaled(ab, b, -1, a);
    add_scaled(ac, c, -1, a);
    double d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b), d5 = -dot(ab, c), d6 = -dot(ac, c);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (va > 0 && vb > 0 && vc > 0) { /* above the inside */
        double sum = va + vb + vc;
        add_scaled(out, a, vb / sum, ab);
        add_scaled(out, out, vc / sum, ac);
        return;
    }
    /* On an edge or a corner: the best of the three edges. */
    static const int edges[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    simplex best = {.count = 0};
    double nearest = INFINITY, point[3];
    for (int i = 0; i < 3; i++) {
        simplex edge = *s;
        keep(&edge, edges[i], 2);
        nearest_on_segment(&edge, point);
        if (dot(point, point) < nearest) {
            nearest = dot(point, point);
            best = edge;
            memcpy(out, point, sizeof point);
        }
    }
    *s = best;
}

static double volume(const double *a, const double *b, const double *c, const double *d) {
    double ab[3], ac[3], ad[3], n[3];
    add_scaled(ab, b, -1, a);
    add_scaled(ac, c, -1, a);
    add_scaled(ad, d, -1, a);
    cross(n, ab, ac);
    return dot(n, ad);
}

/* 1 if the origin is inside. */
static int nearest_on_tetrahedron(simplex *s, double *out) {
    static const int faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    const double origin[3] = {0, 0, 0};
    simplex best = {.count = 0};
    double nearest = INFINITY, point[3];
    int inside = 1;
    for (int i = 0; i < 4; i++) {
        const int *f = faces[i];
        double own = volume(s->corner[f[0]], s->corner[f[1]], s->corner[f[2]], s->corner[f[3]]);
        double of_origin = volume(s->corner[f[0]], s->corner[f[1]], s->corner[f[2]], origin);
        if (own * of_origin > 0) continue; /* the origin is on the inner side of this face */
        inside = 0;
        simplex face = *s;
        keep(&face, f, 3);
        nearest_on_triangle(&face, point);
        if (dot(point, point) < nearest) {
            nearest = dot(point, point);
            best = face;
            memcpy(out, point, sizeof point);
        }
    }
    if (!inside) *s = best;
    return inside;
}

/* The point of the first shape that a point of the simplex stands for: as its corners make up the one, so the other. */
static void point_on_a(const simplex *s, const double *point, double *out) {
    double weight[3] = {1, 0, 0}, ab[3], ac[3], ap[3];
    if (s->count > 1) {
        add_scaled(ab, s->corner[1], -1, s->corner[0]);
        add_scaled(ap, point, -1, s->corner[0]);
        double d00 = dot(ab, ab), d20 = dot(ap, ab);
        if (s->count == 2) {
            weight[1] = d00 > 0 ? d20 / d00 : 0;
        } else {
            add_scaled(ac, s->corner[2], -1, s->corner[0]);
            double d01 = dot(ab, ac), d11 = dot(ac, ac), d21 = dot(ap, ac), area = d00 * d11 - d01 * d01;
            weight[1] = area > 0 ? (d11 * d20 - d01 * d21) / area : 0;
            weight[2] = area > 0 ? (d00 * d21 - d01 * d20) / area : 0;
        }
        weight[0] = 1 - weight[1] - weight[2];
    }
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int i = 0; i < s->count && i < 3; i++) out[k] += weight[i] * s->on_a[i][k];
    }
}

/* Of the cores, without margins; 0 if they meet. `apart` goes from the second towards the first, displaced by `by`. */
static double core_distance(const shape *a, const double *by, const shape *b, double *apart, double *on_a) {
    simplex s = {.count = 0};
    double way[3], far_a[3], far_b[3], corner[3], scale = 1e-300;
    const double *from = a->points ? a->points : a->position, *to = b->points ? b->points : b->position;
    for (int k = 0; k < 3; k++) apart[k] = from[k] + by[k] - to[k];
    if (dot(apart, apart) == 0) apart[0] = 1;
    double best = INFINITY;
    for (int round = 0; round < 64; round++) {
        for (int k = 0; k < 3; k++) way[k] = -apart[k];
        support(a, way, far_a);
        support(b, apart, far_b);
        for (int k = 0; k < 3; k++) corner[k] = far_a[k] + by[k] - far_b[k];
        scale = fmax(scale, dot(corner, corner));
        double distance = dot(apart, apart);
        /* No corner lies nearer to the origin along this direction: what has been found is the nearest. */
        if (s.count && distance - dot(apart, corner) <= 1e-12 * distance + 1e-30) break;
        int known = 0;
        for (int i = 0; i < s.count; i++) known |= !memcmp(s.corner[i], corner, sizeof corner);
        if (known) break;
        memcpy(s.on_a[s.count], far_a, sizeof far_a);
        memcpy(s.corner[s.count++], corner, sizeof corner);
        double next[3];
        if (s.count == 1) memcpy(next, corner, sizeof next);
        if (s.count == 2) nearest_on_segment(&s, next);
        if (s.count == 3) nearest_on_triangle(&s, next);
        if (s.count == 4 && nearest_on_tetrahedron(&s, next)) return 0;
        double now = dot(next, next);
        if (now <= 1e-24 * scale) return 0;
        if (now >= best) break; /* rounding: it gets no better */
        best = now;
        memcpy(apart, next, sizeof next);
        if (on_a) point_on_a(&s, apart, on_a);
    }
    return sqrt(dot(apart, apart));
}

double shape_distance(const shape *a, const double *by, const shape *b, double *normal) {
    double apart[3], distance;
    if (b->kind == SHAPE_PLANE) { /* half[] is its normal, position[0] its offset */
        double way[3] = {-b->half[0], -b->half[1], -b->half[2]}, lowest[3];
        support(a, way, lowest);
        add_scaled(lowest, lowest, 1, by);
        memcpy(normal, b->half, 3 * sizeof *normal);
        return dot(lowest, b->half) - b->position[0] - a->margin;
    }
    distance = core_distance(a, by, b, apart, NULL);
    double length = sqrt(dot(apart, apart));
    for (int k = 0; k < 3; k++) normal[k] = distance > 0 ? apart[k] / length : 0;
    return distance - a->margin - b->margin;
}

/* How far along the motion (0 to 1) the shape, which is apart now, first comes as near as `gap`; 2: not at all. */
double first_touch(const shape *a, const double *motion, const shape *b, double gap, double *normal) {
    double t = 0, by[3] = {0, 0, 0};
    for (int round = 0; round < 100; round++) {
        double distance = shape_distance(a, by, b, normal), closing = -dot(motion, normal);
        if (distance <= gap) return t;
        if (closing <= 0) return 2;
        t += (distance - 0.5 * gap) / closing;
        if (t > 1) return 2;
        for (int k = 0; k < 3; k++) by[k] = t * motion[k];
    }
    return t;
}

double closest_points(const shape *a, const shape *b, double *on_a, double *on_b) {
    static const double here[3];
    double normal[3], apart[3], distance;
    if (b->kind == SHAPE_PLANE) {
        distance = shape_distance(a, here, b, normal);
        double way[3] = {-normal[0], -normal[1], -normal[2]};
        support(a, way, on_a);
    } else {
        distance = core_distance(a, here, b, apart, on_a) - a->margin - b->margin;
        double length = sqrt(dot(apart, apart));
        for (int k = 0; k < 3; k++) normal[k] = length > 0 ? apart[k] / length : 0;
    }
    for (int k = 0; k < 3; k++) {
        on_a[k] -= a->margin * normal[k];
        on_b[k] = on_a[k] - distance * normal[k];
    }
    return distance;
}
