/* Which triangles of a mesh a box meets, by a tree of boxes that is made when a mesh is first asked. */

#include "broad.h"

static const double *corner(const oo_mesh *mesh, unsigned int triangle, int k) {
    return mesh->vertices + 3 * mesh->triangles[3 * triangle + k];
}

static void box_of(const void *keeper, unsigned int triangle, box *out) {
    for (int k = 0; k < 3; k++) {
        double a = corner(keeper, triangle, 0)[k], b = corner(keeper, triangle, 1)[k], c = corner(keeper, triangle, 2)[k];
        out->low[k] = fmin(fmin(a, b), c);
        out->high[k] = fmax(fmax(a, b), c);
    }
}

static int make(oo_mesh *mesh) {
    mesh->tree = malloc(sizeof *mesh->tree);
    if (!mesh->tree) return OO_NO_MEMORY;
    tree_start(mesh->tree);
    if (!tree_build(mesh->tree, mesh->triangle_count, box_of, mesh)) return OO_OK;
    triangles_free(mesh);
    return OO_NO_MEMORY;
}

void triangles_free(oo_mesh *mesh) {
    if (!mesh->tree) return;
    free(mesh->tree->nodes);
    free(mesh->tree);
    mesh->tree = NULL;
}

typedef struct visitor {
    const oo_mesh *mesh;
    void (*visit)(void *, const double *[3]);
    void *data;
} visitor;

static void pass_on(void *data, unsigned int triangle) {
    const visitor *v = data;
    const double *corners[3];
    for (int k = 0; k < 3; k++) corners[k] = corner(v->mesh, triangle, k);
    v->visit(v->data, corners);
}

int triangles_in(oo_mesh *mesh, const double low[3], const double high[3], void (*visit)(void *, const double *[3]), void *data) {
    if (!mesh->tree && make(mesh)) return OO_NO_MEMORY;
    visitor v = {mesh, visit, data};
    box wanted;
    memcpy(wanted.low, low, sizeof wanted.low);
    memcpy(wanted.high, high, sizeof wanted.high);
    tree_visit(mesh->tree, meets_box, &wanted, pass_on, &v);
    return OO_OK;
}
