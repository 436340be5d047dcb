/* The C core of osgode as both the C compiler and cffi read it, so no preprocessor here. */

/* What calls return. */
enum oo_status {
    OO_OK = 0,
    OO_NO_MEMORY = -1,  /* nothing was done */
    OO_ASSERT = -2,     /* ODE refused; oo_last_error() says why */
    OO_BAD_BODY = -3,   /* world.bad_body is not finite or out of bounds; nothing was done */
    OO_BROKEN = -4      /* an ODE assert inside a collide left this World unusable */
};

enum oo_geom_kind {
    OO_BOX, OO_SPHERE, OO_CAPSULE, OO_CYLINDER, OO_PLANE, OO_TRIMESH,
    OO_RAY, OO_HULL, /* a hull as a mesh */ OO_CONVEX, OO_HEIGHTFIELD
};
enum oo_space_kind { OO_SIMPLE_SPACE, OO_HASH_SPACE, OO_QUADTREE_SPACE, OO_SAP_SPACE };
enum oo_joint_kind {
    OO_BALL, OO_HINGE, OO_SLIDER, OO_FIXED, OO_UNIVERSAL, OO_HINGE2, OO_AMOTOR, OO_LMOTOR, OO_PR, OO_PU, OO_PISTON,
    OO_PLANE2D, OO_DBALL, OO_DHINGE, OO_TRANSMISSION
};

/* Parameters of joints beside ODE's own numbers. */
enum oo_param {
    OO_ANGLE = 0xf0,            /* of an angular motor in user mode; a group may be added */
    OO_DISTANCE = 0x1000,       /* of a double ball or double hinge */
    OO_BACKLASH = 0x1001        /* of a transmission */
};

enum oo_geom_flags {
    OO_ALIVE = 1,
    OO_LISTENED = 2,    /* somebody in Python wants its touches */
    OO_IS_SPACE = 4,
    OO_IS_MESH = 8,     /* collided under a process-wide lock: OPCODE's caches are global */
    OO_IS_CYLINDER = 16,
    OO_IS_RAY = 32,     /* reports, and never responds */
    OO_IS_HEIGHTFIELD = 64,
    OO_ASKED = 128,     /* somebody in Python wants to be asked before its contacts act */
    OO_SENSOR = 256,    /* it is touched and never responds */
    OO_IS_BELT = 512,
    OO_IS_SPHERE = 1024
};

/* As the surface of a contact row: it only reports; it was refused, and does not even that. */
enum oo_surface_index { OO_NO_RESPONSE = 0x7fffffff, OO_REFUSED = 0x7ffffffe };

enum oo_touch_state { OO_BEGIN, OO_STAY, OO_END, OO_UNASKED };

enum oo_tunnelling { OO_TUNNEL, OO_TUNNEL_RAY, OO_TUNNEL_SWEEP };

typedef struct oo_body {
    dBodyID id;
    double com[3];      /* centre of mass (ODE's reference point) in the frame that the author placed */
    double thin;        /* half of its thinnest part, metres; infinite without geoms */
    double way[3];      /* of its centre of mass in the last step, if anything was too fast in it */
    double moved[3];    /* the same, if it was not stopped on it */
    int held;           /* it was stopped in the last step */
    int watched;        /* for so many steps it is followed though it is slow */
    int tunnelling;     /* enum oo_tunnelling */
    int warned;         /* that it is too fast for its size: 1 to be told, 2 told */
    int settled;        /* it slept when its pose was written last, and both tables say the same */
} oo_body;

typedef struct oo_mesh oo_mesh;

typedef struct oo_geom {
    dGeomID id;
    oo_mesh *mesh;                  /* what it is made from, or NULL */
    unsigned int category, collide;
    unsigned int material;          /* 0 to 15 */
    unsigned int surface;           /* own surface, an index above the pair table; 0: none */
    unsigned int flags;
    float velocity[3];              /* of its surface against itself, along its own axes, with OO_IS_BELT */
} oo_geom;

typedef struct oo_contact {
    dContactGeom geom;              /* first, so that dCollide writes rows in place */
    unsigned int slot1, slot2;      /* into world.geoms */
    unsigned int surface;           /* into world.surfaces, or OO_NO_RESPONSE */
    int feedback;                   /* into world.feedback, or -1 */
    double force[3];                /* on the body of geom 1, newtons; 0 if nobody listens */
} oo_contact;

typedef struct oo_touch {
    unsigned int slot1, slot2;      /* slot1 < slot2 */
    unsigned int first, count;      /* its contact rows; count 0 at the end of a touch */
    int state;                      /* enum oo_touch_state */
    double impulse;                 /* sum of contact force times step size, newton seconds */
} oo_touch;

