/* Everything of osgode that is written in C: owning ODE's objects, one step of a World, bulk export.

   No Python runs inside anything here and nothing here calls Python: steps write rows, Python reads them
   after the call has returned. The order below: assertions and messages, memory, random numbers, worlds,
   bodies, geoms and meshes, joints, one step. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <ode/ode.h>

#include "core.h"

_Static_assert(sizeof(dReal) == sizeof(double), "osgode needs the double precision build of libode");

enum { MATERIALS = 16, PAIR_SURFACES = MATERIALS * MATERIALS };

#define POSITION_LIMIT 1e8  /* HashSpace cells are counted in 31 bits: 2.7e8 m at its finest level */
#define VELOCITY_LIMIT 1e10 /* above about 1e160 ODE aborts while it steps */

/* ------------------------------------------------------------------ assertions and messages

   ODE aborts the process when an assert fails. Every call that can reach one runs between guard_enter and
   guard_leave: the handler jumps back there, and the call returns OO_ASSERT. */

static __thread struct {
    jmp_buf place;
    int armed;
    char text[400];
} guard;

/* guard_enter() is 0 at first and 1 when ODE's assert has jumped back. */
#define guard_enter() (guard.armed = 1, _setjmp(guard.place) ? (guard.armed = 0, 1) : 0)
#define guard_leave() (guard.armed = 0)

enum { MESSAGES = 64, MESSAGE_SIZE = 400 };
static struct {
    pthread_mutex_t lock;
    char text[MESSAGES][MESSAGE_SIZE];
    unsigned int first, count;
} messages = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* ODE pastes the asserted expression into the format unescaped, so a bare % may stand there: only the
   conversions that ODE itself uses are followed, everything else is copied. */
static void copy_text(char *out, size_t size, const char *format, va_list args) {
    size_t used = 0;
    for (const char *c = format; *c && used + 1 < size;) {
        int wrote = -1;
        if (c[0] == '%') {
            if (c[1] == 's')
                wrote = snprintf(out + used, size - used, "%s", va_arg(args, const char *));
            else if (c[1] == 'd' || c[1] == 'i')
                wrote = snprintf(out + used, size - used, "%d", va_arg(args, int));
            else if (c[1] == 'u')
                wrote = snprintf(out + used, size - used, "%u", va_arg(args, unsigned int));
            else if (strncmp(c, "%.4e", 4) == 0)
                wrote = snprintf(out + used, size - used, "%g", va_arg(args, double));
        }
        if (wrote >= 0) {
            used += (size_t)wrote;
            c += c[1] == '.' ? 4 : 2;
        } else {
            out[used++] = *c++;
        }
    }
    out[used < size ? used : size - 1] = 0;
}

static void keep_message(const char *text) {
    pthread_mutex_lock(&messages.lock);
    snprintf(messages.text[(messages.first + messages.count) % MESSAGES], MESSAGE_SIZE, "%s", text);
    if (messages.count < MESSAGES)
        messages.count++;
    else
        messages.first = (messages.first + 1) % MESSAGES;
    pthread_mutex_unlock(&messages.lock);
}

static void on_failure(int number, const char *format, va_list args) {
    (void)number;
    copy_text(guard.text, sizeof guard.text, format, args);
    keep_message(guard.text);
    if (guard.armed) longjmp(guard.place, 1);
}

static void on_message(int number, const char *format, va_list args) {
    (void)number;
    char text[MESSAGE_SIZE];
    copy_text(text, sizeof text, format, args);
    keep_message(text);
}

const char *oo_last_error(void) { return guard.text; }

int oo_take_message(char *text, unsigned int size) {
    int taken = 0;
    pthread_mutex_lock(&messages.lock);
    if (messages.count) {
        snprintf(text, size, "%s", messages.text[messages.first]);
        messages.first = (messages.first + 1) % MESSAGES;
        messages.count--;
        taken = 1;
    }
    pthread_mutex_unlock(&messages.lock);
    return taken;
}

/* ------------------------------------------------------------------ memory */

static oo_live live;

static void count_live(long *counter, long change) { __atomic_fetch_add(counter, change, __ATOMIC_RELAXED); }

/* In each step ODE walks lists of its bodies, geoms and joints. Where malloc puts them is where Python's heap has
   gaps, all over it: a step of 340 geoms took 1.2 times as long as in plain C. So small blocks are cut from slabs,
   one after the other, and one that is freed waits in the list of its size. Slabs are never given back. Blocks
   begin with a cache line: where they begin 48 bytes later, the same step takes 1.06 times as long. */
enum { LINE = 64, SLAB = 1 << 18 };
#ifdef __SANITIZE_ADDRESS__
enum { SMALL = 0 }; /* so that the sanitizer sees each block */
#else
enum { SMALL = 2048 };
#endif

