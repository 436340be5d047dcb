"""What ODE does with bad joints (aborts, crashes, silence) is a clear error here, and nothing has changed after it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import osgode as oo
from tests.joints.held import KINDS, Held

NAN, INF = math.nan, math.inf
X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


@dataclass(frozen=True)
class Row:
    """A misuse, what it is called on, and what the error says."""

    misuse: str
    act: Callable[..., object]
    words: str
    error: type = oo.FieldError

    def __str__(self) -> str:
        return self.misuse


def new(cls: Any, **arguments: Any) -> Callable[..., object]:
    """Make a joint between both bodies."""
    return lambda a, b, _: cls(a, b, name="it", **arguments)


def gears(**arguments: Any) -> Callable[..., object]:
    return lambda a, b, _: oo.Transmission(
        a, b, **{"anchor1": (0, 0, 0), "anchor2": (2, 0, 0), "name": "it"} | arguments
    )


def put(cls: Any, name: str, value: object, **arguments: Any) -> Callable[..., object]:
    """Set an attribute of a joint that was right before."""
    return lambda a, b, made: setattr(made(cls, **arguments), name, value)


def call(cls: Any, name: str, *args: Any, fields: dict[str, Any] | None = None, **kwargs: Any) -> Callable[..., object]:
    return lambda a, b, made: getattr(made(cls, **fields or {}), name)(*args, **kwargs)


GEARS = {"anchor1": (0, 0, 0), "anchor2": (2, 0, 0)}
CHAIN = {**GEARS, "mode": "chain", "radius1": 0.5, "radius2": 0.25}
EULER = {"mode": "euler", "axes": (X, Z)}

ROWS = [
    # bodies
    Row(
        "the same body twice",
        lambda a, b, _: oo.Hinge(a, a, name="it"),
        "Hinge 'it': body1 and body2 .* Body 'a'",
        oo.TreeError,
    ),
    Row(
        "a hinge-2 to one body",
        lambda a, b, _: oo.Hinge2(a, None, name="it"),
        "Hinge2 'it': body2 is None",
        oo.TreeError,
    ),
    Row(
        "a gear to one body",
        lambda a, b, _: oo.Transmission(a, None, name="it"),
        "Transmission 'it': body2 is None",
        oo.TreeError,
    ),
    Row("nothing to a body", lambda a, b, _: oo.Hinge(None, b, name="it"), "Hinge 'it': body1 is None", oo.TreeError),
    Row("a plane with two bodies", lambda a, b, _: oo.Plane2D(a, b), "positional", TypeError),
    Row("a rod to nowhere", lambda a, b, _: oo.DoubleBall(a, name="it"), r"DoubleBall 'it'\.anchor2 is None"),
    Row("a hinged rod to nowhere", lambda a, b, _: oo.DoubleHinge(a, name="it"), r"DoubleHinge 'it'\.anchor2 is None"),
    # axes
    Row("a zero axis", new(oo.Hinge, axis=(0, 0, 0)), r"Hinge 'it'\.axis is \(0, 0, 0\); it must be a direction"),
    Row("a NaN axis", new(oo.Slider, axis=(NAN, 0, 0)), r"Slider 'it'\.axis is \(nan, 0, 0\)"),
    Row("an axis that is taken away", put(oo.Piston, "axis", (0, 0, 0)), r"Piston 'it'\.axis is \(0, 0, 0\)"),
    Row("an axis out of bounds of floats", new(oo.PR, axis1=(1e308, 1e308, 0)), r"PR 'it'\.axis1 is "),
    Row(
        "hinge-2 axes that are parallel",
        new(oo.Hinge2, axis1=Y, axis2=(0, -2, 0)),
        r"Hinge2 'it'\.axis2 is .*parallel to axis1",
    ),
    Row("hinge-2 axes made parallel", put(oo.Hinge2, "axis1", Z), r"Hinge2 'it'\.axis2 is .*parallel to axis1"),
    Row(
        "a cross of parallel axes",
        new(oo.Universal, axis1=Y, axis2=Y),
        r"Universal 'it'\.axis2 is .* right angle to it",
    ),
    Row("a cross made flat", put(oo.Universal, "axis1", Y), r"Universal 'it'\.axis2 is .* at 0\.0 degrees to axis1"),
    Row("a PU of parallel axes", new(oo.PU, axis1=X, axis2=X), r"PU 'it'\.axis2 is .* right angle to it"),
    Row("a PR of parallel axes", new(oo.PR, axis1=X, axis2=(-3, 0, 0)), r"PR 'it'\.axis2 is .* at 180\.0 degrees"),
    Row(
        "a rod out of the plane of its hinges",
        new(oo.DoubleHinge, anchor1=(0, 0, 0), anchor2=(1, 0, 1), axis=Z),
        r"DoubleHinge 'it'\.anchor2 is .* plane",
    ),
    # motors
    Row(
        "Euler angles without axes",
        new(oo.AngularMotor, mode="euler", axes=()),
        r"AngularMotor 'it'\.axes is .*two directions",
    ),
    Row(
        "Euler angles of three axes", new(oo.AngularMotor, mode="euler"), r"AngularMotor 'it'\.axes is .*two directions"
    ),
    Row(
        "Euler angles about parallel axes",
        new(oo.AngularMotor, mode="euler", axes=(X, X)),
        r"AngularMotor 'it'\.axes\[1\] is .*right angle",
    ),
    Row(
        "Euler axes made parallel",
        put(oo.AngularMotor, "axes", (Z, Z), **EULER),
        r"AngularMotor 'it'\.axes\[1\] is .*right angle",
    ),
    Row(
        "user angles in the Euler mode", put(oo.AngularMotor, "user_angle1", 0.5, **EULER), "AngularMotor 'it' .*euler"
    ),
    Row("four axes", new(oo.LinearMotor, axes=(X, Y, Z, X)), r"LinearMotor 'it'\.axes is .*at most 3"),
    Row("axes that are none", new(oo.LinearMotor, axes=7), r"LinearMotor 'it'\.axes is 7"),
    Row(
        "a zero axis of a motor",
        new(oo.LinearMotor, axes=(X, (0, 0, 0))),
        r"LinearMotor 'it'\.axes\[1\] is \(0, 0, 0\)",
    ),
    Row(
        "an axis of nobody",
        new(oo.AngularMotor, relative_to="body3"),
        r"AngularMotor 'it'\.relative_to\[0\] is 'body3'",
    ),
    Row(
        "carriers for other axes",
        new(oo.AngularMotor, relative_to=["body1"]),
        r"AngularMotor 'it'\.relative_to is \['body1'\]",
    ),
    Row(
        "an axis too many",
        put(oo.LinearMotor, "axes", (X, Y, Z), axes=(X,)),
        r"LinearMotor 'it'\.axes is .*1 directions, as before",
    ),
    Row("axes set to none", put(oo.LinearMotor, "axes", None, axes=(X,)), r"LinearMotor 'it'\.axes is None"),
    Row(
        "a motor about an axis that is not there",
        put(oo.LinearMotor, "motor_max_force2", 5.0, axes=(X,)),
        "LinearMotor 'it' has 1 axes",
    ),
    Row(
        "a stop about an axis that is not there",
        put(oo.AngularMotor, "stops3", (0, 1), axes=(X, Y)),
        "AngularMotor 'it' has 2 axes",
    ),
    Row("no such mode", new(oo.AngularMotor, mode="Euler"), r"AngularMotor 'it'\.mode is 'Euler'"),
    Row(
        "motor index 0",
        call(oo.Universal, "motor", 1.0, 5.0, axis=0),
        r"Universal 'it'\.motor\(\)\.axis is 0; it must be one of 1, 2",
    ),
    Row("motor index 3", call(oo.Universal, "motor", 1.0, 5.0, axis=3), r"Universal 'it'\.motor\(\)\.axis is 3"),
    Row(
        "no motor index", call(oo.PU, "motor", 1.0, 5.0), r"PU 'it'\.motor\(\)\.axis is None; it must be one of 1, 2, 3"
    ),
    Row(
        "a motor index too many",
        call(oo.Hinge, "motor", 1.0, 5.0, axis=1),
        r"Hinge 'it'\.motor\(\)\.axis is 1; it must not be given",
    ),
    Row("a word for a motor", call(oo.PU, "motor", 1.0, 5.0, axis="2"), r"PU 'it'\.motor\(\)\.axis is '2'"),
    Row(
        "a motor index beyond words", call(oo.PR, "motor", 1.0, 5.0, axis=10**5000), r"PR 'it'\.motor\(\)\.axis is int"
    ),
    Row("infinite motor velocity", put(oo.Hinge, "motor_velocity", INF), r"Hinge 'it'\.motor_velocity is inf"),
    Row(
        "infinite velocity of a third axis",
        put(oo.Plane2D, "motor_velocity3", -INF),
        r"Plane2D 'it'\.motor_velocity3 is -inf",
    ),
    Row("a force limit below 0", put(oo.Slider, "motor_max_force", -1.0), r"Slider 'it'\.motor_max_force is -1"),
    Row("a NaN force limit", put(oo.Hinge2, "motor_max_force2", NAN), r"Hinge2 'it'\.motor_max_force2 is nan"),
    Row("a fudge factor above 1", put(oo.Piston, "fudge_factor1", 1.5), r"Piston 'it'\.fudge_factor1 is 1\.5"),
    Row(
        "an endless motor at a stop",
        put(oo.Hinge, "motor_max_force", INF, stops=(0, 1)),
        r"Hinge 'it'\.motor_max_force is inf; with stops",
    ),
    Row(
        "an endless motor at a second stop",
        put(oo.PR, "stops2", (0, 1), motor_max_force2=INF),
        r"PR 'it'\.motor_max_force2 is inf; with stops2",
    ),
    # stops
    Row("the low stop above the high one", put(oo.Hinge, "stops", (1, 0)), r"Hinge 'it'\.stops is \(1, 0\)"),
    Row("a hinge's stop beyond pi", put(oo.Hinge, "stops", (0, 3.2)), r"Hinge 'it'\.stops is \(0, 3\.2\)"),
    Row("a cross's stop beyond pi", put(oo.Universal, "stops2", (-4, 0)), r"Universal 'it'\.stops2 is \(-4, 0\)"),
    Row("infinite stops", put(oo.PU, "stops3", (-INF, INF)), r"PU 'it'\.stops3 is \(-inf, inf\)"),
    Row("NaN stops", put(oo.AngularMotor, "stops1", (NAN, 1)), r"AngularMotor 'it'\.stops1 is \(nan, 1\)"),
    Row("a bounce above 1", put(oo.Hinge2, "stop_bounce1", 1.1), r"Hinge2 'it'\.stop_bounce1 is 1\.1"),
    Row(
        "stops of a wheel's own axis",
        put(oo.Hinge2, "stops2", (0, 1)),
        "Hinge2 'it' has no 'stops2'",
        oo.ParameterError,
    ),
    Row("stops of a plane", put(oo.Plane2D, "stops1", (0, 1)), "Plane2D 'it' has no 'stops1'", oo.ParameterError),
    # softness
    Row("NaN ERP", put(oo.Ball, "erp", NAN), r"Ball 'it'\.erp is nan"),
    Row("a CFM below 0", put(oo.Fixed, "cfm", -1e-9), r"Fixed 'it'\.cfm is -1e-09"),
    Row("a CFM of 0", put(oo.Hinge, "stop_cfm", 0.0), r"Hinge 'it'\.stop_cfm is 0"),
    Row("a suspension CFM of 0", put(oo.Hinge2, "suspension_cfm", 0.0), r"Hinge2 'it'\.suspension_cfm is 0"),
    Row("a spring that pushes", put(oo.DoubleBall, "stiffness", -5.0), r"DoubleBall 'it'\.stiffness is -5"),
    Row("a spring of nothing", put(oo.Hinge2, "suspension_stiffness", 0.0), "Hinge2 'it': suspension_stiffness and"),
    Row("a spring beside an ERP", put(oo.Ball, "stiffness", 10.0, erp=0.5), r"Ball 'it'\.erp is 0\.5 beside stiffness"),
    # rods
    Row("a distance below 0", put(oo.DoubleBall, "distance", -1.0), r"DoubleBall 'it'\.distance is -1"),
    Row("a NaN distance", put(oo.DoubleHinge, "distance", NAN), r"DoubleHinge 'it'\.distance is nan"),
    # transmissions
    Row("no such drive", gears(mode="gears"), r"Transmission 'it'\.mode is 'gears'"),
    Row("anchors at one place", gears(anchor2=(0, 0, 0)), r"Transmission 'it'\.anchor2 is .*beside anchor1"),
    Row(
        "anchors above each other",
        gears(anchor2=(0, 0, 2)),
        r"Transmission 'it'\.anchor2 is .*plane of the first wheel",
    ),
    Row("gears on axes that aren't parallel", gears(axis2=X), r"Transmission 'it'\.axis2 is .*that of axis1"),
    Row("bevel gears on parallel axes", gears(mode="intersecting"), r"Transmission 'it'\.axis2 is .*right angle to it"),
    Row(
        "a bevel gear without radius",
        gears(mode="intersecting", axis2=X, anchor2=(2, 0, 0)),
        r"Transmission 'it'\.anchor1 is|anchor2 is .*plane of the other wheel",
    ),
    Row("a ratio of 0", gears(ratio=0.0), r"Transmission 'it'\.ratio is 0"),
    Row("a ratio below 0", put(oo.Transmission, "ratio", -2.0, **GEARS), r"Transmission 'it'\.ratio is -2"),
    Row(
        "the ratio of a chain",
        put(oo.Transmission, "ratio", 2.0, **CHAIN),
        r"Transmission 'it'\.ratio is 2; only the mode 'parallel'",
    ),
    Row(
        "the radius of a gear",
        put(oo.Transmission, "radius1", 2.0, **GEARS),
        "Transmission 'it': the mode 'parallel' can't have radius1",
    ),
    Row("a chain without radii", gears(mode="chain"), "Transmission 'it': the mode 'chain' needs radius1"),
    Row(
        "a chain that loses a radius",
        put(oo.Transmission, "radius2", None, **CHAIN),
        "Transmission 'it': the mode 'chain' needs radius2",
    ),
    Row("a sprocket of radius 0", put(oo.Transmission, "radius2", 0.0, **CHAIN), r"Transmission 'it'\.radius2 is 0"),
    Row(
        "a sprocket within the other",
        put(oo.Transmission, "radius1", 9.0, **CHAIN),
        "Transmission 'it': radius1=9.0 and radius2=0.25 differ",
    ),
    Row(
        "a chain anchored anew too narrowly",
        call(oo.Transmission, "anchor_anew", fields=CHAIN, anchor2=(0.2, 0, 0)),
        "Transmission 'it': radius1=0.5 and radius2=0.25 differ",
    ),
    Row("negative backlash", put(oo.Transmission, "backlash", -1.0, **GEARS), r"Transmission 'it'\.backlash is -1"),
    # what a joint bears
    Row("a break force below 0", put(oo.Ball, "break_force", -1.0), r"Ball 'it'\.break_force is -1"),
    Row("a NaN break torque", put(oo.Fixed, "break_torque", NAN), r"Fixed 'it'\.break_torque is nan"),
    # servos
    Row("a servo of nonsense", put(oo.Hinge, "servo", 5.0), r"Hinge 'it'\.servo is 5\.0; it must be a Servo, or None"),
    Row(
        "a servo on what it can't drive",
        put(oo.Ball, "servo", oo.Servo()),
        "Ball 'it' has no 'servo'",
        oo.ParameterError,
    ),
    Row(
        "a motor beside a servo",
        put(oo.Hinge, "motor_velocity", 1.0, servo=oo.Servo),
        "Hinge 'it'.motor_velocity can't be set",
        oo.StateError,
    ),
    # pushes
    Row("a NaN torque", call(oo.Hinge, "add_torque", NAN), r"Hinge 'it'\.add_torque\(\)\.torque is nan"),
    Row("an infinite force", call(oo.Slider, "add_force", INF), r"Slider 'it'\.add_force\(\)\.force is inf"),
    Row(
        "a NaN second torque",
        call(oo.Universal, "add_torques", 0.0, NAN),
        r"Universal 'it'\.add_torques\(\)\.torque2 is nan",
    ),
    Row(
        "a NaN third torque",
        call(oo.AngularMotor, "add_torques", 0.0, 0.0, NAN),
        r"AngularMotor 'it'\.add_torques\(\)\.torque3 is nan",
    ),
    # anchors
    Row("a NaN anchor", new(oo.Ball, anchor=(NAN, 0, 0)), r"Ball 'it'\.anchor is \(nan, 0, 0\)"),
    Row("an anchor out of the world", put(oo.PU, "anchor", (2e8, 0, 0)), r"PU 'it'\.anchor is \(200000000\.0, 0, 0\)"),
    Row(
        "an anchor that the kind hasn't got",
        call(oo.Slider, "anchor_anew", anchor=(0, 0, 0)),
        "Slider 'it' has no 'anchor'",
        oo.ParameterError,
    ),
    Row(
        "an anchor of a motor",
        call(oo.LinearMotor, "anchor_anew", anchor=(0, 0, 0)),
        "LinearMotor 'it' has no 'anchor'",
        oo.ParameterError,
    ),
    Row(
        "contact points before the first step",
        lambda a, b, made: made(oo.Transmission, **GEARS).contact_points,
        r"Transmission 'it'\.contact_points",
        oo.StateError,
    ),
    Row(
        "a reaction that nobody asked for",
        lambda a, b, made: made(oo.Ball).reaction,
        r"Ball 'it'\.reaction needs feedback=True",
        oo.StateError,
    ),
]


@pytest.mark.parametrize("live", [True, False])
@pytest.mark.parametrize("row", ROWS, ids=str)
def test_a_misuse_is_an_error_that_changes_nothing(row, live):
    """It names the joint, what was wrong and the value; joints and bodies are as before, and the World steps on."""
    world = oo.World(gravity=(0, 0, 0))
    a, b = (oo.Body(name=name, position=at) for name, at in (("a", (0, 0, 0)), ("b", (1, 2, 0))))
    if live:
        world.attach(a)
        world.attach(b)
    joints = []

    def made(cls, **fields):
        fields = {name: value() if callable(value) else value for name, value in fields.items()}
        joints.append(cls(a, **fields, name="it") if cls is oo.Plane2D else cls(a, b, **fields, name="it"))
        return joints[0]

    def state():
        fields = [{name: field.own(joint) for name, field in joint.FIELDS.items()} for joint in joints]
        spots = [{name: getattr(joint, name) for name in joint.SPOTS} for joint in joints]
        return fields, spots, [getattr(joint, "axes", None) for joint in joints], a.pose, b.pose

    before = []
    act = row.act

    def remembered(cls, **fields):
        joint = made(cls, **fields)
        before.append(state())
        return joint

    with pytest.raises(row.error, match=row.words):
        act(a, b, remembered)
    if before:
        assert state() == before[0]
    assert a.joints == tuple(joints)
    assert oo.live_natives().joints == len(joints) * live
    world.step(2)
    assert np.isfinite(world.poses).all()


def test_a_body_of_another_world_is_waited_for():
    """ODE aborts on such a pair; here the joint isn't live until both are in one World."""
    one, other = oo.World(), oo.World()
    joint = oo.Hinge(one.attach(oo.Body()), other.attach(oo.Body()))
    assert not joint.is_live
    one.step()
    other.step()