typedef struct oo_servo {
    double target, max_speed, frequency, damping_ratio;
    int turns;                      /* the target is an angle, to be reached the shorter way round */
} oo_servo;

typedef struct oo_joint {
    dJointID id;
    int kind;                       /* enum oo_joint_kind */
    unsigned int index;             /* in world.joints */
    unsigned long long born;        /* world.steps when it was made */
    double at[3];                   /* where its torque is taken, in body 1 from its centre of mass */
    double break_force, break_torque; /* infinite: it doesn't break */
    int has_servo;
    oo_servo servo;
    int euler, axis_count, axis_of[3]; /* of motors: an axis is that of the world (0), of body 1 or of body 2 */
    double axes[3][3], references[2][3];
    int gears;                      /* of a transmission: its mode */
    int counting;                   /* its references are set, and ODE counts from `zero` */
    double middles[2][3], sense[2]; /* of its wheels; 1 or -1: which way round ODE has their axes */
    double turned[2], zero[2];      /* radians since it was made */
    dJointFeedback feedback;
} oo_joint;

typedef struct oo_joint_state {
    double position[3], rate[3];    /* angles (rad) and positions (m) as the kind of joint has them */
    double force1[3], torque1[3];   /* on body 1, the torque about its centre of mass; 0 without feedback */
    double force2[3], torque2[3];
    double torque[3];               /* on body 1, about the anchor */
} oo_joint_state;

typedef struct oo_pair {
    dSpaceID space, other;          /* other NULL: the pairs inside space */
    int nested;                     /* not declared, but in a space that was: ODE has to be told of it */
} oo_pair;

typedef struct oo_glide {
    unsigned int body;
    int arrives;                    /* with this step */
    double target[7];               /* of the frame: x y z qw qx qy qz */
    double seconds;                 /* left */
    double next[7], velocity[6];    /* of this step; the velocity of the centre of mass */
} oo_glide;

typedef struct oo_island {
    unsigned int parent;            /* a body that it touches or is joined to; of the first of them, itself */
    int awake;                      /* of the first: one of them is */
} oo_island;

/* Seconds since Python set them to 0, of whole steps. */
typedef struct oo_timings {
    double collide;                 /* finding pairs, and their contacts */
    double respond;                 /* making joints of these */
    double solve;                   /* moving the bodies */
    double report;                  /* what touches, breaks and is out of bounds; poses for the picture */
    unsigned int steps;
} oo_timings;

/* What is to be known of a body that the tables of poses don't tell. */
typedef struct oo_body_state {
    double com[3];                  /* centre of mass in the frame */
    int asleep, kinematic;
} oo_body_state;

/* Of a slot. */
typedef struct oo_geom_state {
    double low[3], high[3];         /* its box along the world's axes; may be infinite */
    unsigned int flags;             /* enum oo_geom_flags; without OO_ALIVE, or of a space, the box is 0 */
    int enabled;
} oo_geom_state;

typedef struct oo_broad oo_broad;

typedef struct oo_query {
    unsigned int kinds;             /* category bits that are met */
    dSpaceID space;                 /* only what is in it; NULL: anywhere */
    const unsigned int *excluded;   /* slots, sorted */
    unsigned int excluded_count;
} oo_query;

typedef struct oo_hit {
    int slot;                       /* into world.geoms; -1: nothing was hit */
    double distance;                /* of an overlap: its depth */
    double point[3], normal[3];
} oo_hit;

