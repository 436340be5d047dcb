/* How two geoms meet. Whatever needs contacts asks here, and not dCollide. */

#include "internal.h"

static int is_hull(const oo_geom *geom) { return geom->mesh && geom->mesh->planes; }

static void hull_hit(dContactGeom *row, dGeomID ray, const oo_geom *hull, const double *plane, double t) {
    frame at = frame_of(hull->id);
    dVector3 start, direction;
    dGeomRayGet(ray, start, direction);
    turn(&at, plane, row->normal);
    for (int k = 0; k < 3; k++) row->pos[k] = start[k] + t * direction[k];
    row->depth = t;
    row->g1 = ray;
    row->g2 = hull->id;
    row->side1 = row->side2 = -1;
}

/* ODE's own takes the distance to a plane for the distance along the ray, and turns vectors in place. The ray is
   clipped by one plane after the other: it is inside from the last one that it enters to the first that it leaves. */
static int collide_ray_with_hull(dGeomID ray, const oo_geom *hull, int most, dContactGeom *rows, int skip) {
    frame at = frame_of(hull->id);
    dVector3 start, direction;
    dGeomRayGet(ray, start, direction);
    double o[3], d[3], enter = -INFINITY, leave = INFINITY;
    to_local(&at, start, o);
    turn_back(&at, direction, d);
    const double *in = NULL, *outward = NULL;
    for (unsigned int i = 0; i < hull->mesh->plane_count; i++) {
        const double *plane = hull->mesh->planes + 4 * i;
        double distance = dot(plane, o) - plane[3], speed = dot(plane, d);
        if (fabs(speed) < 1e-12) {
            if (distance > 0) return 0;
            continue;
        }
        double t = -distance / speed;
        if (speed < 0 && t > enter) {
            enter = t;
            in = plane;
        } else if (speed > 0 && t < leave) {
            leave = t;
            outward = plane;
        }
    }
    if (enter > leave || !outward) return 0;
    double length = dGeomRayGetLength(ray);
    int one = dGeomRayGetClosestHit(ray) || dGeomRayGetFirstContact(ray) || most == 1, found = 0;
    if (in && enter >= 0 && enter <= length) hull_hit(row_at(rows, found++, skip), ray, hull, in, enter);
    if (leave < 0 || leave > length || dGeomRayGetBackfaceCull(ray) || (one && found)) return found;
    hull_hit(row_at(rows, found++, skip), ray, hull, outward, leave);
    return found;
}

/* Normals point against the ray, whichever side of a surface it meets; and on the edge of two triangles it meets one. */
static int collide_ray(const oo_geom *ray, const oo_geom *other, int most, dContactGeom *rows, int skip) {
    int found = is_hull(other) ? collide_ray_with_hull(ray->id, other, most, rows, skip)
                               : dCollide(ray->id, other->id, most, rows, skip);
    int kept = 0;
    dVector3 start, direction;
    dGeomRayGet(ray->id, start, direction);
    for (int i = 0; i < found; i++) {
        dContactGeom *row = row_at(rows, i, skip);
        int again = 0;
        for (int k = 0; k < kept && !again; k++)
            again = fabs(row_at(rows, k, skip)->depth - row->depth) < 1e-9 * (1 + row->depth);
        if (again) continue;
        if (dot(row->normal, direction) > 0)
            for (int k = 0; k < 3; k++) row->normal[k] = -row->normal[k];
        if (kept < i) *row_at(rows, kept, skip) = *row;
        kept++;
    }
    return kept;
}

static int is_polytope(const oo_geom *geom) { return is_hull(geom) || dGeomGetClass(geom->id) == dBoxClass; }
static int has_corners(const oo_geom *geom) { return geom->mesh && !(geom->flags & OO_IS_HEIGHTFIELD); }

int collide_pair(const oo_geom *a, const oo_geom *b, int most, dContactGeom *rows, int skip) {
    if (a->flags & OO_IS_RAY) return collide_ray(a, b, most, rows, skip);
    if ((is_hull(a) && is_polytope(b)) || (is_hull(b) && is_polytope(a))) return collide_polytopes(a, b, most, rows, skip);
    if (has_corners(a) && b->flags & OO_IS_HEIGHTFIELD) return collide_mesh_with_heightfield(a, b, most, rows, skip);
    if (!has_corners(b) || !(a->flags & OO_IS_HEIGHTFIELD)) return dCollide(a->id, b->id, most, rows, skip);
    int found = collide_mesh_with_heightfield(b, a, most, rows, skip);
    for (int i = 0; i < found; i++) {
        dContactGeom *row = row_at(rows, i, skip);
        for (int k = 0; k < 3; k++) row->normal[k] = -row->normal[k];
        row->g1 = a->id;
        row->g2 = b->id;
    }
    return found;
}
