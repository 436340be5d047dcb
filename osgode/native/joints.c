/* Joints: one place for what the fifteen kinds of ODE do each in their own way.

   Body 1 is always there: with the bodies the other way round ODE gives some angles and forces the wrong sign.
   Numbers of parameters are ODE's, group included (dParamVel + 0x100 is the motor velocity of the second axis). */

#include "internal.h"

oo_joint *oo_joint_new(oo_world *w, int kind, dBodyID body1, dBodyID body2) {
    if (reserve(&w->joints, &w->joint_capacity, w->joint_count + 1, sizeof *w->joints)) return NULL;
    if (reserve(&w->broken_joints, &w->broken_capacity, w->joint_count + 1, sizeof *w->broken_joints)) return NULL;
    oo_joint *joint = calloc(1, sizeof *joint);
    if (!joint || guard_enter()) {
        free(joint);
        return NULL;
    }
    dJointID id = NULL;
    switch (kind) {
        case OO_BALL: id = dJointCreateBall(w->id, 0); break;
        case OO_HINGE: id = dJointCreateHinge(w->id, 0); break;
        case OO_SLIDER: id = dJointCreateSlider(w->id, 0); break;
        case OO_FIXED: id = dJointCreateFixed(w->id, 0); break;
        case OO_UNIVERSAL: id = dJointCreateUniversal(w->id, 0); break;
        case OO_HINGE2: id = dJointCreateHinge2(w->id, 0); break;
        case OO_AMOTOR: id = dJointCreateAMotor(w->id, 0); break;
        case OO_LMOTOR: id = dJointCreateLMotor(w->id, 0); break;
        case OO_PR: id = dJointCreatePR(w->id, 0); break;
        case OO_PU: id = dJointCreatePU(w->id, 0); break;
        case OO_PISTON: id = dJointCreatePiston(w->id, 0); break;
        case OO_PLANE2D: id = dJointCreatePlane2D(w->id, 0); break;
        case OO_DBALL: id = dJointCreateDBall(w->id, 0); break;
        case OO_DHINGE: id = dJointCreateDHinge(w->id, 0); break;
        case OO_TRANSMISSION: id = dJointCreateTransmission(w->id, 0); break;
    }
    if (id) dJointAttach(id, body1, body2);
    guard_leave();
    if (!id) {
        free(joint);
        return NULL;
    }
    joint->id = id;
    joint->kind = kind;
    joint->born = w->steps;
    w->gear_count += kind == OO_TRANSMISSION;
    joint->break_force = joint->break_torque = INFINITY;
    joint->index = w->joint_count;
    w->joints[w->joint_count++] = joint;
    count_live(&live.joints, 1);
    return joint;
}

void oo_joint_free(oo_world *w, oo_joint *joint) {
    oo_joint_watch(w, joint, 0, INFINITY, INFINITY);
    oo_joint_drive(w, joint, NULL);
    if (!guard_enter()) {
        dJointDestroy(joint->id);
        guard_leave();
    }
    w->gear_count -= joint->kind == OO_TRANSMISSION;
    w->joint_count--;
    w->joints[joint->index] = w->joints[w->joint_count];
    w->joints[joint->index]->index = joint->index;
    free(joint);
    count_live(&live.joints, -1);
}

/* ------------------------------------------------------------------ where it is */

/* A direction of the world in the axes of body 1 or 2; in those of the world for 0, or where there is no body 2. */
void axis_of_body(const oo_joint *joint, int of, const double *world, double *local) {
    dBodyID body = of ? dJointGetBody(joint->id, of - 1) : NULL;
    dVector3 result = {world[0], world[1], world[2]};
    if (body) dBodyVectorFromWorld(body, world[0], world[1], world[2], result);
    memcpy(local, result, 3 * sizeof *local);
}

void axis_in_world(const oo_joint *joint, int of, const double *local, double *world) {
    dBodyID body = of ? dJointGetBody(joint->id, of - 1) : NULL;
    dVector3 result = {local[0], local[1], local[2]};
    if (body) dBodyVectorToWorld(body, local[0], local[1], local[2], result);
    memcpy(world, result, 3 * sizeof *world);
}

