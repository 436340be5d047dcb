/* Better contacts than ODE's where those are known to be too few or too many: what lies flat gets contacts at the ends of
   where it lies, and more contacts than wanted are thinned to those that span the most. */

#include "internal.h"

enum { RIM = 8, MOST_SPOTS = 4 * RIM, PLENTY = 64 };

typedef struct solid {
    int kind; /* class of ODE; hulls are dConvexClass */
    polytope shape;
    frame at;
    double axis[3], radius, half;
} solid;

/* What a solid turns towards the other: a face, or the line along which it lies; seen along n, and how high it is. */
typedef struct feature {
    int is_line;
    outline seen;
    double normal[3], point[3]; /* of the face */
    double ends[2][3];          /* of the line */
} feature;

typedef struct view {
    double n[3], u[3], v[3]; /* n from the second to the first */
} view;

typedef struct found_spot {
    double x[2], depth, middle;
} found_spot;

static int solid_of(const oo_geom *geom, solid *out) {
    out->kind = geom->mesh && geom->mesh->planes ? dConvexClass : dGeomGetClass(geom->id);
    if (out->kind != dBoxClass && out->kind != dConvexClass && out->kind != dCapsuleClass && out->kind != dCylinderClass)
        return 0;
    out->at = frame_of(geom->id);
    if (out->kind == dBoxClass || out->kind == dConvexClass) {
        polytope_of(geom->id, geom->mesh, &out->shape);
        return 1;
    }
    double length;
    if (out->kind == dCapsuleClass)
        dGeomCapsuleGetParams(geom->id, &out->radius, &length);
    else
        dGeomCylinderGetParams(geom->id, &out->radius, &length);
    out->half = length / 2;
    for (int k = 0; k < 3; k++) out->axis[k] = out->at.r[4 * k + 2];
    return 1;
}

/* The outward normal of a face within 6 degrees of a direction, or 0. */
static int face_towards(const solid *s, const double *way, double *normal) {
    if (s->kind == dCapsuleClass) return 0;
    if (s->kind == dCylinderClass) {
        double along = dot(s->axis, way);
        for (int k = 0; k < 3; k++) normal[k] = along < 0 ? -s->axis[k] : s->axis[k];
        return fabs(along) > FLAT;
    }
    double local[3], best = FLAT;
    int found = 0;
    turn_back(&s->at, way, local);
    for (unsigned int i = 0; i < s->shape.plane_count; i++) {
        const double *plane = s->shape.planes + 4 * i;
        if (dot(plane, local) <= best) continue;
        best = dot(plane, local);
        turn(&s->at, plane, normal);
        found = 1;
    }
    return found;
}

static int lies_along(const solid *s, const double *way) {
    return (s->kind == dCapsuleClass || s->kind == dCylinderClass) && fabs(dot(s->axis, way)) < ALONG;
}

static void seen_from(const view *w, const double *point, double *x) {
    x[0] = dot(w->u, point);
    x[1] = dot(w->v, point);
}

static void face_of(const solid *s, const view *w, const double *normal, feature *out) {
    double points[MOST_CORNERS][2], world[3];
    int count = 0;
    out->is_line = 0;
    memcpy(out->normal, normal, sizeof out->normal);
    if (s->kind == dCylinderClass) {
        double end = dot(s->axis, normal) < 0 ? -s->half : s->half;
        for (int i = 0; i < RIM; i++) {
            double corner[3] = {s->radius * cos(2 * M_PI * i / RIM), s->radius * sin(2 * M_PI * i / RIM), end};
            to_world(&s->at, corner, world);
            seen_from(w, world, points[count++]);
        }
    } else {
        double local[3], highest = -INFINITY, size = 0;
        turn_back(&s->at, normal, local);
        for (unsigned int i = 0; i < s->shape.vertex_count; i++) {
            const double *corner = s->shape.vertices + 3 * i;
            highest = fmax(highest, dot(local, corner));
            size = fmax(size, fabs(corner[0]) + fabs(corner[1]) + fabs(corner[2]));
        }
        for (unsigned int i = 0; i < s->shape.vertex_count && count < MOST_CORNERS; i++) {
            const double *corner = s->shape.vertices + 3 * i;
            if (dot(local, corner) < highest - 1e-4 * size) continue;
            to_world(&s->at, corner, world);
            seen_from(w, world, points[count++]);
        }
    }
    memcpy(out->point, world, sizeof world); /* any of them */
    outline_of(points, count, &out->seen);
}

