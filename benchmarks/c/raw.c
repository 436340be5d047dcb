/* The scenes of benchmarks/scenes.py in plain C on the same libode, as one writes it after ODE's manual.

   Reads a scene from stdin, one thing a line, up to "go":
     world STEP GX GY GZ CONTACTS      step size, gravity, contacts of a pair at most
     place X Y Z QW QX QY QZ           static: the next shape stands there
     auto_disable                      bodies that come to rest fall asleep, by ODE's own measures
     body MASS X Y Z QW QX QY QZ       the next shape is its only part
     asleep                            the last body, from the start
     velocity X Y Z AX AY AZ           of the last body, linear and angular
     plane A B C D | box X Y Z | sphere R | capsule R L | cylinder R L
     mesh VERTICES TRIANGLES           followed by their numbers
     ball BODY OTHER X Y Z             bodies by number; -1: the static world
     hinge2 CHASSIS WHEEL X Y Z AX AY AZ VELOCITY MAX_FORCE ERP CFM    velocity of the wheel as the chassis sees it
   then takes orders until stdin ends:
     step N    does N steps and answers with the nanoseconds that they took, by the clock and of the processor
     state     answers with 13 raw doubles a body: position, quaternion, linear and angular velocity */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <ode/ode.h>

enum { MOST_CONTACTS = 64, WORD = 32 };

static dWorldID world;
static dSpaceID moving, fixed;
static dJointGroupID contacts;
static double step_size;
static int contacts_per_pair;
static dBodyID *bodies;
static int body_count;

/* ------------------------------------------------------------------ building the scene */

static void fail(const char *why) {
    fprintf(stderr, "raw: %s\n", why);
    exit(2);
}

static void read_numbers(double *out, int count) {
    for (int i = 0; i < count; i++)
        if (scanf("%lf", &out[i]) != 1) fail("a number is missing");
}

static int read_whole(void) {
    double value;
    read_numbers(&value, 1);
    return (int)value;
}

static void *allocate(size_t count, size_t size) {
    void *block = calloc(count, size);
    if (!block) fail("out of memory");
    return block;
}

static dGeomID read_mesh(dSpaceID space) {
    int vertex_count = read_whole(), triangle_count = read_whole();
    double *vertices = allocate(3 * vertex_count, sizeof *vertices); /* ODE reads both as long as the geom lives */
    dTriIndex *triangles = allocate(3 * triangle_count, sizeof *triangles);
    read_numbers(vertices, 3 * vertex_count);
    for (int i = 0; i < 3 * triangle_count; i++) triangles[i] = (dTriIndex)read_whole();
    dTriMeshDataID data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(data, vertices, 3 * sizeof *vertices, vertex_count, triangles, 3 * triangle_count,
                                3 * sizeof *triangles);
    dGeomTriMeshDataPreprocess2(
        data, (1U << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES) | (1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES), NULL);
    return dCreateTriMesh(space, data, NULL, NULL, NULL);
}

/* The shape called `word`, and in `mass` what it has if it is to weigh `total`; NULL if there is no such shape. */
static dGeomID read_shape(const char *word, dSpaceID space, double total, dMass *mass) {
    double d[4];
    if (!strcmp(word, "mesh")) return read_mesh(space);
    if (!strcmp(word, "plane")) {
        read_numbers(d, 4);
        return dCreatePlane(space, d[0], d[1], d[2], d[3]);
    }
    if (!strcmp(word, "box")) {
        read_numbers(d, 3);
        if (mass) dMassSetBoxTotal(mass, total, d[0], d[1], d[2]);
        return dCreateBox(space, d[0], d[1], d[2]);
    }
    if (!strcmp(word, "sphere")) {
        read_numbers(d, 1);
        if (mass) dMassSetSphereTotal(mass, total, d[0]);
        return dCreateSphere(space, d[0]);
    }
    if (!strcmp(word, "capsule")) {
        read_numbers(d, 2);
        if (mass) dMassSetCapsuleTotal(mass, total, 3, d[0], d[1]);
        return dCreateCapsule(space, d[0], d[1]);
    }
    if (!strcmp(word, "cylinder")) {
        read_numbers(d, 2);
        if (mass) dMassSetCylinderTotal(mass, total, 3, d[0], d[1]);
        return dCreateCylinder(space, d[0], d[1]);
    }
    return NULL;
}

static void read_static(void) {
    double pose[7];
    char word[WORD];
    read_numbers(pose, 7);
    if (scanf("%31s", word) != 1) fail("a shape is missing");
    dGeomID geom = read_shape(word, fixed, 0, NULL);
    if (!geom) fail("no such shape");
    dGeomSetPosition(geom, pose[0], pose[1], pose[2]);
    dGeomSetQuaternion(geom, pose + 3);
}

static void read_body(void) {
    double total, pose[7];
    char word[WORD];
    dMass mass;
    read_numbers(&total, 1);
    read_numbers(pose, 7);
    if (scanf("%31s", word) != 1) fail("a shape is missing");
    dBodyID body = dBodyCreate(world);
    dBodySetPosition(body, pose[0], pose[1], pose[2]);
    dBodySetQuaternion(body, pose + 3);
    dGeomID geom = read_shape(word, moving, total, &mass);
    if (!geom) fail("no such shape");
    dGeomSetBody(geom, body);
    dBodySetMass(body, &mass);
    bodies = realloc(bodies, (body_count + 1) * sizeof *bodies);
    if (!bodies) fail("out of memory");
    bodies[body_count++] = body;
}