typedef struct oo_world {
    dWorldID id;
    double step_size;
    int exact;                      /* dWorldStep instead of dWorldQuickStep */
    unsigned int max_contacts;      /* per pair of geoms, 1 to 65535 */
    int refines;                    /* contacts are osgode's own where ODE's are poor, unless with ode_broad */
    unsigned long seed;             /* of the solver's random row order */
    unsigned long long steps;
    int broken;
    int out_of_memory;              /* while colliding */
    int bad_body;                   /* index, or -1 */
    unsigned int flagged_count;     /* bodies with a tunnelling of their own */
    unsigned int too_fast_count;    /* bodies to be warned of */

    oo_body *bodies;                /* dense: the last takes the place of one that is freed */
    unsigned int body_count, body_capacity;
    double *poses, *previous;       /* Python's tables, table_capacity rows of x y z qw qx qy qz */
    unsigned int table_capacity;

    oo_glide *glides;               /* kinematic bodies on their way */
    unsigned int glide_count, glide_capacity;

    oo_geom *geoms;                 /* by slot; spaces too */
    unsigned int geom_count, geom_capacity;
    unsigned int *free_slots, *retired_slots;
    unsigned int free_count, retired_count, retired_ripe, slot_capacity;

    oo_pair *pairs;
    unsigned int pair_count;
    oo_pair *declared;              /* those of them that are not nested */
    unsigned int declared_count;
    int edited;                     /* what stands where may have been changed since it looked last, not by a step */
    int pairs_are_new;              /* since osgode's own broad phase looked last */
    int ode_broad;                  /* pairs are found by ODE's spaces, in their order */
    oo_broad *broad;
    dSurfaceParameters *surfaces;   /* 16 x 16 for pairs of materials, then own surfaces of geoms */
    double *directions;             /* 3 for each of these: along what its first friction acts, 0 0 0: anything */
    unsigned int surface_count;

    oo_contact *contacts;
    unsigned int contact_count, contact_capacity;
    oo_island *islands;             /* by body, while contacts become joints */
    unsigned int island_capacity, asleep_count; /* bodies that slept after the last step */
    dJointFeedback *feedback;
    unsigned int feedback_count, feedback_capacity;

    oo_touch *touching, *touched;   /* of this step and of the last one, sorted by slots */
    unsigned int touching_count, touching_capacity, touched_count, touched_capacity;
    unsigned int asked_count;       /* pairs of touching that somebody wants to be asked about */
    int asking;                     /* oo_run has collided, and waits for the answers to respond to the rest */
    oo_touch *events;
    unsigned int event_count, event_capacity;

    oo_hit *hits;                   /* of the last query that may have several */
    unsigned int hit_count, hit_capacity;

    oo_mesh *meshes;
    oo_joint **joints;              /* dense: the last takes the place of one that is freed */
    unsigned int joint_count, joint_capacity, servo_count, breakable_count, gear_count;
    unsigned int *broken_joints;    /* indices of those that the last step overloaded */
    unsigned int broken_count, broken_capacity;
    dJointGroupID contact_group;
    dThreadingImplementationID threading;
    oo_timings timings;
} oo_world;

typedef struct oo_live { long worlds, bodies, geoms, spaces, joints, meshes, blocks, bytes; } oo_live;

/* Once, at import. Returns 0, or OO_ASSERT if libode can't be used. */
int oo_init(void);
/* 1 if libode draws its random numbers from the core, 0 if a lock has to serialise the steps of all Worlds. */
int oo_random_is_local(void);
/* What is alive in the whole process. */
oo_live oo_count_live(void);
/* The text of the last ODE assert of this thread. */
const char *oo_last_error(void);
/* The oldest message that ODE wrote and nobody has taken yet: 1 and the text, or 0. */
int oo_take_message(char *text, unsigned int size);

oo_world *oo_world_new(void);
void oo_world_free(oo_world *);
int oo_set_pairs(oo_world *, const oo_pair *, unsigned int count);
/* Set one surface, growing the table as needed. The direction, in the axes of the geom whose own surface it is, may be
   0 0 0. */
int oo_set_surface(oo_world *, unsigned int index, const dSurfaceParameters *, const double direction[3]);
void oo_geom_set_velocity(oo_world *, unsigned int slot, const double velocity[3]);

/* An index into world.bodies, or a status below 0. The caller keeps table_capacity above body_count. */
int oo_body_new(oo_world *);
/* The last body moves to the freed index, in the tables too. */
void oo_body_free(oo_world *, unsigned int index);
/* Position, quaternion and rotation matrix exactly as ODE holds them (3 + 4 + 12 doubles); its own setters round. */
void oo_body_read_raw(const oo_world *, unsigned int index, double raw[19]);
void oo_body_write_raw(oo_world *, unsigned int index, const double raw[19]);
/* Let a kinematic body move to a pose of its frame, linearly and by the shorter turn, and stand still there; instead of
   where it glided to before. At least one step; a step size that changes on the way changes the number of steps. */
int oo_glide_start(oo_world *, unsigned int index, const double target[7], double seconds);
/* Let it stay where it is: with halt it stands still, without it keeps the velocities of this moment. */
void oo_glide_stop(oo_world *, unsigned int index, int halt);
int oo_glides(const oo_world *, unsigned int index);
int oo_body_set_mass(oo_world *, unsigned int index, double mass, const double inertia[9]);

