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

/* A threading implementation of the World's own: ODE's default one is shared by all worlds and races. */
HIDDEN int use_own_threading(oo_world *);

/* The pose of the frame that the author placed, 7 doubles. */
HIDDEN void write_pose(const oo_body *, double *row);

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
HIDDEN void to_local(const oo_joint *, int of, const double *world, double *local);
HIDDEN void to_world(const oo_joint *, int of, const double *local, double *world);
static inline double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline void cross(double *out, const double *a, const double *b) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
/* After a step. */
HIDDEN void find_broken_joints(oo_world *);

#endif
