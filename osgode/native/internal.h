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
/* After a step. */
HIDDEN void find_broken_joints(oo_world *);

/* Contacts of two geoms into the rows, if they may have any. */
HIDDEN void collide_pair(oo_world *, unsigned int slot1, unsigned int slot2);
/* Whether there would be any. For use between steps. */
HIDDEN int geoms_touch(oo_world *, unsigned int slot1, unsigned int slot2);

enum { MOST_DECLARED = 64 }; /* pairs of spaces that osgode's own broad phase can tell apart */
/* Contacts of all pairs that matter, by osgode's own broad phase. */
HIDDEN int find_pairs(oo_world *);
/* Another way was taken: what it knows is of an older step. */
HIDDEN void broad_forget(oo_world *);
/* Wake the bodies that slept on a geom in the last step, if the pairs were found this way in it. */
HIDDEN void wake_sleepers_on(oo_world *, unsigned int slot);
HIDDEN void broad_free(oo_world *);

#endif
