/* How things meet meshes without tripping over the seams of their triangles. */

#include "internal.h"

enum { MOST_NEAR = 512, FORTH = 3 };

static const double SAME_WAY = 0.9945; /* cosine of 6 degrees */

typedef struct near_triangles {
    double corners[MOST_NEAR][3][3], normals[MOST_NEAR][3];
    int count;
} near_triangles;

static void between(const double *from, const double *to, double *out) {
    for (int k = 0; k < 3; k++) out[k] = to[k] - from[k];
}

static double length_of(const double *v) { return sqrt(dot(v, v)); }

/* Of unit length; 0 if the triangle has no area to speak of. */
static int face_normal(const double (*t)[3], double *n) {
    double u[3], v[3];
    between(t[0], t[1], u);
    between(t[0], t[2], v);
    cross(n, u, v);
    double length = length_of(n);
    if (!(length > 1e-12 * (dot(u, u) + dot(v, v)))) return 0;
    for (int k = 0; k < 3; k++) n[k] /= length;
    return 1;
}

/* Those without an area are left out. */
static void add_triangle(void *data, const double *corners[3]) {
    near_triangles *near = data;
    if (near->count == MOST_NEAR) return;
    double(*t)[3] = near->corners[near->count];
    for (int k = 0; k < 3; k++) memcpy(t[k], corners[k], 3 * sizeof(double));
    near->count += face_normal((const double(*)[3])t, near->normals[near->count]);
}

/* 0 if there are too many, or no memory. */
static int gather(const oo_geom *mesh, const double *low, const double *high, near_triangles *near) {
    near->count = 0;
    return !triangles_in(mesh->mesh, low, high, add_triangle, near) && near->count < MOST_NEAR;
}

static void nearest_on_edge(const double *a, const double *b, const double *c, double *q) {
    double ab[3], ac[3];
    between(a, b, ab);
    between(a, c, ac);
    double t = fmin(fmax(dot(ab, ac) / dot(ab, ab), 0), 1);
    for (int k = 0; k < 3; k++) q[k] = a[k] + t * ab[k];
}

/* The point of a triangle that is nearest to c; 1 if it is within, 0 if on an edge. */
static int nearest_on_triangle(const double (*t)[3], const double *n, const double *c, double *q) {
    double out[3], ab[3], ac[3], best = INFINITY;
    int inside = 1;
    for (int e = 0; e < 3; e++) {
        between(t[e], t[(e + 1) % 3], ab);
        between(t[e], c, ac);
        cross(out, ab, n);
        if (dot(out, ac) > 0) inside = 0;
    }
    if (inside) {
        double above = dot(n, ac);
        for (int k = 0; k < 3; k++) q[k] = c[k] - above * n[k];
        return 1;
    }
    for (int e = 0; e < 3; e++) {
        double on[3], way[3];
        nearest_on_edge(t[e], t[(e + 1) % 3], c, on);
        between(on, c, way);
        if (dot(way, way) >= best) continue;
        best = dot(way, way);
        memcpy(q, on, sizeof on);
    }
    return 0;
}

/* ------------------------------------------------------------------ spheres */

typedef struct spot {
    double p[3], n[3], away;
    int on_edge;
} spot;

/* Those within first: an edge may seem as near for rounding, with a normal that leans. */
static int by_place(const void *a, const void *b) {
    const spot *p = a, *q = b;
    if (p->on_edge != q->on_edge) return p->on_edge - q->on_edge;
    if (p->away != q->away) return p->away < q->away ? -1 : 1;
    return memcmp(p->p, q->p, sizeof p->p);
}

/* Every triangle that is nearest to the middle somewhere inside of it; and points of edges only if they stand out above the
   tangents at those and at all nearer ones: others are seams, or lie beyond a ridge. */
