/* What the C files share and Python never sees. */

#ifndef OSGODE_INTERNAL_H
#define OSGODE_INTERNAL_H

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <ode/ode.h>

#include "core.h"

#define HIDDEN __attribute__((visibility("hidden")))

#define POSITION_LIMIT 1e8  /* HashSpace cells are counted in 31 bits: 2.7e8 m at its finest level */
#define VELOCITY_LIMIT 1e10 /* above about 1e160 ODE aborts while it steps */

enum { MATERIALS = 16, PAIR_SURFACES = MATERIALS * MATERIALS };

/* ODE aborts the process when an assert fails. Every call that can reach one runs between guard_enter and
   guard_leave: the handler jumps back there, and the call returns OO_ASSERT. */
struct guard {
    jmp_buf place;
    int armed;
    char text[400];
};
extern HIDDEN __thread struct guard guard;

/* guard_enter() is 0 at first and 1 when ODE's assert has jumped back. */
#define guard_enter() (guard.armed = 1, _setjmp(guard.place) ? (guard.armed = 0, 1) : 0)
#define guard_leave() (guard.armed = 0)

extern HIDDEN oo_live live;
static inline void count_live(long *counter, long change) { __atomic_fetch_add(counter, change, __ATOMIC_RELAXED); }

/* Room for `wanted` elements behind *array. Existing ones may move. */
HIDDEN int reserve(void *array, unsigned int *capacity, size_t wanted, size_t element);

/* Let ODE draw its random numbers from this World's sequence, and take the seed back. */
HIDDEN void random_begin(const oo_world *);
HIDDEN void random_end(oo_world *);

struct triangle_tree;

/* What geoms are made from. */
struct oo_mesh {
    dTriMeshDataID id;                /* of a mesh, and of a hull as a mesh */
    double *vertices;                 /* x y z; of a heightfield the heights alone, x running fastest */
    unsigned int vertex_count;
    unsigned int triangle_count;      /* of a mesh, and of a hull as a mesh */
    struct triangle_tree *tree;       /* of them, made when it is first wanted */
    double (*normals)[3];             /* made with it; zeros for those without an area */
    unsigned int *triangles;          /* of a solid hull with a 3 before each, as ODE's polygons */
    double *planes;                   /* of a hull, one per triangle: outward normal n and n . p */
    unsigned int plane_count;
    unsigned int rows, columns;       /* of a heightfield */
    double lowest, highest;
    oo_mesh *next;
};

/* The pose of a geom. */
typedef struct frame {
    const dReal *p, *r;
} frame;

/* The geom class of heightfields: made once, at import. */
HIDDEN void init_heightfields(void);
/* NULL if there is no memory. */
HIDDEN dGeomID heightfield_new(const oo_mesh *, const double *dimensions);
/* How a mesh or hull meets a heightfield: contact rows as of dCollide. */
HIDDEN int collide_mesh_with_heightfield(const oo_geom *mesh, const oo_geom *field, int most, dContactGeom *rows, int skip);
/* A closed convex thing, in its own axes. */
typedef struct polytope {
    frame at;
    const double *vertices, *planes;
    unsigned int vertex_count, plane_count;
    double box_vertices[24], box_planes[24];
} polytope;
/* A mesh or hull has its data, a box NULL. A mesh that is no hull has no planes. */
HIDDEN void polytope_of(dGeomID, const oo_mesh *, polytope *);

enum { MOST_CORNERS = 96 };
typedef struct outline { /* what it turns towards the other, seen along a direction; counter-clockwise */
    double corners[MOST_CORNERS][2];
    int count;
} outline;
/* Sorts the points; at most MOST_CORNERS of them. */
HIDDEN void outline_of(double (*points)[2], int count, outline *);
/* Above 0 if b is to the left of the way from o to a. */
HIDDEN double side_of(const double *o, const double *a, const double *b);
/* Two directions that stand square to n and to each other. */
HIDDEN void axes_across(const double *n, double *u, double *v);

/* How two hulls, or a hull and a box, meet. */
HIDDEN int collide_polytopes(const oo_geom *, const oo_geom *, int most, dContactGeom *rows, int skip);

/* What dCollide does, and what it should do: ODE's rays miss solid hulls, its hulls jitter, and its meshes
   sink into heightfields. */
HIDDEN int collide_pair(const oo_geom *, const oo_geom *, int most, dContactGeom *rows, int skip);

enum { PLENTY_OF_ROWS = 512 };

static const double FLAT = 0.9945, ALONG = 0.1045; /* cosine and sine of 6 degrees: within it, it lies flat */

/* Without those that others make needless: the same, or in the middle of others. size: of the smaller thing. */
HIDDEN int merge_rows(dContactGeom *, int count, double size);
/* The same with contacts that let things lie still and roll over meshes; of too many, those that span the most. */
HIDDEN int collide_well(const oo_geom *, const oo_geom *, int most, dContactGeom *rows, int skip);
/* Its part for pairs with a mesh, up to PLENTY_OF_ROWS. */
HIDDEN int collide_mesh(const oo_geom *, const oo_geom *, dContactGeom *rows);

static inline dContactGeom *row_at(dContactGeom *rows, int index, int skip) {
    return (dContactGeom *)((char *)rows + (size_t)index * (size_t)skip);
}

