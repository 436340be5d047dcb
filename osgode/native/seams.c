/* How things meet meshes without tripping over the seams of their triangles. */

#include "onmesh.h"

enum { FORTH = 3 };

static double length_of(const double *v) { return sqrt(dot(v, v)); }

/* ------------------------------------------------------------------ which triangles */

/* How far it reaches from its middle along a direction. */
static double reach_along(const thing *t, const double *n) {
    if (t->class == dSphereClass) return t->radius;
    double along[3];
    turn_back(&t->at, n, along);
    for (int k = 0; k < 3; k++) along[k] = fabs(along[k]);
    if (t->class == dBoxClass) return dot(t->half, along);
    double across = 1 - along[2] * along[2];
    return t->half[2] * along[2] + t->radius * (t->class == dCapsuleClass ? 1 : sqrt(across > 0 ? across : 0));
}

/* 0 if it is none of them. */
static int thing_of(const oo_geom *geom, const oo_geom *mesh, thing *t) {
    t->class = dGeomGetClass(geom->id);
    dVector3 sides;
    double length = 0;
    switch (t->class) {
        case dSphereClass: t->radius = dGeomSphereGetRadius(geom->id); break;
        case dBoxClass: dGeomBoxGetLengths(geom->id, sides); break;
        case dCapsuleClass: dGeomCapsuleGetParams(geom->id, &t->radius, &length); break;
        case dCylinderClass: dGeomCylinderGetParams(geom->id, &t->radius, &length); break;
        default: return 0;
    }
    for (int k = 0; k < 3; k++) t->half[k] = t->class == dBoxClass ? sides[k] / 2 : k == 2 ? length / 2 : 0;
    frame own = frame_of(geom->id), base = frame_of(mesh->id);
    to_local(&base, own.p, t->p);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            t->r[4 * i + k] =
                base.r[i] * own.r[k] + base.r[4 + i] * own.r[4 + k] + base.r[8 + i] * own.r[8 + k];
    t->at = (frame){t->p, t->r};
    t->mesh = mesh->mesh;
    t->size = INFINITY;
    for (int k = 0; k < 3; k++) {
        double way[3] = {k == 0, k == 1, k == 2}, reach = reach_along(t, way);
        t->low[k] = t->p[k] - reach;
        t->high[k] = t->p[k] + reach;
        if (2 * reach < t->size) t->size = 2 * reach;
    }
    return 1;
}

/* Those without an area are left out, and those whose plane is out of reach. */
static void add_triangle(void *data, unsigned int triangle) {
    thing *t = data;
    const double *n = t->mesh->normals[triangle];
    if (t->count == MOST_NEAR || !(n[0] || n[1] || n[2])) return;
    near_triangle *near = &t->near[t->count];
    for (int k = 0; k < 3; k++) near->corners[k] = t->mesh->vertices + 3 * t->mesh->triangles[3 * triangle + k];
    double arm[3];
    between(near->corners[0], t->p, arm);
    near->n = n;
    near->above = dot(n, arm);
    t->count += fabs(near->above) <= reach_along(t, n) + t->margin;
}

/* 0 if there are too many, or no memory. */
static int gather(thing *t, oo_mesh *mesh, double margin) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = t->low[k] - margin;
        high[k] = t->high[k] + margin;
    }
    t->margin = margin;
    t->count = 0;
    return !triangle_numbers_in(mesh, low, high, add_triangle, t) && t->count < MOST_NEAR;
}

static void nearest_on_edge(const double *a, const double *b, const double *c, double *q) {
    double ab[3], ac[3];
    between(a, b, ab);
    between(a, c, ac);
    double t = dot(ab, ac) / dot(ab, ab);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; k++) q[k] = a[k] + t * ab[k];
}