static int meet_sphere(const near_triangles *near, const double *c, double r, spot *spots) {
    int count = 0, kept = 0;
    for (int i = 0; i < near->count; i++) {
        const double(*t)[3] = near->corners[i];
        const double *n = near->normals[i];
        double arm[3], q[3], way[3];
        between(t[0], c, arm);
        double above = dot(n, arm);
        if (above < 0 || above > r) continue; /* from behind a mesh is open, as in ODE */
        int inside = nearest_on_triangle(t, n, c, q);
        between(q, c, way);
        double away = length_of(way);
        if (away > r) continue;
        spot *s = &spots[count++];
        *s = (spot){{q[0], q[1], q[2]}, {n[0], n[1], n[2]}, away, !inside};
        if (!inside && away > 1e-6 * r)
            for (int k = 0; k < 3; k++) s->n[k] = way[k] / away;
    }
    qsort(spots, (size_t)count, sizeof *spots, by_place);
    for (int i = 0; i < count; i++) {
        int hidden = 0;
        for (int k = 0; k < kept && !hidden; k++) {
            double way[3];
            between(spots[k].p, spots[i].p, way);
            hidden = spots[i].on_edge ? dot(way, spots[k].n) < 1e-3 * r : length_of(way) < 1e-6 * r;
        }
        if (!hidden) spots[kept++] = spots[i];
    }
    return kept;
}

/* ------------------------------------------------------------------ other shapes */

/* How far off a face a contact with it may be. */
static double reach_of(const dContactGeom *row, double size) { return 1.1 * fabs(row->depth) + 1e-3 * size; }

/* Whether a normal at a point of a mesh (in its axes) is one that the surface has there: that of a face, or one of a
   ridge or corner, which leads away from all triangles. ODE looks at each triangle alone, and takes the rim of one for a
   step where the next one goes on. */
static int is_sound(const near_triangles *near, const double *p, const double *n, double reach) {
    double ahead[3], q[3], way[3];
    for (int i = 0; i < near->count; i++) {
        const double *face = near->normals[i];
        if (dot(face, n) < 0.999) continue;
        between(near->corners[i][0], p, way);
        if (fabs(dot(face, way)) >= reach) continue;
        nearest_on_triangle(near->corners[i], face, p, q);
        between(p, q, way);
        if (length_of(way) < reach) return 1;
    }
    for (int k = 0; k < 3; k++) ahead[k] = p[k] + FORTH * reach * n[k];
    for (int i = 0; i < near->count; i++) {
        between(near->corners[i][0], ahead, way);
        if (fabs(dot(near->normals[i], way)) > 0.5 * FORTH * reach) continue;
        nearest_on_triangle(near->corners[i], near->normals[i], ahead, q);
        between(q, ahead, way);
        if (length_of(way) <= 0.5 * FORTH * reach) return 0;
    }
    return 1;
}

static int drop_seams(const near_triangles *near, const frame *at, double side, double size, dContactGeom *rows,
                      int count) {
    int sound = 0;
    for (int i = 0; i < count; i++) {
        double p[3], n[3], normal[3];
        for (int k = 0; k < 3; k++) normal[k] = side * rows[i].normal[k];
        to_local(at, rows[i].pos, p);
        turn_back(at, normal, n);
        if (!is_sound(near, p, n, reach_of(&rows[i], size))) continue;
        dContactGeom kept = rows[sound];
        rows[sound++] = rows[i];
        rows[i] = kept;
    }
    return sound ? sound : count; /* something has to hold it */
}