typedef struct header { /* stands in the line before its block */
    size_t size;           /* as it was asked for: a quadtree says another when it frees */
    struct header *next;   /* while it is free */
} header;
_Static_assert(sizeof(header) == 16, "blocks from malloc would not be aligned");

static struct {
    pthread_mutex_t lock;
    char *at;
    size_t left;
    header *freed[SMALL / LINE + 2]; /* by size with header, in lines */
} slab = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* How many lines a block of that size takes; 0: it comes from malloc. */
static size_t lines_of(size_t size) { return size < SMALL ? (sizeof(header) + size + LINE - 1) / LINE : 0; }

static header *cut_block(size_t size) {
    if (slab.left < size) {
        char *fresh = aligned_alloc(LINE, SLAB);
        if (!fresh) return NULL;
        slab.at = fresh + LINE - sizeof(header);
        slab.left = SLAB - LINE + sizeof(header);
    }
    header *cut = (header *)slab.at;
    slab.at += size;
    slab.left -= size;
    return cut;
}

static void *take_block(size_t size) {
    size_t lines = lines_of(size);
    header *taken;
    if (lines) {
        pthread_mutex_lock(&slab.lock);
        taken = slab.freed[lines];
        if (taken)
            slab.freed[lines] = taken->next;
        else
            taken = cut_block(LINE * lines);
        pthread_mutex_unlock(&slab.lock);
    } else {
        taken = malloc(sizeof *taken + size);
    }
    if (!taken) return NULL;
    taken->size = size;
    return taken + 1;
}

static void give_block(void *given) {
    if (!given) return;
    header *old = (header *)given - 1;
    size_t lines = lines_of(old->size);
    if (lines) {
        pthread_mutex_lock(&slab.lock);
        old->next = slab.freed[lines];
        slab.freed[lines] = old;
        pthread_mutex_unlock(&slab.lock);
    } else {
        free(old);
    }
}

static size_t size_of(const void *block) { return block ? ((const header *)block - 1)->size : 0; }

static void *counted_alloc(dsizeint size) {
    void *block = take_block(size);
    if (block) {
        count_live(&live.blocks, 1);
        count_live(&live.bytes, (long)size);
    }
    return block;
}

/* Not counted as a block: only caches that ODE keeps for good begin with NULL here. */
static void *counted_realloc(void *old, dsizeint old_size, dsizeint size) {
    (void)old_size;
    size_t held = size_of(old);
    void *block = take_block(size);
    if (!block) return NULL;
    if (old) memcpy(block, old, held < size ? held : size);
    give_block(old);
    count_live(&live.bytes, (long)size - (long)held);
    return block;
}

static void counted_free(void *block, dsizeint size) {
    (void)size;
    if (block) {
        count_live(&live.blocks, -1);
        count_live(&live.bytes, -(long)size_of(block));
    }
    give_block(block);
}

oo_live oo_count_live(void) { return live; }

/* Room for `wanted` elements behind *array. Existing ones may move. */
static int reserve(void *array, unsigned int *capacity, size_t wanted, size_t element) {
    if (wanted <= *capacity) return OO_OK;
    size_t grown = *capacity ? *capacity : 16;
    while (grown < wanted) grown *= 2;
    void **place = array;
    void *moved = realloc(*place, grown * element);
    if (!moved) return OO_NO_MEMORY;
    *place = moved;
    *capacity = (unsigned int)grown;
    return OO_OK;
}

/* ------------------------------------------------------------------ random numbers

   The quick step draws the order of its rows from one sequence for the whole process. This dRand takes the
   place of libode's (the dynamic linker looks here first) with a seed per thread, which integrate() loads from
   the World and stores back. Where libode was loaded before us it keeps its own, and a lock must do. */

static __thread unsigned long thread_seed;
static int random_is_local;
static pthread_mutex_t random_lock = PTHREAD_MUTEX_INITIALIZER;
static void (*shared_set_seed)(unsigned long);
static unsigned long (*shared_get_seed)(void);

unsigned long dRand(void) { /* the generator of libode: Numerical Recipes' ranqd1 */
    thread_seed = (1664525UL * thread_seed + 1013904223UL) & 0xffffffffUL;
    return thread_seed;
}

static int find_random(void) {
    thread_seed = 1;
    dRandInt(1000);
    random_is_local = thread_seed != 1;
    if (random_is_local) return OO_OK;
    void *libode = dlopen("libode.so.8", RTLD_LAZY | RTLD_NOLOAD);
    if (!libode) return OO_ASSERT;
    *(void **)&shared_set_seed = dlsym(libode, "dRandSetSeed");
    *(void **)&shared_get_seed = dlsym(libode, "dRandGetSeed");
    return shared_set_seed && shared_get_seed ? OO_OK : OO_ASSERT;
}

int oo_random_is_local(void) { return random_is_local; }

