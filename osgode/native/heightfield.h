/* What the C files about heightfields share. */

#ifndef OSGODE_HEIGHTFIELD_H
#define OSGODE_HEIGHTFIELD_H

#include "internal.h"

typedef struct spot { /* where something meets a heightfield, in the axes of the heightfield */
    double p[3], n[3], depth, apart;
} spot;

typedef struct field {
    const oo_mesh *data;
    double width, depth, thickness;
    double dx, dz;              /* from sample to sample */
    spot *spots;                /* room to work in */
    unsigned int spot_count, spot_capacity;
} field;

static inline double height_of(const oo_mesh *m, int i, int j) { return m->vertices[(size_t)j * m->columns + (size_t)i]; }

/* The plane y = level + slope_x u + slope_z v of a triangle of cell (i, j), u and v from 0 to 1 across the cell.
   A cell is divided from its (1, 0) corner to its (0, 1) corner. */
typedef struct facet {
    double level, slope_x, slope_z;
} facet;
HIDDEN facet facet_of(const oo_mesh *, int i, int j, int upper);
HIDDEN void facet_normal(const field *, facet, double *n);

static inline int clamped(double value, int high) { return value < 0 ? 0 : value > high ? high : (int)value; }

/* Spheres, boxes, capsules, cylinders: a collider of ODE's for the geom class. */
HIDDEN int collide_field_with_shape(dGeomID, dGeomID other, int flags, dContactGeom *rows, int skip);

#endif