int nearest_on_triangle(const near_triangle *t, const double *c, double *q) {
    double out[3], ab[3], ac[3], best = INFINITY;
    int inside = 1;
    for (int e = 0; e < 3; e++) {
        between(t->corners[e], t->corners[(e + 1) % 3], ab);
        between(t->corners[e], c, ac);
        cross(out, ab, t->n);
        if (dot(out, ac) > 0) inside = 0;
    }
    if (inside) {
        double above = dot(t->n, ac);
        for (int k = 0; k < 3; k++) q[k] = c[k] - above * t->n[k];
        return 1;
    }
    for (int e = 0; e < 3; e++) {
        double on[3], way[3];
        nearest_on_edge(t->corners[e], t->corners[(e + 1) % 3], c, on);
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
static void meet_sphere(const thing *t, meetings *out) {
    spot spots[MOST_NEAR];
    int count = 0, kept = 0;
    double r = t->radius;
    for (int i = 0; i < t->count; i++) {
        const near_triangle *near = &t->near[i];
        double q[3], way[3];
        if (near->above < 0 || near->above > r) continue; /* from behind a mesh is open, as in ODE */
        int inside = nearest_on_triangle(near, t->p, q);
        between(q, t->p, way);
        double away = length_of(way);
        if (away > r) continue;
        spot *s = &spots[count++];
        *s = (spot){{q[0], q[1], q[2]}, {near->n[0], near->n[1], near->n[2]}, away, !inside};
        if (!inside && away > 1e-6 * r)
            for (int k = 0; k < 3; k++) s->n[k] = way[k] / away;
    }
    if (count > 1) qsort(spots, (size_t)count, sizeof *spots, by_place);
    for (int i = 0; i < count; i++) {
        int hidden = 0;
        for (int k = 0; k < kept && !hidden; k++) {
            double way[3];
            between(spots[k].p, spots[i].p, way);
            hidden = spots[i].on_edge ? dot(way, spots[k].n) < 1e-3 * r : length_of(way) < 1e-6 * r;
        }
        if (!hidden) spots[kept++] = spots[i];
    }
    for (int i = 0; i < kept; i++) add_meeting(out, spots[i].p, spots[i].n, r - spots[i].away, 1);
}

/* ------------------------------------------------------------------ other shapes */

/* How far off a face a contact with it may be. */
static double reach_of(const thing *t, double depth) { return 1.1 * fabs(depth) + 1e-3 * t->size; }

/* Whether a normal at a point of a mesh is one that the surface has there: that of a face, or one of a
   ridge or corner, which leads away from all triangles. ODE looks at each triangle alone, and takes the rim of one for a
   step where the next one goes on. */
static int is_sound(const thing *t, const dContactGeom *m) {
    double ahead[3], q[3], way[3], reach = reach_of(t, m->depth);
    for (int i = 0; i < t->count; i++) {
        const near_triangle *near = &t->near[i];
        if (dot(near->n, m->normal) < 0.999) continue;
        between(near->corners[0], m->pos, way);
        if (fabs(dot(near->n, way)) >= reach) continue;
        nearest_on_triangle(near, m->pos, q);
        between(m->pos, q, way);
        if (length_of(way) < reach) return 1;
    }
    for (int k = 0; k < 3; k++) ahead[k] = m->pos[k] + FORTH * reach * m->normal[k];
    for (int i = 0; i < t->count; i++) {
        const near_triangle *near = &t->near[i];
        between(near->corners[0], ahead, way);
        if (fabs(dot(near->n, way)) > 0.5 * FORTH * reach) continue;
        nearest_on_triangle(near, ahead, q);
        between(q, ahead, way);
        if (length_of(way) <= 0.5 * FORTH * reach) return 0;
    }
    return 1;
}

static void drop_seams(const thing *t, meetings *all) {
    int sound = 0;
    for (int i = 0; i < all->count; i++) {
        if (!all->at[i].side1 && !is_sound(t, &all->at[i])) continue;
        dContactGeom kept = all->at[sound];
        all->at[sound++] = all->at[i];
        all->at[i] = kept;
    }
    if (sound) all->count = sound; /* something has to hold it */
}

/* What lies on triangles has its contacts at its own corners and ends, and where its edges cross theirs, instead of those
   with about the same normal that were found for each triangle alone. */
static void lie_on_mesh(const thing *t, meetings *all) {
    const dContactGeom *deepest = all->at;
    for (int i = 1; i < all->count; i++)
        if (all->at[i].depth > deepest->depth) deepest = &all->at[i];
    double n[3], limit = 2 * deepest->depth + 1e-2 * t->size;
    memcpy(n, deepest->normal, sizeof n);
    dContactGeom rows[MOST_ON_MESH];
    meetings flat = {rows, 0};
    for (int i = 0, many = MOST_ON_MESH / 2; i < t->count; i++) {
        if (dot(t->near[i].n, n) < FLAT) continue;
        if (flat.count > many) {
            flat.count = merge_rows(rows, flat.count, t->size);
            if (flat.count > many / 2) many = (flat.count + MOST_ON_MESH) / 2;
        }
        lie_on_triangle(t, &t->near[i], limit, &flat);
    }
    if (!flat.count) return;
    int kept = 0;
    for (int i = 0; i < all->count; i++)
        if (dot(all->at[i].normal, n) < FLAT) all->at[kept++] = all->at[i];
    all->count = kept;
    for (int i = 0; i < flat.count && all->count < MOST_ON_MESH; i++) all->at[all->count++] = flat.at[i];
}

/* Rows of ODE into the axes of the mesh, with normals away from it; and back. */
static void take_rows(const frame *base, double side, meetings *all) {
    for (int i = 0; i < all->count; i++) {
        dContactGeom *row = &all->at[i];
        double p[3], n[3];
        to_local(base, row->pos, p);
        turn_back(base, row->normal, n);
        for (int k = 0; k < 3; k++) row->normal[k] = side * n[k];
        memcpy(row->pos, p, sizeof p);
        row->side1 = 0;
    }
}

static void give_rows(const frame *base, double side, dGeomID a, dGeomID b, meetings *all) {
    for (int i = 0; i < all->count; i++) {
        dContactGeom *row = &all->at[i];
        double p[3], n[3];
        to_world(base, row->pos, p);
        turn(base, row->normal, n);
        for (int k = 0; k < 3; k++) row->normal[k] = side * n[k];
        memcpy(row->pos, p, sizeof p);
        row->g1 = a;
        row->g2 = b;
        row->side1 = row->side2 = -1;
    }
}

/* Triangles ahead of a deep contact may be farther off than those that are touched. */
static int gather_ahead(thing *t, oo_mesh *mesh, const meetings *all) {
    double reach = 0;
    for (int i = 0; i < all->count; i++) {
        double here = FORTH * reach_of(t, all->at[i].depth);
        if (!all->at[i].side1 && here > reach) reach = here;
    }
    return reach <= t->margin || gather(t, mesh, reach);
}

int collide_mesh(const oo_geom *a, const oo_geom *b, dContactGeom *rows) {
    int first = a->mesh && a->mesh->id && a->flags & OO_IS_MESH;
    const oo_geom *mesh = first ? a : b, *other = first ? b : a;
    double side = first ? -1 : 1; /* rows have their normals from b to a */
    int hull = mesh->mesh->planes != NULL;
    frame base = frame_of(mesh->id);
    meetings all = {rows, 0};
    thing t;
    if (!thing_of(other, mesh, &t) || (hull && t.class == dBoxClass)) /* by polytope.c */
        return collide_pair(a, b, MOST_ON_MESH, rows, sizeof *rows);
    int exact = t.class == dSphereClass || t.class == dCapsuleClass; /* by what is nearest */
    if (!gather(&t, mesh->mesh, exact ? 0 : FORTH * reach_of(&t, 1e-2 * t.size)))
        return collide_pair(a, b, MOST_ON_MESH, rows, sizeof *rows);
    if (!t.count) return 0;
    if (t.class == dSphereClass) {
        meet_sphere(&t, &all);
    } else if (t.class == dCapsuleClass) {
        meet_capsule(&t, &all);
    } else {
        all.count = collide_pair(a, b, MOST_ON_MESH, rows, sizeof *rows);
        if (!all.count) return 0;
        take_rows(&base, side, &all);
        if (gather_ahead(&t, mesh->mesh, &all)) {
            drop_seams(&t, &all);
            if (!hull) lie_on_mesh(&t, &all);
        }
    }
    give_rows(&base, side, a->id, b->id, &all);
    return all.count;
}
