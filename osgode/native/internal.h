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
HIDDEN void put_frame(const oo_body *, const double *row);

/* Before and after the integration: the velocities of gliding bodies, and the poses that they reach. */
HIDDEN void begin_glides(oo_world *);
HIDDEN void end_glides(oo_world *);
/* A body is about to go, and the last one to take its index. */
HIDDEN void forget_glide(oo_world *, unsigned int body, unsigned int last);

/* Before a step: what their motors are to do in it. */
HIDDEN void drive_servos(oo_world *);
/* After a step. */
HIDDEN void find_broken_joints(oo_world *);

#endif