#define XYZ(v) (v)[0], (v)[1], (v)[2]

static void place_motor(oo_joint *joint, const double *s, const int *how) {
    dJointID id = joint->id;
    int euler = joint->kind == OO_AMOTOR && how[0];
    joint->euler = euler;
    joint->axis_count = euler ? 3 : how[1];
    for (int i = 0; i < joint->axis_count; i++) {
        int of = how[2 + i];
        joint->axis_of[i] = of;
        axis_of_body(joint, of, s + 3 * i, joint->axes[i]);
    }
    if (joint->kind == OO_LMOTOR) {
        dJointSetLMotorNumAxes(id, joint->axis_count);
        for (int i = 0; i < joint->axis_count; i++) dJointSetLMotorAxis(id, i, joint->axis_of[i], XYZ(s + 3 * i));
        return;
    }
    dJointSetAMotorMode(id, euler ? dAMotorEuler : dAMotorUser);
    if (!euler) dJointSetAMotorNumAxes(id, joint->axis_count);
    for (int i = 0; i < joint->axis_count; i++)
        if (!euler || i != 1) dJointSetAMotorAxis(id, i, joint->axis_of[i], XYZ(s + 3 * i));
    if (euler) { /* the third axis as body 1 has it, and the first as body 2 has it, at the angles 0 */
        axis_of_body(joint, 1, s + 6, joint->references[0]);
        axis_of_body(joint, 2, s, joint->references[1]);
    }
}

/* ODE takes one axis after the other, and complains of two that are parallel meanwhile. */
static void set_universal_axes(dJointID id, const double *axis1, const double *axis2) {
    dVector3 old, aside;
    dJointGetUniversalAxis2(id, old);
    for (int k = 0; k < 3; k++) /* across the old second axis and the new one, or, if these are parallel, across both */
        aside[k] = old[(k + 1) % 3] * axis2[(k + 2) % 3] - old[(k + 2) % 3] * axis2[(k + 1) % 3];
    const double *first = dot(aside, aside) > 1e-6 ? aside : axis1;
    dJointSetUniversalAxis1(id, XYZ(first));
    dJointSetUniversalAxis2(id, XYZ(axis2));
    dJointSetUniversalAxis1(id, XYZ(axis1));
}

int oo_joint_place(oo_joint *joint, const double *s, const int *how, const double at[3]) {
    dJointID id = joint->id;
    memcpy(joint->at, at, sizeof joint->at);
    if (guard_enter()) return OO_ASSERT;
    switch (joint->kind) {
        case OO_BALL: dJointSetBallAnchor(id, XYZ(s)); break;
        case OO_HINGE:
            dJointSetHingeAnchor(id, XYZ(s));
            dJointSetHingeAxis(id, XYZ(s + 3));
            break;
        case OO_SLIDER: dJointSetSliderAxis(id, XYZ(s)); break;
        case OO_FIXED: dJointSetFixed(id); break;
        case OO_UNIVERSAL:
            dJointSetUniversalAnchor(id, XYZ(s));
            set_universal_axes(id, s + 3, s + 6);
            break;
        case OO_HINGE2: {
            dVector3 axis1 = {XYZ(s + 3)}, axis2 = {XYZ(s + 6)};
            dJointSetHinge2Axes(id, axis1, axis2);
            dJointSetHinge2Anchor(id, XYZ(s));
            break;
        }
        case OO_AMOTOR:
        case OO_LMOTOR: place_motor(joint, s, how); break;
        case OO_PR:
            dJointSetPRAnchor(id, XYZ(s));
            dJointSetPRAxis1(id, XYZ(s + 3));
            dJointSetPRAxis2(id, XYZ(s + 6));
            break;
        case OO_PU:
            dJointSetPUAnchor(id, XYZ(s));
            dJointSetPUAxis1(id, XYZ(s + 3));
            dJointSetPUAxis2(id, XYZ(s + 6));
            dJointSetPUAxis3(id, XYZ(s + 9));
            break;
        case OO_PISTON:
            dJointSetPistonAnchor(id, XYZ(s));
            dJointSetPistonAxis(id, XYZ(s + 3));
            break;
        case OO_DBALL:
            dJointSetDBallAnchor1(id, XYZ(s));
            dJointSetDBallAnchor2(id, XYZ(s + 3));
            break;
        case OO_DHINGE:
            dJointSetDHingeAxis(id, XYZ(s + 6));
            dJointSetDHingeAnchor1(id, XYZ(s));
            dJointSetDHingeAnchor2(id, XYZ(s + 3));
            break;
        case OO_TRANSMISSION: place_gears(joint, s, how[0]); break;
    }
    guard_leave();
    return OO_OK;
}

