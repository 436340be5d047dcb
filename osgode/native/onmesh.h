/* What the C files about things on meshes share. All is in the axes of the mesh. */

#ifndef OSGODE_ONMESH_H
#define OSGODE_ONMESH_H

#include "internal.h"

enum { MOST_NEAR = 512, MOST_ON_MESH = PLENTY_OF_ROWS };


typedef struct near_triangle {
    const double *corners[3], *n;
    double above; /* the middle of the thing over its plane */
} near_triangle;

/* A box, sphere, capsule or cylinder, and the triangles that it may touch. */
typedef struct thing {
    int class;
    double p[3], r[12], half[3], radius; /* axes along z, half lengths without round ends */
    frame at;
    double low[3], high[3], size, margin; /* its box, the least side of that; how far triangles may be off */
    const oo_mesh *mesh;
    int count;
    near_triangle near[MOST_NEAR];
} thing;

/* Contacts in the axes of the mesh, with normals away from it. side1 says that one is known to be no seam. */
typedef struct meetings {
    dContactGeom *at; /* MOST_ON_MESH of them */
    int count;
} meetings;

static inline void between(const double *from, const double *to, double *out) {
    for (int k = 0; k < 3; k++) out[k] = to[k] - from[k];
}

/* Where there is no more room it is forgotten. */
static inline void add_meeting(meetings *all, const double *p, const double *n, double depth, int sound) {
    if (all->count == MOST_ON_MESH) return;
    dContactGeom *m = &all->at[all->count++];
    memcpy(m->pos, p, 3 * sizeof *p);
    memcpy(m->normal, n, 3 * sizeof *n);
    m->depth = depth;
    m->side1 = sound;
}

/* The point of a triangle that is nearest to c; 1 if it is within, 0 if on an edge. */
HIDDEN int nearest_on_triangle(const near_triangle *, const double *c, double *q);

/* The part of a line from a to b that is over or under a triangle, from 0 to 1; 0 if none. */
HIDDEN int stretch_over(const near_triangle *, const double *a, const double *b, double *from, double *to);

HIDDEN void meet_capsule(const thing *, meetings *);
/* Where a flat side of a box or cylinder, or the length of a cylinder, lies on a triangle, no deeper than that. */
HIDDEN void lie_on_triangle(const thing *, const near_triangle *, double deepest, meetings *);

#endif