/* The box of a geom in the axes of a mesh. */
static void box_in_mesh(const frame *at, dGeomID id, double *low, double *high) {
    dReal box[6];
    dGeomGetAABB(id, box);
    double middle[3] = {(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, (box[4] + box[5]) / 2}, local[3];
    to_local(at, middle, local);
    for (int k = 0; k < 3; k++) {
        double half = 0;
        for (int c = 0; c < 3; c++) half += fabs(at->r[4 * c + k]) * (box[2 * c + 1] - box[2 * c]) / 2;
        low[k] = local[k] - half;
        high[k] = local[k] + half;
    }
}

/* What lies on triangles has its contacts at its own corners and ends, and where its edges cross theirs, instead of those
   with about the same normal that ODE found for each triangle alone. */
static int lie_on_mesh(const near_triangles *near, const frame *at, const oo_geom *other, double side, double size,
                       dContactGeom *rows, int count, int most) {
    double n[3];
    int deepest = 0, kept = 0, found = 0, many = MOST_NEAR / 2;
    for (int i = 1; i < count; i++)
        if (rows[i].depth > rows[deepest].depth) deepest = i;
    for (int k = 0; k < 3; k++) n[k] = side * rows[deepest].normal[k];
    double limit = 2 * rows[deepest].depth + 1e-2 * size;
    dContactGeom flat[MOST_NEAR];
    for (int i = 0; i < near->count && found < MOST_NEAR; i++) {
        double t[3][3], face[3];
        turn(at, near->normals[i], face);
        if (dot(face, n) < SAME_WAY) continue;
        for (int k = 0; k < 3; k++) to_world(at, near->corners[i][k], t[k]);
        if (found > many) {
            found = merge_rows(flat, found, size);
            if (found > many / 2) many = (found + MOST_NEAR) / 2;
        }
        found += lie_on_triangle(other, t, face, limit, side, MOST_NEAR - found, flat + found);
    }
    if (!found) return count;
    dGeomID g1 = rows[0].g1, g2 = rows[0].g2;
    for (int i = 0; i < count; i++)
        if (side * dot(rows[i].normal, n) < SAME_WAY) rows[kept++] = rows[i];
    for (int i = 0; i < found && kept < most; i++) {
        rows[kept] = flat[i];
        rows[kept].g1 = g1;
        rows[kept++].g2 = g2;
    }
    return kept;
}

/* ------------------------------------------------------------------ both */

int collide_mesh(const oo_geom *a, const oo_geom *b, int most, dContactGeom *rows) {
    int first = a->mesh && a->mesh->id && a->flags & OO_IS_MESH;
    const oo_geom *mesh = first ? a : b, *other = first ? b : a;
    double side = first ? -1 : 1; /* rows have their normals from b to a */
    int class = dGeomGetClass(other->id);
    near_triangles near;
    if (class != dSphereClass) {
        int found = collide_pair(a, b, most, rows, sizeof *rows);
        int known = class == dBoxClass || class == dCapsuleClass || class == dCylinderClass;
        int ours = class == dBoxClass && mesh->mesh->planes; /* by polytope.c */
        if (!known || ours || !found) return found;
        double low[3], high[3], reach = 0;
        frame at = frame_of(mesh->id);
        box_in_mesh(&at, other->id, low, high);
        double size = fmin(fmin(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
        for (int i = 0; i < found; i++) reach = fmax(reach, FORTH * reach_of(&rows[i], size));
        for (int k = 0; k < 3; k++) {
            low[k] -= reach;
            high[k] += reach;
        }
        if (!gather(mesh, low, high, &near)) return found;
        found = drop_seams(&near, &at, side, size, rows, found);
        return mesh->mesh->planes ? found : lie_on_mesh(&near, &at, other, side, size, rows, found, most);
    }
    frame at = frame_of(mesh->id);
    double r = dGeomSphereGetRadius(other->id), c[3], low[3], high[3];
    to_local(&at, dGeomGetPosition(other->id), c);
    for (int k = 0; k < 3; k++) {
        low[k] = c[k] - r;
        high[k] = c[k] + r;
    }
    spot spots[MOST_NEAR];
    if (!gather(mesh, low, high, &near))
        return collide_pair(a, b, most, rows, sizeof *rows);
    int count = meet_sphere(&near, c, r, spots);
    if (count > most) count = most;
    for (int i = 0; i < count; i++) {
        double n[3];
        to_world(&at, spots[i].p, rows[i].pos);
        turn(&at, spots[i].n, n);
        for (int k = 0; k < 3; k++) rows[i].normal[k] = side * n[k];
        rows[i].depth = r - spots[i].away;
        rows[i].g1 = a->id;
        rows[i].g2 = b->id;
        rows[i].side1 = rows[i].side2 = -1;
    }
    return count;
}
