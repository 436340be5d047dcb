"""Ragdolls: where every limb is and how heavy, how far joints bend and which way, and that they hold together."""

import math
from pathlib import Path

import pytest

import osgode as oo
from osgode.assemblies import figure
from tests.assemblies.scenes import DOWN, empty, fastest, ground, snapshot, strayed

SIDED = ("upper arm", "forearm", "hand", "thigh", "shank", "foot")
PARTS = ["pelvis", "torso", "head", *(f"{side} {part}" for side in ("left", "right") for part in SIDED)]
JOINTS = [
    "waist",
    "neck",
    *(f"{side} {j}" for side in ("left", "right") for j in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")),
]
AWAY = oo.Pose(oo.Vec3(3, 2, -1), oo.Quat.from_axis_angle((1, 2, 0.5), 0.9))


def alone(**settings):
    """One in space, without gravity."""
    world, space = empty(gravity=(0, 0, 0))
    return world, oo.ragdoll(space, **{"tone": 0.0} | settings)


# -- what it is


def test_it_has_fifteen_parts_and_fourteen_joints():
    _, doll = alone()
    assert [body.name for body in doll.bodies] == PARTS
    assert list(doll.ranges) == JOINTS
    assert type(doll.top) is oo.SimpleSpace
    assert doll.top.children == doll.bodies
    kinds = {type(doll.joint(name)) for name in ("left knee", "right elbow")}
    assert kinds == {oo.Hinge}
    assert {type(doll.joint(name)) for name in ("left wrist", "right ankle")} == {oo.Universal}
    for name in ("waist", "neck", "left shoulder", "right hip"):
        assert type(doll.joint(name)) is oo.Ball
        assert type(doll.joint(f"{name} range")) is oo.AngularMotor


def test_the_masses_of_the_figure_add_up_to_one():
    middle = sum(segment.mass for segment in figure.MIDDLE.values())
    sides = sum(segment.mass for segment in figure.SIDES.values())
    assert middle + 2 * sides == pytest.approx(1.0, abs=1e-12)
    for segment in [*figure.MIDDLE.values(), *figure.SIDES.values()]:
        assert sum(solid.weight for solid in segment.solids) == pytest.approx(1.0)


@pytest.mark.parametrize("mass", [75.0, 20.0])
def test_the_parts_have_winters_masses(mass):
    """Of table 4.1 in Winter, by the part of the whole."""
    _, doll = alone(mass=mass)
    assert doll.mass == pytest.approx(mass)
    table = {"head": 0.081, "torso": 0.355, "pelvis": 0.142, "left hand": 0.006, "right forearm": 0.016}
    table |= {"left upper arm": 0.028, "right thigh": 0.100, "left shank": 0.0465, "right foot": 0.0145}
    for part, fraction in table.items():
        assert doll.body(part).mass == pytest.approx(fraction * mass)


@pytest.mark.parametrize("place", [oo.Pose(), AWAY], ids=["home", "away"])
@pytest.mark.parametrize("height", [1.8, 0.9])
def test_the_joints_are_where_the_proportions_say(place, height):
    """Heights of Drillis and Contini; the right side is at +X of a figure that looks along -Z."""
    _, doll = alone(height=height, position=place.position, rotation=place.rotation)
    table = {"right knee": (0.05, 0.285), "left knee": (-0.05, 0.285), "right hip": (0.05, 0.53)}
    table |= {"left ankle": (-0.05, 0.039), "right elbow": (0.129, 0.632), "left wrist": (-0.129, 0.486)}
    for name, (x, y) in table.items():
        assert doll.joint(name).anchor == pytest.approx(place.transform(oo.Vec3(x, y, 0) * height), abs=1e-9)
    for body in doll.bodies:
        assert body.centre_of_mass == pytest.approx((0, 0, 0), abs=1e-12)
        assert body.rotation == pytest.approx(place.rotation)
    assert place.inverse().transform(doll.centre_of_mass).x == pytest.approx(0.0, abs=1e-9)
    # The centre of mass of a standing man is at 0.55 to 0.57 of his height.
    assert place.inverse().transform(doll.centre_of_mass).y / height == pytest.approx(0.56, abs=0.02)


def test_it_is_as_tall_as_it_should_be_and_stands_on_its_soles():
    _, doll = alone(height=1.7)
    boxes = [geom.bounds for body in doll.bodies for geom in body.geoms]
    assert min(low.y for low, _ in boxes) == pytest.approx(0.0, abs=1e-9)
    assert max(high.y for _, high in boxes) == pytest.approx(1.7, abs=1e-9)


def test_left_and_right_are_mirror_images():
    _, doll = alone()
    for part in SIDED:
        left, right = doll.body(f"left {part}"), doll.body(f"right {part}")
        assert left.position == pytest.approx((-right.position.x, right.position.y, right.position.z))
        assert left.mass == right.mass


def test_the_feet_point_forward():
    _, doll = alone()
    assert doll.body("left foot").position.z < doll.body("left shank").position.z - 0.02


def test_standing_at_ease_nothing_touches():
    world, _ = alone()
    world.step()
    assert len(world.contacts) == 0


def test_at_the_start_all_angles_are_zero():
    _, doll = alone(position=AWAY.position, rotation=AWAY.rotation)
    for movements in doll.angles.values():
        assert list(movements.values()) == pytest.approx([0.0] * len(movements), abs=1e-9)
    assert doll.error < 1e-9


# -- which way the joints bend

BENDS = [
    # joint, movement, and where the middle of the part beyond it goes: (axis, sign) of the figure
    ("right shoulder", "flexion", "right upper arm", (2, -1)),
    ("left shoulder", "flexion", "left upper arm", (2, -1)),
    ("right shoulder", "abduction", "right upper arm", (0, 1)),
    ("left shoulder", "abduction", "left upper arm", (0, -1)),
    ("right elbow", "flexion", "right forearm", (2, -1)),
    ("right wrist", "flexion", "right hand", (0, -1)),
    ("left wrist", "flexion", "left hand", (0, 1)),
    ("left wrist", "deviation", "left hand", (2, -1)),
    ("right hip", "flexion", "right thigh", (2, -1)),
    ("left hip", "abduction", "left thigh", (0, -1)),
    ("right knee", "flexion", "right shank", (2, 1)),
    ("left knee", "flexion", "left shank", (2, 1)),
    ("right ankle", "flexion", "right foot", (1, 1)),
    ("waist", "flexion", "torso", (2, -1)),
    ("neck", "flexion", "head", (2, -1)),
]


@pytest.mark.parametrize(("joint", "movement", "part", "goes"), BENDS)
def test_positive_movements_go_the_way_of_their_names(joint, movement, part, goes):
    """The far part, turned by hand about the joint by 0.2 rad the named way, is read as +0.2 and no other movement."""
    _, doll = alone()
    near, far = doll.joint(joint).body2, doll.body(part)
    anchor = doll.joint(joint).anchor
    axis, sign = goes
    out = far.position - anchor
    way = [0.0, 0.0, 0.0]
    way[axis] = float(sign)
    about = out.cross(way).normalized()
    turn = oo.Quat.from_axis_angle(about, 0.2)
    for body in doll.bodies:
        body.kinematic = body is near
    far.position = anchor + turn.rotate(out)
    far.rotation = turn
    measured = doll.angles[joint]
    if joint.endswith(("ankle", "elbow")) or "knee" in joint or len(measured) > 1:
        # The middle of a foot, say, isn't straight below its joint: turning about a main axis is what is meant.
        assert abs(max(map(abs, about)) - 1) < 0.01
    assert measured.pop(movement) == pytest.approx(0.2, abs=1e-3)
    assert list(measured.values()) == pytest.approx([0.0] * len(measured), abs=5e-3)


@pytest.mark.parametrize("side", ["left", "right"])
def test_turning_inwards_is_positive_rotation(side):
    """About the limb's own axis, the front towards the middle: to the left for the right arm."""
    _, doll = alone()
    sign = 1.0 if side == "right" else -1.0
    for joint, part in (("shoulder", "upper arm"), ("hip", "thigh")):
        limb = doll.body(f"{side} {part}")
        limb.rotation = oo.Quat.from_axis_angle((0, sign, 0), 0.3)
        assert limb.vector_to_world((0, 0, -1)).x * sign < 0
        assert doll.angles[f"{side} {joint}"]["rotation"] == pytest.approx(0.3, abs=1e-9)


CASES = [(joint, movement) for joint in ("waist", "neck", "right shoulder", "left hip") for movement in range(3)]
CASES += [(joint, movement) for joint in ("left wrist", "right ankle") for movement in range(2)]
CASES += [("right elbow", 0), ("left knee", 0)]


@pytest.mark.parametrize(("joint", "which"), CASES)
@pytest.mark.parametrize("end", [0, 1], ids=["low", "high"])
def test_a_joint_that_is_turned_goes_to_its_stop_and_stays_there(joint, which, end):
    """Driven slowly by its own motor it gets to the stop, within a degree, and no farther."""
    world, doll = alone()
    movement = list(doll.ranges[joint])[which]
    stop = doll.ranges[joint][movement][end]
    axis = doll._axes[joint][movement]
    for other in doll.joints:
        if isinstance(other, oo.AngularMotor | oo.Hinge | oo.Universal) and other is not axis.joint:
            for name in other.FIELDS:
                if name.startswith("motor_max_force"):
                    setattr(other, name, 200.0)
    doll.joint(joint).body2.kinematic = True
    setattr(axis.joint, f"motor_velocity{axis.number}", math.copysign(1.0, stop or -1.0))
    setattr(axis.joint, f"motor_max_force{axis.number}", 20.0)
    world.stop_colliding(doll.parent)  # a leg would meet the other
    world.run(seconds=abs(stop) + 1.0)
    assert doll.angles[joint][movement] == pytest.approx(stop, abs=math.radians(1.5))


def test_the_ranges_are_those_of_the_figure():
    _, doll = alone()
    assert doll.ranges["left knee"] == {"flexion": pytest.approx((0.0, math.radians(135)))}
    assert doll.ranges["right hip"] == {
        "flexion": pytest.approx((math.radians(-30), math.radians(120))),
        "abduction": pytest.approx((math.radians(-30), math.radians(45))),
        "rotation": pytest.approx((math.radians(-45), math.radians(45))),
    }
    assert doll.joint("left knee").stops == doll.ranges["left knee"]["flexion"]


# -- falling


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_it_falls_stays_together_and_comes_to_rest(seed):
    """From standing: no joint opens by two centimetres, none bends more than a few degrees past its stops."""
    world, space = ground(step_size=1 / 480, iterations=50, seed=seed)
    doll = oo.ragdoll(space, rotation=oo.Quat.from_axis_angle((1, 0, 0.5), 0.1 * (seed - 1)))
    widest, farthest = 0.0, 0.0
    for _ in range(120 * 5):
        world.step(4)
        widest, farthest = max(widest, doll.error), max(farthest, strayed(doll))
    assert widest < 0.02
    assert farthest < 10.0
    assert strayed(doll) < 2.0
    assert doll.centre_of_mass.y < 0.35
    assert all(body.position.y > 0.0 for body in doll.bodies)
    world.run(seconds=3)
    assert fastest(doll) < 0.2


def test_thrown_it_tumbles_and_stays_together():
    world, space = ground(step_size=1 / 480, iterations=40)
    doll = oo.ragdoll(space, position=(0, 2, 0), rotation=oo.Quat.from_axis_angle((1, 0.4, 0), 2.0))
    for body in doll.bodies:
        body.linear_velocity = (3, 1, -2)
    start = doll.centre_of_mass
    world.run(seconds=0.2)
    assert doll.centre_of_mass == pytest.approx(start + oo.Vec3(0.6, 0.2 - DOWN * 0.02, -0.4), abs=0.01)
    worst = 0.0
    for _ in range(60):
        world.step(30)
        worst = max(worst, doll.error)
    assert worst < 0.02


def test_it_falls_asleep():
    world, space = ground(
        iterations=50, auto_disable=True, auto_disable_linear_threshold=0.1, auto_disable_angular_threshold=0.5
    )
    doll = oo.ragdoll(space)
    world.run(seconds=10)
    assert not any(body.enabled for body in doll.bodies)
    doll.wake()
    assert all(body.enabled for body in doll.bodies)


# -- limp and stiff


def test_tone_is_what_the_limb_weighs_at_its_joint():
    """The shank and foot beyond a knee: their weight times the way to their common centre."""
    _, doll = alone(tone=0.5)
    knee = doll.joint("left knee")
    shank, foot = doll.body("left shank"), doll.body("left foot")
    mass = shank.mass + foot.mass
    centre = (shank.position * shank.mass + foot.position * foot.mass) / mass
    assert knee.motor_max_force == pytest.approx(0.5 * mass * DOWN * centre.distance(knee.anchor))
    assert knee.motor_velocity == 0.0
    hip = doll.joint("left hip range")
    assert hip.motor_max_force1 == hip.motor_max_force2 == hip.motor_max_force3 > knee.motor_max_force
    doll.tone = 0.0
    assert doll.tone == 0.0
    assert knee.motor_max_force == hip.motor_max_force3 == 0.0


def test_a_stiff_arm_stays_out_and_a_limp_one_drops():
    """Lying on its back in the air, held by the torso: with a tone above 1 arms and legs stay straight out."""
    down = {}
    for tone in (0.0, 1.5):
        world, space = empty(solver="exact")
        doll = oo.ragdoll(space, rotation=oo.Quat.from_axis_angle((1, 0, 0), math.pi / 2), tone=tone)
        doll.body("torso").kinematic = True
        before = doll.body("left hand").position.y
        world.run(seconds=1)
        down[tone] = before - doll.body("left hand").position.y
    assert down[0.0] > 0.2
    assert abs(down[1.5]) < 0.01


@pytest.mark.parametrize("tone", [-0.1, math.nan, "stiff", None])
def test_a_bad_tone_is_refused(tone):
    _, doll = alone(tone=0.25)
    with pytest.raises(oo.FieldError, match=r"Ragdoll 'ragdoll'.tone is .*; it must be a number from 0 to 1e\+06"):
        doll.tone = tone
    assert doll.tone == 0.25


# -- coming and going


def test_it_moves_to_another_world_in_the_middle_of_its_fall():
    """Angles, velocities and joints go along; the fall ends there as it would have here."""
    ends = []
    for moves in (False, True):
        world, space = ground(step_size=1 / 240, iterations=40)
        other, elsewhere = ground(step_size=1 / 240, iterations=40)
        doll = oo.ragdoll(space)
        world.run(seconds=0.6)
        angles, velocity = doll.angles, doll.body("head").linear_velocity
        if moves:
            assert doll.move_to(elsewhere) is doll
            assert len(other.joints) == 20
            assert len(world.joints) == len(world.bodies) == 0
            world = other
            for joint, movements in doll.angles.items():
                assert movements == pytest.approx(angles[joint], abs=1e-6)
            assert doll.body("head").linear_velocity == pytest.approx(velocity)
        world.run(seconds=0.2)
        ends.append(doll.body("head").position)
    assert ends[0].distance(ends[1]) < 0.1


def test_a_crowd_in_one_world_and_one_of_them_leaves():
    world, space = ground()
    dolls = [oo.ragdoll(space, position=(x, 0, 0), name=f"doll {x}") for x in range(4)]
    world.run(seconds=1)
    assert len(world.bodies) == 60
    dolls[1].detach()
    assert not dolls[1].is_live
    assert len(world.bodies) == 45
    assert len(world.joints) == 60
    world.run(seconds=0.5)
    assert all(doll.error < 0.05 for doll in dolls)


def test_built_outside_of_a_world_it_lives_later():
    space = oo.HashSpace()
    doll = oo.ragdoll(space, tone=0.3)
    with pytest.raises(oo.StateError):
        _ = doll.angles
    world = oo.World()
    world.attach(space)
    assert doll.is_live
    assert doll.joint("left knee").motor_max_force > 0
    assert doll.angles["left knee"]["flexion"] == pytest.approx(0.0, abs=1e-9)
    assert world.bodies == doll.bodies


# -- looks


def test_it_wears_what_it_is_told():
    _, space = empty()
    green = oo.Appearance((0.1, 0.6, 0.2, 1.0))
    doll = oo.ragdoll(space, looks={"shirt": green}, material="rubber")
    assert {geom.appearance for geom in doll.body("torso").geoms} == {green}
    assert doll.body("left upper arm").geoms[0].appearance is green
    assert doll.body("head").geoms[0].appearance is not green
    assert {geom.material for body in doll.bodies for geom in body.geoms} == {"rubber"}


WRONG = [
    ({"height": 0.0}, r"ragdoll\(\).height is 0.0"),
    ({"height": "tall"}, r"ragdoll\(\).height is 'tall'"),
    ({"mass": -1.0}, r"ragdoll\(\).mass is -1.0"),
    ({"position": (0, 0)}, r"ragdoll\(\).position is \(0, 0\)"),
    ({"rotation": (0, 0, 0, 0)}, r"ragdoll\(\).rotation is \(0, 0, 0, 0\)"),
    ({"tone": -0.5}, "tone is -0.5"),
    ({"tone": 0.5, "mass": 1e12}, "tone is 0.5; it must be a number from 0 to 0"),
    ({"looks": {"hat": oo.Appearance()}}, r"ragdoll\(\).looks has 'hat': .*'skin', 'shirt', 'trousers', 'shoes'"),
    ({"looks": {"skin": "green"}}, r"ragdoll\(\).looks has 'skin': 'green'"),
    ({"material": "cheese"}, "material is 'cheese'"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG, ids=lambda value: value if isinstance(value, str) else "")
def test_bad_arguments_of_ragdolls_are_refused_and_nothing_is_changed(arguments, message):
    _, space = empty()
    before = snapshot(space)
    with pytest.raises(oo.FieldError, match=message):
        oo.ragdoll(space, **arguments)
    assert snapshot(space) == before


def test_a_ragdoll_needs_a_space_or_a_world():
    with pytest.raises(oo.TreeError, match=r"ragdoll\(\).parent is <Group>"):
        oo.ragdoll(oo.Group())


def test_the_page_tells_the_ranges():
    """The table of docs/assemblies.md, row by row."""
    page = (Path(__file__).parents[2] / "docs" / "assemblies.md").read_text()
    for name, link in (figure.MIDDLE_LINKS | figure.SIDE_LINKS).items():
        told = [
            f"{each.name} {each.high:g}" if each.low == -each.high else f"{each.name} {each.low:g} to {each.high:g}"
            for each in link.movements
        ]
        kind = {1: "hinge", 2: "universal", 3: "ball and motor"}[len(told)]
        assert f"| {name} | {kind} | {', '.join(told)} |" in page