def test_an_infinite_force_limit_is_fine():
    world = oo.World(gravity=(0, 0, 0), solver="exact")
    hinge = oo.Hinge(world.attach(oo.Body()), motor_velocity=2.0, motor_max_force=math.inf)
    world.step(3)
    assert hinge.angle_rate == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_a_spring_of_next_to_nothing_is_as_soft_as_can_be(solver):
    """1 / 5e-324 is infinite, which ODE would make NaN of; this lets the body fall freely."""
    world = oo.World(gravity=(0, -10, 0), solver=solver)
    body = world.attach(oo.Body())
    ball = oo.Ball(body, stiffness=5e-324)
    world.step(60)
    assert ball.cfm == pytest.approx(1e12)
    assert body.position.y == pytest.approx(-10 / 120**2 * 60 * 61 / 2, rel=1e-9)
    assert oo.Surface(damping=5e-324).row(0.01).soft_cfm == pytest.approx(1e12)


STOPPED = [(kind, name[5:]) for kind in KINDS for name in kind.cls.FIELDS if name.startswith("stops")]


@pytest.mark.parametrize("solver", ["quick", "exact"])
@pytest.mark.parametrize(("kind", "n"), STOPPED, ids=str)
def test_stops_taken_away_while_at_the_stop(kind, n, solver):
    """Driven into it, freed, driven on, many times, between stops moved past each other: every body stays finite."""
    held = Held(kind, kind.attached[0], way=0.0)
    held.world.solver = solver
    joint = held.joint
    setattr(joint, f"motor_max_force{n}", 200.0)
    for k in range(6):
        setattr(joint, f"motor_velocity{n}", 2.0 if k % 3 else -2.0)
        setattr(joint, f"stops{n}", (-0.01 * k, 0.02 * k))
        held.world.step(8)
        setattr(joint, f"stops{n}", None)
        held.world.step(2)
        setattr(joint, f"stops{n}", (0.3, 0.3))
        held.world.step(2)
    assert np.isfinite(held.world.poses).all()
    assert joint.is_live


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_feedback_outlives_whatever_was_joined(kind):
    """ODE writes into the joint's own memory: it comes, goes and is made again between steps."""
    held = Held(kind, kind.attached[0], fields={"feedback": True})
    joint = held.joint
    for watched in (True, False, True):
        joint.feedback = watched
        held.world.step()
        held.body1.fixed_mass = oo.Mass(3.0, oo.Vec3(0.1, 0.2, -0.1))
        held.world.step()
        held.body1.fixed_mass = None
        held.space.detach(held.body1)
        held.world.step()
        held.space.attach(held.body1)
        held.world.step()
    assert all(map(math.isfinite, joint.reaction.torque))
    joint.release()
    held.world.step()
    assert oo.live_natives().joints == 0