int oo_init(void) {
    dSetErrorHandler(on_failure);
    dSetDebugHandler(on_failure);
    dSetMessageHandler(on_message);
    if (find_random() != OO_OK) return OO_ASSERT;
    if (random_is_local) { /* else somebody used libode before us, and may free with our handlers what he got from his */
        dSetAllocHandler(counted_alloc);
        dSetReallocHandler(counted_realloc);
        dSetFreeHandler(counted_free);
    }
    if (!dInitODE2(0) || !dAllocateODEDataForThread(dAllocateMaskAll)) return OO_ASSERT;
    oo_world *first = oo_world_new();
    if (!first) return OO_ASSERT;
    dGeomDestroy(dCreateSphere(0, 1)); /* leaves one block in ODE's cache of geom positions */
    oo_world_free(first);
    live = (oo_live){0}; /* what ODE keeps for good since its first world is not ours to count */
    return OO_OK;
}

/* ------------------------------------------------------------------ worlds */

/* ODE's default implementation is shared by all worlds and races when two of them step at once. */
static int use_own_threading(oo_world *w) {
    dThreadingImplementationID own = dThreadingAllocateSelfThreadedImplementation();
    if (!own) return OO_NO_MEMORY;
    w->threading = own;
    dWorldSetStepThreadingImplementation(w->id, dThreadingImplementationGetFunctions(own), own);
    return OO_OK;
}

oo_world *oo_world_new(void) {
    oo_world *w = calloc(1, sizeof *w);
    if (!w) return NULL;
    w->surfaces = calloc(PAIR_SURFACES, sizeof *w->surfaces);
    w->surface_count = PAIR_SURFACES;
    w->bad_body = -1;
    w->max_contacts = 1;
    int made = 0;
    if (w->surfaces && !guard_enter()) {
        w->id = dWorldCreate();
        w->contact_group = dJointGroupCreate(0);
        made = w->id && w->contact_group && use_own_threading(w) == OO_OK;
        guard_leave();
    }
    if (!made) {
        free(w->surfaces);
        free(w);
        return NULL;
    }
    count_live(&live.worlds, 1);
    return w;
}

static void mesh_destroy(oo_mesh *);

void oo_world_free(oo_world *w) {
    if (!w->broken) { /* a broken one has a space that is locked for good: its ODE part is leaked on purpose */
        /* Geoms before spaces: a quadtree that still holds some leaves them unusable. */
        for (unsigned int i = 0; i < w->geom_count; i++)
            if ((w->geoms[i].flags & (OO_ALIVE | OO_IS_SPACE)) == OO_ALIVE) oo_geom_free(w, i);
        for (unsigned int i = w->geom_count; i-- > 0;)
            if (w->geoms[i].flags & OO_ALIVE) oo_geom_free(w, i);
        while (w->meshes) oo_mesh_free(w, w->meshes);
        if (!guard_enter()) {
            dJointGroupDestroy(w->contact_group);
            dWorldDestroy(w->id); /* with the bodies and joints that are left */
            dThreadingImplementationShutdownProcessing(w->threading);
            dThreadingFreeImplementation(w->threading);
            guard_leave();
        }
    }
    count_live(&live.bodies, -(long)w->body_count);
    count_live(&live.joints, -(long)w->joint_count);
    count_live(&live.worlds, -1);
    free(w->bodies);
    free(w->geoms);
    free(w->free_slots);
    free(w->retired_slots);
    free(w->pairs);
    free(w->surfaces);
    free(w->contacts);
    free(w->feedback);
    free(w->touching);
    free(w->touched);
    free(w->events);
    free(w);
}

int oo_set_pairs(oo_world *w, const oo_pair *pairs, unsigned int count) {
    oo_pair *copy = malloc((count + 1) * sizeof *copy);
    if (!copy) return OO_NO_MEMORY;
    memcpy(copy, pairs, count * sizeof *copy);
    free(w->pairs);
    w->pairs = copy;
    w->pair_count = count;
    return OO_OK;
}

int oo_set_surface(oo_world *w, unsigned int index, const dSurfaceParameters *surface) {
    if (index >= w->surface_count) {
        dSurfaceParameters *moved = realloc(w->surfaces, (index + 1) * sizeof *moved);
        if (!moved) return OO_NO_MEMORY;
        memset(moved + w->surface_count, 0, (index + 1 - w->surface_count) * sizeof *moved);
        w->surfaces = moved;
        w->surface_count = index + 1;
    }
    w->surfaces[index] = *surface;
    return OO_OK;
}

/* ------------------------------------------------------------------ bodies */

/* The pose of the frame: p_frame = p_centre - R com. */
static void write_pose(const oo_body *body, double *row) {
    const dReal *p = dBodyGetPosition(body->id), *q = dBodyGetQuaternion(body->id);
    const double *c = body->com;
    memcpy(row, p, 3 * sizeof *row);
    if (c[0] != 0 || c[1] != 0 || c[2] != 0) {
        const dReal *r = dBodyGetRotation(body->id);
        for (int k = 0; k < 3; k++) row[k] -= r[4 * k] * c[0] + r[4 * k + 1] * c[1] + r[4 * k + 2] * c[2];
    }
    memcpy(row + 3, q, 4 * sizeof *row);
}