/* ------------------------------------------------------------------ parameters */

/* ODE's angles of a hinge-2 are those of the chassis as the wheel sees it. Here they are those of the wheel, so
   velocities change their sign, and the stops their places too. */
static int mirrored(const oo_joint *joint, int *code) {
    if (joint->kind != OO_HINGE2) return 0;
    int parameter = *code & 0xff, group = *code & 0xff00;
    if (parameter == dParamLoStop || parameter == dParamHiStop) {
        *code = group + (parameter == dParamLoStop ? dParamHiStop : dParamLoStop);
        return 1;
    }
    return parameter == dParamVel;
}

void oo_joint_set_param(oo_joint *joint, int code, double value) {
    dJointID id = joint->id;
    int parameter = code & 0xff, group = (code >> 8) & 0xff;
    if (code == OO_DISTANCE) {
        dJointSetDBallDistance(id, value); /* a double hinge too: it is a double ball with more rows */
        return;
    }
    if (code == OO_BACKLASH) {
        dJointSetTransmissionBacklash(id, value);
        return;
    }
    if (parameter == OO_ANGLE) {
        dJointSetAMotorAngle(id, group, value);
        return;
    }
    if (mirrored(joint, &code)) value = -value;
    switch (joint->kind) {
        case OO_BALL: dJointSetBallParam(id, code, value); break;
        case OO_HINGE: dJointSetHingeParam(id, code, value); break;
        case OO_SLIDER: dJointSetSliderParam(id, code, value); break;
        case OO_FIXED: dJointSetFixedParam(id, code, value); break;
        case OO_UNIVERSAL: dJointSetUniversalParam(id, code, value); break;
        case OO_HINGE2: dJointSetHinge2Param(id, code, value); break;
        case OO_AMOTOR: dJointSetAMotorParam(id, code, value); break;
        case OO_LMOTOR: dJointSetLMotorParam(id, code, value); break;
        case OO_PR: dJointSetPRParam(id, code, value); break;
        case OO_PU: dJointSetPUParam(id, code, value); break;
        case OO_PISTON: dJointSetPistonParam(id, code, value); break;
        case OO_DBALL: dJointSetDBallParam(id, code, value); break;
        case OO_DHINGE: dJointSetDHingeParam(id, code, value); break;
        case OO_TRANSMISSION: dJointSetTransmissionParam(id, code, value); break;
        case OO_PLANE2D:
            if (group == 0) dJointSetPlane2DXParam(id, parameter, value);
            if (group == 1) dJointSetPlane2DYParam(id, parameter, value);
            if (group == 2) dJointSetPlane2DAngleParam(id, parameter, value);
            break;
    }
}

static double ode_param(const oo_joint *joint, int code) {
    dJointID id = joint->id;
    switch (joint->kind) {
        case OO_BALL: return dJointGetBallParam(id, code);
        case OO_HINGE: return dJointGetHingeParam(id, code);
        case OO_SLIDER: return dJointGetSliderParam(id, code);
        case OO_FIXED: return dJointGetFixedParam(id, code);
        case OO_UNIVERSAL: return dJointGetUniversalParam(id, code);
        case OO_HINGE2: return dJointGetHinge2Param(id, code);
        case OO_AMOTOR: return dJointGetAMotorParam(id, code);
        case OO_LMOTOR: return dJointGetLMotorParam(id, code);
        case OO_PR: return dJointGetPRParam(id, code);
        case OO_PU: return dJointGetPUParam(id, code);
        case OO_PISTON: return dJointGetPistonParam(id, code);
        case OO_DBALL: return dJointGetDBallParam(id, code);
        case OO_DHINGE: return dJointGetDHingeParam(id, code);
        case OO_TRANSMISSION: return dJointGetTransmissionParam(id, code);
    }
    return 0;
}

