/* Which triangles of a mesh a box meets, by a tree of boxes that is made when a mesh is first asked. */

#include "broad.h"

struct triangle_tree {
    twig *twigs;
    int count;
};

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

/* Of unit length; zeros if the triangle has no area to speak of. */
static void normal_of(const oo_mesh *mesh, unsigned int triangle, double *n) {
    const double *a = corner(mesh, triangle, 0), *b = corner(mesh, triangle, 1), *c = corner(mesh, triangle, 2);
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    cross(n, u, v);
    double length = sqrt(dot(n, n));
    int flat = length > 1e-12 * (dot(u, u) + dot(v, v));
    for (int k = 0; k < 3; k++) n[k] = flat ? n[k] / length : 0;
}

static int make(oo_mesh *mesh) {
    box_tree grown;
    tree_start(&grown);
    mesh->tree = calloc(1, sizeof *mesh->tree);
    mesh->normals = malloc((size_t)mesh->triangle_count * sizeof *mesh->normals);
    int status = mesh->tree && mesh->normals ? tree_build(&grown, mesh->triangle_count, box_of, mesh) : OO_NO_MEMORY;
    if (!status) mesh->tree->twigs = malloc((size_t)grown.count * sizeof *mesh->tree->twigs);
    if (status || !mesh->tree->twigs) {
        free(grown.nodes);
        triangles_free(mesh);
        return OO_NO_MEMORY;
    }
    mesh->tree->count = (int)grown.count;
    tree_flatten(&grown, mesh->tree->twigs);
    free(grown.nodes);
    for (unsigned int i = 0; i < mesh->triangle_count; i++) normal_of(mesh, i, mesh->normals[i]);
    return OO_OK;
}

void triangles_free(oo_mesh *mesh) {
    if (mesh->tree) free(mesh->tree->twigs);
    free(mesh->tree);
    free(mesh->normals);
    mesh->tree = NULL;
    mesh->normals = NULL;
}

int triangle_numbers_in(oo_mesh *mesh, const double low[3], const double high[3], void (*visit)(void *, unsigned int), void *data) {
    if (!mesh->tree && make(mesh)) return OO_NO_MEMORY;
    float from[3], to[3];
    for (int k = 0; k < 3; k++) {
        from[k] = float_below(low[k]);
        to[k] = float_above(high[k]);
    }
    const twig *twigs = mesh->tree->twigs;
    for (int at = 0; at < mesh->tree->count;) {
        const twig *t = &twigs[at];
        if (t->low[0] > to[0] || t->high[0] < from[0] || t->low[2] > to[2] || t->high[2] < from[2] || t->low[1] > to[1] ||
            t->high[1] < from[1]) {
            at = t->next;
            continue;
        }
        if (t->slot != NONE) visit(data, (unsigned int)t->slot);
        at++;
    }
    return OO_OK;
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
    visitor v = {mesh, visit, data};
    return triangle_numbers_in(mesh, low, high, pass_on, &v);
}