void oo_body_snap(oo_world *w, unsigned int index) {
    write_pose(&w->bodies[index], w->poses + 7 * index);
    memcpy(w->previous + 7 * index, w->poses + 7 * index, 7 * sizeof(double));
}

int oo_body_new(oo_world *w) {
    if (w->body_count >= w->table_capacity || reserve(&w->bodies, &w->body_capacity, w->body_count + 1, sizeof *w->bodies))
        return OO_NO_MEMORY;
    if (guard_enter()) return OO_ASSERT;
    oo_body *body = &w->bodies[w->body_count];
    memset(body, 0, sizeof *body);
    body->id = dBodyCreate(w->id);
    guard_leave();
    if (!body->id) return OO_NO_MEMORY;
    count_live(&live.bodies, 1);
    oo_body_snap(w, w->body_count);
    return (int)w->body_count++;
}

void oo_body_free(oo_world *w, unsigned int index) {
    if (!guard_enter()) {
        dBodyDestroy(w->bodies[index].id);
        guard_leave();
    }
    unsigned int last = --w->body_count;
    w->bodies[index] = w->bodies[last];
    memcpy(w->poses + 7 * index, w->poses + 7 * last, 7 * sizeof(double));
    memcpy(w->previous + 7 * index, w->previous + 7 * last, 7 * sizeof(double));
    count_live(&live.bodies, -1);
}

void oo_body_read_raw(const oo_world *w, unsigned int index, double raw[19]) {
    dBodyID id = w->bodies[index].id;
    memcpy(raw, dBodyGetPosition(id), 3 * sizeof *raw);
    memcpy(raw + 3, dBodyGetQuaternion(id), 4 * sizeof *raw);
    memcpy(raw + 7, dBodyGetRotation(id), 12 * sizeof *raw);
}

void oo_body_write_raw(oo_world *w, unsigned int index, const double raw[19]) {
    dBodyID id = w->bodies[index].id;
    memcpy((dReal *)dBodyGetQuaternion(id), raw + 3, 4 * sizeof *raw);
    memcpy((dReal *)dBodyGetRotation(id), raw + 7, 12 * sizeof *raw);
    dBodySetPosition(id, raw[0], raw[1], raw[2]); /* tells the geoms that they have moved */
}

int oo_body_set_mass(oo_world *w, unsigned int index, double mass, const double inertia[9]) {
    dMass m = {.mass = mass};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) m.I[4 * row + column] = inertia[3 * row + column];
    if (guard_enter()) return OO_ASSERT;
    dBodySetMass(w->bodies[index].id, &m);
    guard_leave();
    return OO_OK;
}

/* ------------------------------------------------------------------ geoms and meshes */

struct oo_mesh {
    dTriMeshDataID id;
    double *vertices;
    unsigned int *triangles;
    oo_mesh *next;
};

static int take_slot(oo_world *w) {
    if (w->free_count) return (int)w->free_slots[--w->free_count];
    if (reserve(&w->geoms, &w->geom_capacity, w->geom_count + 1, sizeof *w->geoms)) return OO_NO_MEMORY;
    unsigned int retired = w->slot_capacity;
    if (reserve(&w->retired_slots, &retired, w->geom_count + 1, sizeof *w->retired_slots)) return OO_NO_MEMORY;
    if (reserve(&w->free_slots, &w->slot_capacity, w->geom_count + 1, sizeof *w->free_slots)) return OO_NO_MEMORY;
    return (int)w->geom_count++;
}

static void give_slot(oo_world *w, unsigned int slot) {
    w->geoms[slot].id = NULL;
    w->geoms[slot].flags = 0;
    w->retired_slots[w->retired_count++] = slot;
}

static int fill_slot(oo_world *w, int slot, dGeomID id, unsigned int flags) {
    if (!id) {
        give_slot(w, (unsigned int)slot);
        return OO_NO_MEMORY;
    }
    w->geoms[slot] = (oo_geom){.id = id, .category = ~0u, .collide = ~0u, .flags = OO_ALIVE | flags};
    dGeomSetData(id, (void *)(size_t)slot);
    return slot;
}

int oo_geom_new(oo_world *w, int kind, const double *d, oo_mesh *mesh) {
    int slot = take_slot(w);
    if (slot < 0) return slot;
    if (guard_enter()) {
        give_slot(w, (unsigned int)slot);
        return OO_ASSERT;
    }
    dGeomID id = NULL;
    unsigned int flags = 0;
    switch (kind) {
        case OO_BOX: id = dCreateBox(0, d[0], d[1], d[2]); break;
        case OO_SPHERE: id = dCreateSphere(0, d[0]); break;
        case OO_CAPSULE: id = dCreateCapsule(0, d[0], d[1]); break;
        case OO_CYLINDER: id = dCreateCylinder(0, d[0], d[1]); flags = OO_IS_CYLINDER; break;
        case OO_PLANE: id = dCreatePlane(0, d[0], d[1], d[2], d[3]); break;
        case OO_TRIMESH: id = dCreateTriMesh(0, mesh->id, NULL, NULL, NULL); flags = OO_IS_MESH; break;
    }
    guard_leave();
    int result = fill_slot(w, slot, id, flags);
    if (result >= 0) count_live(&live.geoms, 1);
    return result;
}