double oo_joint_get_param(const oo_joint *joint, int code) {
    if (code == OO_DISTANCE) return dJointGetDBallDistance(joint->id);
    if (code == OO_BACKLASH) return dJointGetTransmissionBacklash(joint->id);
    if ((code & 0xff) == OO_ANGLE) return dJointGetAMotorAngle(joint->id, (code >> 8) & 0xff);
    int turned = mirrored(joint, &code);
    double value = ode_param(joint, code);
    return turned ? -value : value;
}

/* ------------------------------------------------------------------ what it reads */

/* Angular velocity of body 1 as body 2 sees it, along the axes of the world. */
static void spin(dJointID id, double *out) {
    dBodyID body2 = dJointGetBody(id, 1);
    memcpy(out, dBodyGetAngularVel(dJointGetBody(id, 0)), 3 * sizeof *out);
    if (body2)
        for (int k = 0; k < 3; k++) out[k] -= dBodyGetAngularVel(body2)[k];
}

/* Velocity of the point of body 1 that is at p, as that of body 2 sees it which is at q. */
static void drift(dJointID id, const double *p, const double *q, double *out) {
    dVector3 v1, v2 = {0};
    dBodyGetPointVel(dJointGetBody(id, 0), XYZ(p), v1);
    if (dJointGetBody(id, 1)) dBodyGetPointVel(dJointGetBody(id, 1), XYZ(q), v2);
    for (int k = 0; k < 3; k++) out[k] = v1[k] - v2[k];
}

/* How fast body 1 slides along the axis: at p the two have no other motion against each other that counts. ODE's own
   rates leave out that the axis turns with a body. */
static double sliding(dJointID id, const double *axis, const double *p) {
    double velocity[3];
    drift(id, p, p, velocity);
    return dot(axis, velocity);
}

/* Rates about two axes that may stand at any angle to each other, from the spin that they make up. */
static void split(const double *spin, const double *axis1, const double *axis2, double *rate) {
    double c = dot(axis1, axis2), d1 = dot(axis1, spin), d2 = dot(axis2, spin), s = 1 - c * c;
    rate[0] = s > 1e-12 ? (d1 - c * d2) / s : 0;
    rate[1] = s > 1e-12 ? (d2 - c * d1) / s : 0;
}

static void read_euler(const oo_joint *joint, const double *w, double *angle, double *rate) {
    double a0[3], a1[3], a2[3], ref1[3], ref2[3], q[3];
    axis_in_world(joint, 1, joint->axes[0], a0);
    axis_in_world(joint, 2, joint->axes[2], a2);
    axis_in_world(joint, 1, joint->references[0], ref1);
    axis_in_world(joint, 2, joint->references[1], ref2);
    cross(a1, a2, a0);
    double s = sqrt(dot(a1, a1)); /* the cosine of the angle in the middle */
    if (s < 1e-9) return;         /* gimbal lock: the outer two can't be told apart */
    for (int k = 0; k < 3; k++) a1[k] /= s;
    cross(q, a0, ref1);
    angle[0] = -atan2(dot(a2, q), dot(a2, ref1));
    angle[1] = -atan2(dot(a2, a0), s);
    cross(q, a1, a2);
    angle[2] = -atan2(dot(ref2, a1), dot(ref2, q));
    rate[1] = dot(w, a1);
    rate[2] = dot(w, (cross(q, a0, a1), q)) / s;
    rate[0] = dot(w, (cross(q, a1, a2), q)) / s;
}

static void read_motor(const oo_joint *joint, const double *w, double *angle, double *rate) {
    double velocity[3], axis[3];
    if (joint->euler) {
        read_euler(joint, w, angle, rate);
        return;
    }
    dBodyID body2 = dJointGetBody(joint->id, 1);
    for (int k = 0; k < 3; k++)
        velocity[k] = dBodyGetLinearVel(dJointGetBody(joint->id, 0))[k] - (body2 ? dBodyGetLinearVel(body2)[k] : 0);
    for (int i = 0; i < joint->axis_count; i++) {
        axis_in_world(joint, joint->axis_of[i], joint->axes[i], axis);
        rate[i] = dot(axis, joint->kind == OO_LMOTOR ? velocity : w);
        if (joint->kind == OO_AMOTOR) angle[i] = dJointGetAMotorAngle(joint->id, i);
    }
}