static void attach(dJointID joint) {
    int one = read_whole(), other = read_whole();
    dJointAttach(joint, bodies[one], other < 0 ? NULL : bodies[other]);
}

static void read_ball(void) {
    double d[3];
    dJointID joint = dJointCreateBall(world, 0);
    attach(joint);
    read_numbers(d, 3);
    dJointSetBallAnchor(joint, d[0], d[1], d[2]);
}

static void read_hinge2(void) {
    double d[10];
    dJointID joint = dJointCreateHinge2(world, 0);
    attach(joint);
    read_numbers(d, 10);
    dVector3 up = {0, 1, 0}, axle = {d[3], d[4], d[5]};
    dJointSetHinge2Axes(joint, up, axle);
    dJointSetHinge2Anchor(joint, d[0], d[1], d[2]);
    dJointSetHinge2Param(joint, dParamLoStop, 0);
    dJointSetHinge2Param(joint, dParamHiStop, 0);
    dJointSetHinge2Param(joint, dParamSuspensionERP, d[8]);
    dJointSetHinge2Param(joint, dParamSuspensionCFM, d[9]);
    dJointSetHinge2Param(joint, dParamVel2, -d[6]); /* ODE means the chassis as the wheel sees it */
    dJointSetHinge2Param(joint, dParamFMax2, d[7]);
}

static void read_velocity(void) {
    double d[6];
    read_numbers(d, 6);
    dBodySetLinearVel(bodies[body_count - 1], d[0], d[1], d[2]);
    dBodySetAngularVel(bodies[body_count - 1], d[3], d[4], d[5]);
}

static void read_world(void) {
    double d[5];
    read_numbers(d, 5);
    step_size = d[0];
    dWorldSetGravity(world, d[1], d[2], d[3]);
    contacts_per_pair = (int)d[4];
    if (contacts_per_pair > MOST_CONTACTS) fail("too many contacts per pair");
}

static void read_scene(void) {
    char word[WORD];
    while (scanf("%31s", word) == 1) {
        if (!strcmp(word, "go")) return;
        if (!strcmp(word, "world"))
            read_world();
        else if (!strcmp(word, "place"))
            read_static();
        else if (!strcmp(word, "body"))
            read_body();
        else if (!strcmp(word, "auto_disable"))
            dWorldSetAutoDisableFlag(world, 1);
        else if (!strcmp(word, "asleep"))
            dBodyDisable(bodies[body_count - 1]);
        else if (!strcmp(word, "velocity"))
            read_velocity();
        else if (!strcmp(word, "ball"))
            read_ball();
        else if (!strcmp(word, "hinge2"))
            read_hinge2();
        else if (!read_shape(word, fixed, 0, NULL))
            fail(word);
    }
    fail("the scene has no end");
}

/* ------------------------------------------------------------------ the step that is timed */

static void on_near(void *data, dGeomID g1, dGeomID g2) {
    (void)data;
    dBodyID body1 = dGeomGetBody(g1), body2 = dGeomGetBody(g2);
    if (body1 && body2 && dAreConnectedExcluding(body1, body2, dJointTypeContact)) return;
    dContact contact[MOST_CONTACTS];
    int count = dCollide(g1, g2, contacts_per_pair, &contact[0].geom, sizeof(dContact));
    for (int i = 0; i < count; i++) {
        contact[i].surface.mode = dContactApprox1;
        contact[i].surface.mu = 0.5;
        dJointAttach(dJointCreateContact(world, contacts, &contact[i]), body1, body2);
    }
}

static void step(void) {
    dSpaceCollide(moving, NULL, on_near);
    dSpaceCollide2((dGeomID)moving, (dGeomID)fixed, NULL, on_near);
    dWorldQuickStep(world, step_size);
    dJointGroupEmpty(contacts);
}

/* ------------------------------------------------------------------ orders */

static long long now(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return t.tv_sec * 1000000000LL + t.tv_nsec;
}

static void write_state(void) {
    for (int i = 0; i < body_count; i++) {
        fwrite(dBodyGetPosition(bodies[i]), sizeof(double), 3, stdout);
        fwrite(dBodyGetQuaternion(bodies[i]), sizeof(double), 4, stdout);
        fwrite(dBodyGetLinearVel(bodies[i]), sizeof(double), 3, stdout);
        fwrite(dBodyGetAngularVel(bodies[i]), sizeof(double), 3, stdout);
    }
}

int main(void) {
    char word[WORD];
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    moving = dHashSpaceCreate(0);
    fixed = dSimpleSpaceCreate(0);
    contacts = dJointGroupCreate(0);
    dWorldSetQuickStepNumIterations(world, 20);
    read_scene();
    printf("%d bodies\n", body_count);
    fflush(stdout);
    while (scanf("%31s", word) == 1) {
        if (!strcmp(word, "step")) {
            int count = read_whole();
            long long start = now(CLOCK_MONOTONIC), used = now(CLOCK_THREAD_CPUTIME_ID);
            for (int i = 0; i < count; i++) step();
            used = now(CLOCK_THREAD_CPUTIME_ID) - used;
            printf("%lld %lld\n", now(CLOCK_MONOTONIC) - start, used);
        } else if (!strcmp(word, "state")) {
            write_state();
        } else {
            fail(word);
        }
        fflush(stdout);
    }
    dJointGroupDestroy(contacts);
    dSpaceDestroy(moving);
    dSpaceDestroy(fixed);
    dWorldDestroy(world);
    dCloseODE();
    return 0;
}