/* A slot of world.geoms, or a status below 0. */
int oo_geom_new(oo_world *, int kind, const double *dimensions, oo_mesh *);
int oo_space_new(oo_world *, int kind, const double *arguments);
void oo_geom_free(oo_world *, unsigned int slot);
/* One that was in no space since it was made, so that nothing can name its slot: it may be given out again at once. */
void oo_geom_discard(oo_world *, unsigned int slot);
/* Another width, depth and thickness for a heightfield. */
int oo_heightfield_resize(dGeomID, const double *dimensions);
/* A geom or space from one space to another; either may be NULL. */
void oo_rehouse(dSpaceID from, dSpaceID to, dGeomID);
/* Wake the bodies that touched a geom, or one of a body, in the last step: it is about to go or to change. */
void oo_wake_touching(oo_world *, unsigned int slot);
void oo_wake_touching_body(oo_world *, unsigned int index);
/* What osgode's own broad phase keeps. */
unsigned long long oo_broad_bytes(const oo_world *);
/* As if nothing had touched in the last step. */
void oo_forget_contacts(oo_world *);
void oo_geom_set_bits(oo_world *, unsigned int slot, unsigned int category, unsigned int collide, unsigned int material);

/* What geoms are made from and share. NULL if ODE refused. All is copied. */
oo_mesh *oo_mesh_new(oo_world *, const double *vertices, unsigned int vertex_count, const unsigned int *triangles,
                     unsigned int triangle_count);
/* Closed and convex, counter-clockwise from outside; solid: for OO_CONVEX, with the origin strictly inside; else OO_HULL. */
oo_mesh *oo_hull_new(oo_world *, const double *vertices, unsigned int vertex_count, const unsigned int *triangles,
                     unsigned int triangle_count, int solid);
/* Rows along z, columns along x, at least 2 of each. */
oo_mesh *oo_heights_new(oo_world *, const double *heights, unsigned int rows, unsigned int columns);
void oo_mesh_free(oo_world *, oo_mesh *);

/* NULL if ODE refused. It must be placed before it is used. */
oo_joint *oo_joint_new(oo_world *, int kind, dBodyID body1, dBodyID body2);
void oo_joint_free(oo_world *, oo_joint *);
/* Anchors and axes in the world, in the order of the class in Python; `how` has what else a kind wants to know. */
int oo_joint_place(oo_joint *, const double *spots, const int *how, const double at[3]);
void oo_joint_set_param(oo_joint *, int code, double value);
double oo_joint_get_param(const oo_joint *, int code);
void oo_joint_read(const oo_world *, const oo_joint *, oo_joint_state *);
void oo_joint_watch(oo_world *, oo_joint *, int feedback, double break_force, double break_torque);
/* NULL: no servo. */
void oo_joint_drive(oo_world *, oo_joint *, const oo_servo *);
/* All joints, in the order of world.joints. */
void oo_export_joints(const oo_world *, oo_joint_state *out);

/* The nearest hit of each ray: rows of origin, unit direction, length; one row of out each. */
int oo_cast_rays(oo_world *, const oo_query *, const double *rays, unsigned int count, oo_hit *out);
/* All geoms that a ray hits, each where it does so first, into world.hits by distance: how many, or a status. */
int oo_cast_ray_through(oo_world *, const oo_query *, const double ray[7]);
/* All geoms that overlap one (which need not be in a space), into world.hits by slot: how many, or a status. */
int oo_find_overlaps(oo_world *, const oo_query *, unsigned int slot);

/* What a geom first touches that is moved: the hit's distance is the part of the motion, 0 to 1. 1, 0 (nothing), or a
   status; OO_BAD_BODY for a geom that is not convex. */
int oo_sweep(oo_world *, const oo_query *, unsigned int slot, const double motion[3], oo_hit *out);
/* The nearest points of two geoms, the first convex: 3 numbers each, then how far they are apart. */
int oo_closest(oo_world *, unsigned int slot1, unsigned int slot2, double out[7]);

/* Up to count whole steps; ends early after a step with touch events or joints to break. The number of steps done, or a status below 0
   (then the step that failed was not done, or left no contact joints behind). If world.asking is set it has stopped
   within a step: the next call goes on with it, with the rows of world.touching as they were answered. */
int oo_run(oo_world *, unsigned int count);
/* Forget a step that waits for answers. */
void oo_abandon(oo_world *);
/* The pose of one body into both tables: it was put there, so there is nothing to interpolate. */
void oo_body_snap(oo_world *, unsigned int index);
void oo_body_set_tunnelling(oo_world *, unsigned int index, int tunnelling);
/* 1 once for each body that went farther in a step than it is thick, without being followed. */
int oo_body_take_warning(oo_world *, unsigned int index);
/* Linear velocity of the frame, angular velocity: 6 doubles a body. */
void oo_export_velocities(const oo_world *, double *out);
/* All joints (1 or 0 each), all bodies, and all slots. */
void oo_export_enabled(const oo_world *, unsigned char *out);
void oo_export_bodies(const oo_world *, oo_body_state *out);
void oo_export_geoms(const oo_world *, oo_geom_state *out);
