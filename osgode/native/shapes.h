/* Convex shapes in the world, as sweeps see them. */

#ifndef OSGODE_SHAPES_H
#define OSGODE_SHAPES_H

#include "internal.h"

enum { SHAPE_SEGMENT, SHAPE_BOX, SHAPE_CYLINDER, SHAPE_POINTS, SHAPE_PLANE };

typedef struct shape {
    int kind;
    double position[3], rotation[12]; /* as ODE's: rows of 4 */
    double half[3];                   /* half lengths; of a segment along z; of a cylinder the radius first */
    double margin;                    /* everything within it belongs to the shape too */
    const double *points;             /* in the world; the position is not used then */
    int count;
} shape;

/* The point of a shape, without its margin, that lies farthest along a direction. */
HIDDEN void support(const shape *, const double *way, double *out);
HIDDEN double shape_distance(const shape *, const double *by, const shape *, double *normal);
HIDDEN double first_touch(const shape *, const double *motion, const shape *, double gap, double *normal);
/* Points of both that are nearest to each other, and how far apart; 0 or less where they overlap. */
HIDDEN double closest_points(const shape *, const shape *, double *on_a, double *on_b);

/* 1 and the shape of a geom, as it stands (shape_done frees it); 0 if it is no convex one; or a status below 0. */
HIDDEN int shape_of(const oo_geom *, shape *);
HIDDEN void shape_done(shape *);
/* How far along a motion (0 to 1; 2: nowhere) a shape first touches what is wanted, and what that is. */
HIDDEN double follow_shape(oo_world *, shape *, const double motion[3], int (*wanted)(void *, unsigned int slot), void *asker,
                           unsigned int *slot, double normal[3]);
/* The nearest points of a shape and a mesh or heightfield. */
HIDDEN int nearest_on_surface(const shape *, const oo_geom *, double *distance, double *on_shape, double *on_other);

#endif