int oo_space_new(oo_world *w, int kind, const double *a) {
    int slot = take_slot(w);
    if (slot < 0) return slot;
    if (guard_enter()) {
        give_slot(w, (unsigned int)slot);
        return OO_ASSERT;
    }
    dSpaceID id = NULL;
    switch (kind) {
        case OO_SIMPLE_SPACE: id = dSimpleSpaceCreate(0); break;
        case OO_HASH_SPACE: id = dHashSpaceCreate(0); break;
        case OO_QUADTREE_SPACE: {
            dVector3 centre = {a[0], a[1], a[2]}, extents = {a[3], a[4], a[5]};
            id = dQuadTreeSpaceCreate(0, centre, extents, (int)a[6]);
            break;
        }
        case OO_SAP_SPACE: id = dSweepAndPruneSpaceCreate(0, (int)a[0]); break;
    }
    if (id) dSpaceSetCleanup(id, 0); /* nodes own their geoms; no space ever destroys one */
    guard_leave();
    int result = fill_slot(w, slot, (dGeomID)id, OO_IS_SPACE);
    if (result >= 0) count_live(&live.spaces, 1);
    return result;
}

void oo_geom_free(oo_world *w, unsigned int slot) {
    int space = w->geoms[slot].flags & OO_IS_SPACE;
    if (!guard_enter()) {
        if (space)
            dSpaceDestroy((dSpaceID)w->geoms[slot].id);
        else
            dGeomDestroy(w->geoms[slot].id);
        guard_leave();
    }
    give_slot(w, slot);
    count_live(space ? &live.spaces : &live.geoms, -1);
}

void oo_wake_touching(oo_world *w, unsigned int slot) {
    for (unsigned int i = 0; i < w->contact_count; i++) {
        const oo_contact *row = &w->contacts[i];
        if (row->slot1 != slot && row->slot2 != slot) continue;
        const oo_geom *other = &w->geoms[row->slot1 == slot ? row->slot2 : row->slot1];
        dBodyID body = other->flags & OO_ALIVE ? dGeomGetBody(other->id) : NULL;
        if (body) dBodyEnable(body);
    }
}

/* ODE cleans the geoms at the head of a space's list up to the first that is clean, and puts at the head what is added,
   clean or not: behind a clean one the others would keep their old boxes, and ODE asserts. So they are cleaned first. */
void oo_rehouse(dSpaceID from, dSpaceID to, dGeomID geom) {
    if (guard_enter()) return;
    if (from) dSpaceRemove(from, geom);
    if (to) {
        dSpaceClean(to);
        dSpaceAdd(to, geom);
    }
    guard_leave();
}

void oo_geom_set_bits(oo_world *w, unsigned int slot, unsigned int category, unsigned int collide, unsigned int material) {
    oo_geom *geom = &w->geoms[slot];
    geom->category = category;
    geom->collide = collide;
    geom->material = material;
    dGeomSetCategoryBits(geom->id, category);
    dGeomSetCollideBits(geom->id, collide);
}

oo_mesh *oo_mesh_new(oo_world *w, const double *vertices, unsigned int vertex_count, const unsigned int *triangles,
                     unsigned int triangle_count) {
    oo_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    mesh->vertices = malloc(3 * sizeof(double) * vertex_count);
    mesh->triangles = malloc(3 * sizeof(unsigned int) * triangle_count);
    if (!mesh->vertices || !mesh->triangles || guard_enter()) {
        mesh_destroy(mesh);
        return NULL;
    }
    memcpy(mesh->vertices, vertices, 3 * sizeof(double) * vertex_count);
    memcpy(mesh->triangles, triangles, 3 * sizeof(unsigned int) * triangle_count);
    mesh->id = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh->id, mesh->vertices, 3 * sizeof(double), (int)vertex_count, mesh->triangles,
                                (int)(3 * triangle_count), 3 * sizeof(unsigned int));
    dGeomTriMeshDataPreprocess2(mesh->id, (1U << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES) | (1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES), NULL);
    guard_leave();
    mesh->next = w->meshes;
    w->meshes = mesh;
    count_live(&live.meshes, 1);
    return mesh;
}

static void mesh_destroy(oo_mesh *mesh) {
    if (mesh->id && !guard_enter()) {
        dGeomTriMeshDataDestroy(mesh->id);
        guard_leave();
    }
    free(mesh->vertices);
    free(mesh->triangles);
    free(mesh);
}

