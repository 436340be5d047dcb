/* Geoms, spaces, and the data that geoms share. */

#include "internal.h"

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

static int fill_slot(oo_world *w, int slot, dGeomID id, unsigned int flags, oo_mesh *mesh) {
    if (!id) {
        give_slot(w, (unsigned int)slot);
        return OO_NO_MEMORY;
    }
    w->geoms[slot] = (oo_geom){.id = id, .mesh = mesh, .category = ~0u, .collide = ~0u, .flags = OO_ALIVE | flags};
    dGeomSetData(id, (void *)(size_t)slot);
    if (flags & OO_IS_SPACE) w->pairs_are_new = 1;
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
        case OO_SPHERE: id = dCreateSphere(0, d[0]); flags = OO_IS_SPHERE; break;
        case OO_CAPSULE: id = dCreateCapsule(0, d[0], d[1]); break;
        case OO_CYLINDER: id = dCreateCylinder(0, d[0], d[1]); flags = OO_IS_CYLINDER; break;
        case OO_PLANE: id = dCreatePlane(0, d[0], d[1], d[2], d[3]); break;
        case OO_TRIMESH:
        case OO_HULL: id = dCreateTriMesh(0, mesh->id, NULL, NULL, NULL); flags = OO_IS_MESH; break;
        case OO_CONVEX:
            id = dCreateConvex(0, mesh->planes, mesh->plane_count, mesh->vertices, mesh->vertex_count, mesh->triangles);
            break;
        case OO_HEIGHTFIELD: id = heightfield_new(mesh, d); flags = OO_IS_HEIGHTFIELD; break;
        case OO_RAY:
            id = dCreateRay(0, d[0]);
            if (id) dGeomRaySetClosestHit(id, 1);
            flags = OO_IS_RAY;
            break;
    }
    guard_leave();
    int result = fill_slot(w, slot, id, flags, mesh);
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
    int result = fill_slot(w, slot, (dGeomID)id, OO_IS_SPACE, NULL);
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

void oo_geom_discard(oo_world *w, unsigned int slot) {
    oo_geom_free(w, slot);
    w->retired_count--; /* the last one */
    w->free_slots[w->free_count++] = slot;
}

void oo_wake_touching(oo_world *w, unsigned int slot) {
    for (unsigned int i = 0; i < w->contact_count; i++) {
        const oo_contact *row = &w->contacts[i];
        if ((row->slot1 != slot && row->slot2 != slot) || !row_acts(w, row)) continue;
        const oo_geom *other = &w->geoms[row->slot1 == slot ? row->slot2 : row->slot1];
        dBodyID body = other->flags & OO_ALIVE ? dGeomGetBody(other->id) : NULL;
        if (body) dBodyEnable(body);
    }
    wake_sleepers_on(w, slot);
}

void oo_wake_touching_body(oo_world *w, unsigned int index) {
    for (dGeomID geom = dBodyGetFirstGeom(w->bodies[index].id); geom; geom = dBodyGetNextGeom(geom))
        oo_wake_touching(w, (unsigned int)(size_t)dGeomGetData(geom));
}