/* Where a capsule or cylinder is lowest along `way`, from end to end. */
static void line_of(const solid *s, const view *w, const double *way, feature *out) {
    double down[3];
    memcpy(down, way, sizeof down);
    if (s->kind == dCylinderClass) {
        double along = dot(s->axis, way), length = sqrt(1 - along * along);
        for (int k = 0; k < 3; k++) down[k] = (way[k] - along * s->axis[k]) / length;
    }
    out->is_line = 1;
    out->seen.count = 2;
    for (int e = 0; e < 2; e++) {
        for (int k = 0; k < 3; k++)
            out->ends[e][k] = s->at.p[k] + (e ? s->half : -s->half) * s->axis[k] + s->radius * down[k];
        seen_from(w, out->ends[e], out->seen.corners[e]);
    }
}

static double height_of(const feature *f, const view *w, const double *x) {
    if (!f->is_line) {
        double o[3];
        for (int k = 0; k < 3; k++) o[k] = f->point[k] - x[0] * w->u[k] - x[1] * w->v[k];
        return dot(f->normal, o) / dot(f->normal, w->n);
    }
    const double *a = f->seen.corners[0], *b = f->seen.corners[1];
    double d[2] = {b[0] - a[0], b[1] - a[1]};
    double t = ((x[0] - a[0]) * d[0] + (x[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    return (1 - t) * dot(w->n, f->ends[0]) + t * dot(w->n, f->ends[1]);
}

static int within(const outline *o, const double *x) {
    if (o->count < 3) return 0;
    for (int i = 0; i < o->count; i++)
        if (side_of(o->corners[i], o->corners[(i + 1) % o->count], x) < 0) return 0;
    return 1;
}

typedef struct patch {
    const view *w;
    const feature *a, *b;
    found_spot spots[MOST_SPOTS];
    int count;
} patch;

static void try_spot(patch *p, const double *x) {
    double above = height_of(p->a, p->w, x), below = height_of(p->b, p->w, x);
    if (below < above || p->count == MOST_SPOTS) return;
    p->spots[p->count++] = (found_spot){{x[0], x[1]}, below - above, (above + below) / 2};
}

static void try_crossings(patch *p) {
    const outline *one = &p->a->seen, *other = &p->b->seen;
    for (int i = 0; i < (one->count < 3 ? 1 : one->count); i++)
        for (int j = 0; j < (other->count < 3 ? 1 : other->count); j++) {
            const double *a = one->corners[i], *b = one->corners[(i + 1) % one->count];
            const double *c = other->corners[j], *d = other->corners[(j + 1) % other->count];
            double before = side_of(c, d, a), after = side_of(c, d, b);
            if (before * after >= 0 || side_of(a, b, c) * side_of(a, b, d) >= 0) continue;
            double t = before / (before - after), x[2] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
            try_spot(p, x);
        }
}

/* Two that lie side by side: both ends of the stretch that they have in common. */
static void try_stretch(patch *p) {
    const double *a = p->a->seen.corners[0], *b = p->a->seen.corners[1];
    double d[2] = {b[0] - a[0], b[1] - a[1]}, square = d[0] * d[0] + d[1] * d[1], t[2];
    for (int e = 0; e < 2; e++) {
        const double *c = p->b->seen.corners[e];
        t[e] = ((c[0] - a[0]) * d[0] + (c[1] - a[1]) * d[1]) / square;
    }
    double from = fmax(0, fmin(t[0], t[1])), to = fmin(1, fmax(t[0], t[1]));
    if (from >= to) return;
    for (int e = 0; e < 2; e++) {
        double at = e ? to : from, x[2] = {a[0] + at * d[0], a[1] + at * d[1]};
        try_spot(p, x);
    }
}

/* The direction along which two that lie side by side touch. */
static int between_lines(const solid *a, const solid *b, double *n) {
    double same = dot(a->axis, b->axis), axis[3], length = 0;
    if (fabs(same) < FLAT) return 0;
    for (int k = 0; k < 3; k++) axis[k] = a->axis[k] + (same < 0 ? -b->axis[k] : b->axis[k]);
    for (int k = 0; k < 3; k++) n[k] = a->at.p[k] - b->at.p[k];
    double along = dot(n, axis) / dot(axis, axis);
    for (int k = 0; k < 3; k++) n[k] -= along * axis[k];
    length = sqrt(dot(n, n));
    if (length < 1e-3 * (a->radius + b->radius)) return 0;
    for (int k = 0; k < 3; k++) n[k] /= length;
    return 1;
}

static void meet_outlines(patch *p) {
    const outline *a = &p->a->seen, *b = &p->b->seen;
    for (int i = 0; i < a->count; i++)
        if (within(b, a->corners[i])) try_spot(p, a->corners[i]);
    for (int i = 0; i < b->count; i++)
        if (within(a, b->corners[i])) try_spot(p, b->corners[i]);
    try_crossings(p);
}

static void write_row(const patch *p, int i, dContactGeom *row) {
    const found_spot *s = &p->spots[i];
    for (int k = 0; k < 3; k++) {
        row->pos[k] = s->x[0] * p->w->u[k] + s->x[1] * p->w->v[k] + s->middle * p->w->n[k];
        row->normal[k] = p->w->n[k];
    }
    row->depth = s->depth;
    row->side1 = row->side2 = -1;
}

/* Contacts of two that lie flat on each other, by the normal that ODE found; 0: they don't, or ODE's will do. */
static int collide_flat(const oo_geom *first, const oo_geom *second, const double *normal, dContactGeom *rows) {
    solid a, b;
    view w;
    feature of_a, of_b;
    if (!solid_of(first, &a) || !solid_of(second, &b)) return 0;
    double back[3] = {-normal[0], -normal[1], -normal[2]}, face_a[3], face_b[3];
    int flat_a = face_towards(&a, back, face_a), flat_b = face_towards(&b, normal, face_b);
    int line_a = lies_along(&a, back), line_b = lies_along(&b, normal);
    if (!(flat_a || line_a) || !(flat_b || line_b)) return 0;
    if (flat_b) {
        memcpy(w.n, face_b, sizeof w.n);
    } else if (flat_a) {
        for (int k = 0; k < 3; k++) w.n[k] = -face_a[k];
    } else if (!between_lines(&a, &b, w.n) || dot(w.n, normal) < FLAT) {
        return 0;
    }
    for (int k = 0; k < 3; k++) back[k] = -w.n[k];
    axes_across(w.n, w.u, w.v);
    if (flat_a)
        face_of(&a, &w, face_a, &of_a);
    else
        line_of(&a, &w, back, &of_a);
    if (flat_b)
        face_of(&b, &w, face_b, &of_b);
    else
        line_of(&b, &w, w.n, &of_b);
    patch p = {.w = &w, .a = &of_a, .b = &of_b, .count = 0};
    if (of_a.is_line && of_b.is_line) {
        try_stretch(&p);
    } else {
        meet_outlines(&p);
    }
    for (int i = 0; i < p.count; i++) {
        write_row(&p, i, &rows[i]);
        rows[i].g1 = first->id;
        rows[i].g2 = second->id;
    }
    return p.count;
}

/* ------------------------------------------------------------------ fewer */

static double size_of(dGeomID id) {
    dReal box[6];
    dGeomGetAABB(id, box);
    return sqrt((box[1] - box[0]) * (box[1] - box[0]) + (box[3] - box[2]) * (box[3] - box[2]) +
                (box[5] - box[4]) * (box[5] - box[4]));
}

/* How far two contacts differ: in place, and as much again if their normals stand square to each other. */
static double apart(const dContactGeom *a, const dContactGeom *b, double size) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double way = a->pos[k] - b->pos[k], bent = size * (a->normal[k] - b->normal[k]);
        square += way * way + bent * bent;
    }
    return square;
}

static int merge(dContactGeom *rows, int count, double size) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        if (!usable(&rows[i])) continue;
        int same = -1;
        for (int k = 0; k < kept && same < 0; k++)
            if (apart(&rows[i], &rows[k], size) < 1e-6 * size * size) same = k;
        if (same < 0)
            rows[kept++] = rows[i];
        else if (rows[i].depth > rows[same].depth)
            rows[same] = rows[i];
    }
    return kept;
}