void oo_mesh_free(oo_world *w, oo_mesh *mesh) {
    for (oo_mesh **link = &w->meshes; *link; link = &(*link)->next)
        if (*link == mesh) {
            *link = mesh->next;
            break;
        }
    mesh_destroy(mesh);
    count_live(&live.meshes, -1);
}

/* ------------------------------------------------------------------ joints */

dJointID oo_joint_new(oo_world *w, int kind) {
    if (guard_enter()) return NULL;
    dJointID id = NULL;
    switch (kind) {
        case OO_BALL: id = dJointCreateBall(w->id, 0); break;
        case OO_HINGE: id = dJointCreateHinge(w->id, 0); break;
        case OO_SLIDER: id = dJointCreateSlider(w->id, 0); break;
        case OO_FIXED: id = dJointCreateFixed(w->id, 0); break;
    }
    guard_leave();
    if (id) {
        w->joint_count++;
        count_live(&live.joints, 1);
    }
    return id;
}

void oo_joint_free(oo_world *w, dJointID id) {
    if (!guard_enter()) {
        dJointDestroy(id);
        guard_leave();
    }
    w->joint_count--;
    count_live(&live.joints, -1);
}

/* ------------------------------------------------------------------ one step */

static pthread_mutex_t mesh_lock = PTHREAD_MUTEX_INITIALIZER;
static __thread int holds_mesh_lock;

static void lock_meshes(int wanted) {
    if (wanted == holds_mesh_lock) return;
    if (wanted)
        pthread_mutex_lock(&mesh_lock);
    else
        pthread_mutex_unlock(&mesh_lock);
    holds_mesh_lock = wanted;
}

static int usable(const dContactGeom *c) {
    double sum = c->pos[0] + c->pos[1] + c->pos[2] + c->depth;
    double normal = c->normal[0] * c->normal[0] + c->normal[1] * c->normal[1] + c->normal[2] * c->normal[2];
    return isfinite(sum) && normal > 0.5 && normal < 2.0;
}

static void note_touch(oo_world *w, unsigned int slot1, unsigned int slot2, unsigned int first, unsigned int count) {
    if (reserve(&w->touching, &w->touching_capacity, w->touching_count + 1, sizeof *w->touching)) {
        w->out_of_memory = 1;
        return;
    }
    oo_touch *touch = &w->touching[w->touching_count++];
    *touch = (oo_touch){.slot1 = slot1 < slot2 ? slot1 : slot2,
                        .slot2 = slot1 < slot2 ? slot2 : slot1,
                        .first = first,
                        .count = count};
}

static void on_near(void *data, dGeomID g1, dGeomID g2) {
    oo_world *w = data;
    if (dGeomIsSpace(g1) || dGeomIsSpace(g2)) {
        dSpaceCollide2(g1, g2, data, on_near);
        return;
    }
    unsigned int slot1 = (unsigned int)(size_t)dGeomGetData(g1), slot2 = (unsigned int)(size_t)dGeomGetData(g2);
    const oo_geom *a = &w->geoms[slot1], *b = &w->geoms[slot2];
    if (!(a->category & b->collide) || !(b->category & a->collide)) return;
    dBodyID body1 = dGeomGetBody(g1), body2 = dGeomGetBody(g2);
    if (!body1 && !body2) return;
    if (body1 && body2 && dAreConnectedExcluding(body1, body2, dJointTypeContact)) return;
    if (a->flags & b->flags & OO_IS_CYLINDER && slot2 < slot1) { /* ODE's depth depends on the order of two cylinders */
        dGeomID g = g1;
        g1 = g2;
        g2 = g;
        unsigned int slot = slot1;
        slot1 = slot2;
        slot2 = slot;
        a = &w->geoms[slot1];
        b = &w->geoms[slot2];
    }
    unsigned int first = w->contact_count;
    if (reserve(&w->contacts, &w->contact_capacity, first + w->max_contacts, sizeof *w->contacts)) {
        w->out_of_memory = 1;
        return;
    }

    lock_meshes(((a->flags | b->flags) & OO_IS_MESH) != 0);
    int found = dCollide(g1, g2, (int)w->max_contacts, &w->contacts[first].geom, sizeof *w->contacts);
    lock_meshes(0);

    unsigned int surface = a->surface ? a->surface : b->surface;
    if (a->surface && b->surface && w->surfaces[b->surface].mu < w->surfaces[a->surface].mu) surface = b->surface;
    if (!surface) surface = MATERIALS * a->material + b->material;
    unsigned int kept = first;
    for (unsigned int i = first; i < first + (unsigned int)found; i++) {
        if (!usable(&w->contacts[i].geom)) continue; /* ODE gives NaN for a sphere centred on a cylinder, among others */
        oo_contact *row = &w->contacts[kept];
        if (kept != i) row->geom = w->contacts[i].geom;
        row->slot1 = slot1;
        row->slot2 = slot2;
        row->surface = surface;
        row->feedback = -1;
        row->force[0] = row->force[1] = row->force[2] = 0;
        kept++;
    }
    w->contact_count = kept;
    if (kept > first && (a->flags | b->flags) & OO_LISTENED) note_touch(w, slot1, slot2, first, kept - first);
}