static void read_distance(dJointID id, double *length, double *rate) {
    dVector3 a, b;
    double way[3], velocity[3];
    dJointGetDBallAnchor1(id, a);
    dJointGetDBallAnchor2(id, b);
    for (int k = 0; k < 3; k++) way[k] = a[k] - b[k];
    *length = sqrt(dot(way, way));
    drift(id, a, b, velocity);
    *rate = *length > 0 ? dot(way, velocity) / *length : 0;
}

static void read_hinge2(dJointID id, const double *w, double *position, double *rate) {
    dVector3 axis1, axis2, a, b;
    double velocity[3];
    dJointGetHinge2Axis1(id, axis1);
    dJointGetHinge2Axis2(id, axis2);
    dJointGetHinge2Anchor(id, a);
    dJointGetHinge2Anchor2(id, b);
    split(w, axis1, axis2, rate);
    rate[0] = -rate[0];
    rate[1] = -rate[1];
    position[0] = -dJointGetHinge2Angle1(id);
    position[1] = dJointGetHinge2Angle2(id); /* this one is that of the wheel in ODE too, unlike its rate */
    for (int k = 0; k < 3; k++) position[2] += axis1[k] * (b[k] - a[k]);
    drift(id, b, b, velocity);
    rate[2] = -dot(axis1, velocity);
}

static void read_coordinates(const oo_joint *joint, double *position, double *rate) {
    dJointID id = joint->id;
    dVector3 axis, axis2, anchor;
    double w[3];
    spin(id, w);
    switch (joint->kind) {
        case OO_HINGE:
            position[0] = dJointGetHingeAngle(id);
            rate[0] = dJointGetHingeAngleRate(id);
            break;
        case OO_SLIDER:
            dJointGetSliderAxis(id, axis);
            position[0] = dJointGetSliderPosition(id);
            rate[0] = sliding(id, axis, dBodyGetPosition(dJointGetBody(id, 0)));
            break;
        case OO_UNIVERSAL:
            dJointGetUniversalAngles(id, &position[0], &position[1]);
            dJointGetUniversalAxis1(id, axis);
            dJointGetUniversalAxis2(id, axis2);
            split(w, axis, axis2, rate);
            break;
        case OO_HINGE2: read_hinge2(id, w, position, rate); break;
        case OO_AMOTOR:
        case OO_LMOTOR: read_motor(joint, w, position, rate); break;
        case OO_PR:
            position[0] = dJointGetPRPosition(id);
            position[1] = dJointGetPRAngle(id);
            dJointGetPRAxis1(id, axis);
            dJointGetPRAnchor(id, anchor);
            rate[0] = sliding(id, axis, anchor);
            rate[1] = dJointGetPRAngleRate(id);
            break;
        case OO_PU:
            dJointGetPUAngles(id, &position[0], &position[1]);
            position[2] = dJointGetPUPosition(id);
            dJointGetPUAxis1(id, axis);
            dJointGetPUAxis2(id, axis2);
            split(w, axis, axis2, rate);
            dJointGetPUAxis3(id, axis);
            dJointGetPUAnchor(id, anchor);
            rate[2] = sliding(id, axis, anchor);
            break;
        case OO_PISTON:
            position[0] = dJointGetPistonPosition(id);
            position[1] = dJointGetPistonAngle(id);
            dJointGetPistonAxis(id, axis);
            dJointGetPistonAnchor2(id, anchor);
            rate[0] = sliding(id, axis, anchor);
            rate[1] = dJointGetPistonAngleRate(id);
            break;
        case OO_DBALL:
        case OO_DHINGE: read_distance(id, &position[0], &rate[0]); break;
        case OO_TRANSMISSION: read_gears(joint, position, rate); break;
    }
}