static double distance_to_segment(const double *p, const double *a, const double *b) {
    double d[2] = {b[0] - a[0], b[1] - a[1]}, square = d[0] * d[0] + d[1] * d[1];
    double t = square > 0 ? ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square : 0;
    t = fmin(fmax(t, 0), 1);
    return hypot(p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]);
}

/* Only corners that stand out. */
static void straighten(outline *o, double slack) {
    while (o->count > 2) {
        int least = 0;
        double out = INFINITY;
        for (int i = 0; i < o->count; i++) {
            const double *before = o->corners[(i + o->count - 1) % o->count], *after = o->corners[(i + 1) % o->count];
            double here = distance_to_segment(o->corners[i], before, after);
            if (here >= out) continue;
            out = here;
            least = i;
        }
        if (out > slack) return;
        o->count--;
        memmove(o->corners[least], o->corners[least + 1], (size_t)(o->count - least) * sizeof *o->corners);
    }
}

static int one_plane(const dContactGeom *a, const dContactGeom *b, double size) {
    if (dot(a->normal, b->normal) < 1 - 1e-8) return 0;
    double way[3];
    for (int k = 0; k < 3; k++) way[k] = a->pos[k] - b->pos[k];
    return fabs(dot(way, a->normal)) < 1e-3 * size && fabs(a->depth - b->depth) < 0.1 * size;
}

