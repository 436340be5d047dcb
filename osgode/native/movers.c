/* Which moving boxes of the broad phase meet: a list of them, sorted along one axis, is swept. */

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "broad.h"

/* The axis along which they are spread most: along another most of them would overlap. Of two that are as good, to
   rounding, the first: in which order they stand in the list must not show. */
static int widest_axis(const struct oo_broad *b) {
    double widest = -1, sums[3] = {0}, squares[3] = {0};
    int axis = 0;
    for (unsigned int i = 0; i < b->mover_count; i++) {
        const box *of = &b->entries[b->movers[i].slot].box;
        for (int k = 0; k < 3; k++) {
            double middle = of->low[k] + of->high[k];
            sums[k] += middle;
            squares[k] += middle * middle;
        }
    }
    for (int k = 0; k < 3; k++) {
        double spread = squares[k] - sums[k] * sums[k] / b->mover_count;
        if (spread > widest * (1 + 1e-9)) {
            widest = spread;
            axis = k;
        }
    }
    return axis;
}

static int by_low(const void *a, const void *b) {
    const mover *m = a, *n = b;
    if (m->low != n->low) return m->low < n->low ? -1 : 1;
    return m->slot < n->slot ? -1 : m->slot > n->slot;
}

static void sort_movers(struct oo_broad *b) {
    int axis = widest_axis(b), nearly_sorted = axis == b->axis && b->unsorted < 16;
    b->axis = axis;
    for (unsigned int i = 0; i < b->mover_count; i++) b->movers[i].low = b->entries[b->movers[i].slot].box.low[axis];
    if (!nearly_sorted) {
        qsort(b->movers, b->mover_count, sizeof *b->movers, by_low);
        return;
    }
    for (unsigned int i = 1; i < b->mover_count; i++) {
        mover m = b->movers[i];
        unsigned int k = i;
        for (; k > 0 && by_low(&b->movers[k - 1], &m) > 0; k--) b->movers[k] = b->movers[k - 1];
        b->movers[k] = m;
    }
}

/* Rounding keeps the order of numbers: what stands beside each other here does so in truth. */
static cross_section section_of(const box *b, int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (cross_section){{(float)b->low[u], (float)b->low[v], (float)-b->high[u], (float)-b->high[v]}};
}

/* Whether one lies beside the other, by more than floats can hide. */
static inline int beside(const cross_section *one, const cross_section *mirrored) {
#ifdef __SSE__
    return _mm_movemask_ps(_mm_cmpgt_ps(_mm_loadu_ps(one->sides), _mm_loadu_ps(mirrored->sides)));
#else
    const float *a = one->sides, *b = mirrored->sides;
    return (a[0] > b[0]) | (a[1] > b[1]) | (a[2] > b[2]) | (a[3] > b[3]);
#endif
}

/* Most of what stands near in the list stands aside, which small copies of the boxes tell first. */
void meet_movers(oo_world *w) {
    struct oo_broad *b = w->broad;
    if (!b->mover_count) return;
    sort_movers(b);
    const mover *movers = b->movers;
    const entry *entries = b->entries;
    cross_section *sections = b->sections;
    unsigned int count = b->mover_count;
    for (unsigned int i = 0; i < count; i++) sections[i] = section_of(&entries[movers[i].slot].box, b->axis);
    for (unsigned int i = 0; i < count; i++) {
        const box *own = &entries[movers[i].slot].box;
        const float *s = sections[i].sides;
        const cross_section mirrored = {{-s[2], -s[3], -s[0], -s[1]}};
        double high = own->high[b->axis];
        for (unsigned int k = i + 1; k < count && movers[k].low <= high; k++)
            if (!beside(&sections[k], &mirrored) && overlap(own, &entries[movers[k].slot].box))
                try_pair(w, movers[i].slot, movers[k].slot);
    }
}