void oo_joint_read(const oo_world *w, const oo_joint *joint, oo_joint_state *out) {
    memset(out, 0, sizeof *out);
    read_coordinates(joint, out->position, out->rate);
    const dJointFeedback *f = &joint->feedback;
    memcpy(out->force1, f->f1, sizeof out->force1);
    memcpy(out->torque1, f->t1, sizeof out->torque1);
    memcpy(out->force2, f->f2, sizeof out->force2);
    memcpy(out->torque2, f->t2, sizeof out->torque2);
    dVector3 arm;
    double moment[3];
    dBodyVectorToWorld(dJointGetBody(joint->id, 0), XYZ(joint->at), arm);
    cross(moment, arm, out->force1);
    for (int k = 0; k < 3; k++) out->torque[k] = out->torque1[k] - moment[k];
}

void oo_export_joints(const oo_world *w, oo_joint_state *out) {
    for (unsigned int i = 0; i < w->joint_count; i++) oo_joint_read(w, w->joints[i], out + i);
}

/* ------------------------------------------------------------------ feedback, breaking, servos */

void oo_joint_watch(oo_world *w, oo_joint *joint, int feedback, double break_force, double break_torque) {
    int watched = isfinite(joint->break_force) || isfinite(joint->break_torque);
    int wanted = isfinite(break_force) || isfinite(break_torque);
    w->breakable_count += (unsigned int)(wanted - watched);
    joint->break_force = break_force;
    joint->break_torque = break_torque;
    int given = dJointGetFeedback(joint->id) != NULL;
    if (given == (feedback || wanted)) return;
    memset(&joint->feedback, 0, sizeof joint->feedback);
    dJointSetFeedback(joint->id, given ? NULL : &joint->feedback);
}

void oo_joint_drive(oo_world *w, oo_joint *joint, const oo_servo *servo) {
    w->servo_count += (unsigned int)((servo != NULL) - joint->has_servo);
    joint->has_servo = servo != NULL;
    if (servo) joint->servo = *servo;
}

static int awake(dJointID id) {
    dBodyID body2 = dJointGetBody(id, 1);
    return dBodyIsEnabled(dJointGetBody(id, 0)) || (body2 && dBodyIsEnabled(body2));
}

static void keep_awake(dJointID id) {
    for (int i = 0; i < 2; i++) {
        dBodyID body = dJointGetBody(id, i);
        if (body && dBodyIsEnabled(body)) dBodyEnable(body); /* counts its rest anew */
    }
}

/* A spring to the target of the servo's frequency, one implicit step of it: v' = v + h (k e' - d v') with
   e' = e - h v', k = frequency^2 and d = 2 ratio frequency. The joint's motor makes that velocity, or as much of it as
   its force allows. */
void drive_servos(oo_world *w) {
    for (unsigned int i = 0; i < w->joint_count; i++) {
        oo_joint *joint = w->joints[i];
        if (!joint->has_servo || !dJointIsEnabled(joint->id) || !awake(joint->id)) continue;
        const oo_servo *servo = &joint->servo;
        double position[3] = {0}, rate[3] = {0}, h = w->step_size, k = servo->frequency * servo->frequency;
        read_coordinates(joint, position, rate);
        double error = servo->target - position[0];
        if (servo->turns) error = remainder(error, 2 * M_PI);
        double velocity = (rate[0] + h * k * error) / (1 + 2 * h * servo->damping_ratio * servo->frequency + h * h * k);
        velocity = fmax(-servo->max_speed, fmin(servo->max_speed, velocity));
        oo_joint_set_param(joint, dParamVel, velocity);
        if (fabs(error) > 1e-4) keep_awake(joint->id);
    }
}

void find_broken_joints(oo_world *w) {
    for (unsigned int i = 0; i < w->joint_count; i++) {
        const oo_joint *joint = w->joints[i];
        if (!(isfinite(joint->break_force) || isfinite(joint->break_torque))) continue;
        if (!dJointIsEnabled(joint->id) || !awake(joint->id)) continue;
        oo_joint_state state;
        oo_joint_read(w, joint, &state);
        double force = sqrt(dot(state.force1, state.force1)), torque = sqrt(dot(state.torque, state.torque));
        if (force > joint->break_force || torque > joint->break_torque) w->broken_joints[w->broken_count++] = i;
    }
}
