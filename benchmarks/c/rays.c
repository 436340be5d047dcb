/* Rays in plain C: the nearest hit of each by dSpaceCollide2 with the spaces, after ODE's manual.
   In: a mesh, balls and boxes, rays. Out, for "cast n": nanoseconds and the sum of the distances. */

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <ode/ode.h>

typedef struct {
    double depth;
} nearest;

static void near_callback(void *data, dGeomID a, dGeomID b) {
    if (dGeomIsSpace(a) || dGeomIsSpace(b)) {
        dSpaceCollide2(a, b, data, near_callback);
        return;
    }
    dContactGeom contact;
    nearest *best = data;
    if (dCollide(a, b, 1, &contact, sizeof contact) && contact.depth < best->depth) best->depth = contact.depth;
}

static double number(void) {
    double value;
    if (scanf("%lf", &value) != 1) exit(1);
    return value;
}

static double *numbers(int count) {
    double *out = malloc(sizeof *out * (size_t)(count ? count : 1));
    for (int i = 0; i < count; i++) out[i] = number();
    return out;
}

int main(void) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dWorldID world = dWorldCreate();
    dSpaceID still = dSimpleSpaceCreate(0), moving = dHashSpaceCreate(0);
    int vertex_count = (int)number(), index_count = (int)number();
    double *vertices = numbers(3 * vertex_count), *indices = numbers(index_count);
    unsigned int *triangles = malloc(sizeof *triangles * (size_t)index_count);
    for (int i = 0; i < index_count; i++) triangles[i] = (unsigned int)indices[i];
    dTriMeshDataID mesh = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh, vertices, 3 * sizeof(double), vertex_count, triangles, index_count, 3 * sizeof *triangles);
    dCreateTriMesh(still, mesh, 0, 0, 0);
    int body_count = (int)number();
    for (int i = 0; i < body_count; i++) {
        double *at = numbers(3);
        dBodyID body = dBodyCreate(world);
        dGeomID geom = i % 2 ? dCreateBox(moving, 0.6, 0.6, 0.6) : dCreateSphere(moving, 0.35);
        dGeomSetBody(geom, body);
        dBodySetPosition(body, at[0], at[1], at[2]);
        free(at);
    }
    int ray_count = (int)number();
    double *rays = numbers(7 * ray_count);
    dGeomID ray = dCreateRay(0, 1);
    dGeomRaySetClosestHit(ray, 1);
    char word[16];
    printf("ready\n");
    fflush(stdout);
    while (scanf("%15s", word) == 1) {
        struct timespec start, end;
        double sum = 0;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
        for (int i = 0; i < ray_count; i++) {
            const double *r = rays + 7 * i;
            nearest best = {dInfinity};
            dGeomRaySetLength(ray, r[6]);
            dGeomRaySet(ray, r[0], r[1], r[2], r[3], r[4], r[5]);
            dSpaceCollide2(ray, (dGeomID)still, &best, near_callback);
            dSpaceCollide2(ray, (dGeomID)moving, &best, near_callback);
            if (best.depth < dInfinity) sum += best.depth;
        }
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
        printf("%lld %.17g\n", (end.tv_sec - start.tv_sec) * 1000000000LL + end.tv_nsec - start.tv_nsec, sum);
        fflush(stdout);
    }
    return 0;
}
