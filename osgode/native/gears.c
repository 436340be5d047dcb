/* Transmissions: what ODE's have to be told so that they turn the right way, and how far their wheels have turned.

   ODE counts angles the wrong way round, and loses count above a quarter of a turn in a step; has the error
   of bevel gears in the wrong sense unless both axes point to where they meet, and turns an axis round by itself where
   they make an obtuse angle; and takes the slack side of a chain from the origin of the world. So the angles are
   counted here, bevel gears get their axes in the sense that is right, and where ODE would go wrong it begins to count
   anew from where the wheels stand, which costs the error that it was about to correct. */

#include "internal.h"

enum { PARALLEL, INTERSECTING, CHAIN };

#define XYZ(v) (v)[0], (v)[1], (v)[2]
#define TILT 1e-6 /* of a bevel gear's axis, so that ODE never sees an obtuse angle */

static dBodyID wheel(const oo_joint *joint, int i) { return dJointGetBody(joint->id, i); }

/* The axes as ODE is to have them, in the world. */
static void set_axes(oo_joint *joint) {
    double n[2][3];
    for (int i = 0; i < 2; i++) {
        axis_in_world(joint, i + 1, joint->axes[i], n[i]);
        for (int k = 0; k < 3; k++) n[i][k] *= joint->sense[i];
    }
    if (joint->gears != INTERSECTING) {
        dJointSetTransmissionAxis(joint->id, XYZ(n[0]));
        return;
    }
    double tilt = TILT - fmin(dot(n[0], n[1]), 0);
    for (int k = 0; k < 3; k++) n[1][k] += tilt * n[0][k];
    dJointSetTransmissionAxis1(joint->id, XYZ(n[0]));
    dJointSetTransmissionAxis2(joint->id, XYZ(n[1]));
}

void place_gears(oo_joint *joint, const double *s, int mode) {
    static const int modes[] = {dTransmissionParallelAxes, dTransmissionIntersectingAxes, dTransmissionChainDrive};
    dJointID id = joint->id;
    double way[3];
    joint->gears = mode;
    for (int i = 0; i < 2; i++) {
        dVector3 middle;
        dBodyGetPosRelPoint(wheel(joint, i), XYZ(s + 3 * i), middle);
        memcpy(joint->middles[i], middle, sizeof joint->middles[i]);
        axis_of_body(joint, i + 1, s + 6 + 3 * i, joint->axes[i]);
        joint->sense[i] = 1;
    }
    for (int k = 0; k < 3; k++) way[k] = s[3 + k] - s[k];
    if (mode == INTERSECTING) { /* both towards where they meet */
        if (dot(way, s + 6) < 0) joint->sense[0] = -1;
        if (dot(way, s + 9) > 0) joint->sense[1] = -1;
    }
    dJointSetTransmissionMode(id, modes[mode]);
    dJointSetTransmissionAnchor1(id, XYZ(s));
    dJointSetTransmissionAnchor2(id, XYZ(s + 3));
    set_axes(joint);
    if (mode == PARALLEL) dJointSetTransmissionRatio(id, s[12]);
    if (mode == CHAIN) {
        dJointSetTransmissionRadius1(id, s[13]);
        dJointSetTransmissionRadius2(id, s[14]);
    }
}

/* The axis of a wheel, and what its angle is measured against, across the axis: the way to the other wheel, or the
   other's axis; and how fast that turns about the axis. */
static double measure(const oo_joint *joint, int i, double *axis, double *against) {
    double change[3], across[3];
    axis_in_world(joint, i + 1, joint->axes[i], axis);
    if (joint->gears == INTERSECTING) {
        axis_in_world(joint, 2 - i, joint->axes[1 - i], against);
        cross(change, dBodyGetAngularVel(wheel(joint, 1 - i)), against);
    } else {
        dVector3 at[2], velocity[2];
        for (int k = 0; k < 2; k++) {
            dBodyGetRelPointPos(wheel(joint, k), XYZ(joint->middles[k]), at[k]);
            dBodyGetRelPointVel(wheel(joint, k), XYZ(joint->middles[k]), velocity[k]);
        }
        for (int k = 0; k < 3; k++) {
            against[k] = at[1][k] - at[0][k];
            change[k] = velocity[1][k] - velocity[0][k];
        }
    }
    double along = dot(axis, against);
    for (int k = 0; k < 3; k++) against[k] -= along * axis[k];
    cross(across, axis, against);
    double square = dot(against, against);
    return square > 0 ? dot(across, change) / square : 0;
}

/* The angle of a wheel nearest to one that is expected, and its rate. */
static double angle_near(const oo_joint *joint, int i, double expected, double *rate) {
    double axis[3], against[3], mark[3], side[3];
    double frame = measure(joint, i, axis, against);
    if (rate) *rate = dot(axis, dBodyGetAngularVel(wheel(joint, i))) - frame;
    axis_in_world(joint, i + 1, joint->references[i], mark);
    cross(side, against, mark);
    return expected + remainder(atan2(dot(axis, side), dot(against, mark)) - expected, 2 * M_PI);
}

void read_gears(const oo_joint *joint, double *angle, double *rate) {
    for (int i = 0; i < 2; i++) {
        double now = angle_near(joint, i, joint->turned[i], rate + i);
        angle[i] = joint->counting ? now : 0;
    }
}

static void begin(oo_joint *joint) {
    double axis[3], against[3];
    for (int i = 0; i < 2; i++) {
        measure(joint, i, axis, against);
        axis_of_body(joint, i + 1, against, joint->references[i]);
    }
    joint->counting = 1;
    set_axes(joint); /* as they stand now, and not at rest */
}

void mesh_gears(oo_world *w) {
    for (unsigned int k = 0; k < w->joint_count; k++) {
        oo_joint *joint = w->joints[k];
        if (joint->kind != OO_TRANSMISSION) continue;
        dJointID id = joint->id;
        double way[2];
        if (!joint->counting) begin(joint);
        for (int i = 0; i < 2; i++) {
            joint->turned[i] = angle_near(joint, i, joint->turned[i], NULL);
            way[i] = joint->turned[i] - joint->zero[i];
        }
        int anew = !dJointIsEnabled(id);
        if (joint->gears == CHAIN) {
            double stretch = dJointGetTransmissionRadius1(id) * way[0] - dJointGetTransmissionRadius2(id) * way[1];
            if (joint->sense[0] * stretch > dJointGetTransmissionBacklash(id)) { /* it pulls on the other side now */
                joint->sense[0] = joint->sense[1] = -joint->sense[0];
                anew = 1;
            }
        }
        if (!anew) continue;
        set_axes(joint);
        memcpy(joint->zero, joint->turned, sizeof joint->zero);
    }
}

void count_gears(oo_world *w) {
    for (unsigned int k = 0; k < w->joint_count; k++) {
        oo_joint *joint = w->joints[k];
        double rate;
        if (joint->kind != OO_TRANSMISSION) continue;
        for (int i = 0; i < 2; i++) {
            angle_near(joint, i, 0, &rate);
            joint->turned[i] = angle_near(joint, i, joint->turned[i] + rate * w->step_size, NULL);
        }
    }
}