/* A slot that was retired before the last step is named by no contact, touch or event any longer. */
static void recycle_slots(oo_world *w) {
    for (unsigned int i = 0; i < w->retired_ripe; i++) w->free_slots[w->free_count++] = w->retired_slots[i];
    w->retired_count -= w->retired_ripe;
    memmove(w->retired_slots, w->retired_slots + w->retired_ripe, w->retired_count * sizeof *w->retired_slots);
    w->retired_ripe = w->retired_count;
}

static int collide(oo_world *w) {
    if (guard_enter()) { /* the space that was being walked stays locked for good */
        lock_meshes(0);
        w->broken = 1;
        return OO_BROKEN;
    }
    w->contact_count = w->event_count = w->touching_count = 0;
    w->out_of_memory = 0;
    for (unsigned int i = 0; i < w->pair_count; i++) {
        if (w->pairs[i].other)
            dSpaceCollide2((dGeomID)w->pairs[i].space, (dGeomID)w->pairs[i].other, w, on_near);
        else
            dSpaceCollide(w->pairs[i].space, w, on_near);
    }
    guard_leave();
    return w->out_of_memory ? OO_NO_MEMORY : OO_OK;
}

static int respond(oo_world *w) {
    unsigned int listened = 0;
    for (unsigned int i = 0; i < w->touching_count; i++) listened += w->touching[i].count;
    if (reserve(&w->feedback, &w->feedback_capacity, listened, sizeof *w->feedback)) return OO_NO_MEMORY;
    w->feedback_count = 0;
    for (unsigned int i = 0; i < w->touching_count; i++)
        for (unsigned int k = 0; k < w->touching[i].count; k++)
            w->contacts[w->touching[i].first + k].feedback = (int)w->feedback_count++;
    if (guard_enter()) return OO_ASSERT;
    dContact contact;
    memset(&contact, 0, sizeof contact);
    for (unsigned int i = 0; i < w->contact_count; i++) {
        oo_contact *row = &w->contacts[i];
        contact.surface = w->surfaces[row->surface];
        contact.geom = row->geom;
        dJointID joint = dJointCreateContact(w->id, w->contact_group, &contact);
        dJointAttach(joint, dGeomGetBody(row->geom.g1), dGeomGetBody(row->geom.g2));
        if (row->feedback >= 0) dJointSetFeedback(joint, &w->feedback[row->feedback]);
    }
    guard_leave();
    return OO_OK;
}

static int integrate(oo_world *w) {
    int done;
    if (random_is_local) {
        thread_seed = w->seed;
    } else {
        pthread_mutex_lock(&random_lock);
        shared_set_seed(w->seed);
    }
    if (guard_enter()) {
        done = OO_ASSERT;
    } else {
        done = (w->exact ? dWorldStep(w->id, w->step_size) : dWorldQuickStep(w->id, w->step_size)) ? OO_OK : OO_NO_MEMORY;
        guard_leave();
    }
    if (random_is_local) {
        w->seed = thread_seed;
    } else {
        w->seed = shared_get_seed();
        pthread_mutex_unlock(&random_lock);
    }
    /* After an assert the implementation is left in the middle of its work: a fresh one takes its place, and
       the old one is leaked on purpose (about 66 kB). */
    if (done == OO_ASSERT) use_own_threading(w);
    return done;
}

static int out_of_bounds(dBodyID id) {
    const dReal *p = dBodyGetPosition(id), *v = dBodyGetLinearVel(id), *a = dBodyGetAngularVel(id);
    const dReal *q = dBodyGetQuaternion(id);
    for (int k = 0; k < 3; k++)
        if (!(fabs(p[k]) <= POSITION_LIMIT && fabs(v[k]) <= VELOCITY_LIMIT && fabs(a[k]) <= VELOCITY_LIMIT)) return 1;
    return !isfinite(q[0] + q[1] + q[2] + q[3]);
}

static void find_bad_body(oo_world *w) {
    w->bad_body = -1;
    for (unsigned int i = 0; i < w->body_count && w->bad_body < 0; i++)
        if (out_of_bounds(w->bodies[i].id)) w->bad_body = (int)i;
}

