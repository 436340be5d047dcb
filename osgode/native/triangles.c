/* Which triangles of a mesh a box meets: a tree of boxes, made when a mesh is first asked. */

#include "internal.h"

enum { FEW = 4 };

typedef struct branch {
    float low[3], high[3];
    int right;                /* the left one comes next; 0: a leaf */
    unsigned int first, count; /* of its triangles */
} branch;

struct oo_triangles {
    branch *branches;
    unsigned int *order; /* of triangles */
    int used;
};

static const double *corner(const oo_mesh *mesh, unsigned int triangle, int k) {
    return mesh->vertices + 3 * mesh->triangles[3 * triangle + k];
}

static double centre(const oo_mesh *mesh, unsigned int triangle, int axis) {
    return corner(mesh, triangle, 0)[axis] + corner(mesh, triangle, 1)[axis] + corner(mesh, triangle, 2)[axis];
}

static void halve(const oo_mesh *mesh, unsigned int *order, int count, int axis) {
    for (int low = 0, high = count - 1; low < high;) {
        double pivot = centre(mesh, order[(low + high) / 2], axis);
        int i = low, j = high;
        while (i <= j) {
            while (centre(mesh, order[i], axis) < pivot) i++;
            while (centre(mesh, order[j], axis) > pivot) j--;
            if (i > j) break;
            unsigned int moved = order[i];
            order[i++] = order[j];
            order[j--] = moved;
        }
        if (count / 2 <= j)
            high = j;
        else if (count / 2 >= i)
            low = i;
        else
            break;
    }
}

static int grow(const oo_mesh *mesh, struct oo_triangles *t, unsigned int first, unsigned int count) {
    int made = t->used++;
    branch *b = &t->branches[made];
    for (int k = 0; k < 3; k++) {
        b->low[k] = INFINITY;
        b->high[k] = -INFINITY;
    }
    for (unsigned int i = first; i < first + count; i++)
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                float value = (float)corner(mesh, t->order[i], c)[k];
                b->low[k] = fminf(b->low[k], nextafterf(value, -INFINITY));
                b->high[k] = fmaxf(b->high[k], nextafterf(value, INFINITY));
            }
    b->first = first;
    b->count = count;
    b->right = 0;
    if (count <= FEW) return made;
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (b->high[k] - b->low[k] > b->high[axis] - b->low[axis]) axis = k;
    halve(mesh, t->order + first, (int)count, axis);
    grow(mesh, t, first, count / 2);
    b->right = grow(mesh, t, first + count / 2, count - count / 2);
    return made;
}

static int make(oo_mesh *mesh) {
    struct oo_triangles *t = calloc(1, sizeof *t);
    if (!t) return OO_NO_MEMORY;
    t->branches = malloc(2 * mesh->triangle_count * sizeof *t->branches);
    t->order = malloc(mesh->triangle_count * sizeof *t->order);
    mesh->tree = t;
    if (!t->branches || !t->order) {
        triangles_free(mesh);
        return OO_NO_MEMORY;
    }
    for (unsigned int i = 0; i < mesh->triangle_count; i++) t->order[i] = i;
    grow(mesh, t, 0, mesh->triangle_count);
    return OO_OK;
}

void triangles_free(oo_mesh *mesh) {
    if (!mesh->tree) return;
    free(mesh->tree->branches);
    free(mesh->tree->order);
    free(mesh->tree);
    mesh->tree = NULL;
}

int triangles_in(oo_mesh *mesh, const double low[3], const double high[3], void (*visit)(void *, const double *[3]), void *data) {
    if (!mesh->tree && make(mesh)) return OO_NO_MEMORY;
    const struct oo_triangles *t = mesh->tree;
    int stack[64], depth = 0, at = 0; /* halves: 2^64 triangles */
    for (;;) {
        const branch *b = &t->branches[at];
        int apart = 0;
        for (int k = 0; k < 3; k++) apart |= b->low[k] > high[k] || b->high[k] < low[k];
        if (!apart && b->right) {
            stack[depth++] = b->right;
            at++;
            continue;
        }
        if (!apart)
            for (unsigned int i = b->first; i < b->first + b->count; i++) {
                const double *corners[3];
                for (int k = 0; k < 3; k++) corners[k] = corner(mesh, t->order[i], k);
                visit(data, corners);
            }
        if (!depth) return OO_OK;
        at = stack[--depth];
    }
}