/* Of contacts in one plane those in the middle of others hold nothing that the outer ones don't. */
static int keep_outer(dContactGeom *rows, int count, double size) {
    char group[PLENTY_OF_ROWS] = {0}, drop[PLENTY_OF_ROWS] = {0};
    for (int i = 0; i < count; i++) {
        if (group[i]) continue;
        int members[MOST_CORNERS], n = 0;
        double u[3], v[3], places[MOST_CORNERS][2], sorted[MOST_CORNERS][2];
        axes_across(rows[i].normal, u, v);
        for (int k = i; k < count && n < MOST_CORNERS; k++) {
            if (group[k] || !one_plane(&rows[i], &rows[k], size)) continue;
            group[k] = 1;
            places[n][0] = dot(u, rows[k].pos);
            places[n][1] = dot(v, rows[k].pos);
            members[n++] = k;
        }
        if (n < 3) continue;
        outline outer;
        memcpy(sorted, places, sizeof sorted);
        outline_of(sorted, n, &outer);
        straighten(&outer, 1e-3 * size);
        for (int m = 0; m < n; m++) {
            int stays = 0;
            for (int k = 0; k < outer.count && !stays; k++) stays = !memcmp(outer.corners[k], places[m], sizeof *places);
            drop[members[m]] = !stays;
        }
    }
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (!drop[i]) rows[kept++] = rows[i];
    return kept;
}

static void swap_rows(dContactGeom *a, dContactGeom *b) {
    dContactGeom kept = *a;
    *a = *b;
    *b = kept;
}

/* The deepest, then always the one that is farthest from all those taken before. */
static void put_best_first(dContactGeom *rows, int count, int most, double size) {
    double nearest[PLENTY_OF_ROWS];
    int best = 0;
    for (int i = 1; i < count; i++)
        if (rows[i].depth > rows[best].depth) best = i;
    for (int i = 0; i < count; i++) nearest[i] = INFINITY;
    for (int taken = 0; taken < most; taken++) {
        swap_rows(&rows[taken], &rows[best]);
        nearest[best] = nearest[taken];
        best = taken + 1;
        for (int i = taken + 1; i < count; i++) {
            nearest[i] = fmin(nearest[i], apart(&rows[i], &rows[taken], size));
            if (nearest[i] > nearest[best]) best = i;
        }
    }
}

int merge_rows(dContactGeom *rows, int count, double size) {
    int before;
    count = merge(rows, count, size);
    do {
        before = count;
        count = keep_outer(rows, count, size);
    } while (before > MOST_CORNERS && count < before); /* a plane may have had more than it looks at in one go */
    return count;
}

static int thin_out(dContactGeom *rows, int count, int most, double size) {
    count = merge_rows(rows, count, size);
    if (count <= most) return count;
    put_best_first(rows, count, most, size);
    return most;
}

static int is_round(const oo_geom *geom) {
    int class = dGeomGetClass(geom->id);
    return class == dCapsuleClass || class == dCylinderClass;
}

int collide_well(const oo_geom *a, const oo_geom *b, int most, dContactGeom *rows, int skip) {
    unsigned int either = a->flags | b->flags;
    if (a->flags & b->flags & OO_IS_SPHERE) return collide_pair(a, b, most, rows, skip);
    int mesh = (either & OO_IS_MESH) != 0, solid_pair = is_round(a) || is_round(b);
    int plane = dGeomGetClass(a->id) == dPlaneClass || dGeomGetClass(b->id) == dPlaneClass;
    if (either & (OO_IS_RAY | OO_IS_HEIGHTFIELD) || (plane && !mesh) || (!mesh && !solid_pair)) return collide_pair(a, b, most, rows, skip);
    dContactGeom all[PLENTY_OF_ROWS];
    int found = mesh ? collide_mesh(a, b, all) : collide_pair(a, b, PLENTY, all, sizeof *all);
    if (!found) return 0;
    if (solid_pair) {
        int deepest = 0;
        for (int i = 1; i < found; i++)
            if (usable(&all[i]) && !(all[i].depth <= all[deepest].depth)) deepest = i;
        dContactGeom flat[MOST_SPOTS];
        int better = usable(&all[deepest]) ? collide_flat(a, b, all[deepest].normal, flat) : 0;
        if (better) memcpy(all, flat, (size_t)better * sizeof *all);
        if (better) found = better;
    }
    double size = fmin(size_of(a->id), size_of(b->id));
    found = thin_out(all, found, most, size);
    for (int i = 0; i < found; i++) *row_at(rows, i, skip) = all[i];
    return found;
}
