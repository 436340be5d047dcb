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

#endif
