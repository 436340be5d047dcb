/* How two geoms meet. Whatever needs contacts asks here, and not dCollide. */

#include "internal.h"

/* ODE's own takes the distance to a plane for the distance along the ray, and turns vectors in place. The ray is
   clipped by one plane after the other: it is inside from the last one that it enters to the first that it leaves. */
static int collide_ray_with_hull(dGeomID ray, const oo_geom *hull, dContactGeom *out) {
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
    if (enter > leave || !outward || leave < 0) return 0;
    int inside = enter < 0 || !in;
    if (inside && dGeomRayGetBackfaceCull(ray)) return 0;
    double t = inside ? leave : enter;
    if (t > dGeomRayGetLength(ray)) return 0;
    turn(&at, inside ? outward : in, out->normal);
    for (int k = 0; k < 3; k++) out->pos[k] = start[k] + t * direction[k];
    out->depth = t;
    out->g1 = ray;
    out->g2 = hull->id;
    out->side1 = out->side2 = -1;
    return 1;
}

/* Normals point against the ray, whichever side of a surface it meets; and on the edge of two triangles it meets one. */
static int collide_ray(const oo_geom *ray, const oo_geom *other, int most, dContactGeom *rows, int skip) {
    int is_solid_hull = other->mesh && other->mesh->planes && !other->mesh->id;
    int found = is_solid_hull ? collide_ray_with_hull(ray->id, other, rows) : dCollide(ray->id, other->id, most, rows, skip);
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

static int has_corners(const oo_geom *geom) { return geom->mesh && !(geom->flags & OO_IS_HEIGHTFIELD); }

int collide_pair(const oo_geom *a, const oo_geom *b, int most, dContactGeom *rows, int skip) {
    if (a->flags & OO_IS_RAY) return collide_ray(a, b, most, rows, skip);
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