void oo_export_velocities(const oo_world *w, double *out) {
    for (unsigned int i = 0; i < w->body_count; i++, out += 6) {
        const oo_body *body = &w->bodies[i];
        const dReal *r = dBodyGetRotation(body->id), *v = dBodyGetLinearVel(body->id), *a = dBodyGetAngularVel(body->id);
        double arm[3];
        for (int k = 0; k < 3; k++)
            arm[k] = r[4 * k] * body->com[0] + r[4 * k + 1] * body->com[1] + r[4 * k + 2] * body->com[2];
        /* v_frame = v_centre - w x arm */
        out[0] = v[0] - (a[1] * arm[2] - a[2] * arm[1]);
        out[1] = v[1] - (a[2] * arm[0] - a[0] * arm[2]);
        out[2] = v[2] - (a[0] * arm[1] - a[1] * arm[0]);
        memcpy(out + 3, a, 3 * sizeof *out);
    }
}

static int compare_pairs(const oo_touch *a, const oo_touch *b) {
    if (a->slot1 != b->slot1) return a->slot1 < b->slot1 ? -1 : 1;
    return a->slot2 < b->slot2 ? -1 : a->slot2 > b->slot2;
}

static int by_slots(const void *a, const void *b) { return compare_pairs(a, b); }

static int add_event(oo_world *w, const oo_touch *touch, int state) {
    if (reserve(&w->events, &w->event_capacity, w->event_count + 1, sizeof *w->events)) return OO_NO_MEMORY;
    w->events[w->event_count] = *touch;
    w->events[w->event_count].state = state;
    w->event_count++;
    return OO_OK;
}

/* What touches now is what the next step compares with. Only here, at the end of a step that was done: one that
   fails leaves everything as the last one left it. */
static void keep_touches(oo_world *w) {
    oo_touch *last = w->touched;
    unsigned int capacity = w->touched_capacity;
    w->touched = w->touching;
    w->touched_count = w->touching_count;
    w->touched_capacity = w->touching_capacity;
    w->touching = last;
    w->touching_capacity = capacity;
    w->touching_count = 0;
    recycle_slots(w);
}

/* Forces into the listened rows, and this step's listened pairs against the last step's. */
static int compare_touches(oo_world *w) {
    for (unsigned int i = 0; i < w->touching_count; i++) {
        oo_touch *touch = &w->touching[i];
        for (unsigned int k = touch->first; k < touch->first + touch->count; k++) {
            oo_contact *row = &w->contacts[k];
            const dReal *force = w->feedback[row->feedback].f1;
            /* f1 is what acts on the first body that there is: on that of geom 2 where geom 1 is static */
            double sign = dGeomGetBody(row->geom.g1) ? 1.0 : -1.0;
            for (int c = 0; c < 3; c++) row->force[c] = sign * force[c];
            touch->impulse += sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]) * w->step_size;
        }
    }
    if (w->touching_count) qsort(w->touching, w->touching_count, sizeof *w->touching, by_slots);
    unsigned int now = 0, last = 0;
    while (now < w->touching_count || last < w->touched_count) {
        const oo_touch *a = now < w->touching_count ? &w->touching[now] : NULL;
        const oo_touch *b = last < w->touched_count ? &w->touched[last] : NULL;
        int order = !a ? 1 : !b ? -1 : compare_pairs(a, b);
        if (order > 0) { /* only then: it has ended, and the rows it had are gone */
            oo_touch gone = *b;
            gone.first = gone.count = 0;
            gone.impulse = 0;
            if (add_event(w, &gone, OO_END)) return OO_NO_MEMORY;
            last++;
        } else {
            if (add_event(w, a, order ? OO_BEGIN : OO_STAY)) return OO_NO_MEMORY;
            now++;
            if (!order) last++;
        }
    }
    keep_touches(w);
    return OO_OK;
}

/* After an assert in the middle of ODE's step: gravity is in the accumulators already and must not act twice, and
   the body that caused it is to be named. */
static void clean_up(oo_world *w) {
    for (unsigned int i = 0; i < w->body_count; i++) {
        dBodySetForce(w->bodies[i].id, 0, 0, 0);
        dBodySetTorque(w->bodies[i].id, 0, 0, 0);
    }
    find_bad_body(w);
}

int oo_run(oo_world *w, unsigned int count) {
    unsigned int done = 0;
    if (w->broken) return OO_BROKEN;
    if (w->bad_body >= 0) find_bad_body(w);
    if (w->bad_body >= 0) return OO_BAD_BODY;
    dAllocateODEDataForThread(dAllocateMaskAll);
    while (done < count) {
        int status = collide(w);
        if (status == OO_OK) status = respond(w);
        if (status == OO_OK) {
            status = integrate(w);
            if (status == OO_ASSERT) clean_up(w);
        }
        if (status == OO_OK) status = compare_touches(w);
        dJointGroupEmpty(w->contact_group);
        if (status != OO_OK) return status;
        memcpy(w->previous, w->poses, 7 * sizeof(double) * w->body_count);
        for (unsigned int i = 0; i < w->body_count; i++) write_pose(&w->bodies[i], w->poses + 7 * i);
        w->steps++;
        done++;
        find_bad_body(w);
        if (w->bad_body >= 0) return OO_BAD_BODY;
        if (w->event_count) break;
    }
    return (int)done;
}