void oo_forget_contacts(oo_world *w) {
    w->contact_count = 0;
    broad_forget(w);
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

/* ------------------------------------------------------------------ what geoms are made from */

static void mesh_destroy(oo_mesh *mesh) {
    if (mesh->id && !guard_enter()) {
        dGeomTriMeshDataDestroy(mesh->id);
        guard_leave();
    }
    triangles_free(mesh);
    free(mesh->vertices);
    free(mesh->triangles);
    free(mesh->planes);
    free(mesh);
}

void oo_geom_set_velocity(oo_world *w, unsigned int slot, const double velocity[3]) {
    oo_geom *geom = &w->geoms[slot];
    geom->flags &= ~(unsigned int)OO_IS_BELT;
    for (int k = 0; k < 3; k++) {
        geom->velocity[k] = (float)velocity[k];
        if (velocity[k] != 0) geom->flags |= OO_IS_BELT;
    }
}

static void *copied(const void *data, size_t size) {
    void *copy = malloc(size);
    if (copy) memcpy(copy, data, size);
    return copy;
}

static oo_mesh *mesh_kept(oo_world *w, oo_mesh *mesh) {
    mesh->next = w->meshes;
    w->meshes = mesh;
    count_live(&live.meshes, 1);
    return mesh;
}

/* ODE's triangles for a mesh that has its arrays. */
static int build_triangles(oo_mesh *mesh, unsigned int count) {
    mesh->triangle_count = count;
    if (guard_enter()) return OO_ASSERT;
    mesh->id = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh->id, mesh->vertices, 3 * sizeof(double), (int)mesh->vertex_count, mesh->triangles,
                                (int)(3 * count), 3 * sizeof(unsigned int));
    dGeomTriMeshDataPreprocess2(mesh->id, (1U << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES) | (1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES), NULL);
    guard_leave();
    return OO_OK;
}

oo_mesh *oo_mesh_new(oo_world *w, const double *vertices, unsigned int vertex_count, const unsigned int *triangles,
                     unsigned int triangle_count) {
    oo_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    mesh->vertices = copied(vertices, 3 * sizeof(double) * vertex_count);
    mesh->vertex_count = vertex_count;
    mesh->triangles = copied(triangles, 3 * sizeof(unsigned int) * triangle_count);
    if (!mesh->vertices || !mesh->triangles || build_triangles(mesh, triangle_count)) {
        mesh_destroy(mesh);
        return NULL;
    }
    return mesh_kept(w, mesh);
}

static void plane_through(const double *a, const double *b, const double *c, double *plane) {
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) plane[k] = n[k] / length;
    plane[3] = dot(plane, a);
}

oo_mesh *oo_hull_new(oo_world *w, const double *vertices, unsigned int vertex_count, const unsigned int *triangles,
                     unsigned int triangle_count, int solid) {
    oo_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    unsigned int each = solid ? 4 : 3;
    mesh->vertices = copied(vertices, 3 * sizeof(double) * vertex_count);
    mesh->vertex_count = vertex_count;
    mesh->triangles = malloc(each * sizeof(unsigned int) * triangle_count);
    mesh->planes = malloc(4 * sizeof(double) * triangle_count);
    mesh->plane_count = triangle_count;
    if (!mesh->vertices || !mesh->triangles || !mesh->planes) {
        mesh_destroy(mesh);
        return NULL;
    }
    for (unsigned int i = 0; i < triangle_count; i++) {
        const unsigned int *t = triangles + 3 * i;
        unsigned int *kept = mesh->triangles + each * i;
        if (solid) *kept++ = 3; /* how many corners the polygon has */
        memcpy(kept, t, 3 * sizeof *t);
        plane_through(vertices + 3 * t[0], vertices + 3 * t[1], vertices + 3 * t[2], mesh->planes + 4 * i);
    }
    if (!solid && build_triangles(mesh, triangle_count)) {
        mesh_destroy(mesh);
        return NULL;
    }
    return mesh_kept(w, mesh);
}

oo_mesh *oo_heights_new(oo_world *w, const double *heights, unsigned int rows, unsigned int columns) {
    oo_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    mesh->vertex_count = rows * columns;
    mesh->vertices = copied(heights, sizeof(double) * mesh->vertex_count);
    if (!mesh->vertices) {
        mesh_destroy(mesh);
        return NULL;
    }
    mesh->rows = rows;
    mesh->columns = columns;
    mesh->lowest = mesh->highest = heights[0];
    for (unsigned int i = 1; i < mesh->vertex_count; i++) {
        mesh->lowest = fmin(mesh->lowest, heights[i]);
        mesh->highest = fmax(mesh->highest, heights[i]);
    }
    return mesh_kept(w, mesh);
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