static inline frame frame_of(dGeomID id) { return (frame){dGeomGetPosition(id), dGeomGetRotation(id)}; }
static inline double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/* out = R v */
static inline void turn(const frame *f, const double *v, double *out) {
    for (int k = 0; k < 3; k++) out[k] = f->r[4 * k] * v[0] + f->r[4 * k + 1] * v[1] + f->r[4 * k + 2] * v[2];
}
/* out = R^T v */
static inline void turn_back(const frame *f, const double *v, double *out) {
    for (int k = 0; k < 3; k++) out[k] = f->r[k] * v[0] + f->r[4 + k] * v[1] + f->r[8 + k] * v[2];
}
static inline void to_world(const frame *f, const double *point, double *out) {
    turn(f, point, out);
    for (int k = 0; k < 3; k++) out[k] += f->p[k];
}
static inline void to_local(const frame *f, const double *point, double *out) {
    double arm[3] = {point[0] - f->p[0], point[1] - f->p[1], point[2] - f->p[2]};
    turn_back(f, arm, out);
}

/* A threading implementation of the World's own: ODE's default one is shared by all worlds and races. */
HIDDEN int use_own_threading(oo_world *);

static inline void cross(double *out, const double *a, const double *b) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The pose of the frame that the author placed, 7 doubles. */
HIDDEN void write_pose(const oo_body *, double *row);
HIDDEN void put_frame(const oo_body *, const double *row);
/* A vector turned by a unit quaternion. */
HIDDEN void rotate_by(double out[3], const double q[4], const double v[3]);

/* Before and after the integration: the velocities of gliding bodies, and the poses that they reach. */
HIDDEN void begin_glides(oo_world *);
HIDDEN void end_glides(oo_world *);
/* A body is about to go, and the last one to take its index. */
HIDDEN void forget_glide(oo_world *, unsigned int body, unsigned int last);

/* Before a step: what their motors are to do in it. */
HIDDEN void drive_servos(oo_world *);
/* Before a step: where the wheels of transmissions stand, and whether ODE may go on counting. After it: how far they
   have turned. */
HIDDEN void mesh_gears(oo_world *);
HIDDEN void count_gears(oo_world *);
/* Of one transmission, for reading. */
HIDDEN void read_gears(const oo_joint *, double *angle, double *rate);
/* Anchors at s, axes at s + 6, then ratio and both radii. */
HIDDEN void place_gears(oo_joint *, const double *s, int mode);
HIDDEN void axis_of_body(const oo_joint *, int of, const double *world, double *local);
HIDDEN void axis_in_world(const oo_joint *, int of, const double *local, double *world);
/* After a step. */
HIDDEN void find_broken_joints(oo_world *);

/* Contacts of two geoms into the rows, if their categories want it. */
HIDDEN void meet_pair(oo_world *, unsigned int slot1, unsigned int slot2);
HIDDEN int geoms_touch(oo_world *, unsigned int slot1, unsigned int slot2);

enum { MOST_DECLARED = 64 }; /* pairs of spaces that osgode's own broad phase can tell apart */
/* Contacts of all pairs that matter, by osgode's own broad phase. */
HIDDEN int find_pairs(oo_world *);
/* Another way was taken: what it knows is of an older step. */
HIDDEN void broad_forget(oo_world *);
/* Wake the bodies that slept on a geom in the last step, if the pairs were found this way in it. */
HIDDEN void wake_sleepers_on(oo_world *, unsigned int slot);
HIDDEN void broad_free(oo_world *);

typedef struct ray {
    double origin[3], direction[3], inverse[3], length; /* the length may be cut while it is followed */
} ray;
/* Bring the boxes up to date, ask, and end it; nothing may change in between. */
HIDDEN int begin_queries(oo_world *, unsigned int count);
HIDDEN void along_ray(oo_world *, ray *, void (*visit)(void *, unsigned int slot), void *data);
HIDDEN void in_box_of(oo_world *, dGeomID, void (*visit)(void *, unsigned int slot), void *data);
HIDDEN void end_queries(oo_world *);
/* All geoms whose boxes meet one, as they stand now. */
HIDDEN void in_box(oo_world *, const double low[3], const double high[3], void (*visit)(void *, unsigned int slot), void *data);

HIDDEN void lock_meshes(int wanted);
HIDDEN int usable(const dContactGeom *);
/* Whether a contact is to make a joint. */
HIDDEN int row_acts(const oo_world *, const oo_contact *);
/* Of this step's contacts and joints; then whether a body is awake, or is about to be woken by what is. */
HIDDEN int find_islands(oo_world *);
HIDDEN int is_awake(const oo_world *, dBodyID);

/* The triangles whose boxes meet a box, in the axes of the mesh; by number, when their normals are there too. */
HIDDEN int triangle_numbers_in(oo_mesh *, const double low[3], const double high[3], void (*visit)(void *, unsigned int), void *data);
HIDDEN int triangles_in(oo_mesh *, const double low[3], const double high[3], void (*visit)(void *, const double *corners[3]), void *data);
HIDDEN void triangles_free(oo_mesh *);

/* Put bodies that were too fast to where they first touch something. */
HIDDEN int stop_fast_bodies(oo_world *);
/* Geoms whose boxes were in a box at any time in the last step. */
HIDDEN void near_way(oo_world *, const double low[3], const double high[3], void (*visit)(void *, unsigned int slot), void *data);
HIDDEN int pair_declared(const oo_world *, unsigned int slot1, unsigned int slot2);

#endif
