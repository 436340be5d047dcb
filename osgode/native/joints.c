/* Joints. */

#include "internal.h"

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
