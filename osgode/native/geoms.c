/* Geoms, spaces and meshes. */

#include "internal.h"

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

static void mesh_destroy(oo_mesh *mesh) {
    if (mesh->id && !guard_enter()) {
        dGeomTriMeshDataDestroy(mesh->id);
        guard_leave();
    }
    free(mesh->vertices);
    free(mesh->triangles);
    free(mesh);
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

void oo_mesh_free(oo_world *w, oo_mesh *mesh) {
    for (oo_mesh **link = &w->meshes; *link; link = &(*link)->next)
        if (*link == mesh) {
            *link = mesh->next;
            break;
        }
    mesh_destroy(mesh);
    count_live(&live.meshes, -1);
}
