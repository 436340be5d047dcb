"""Weapons in general: picked up, held, switched, put away."""

import math

import pytest

import osgode as oo
from osgode.examples.game.flail import Flail
from osgode.examples.game.gun import ConstructorGun
from osgode.examples.game.rocket import RocketLauncher
from osgode.examples.game.weapon import AGAIN, LOOK_EVERY, RECOIL_TIME, TOUCH, Weapon
from tests.examples.game.bearer import AHEAD, EYE, Range

KINDS = (ConstructorGun, RocketLauncher, Flail)


def natives_of(weapon):
    """What it has in ODE: bodies, geoms, spaces; and joints among its bodies."""
    own = set(map(id, weapon.bodies))
    inner = [joint for joint in weapon.joints if joint.body2 is not None and {id(joint.body1), id(joint.body2)} <= own]
    return len(weapon.bodies), len(weapon.geoms), 1, len(inner)


def counts():
    live = oo.live_natives()
    return live.bodies, live.geoms, live.spaces, live.joints


def test_a_weapon_lies_about_until_somebody_comes_near():
    scene = Range()
    gun = scene.moving.attach(ConstructorGun((3.0, 0.3, 0.0)))
    scene.world.run(seconds=1.0)
    assert gun.hand is None
    assert not gun.held
    assert not gun.stowed
    lying = gun.main_body.position
    assert lying.y < 0.3
    scene.bearer.hand.position = lying + oo.Vec3(TOUCH + 0.3, 0.0, 0.0)
    scene.world.step(2 * LOOK_EVERY)
    assert gun.hand is None
    # Half of the hand's width from its middle, so it is within reach by 4 cm.
    scene.bearer.hand.position = lying + oo.Vec3(TOUCH + 0.01, 0.0, 0.0)
    scene.world.step(LOOK_EVERY)
    assert gun.held
    assert gun.hand is scene.bearer.hand
    assert gun.carrier is scene.bearer
    assert scene.bearer.arsenal.in_hand is gun


def test_only_who_picks_up_gets_a_weapon():
    scene = Range(bearer=False)
    gun = scene.moving.attach(ConstructorGun((0.0, 0.1, 0.0)))
    crate = scene.crate((0.0, 0.8, 0.0), kind="player")
    scene.world.run(seconds=1.0)
    assert gun.main_body.position.distance(crate.position) < TOUCH
    assert gun.hand is None


@pytest.mark.parametrize("kind", KINDS)
def test_the_grip_is_in_the_hand_and_the_weapon_follows_its_pose(kind):
    """While the hand turns and moves about: the grip stays within 1 cm, the direction within 3 degrees."""
    scene = Range(iterations=50)
    weapon = scene.give(kind((0.0, 0.5, 2.0)))
    hand, world = scene.bearer.hand, scene.world
    furthest = widest = 0.0
    for k in range(360):
        t = k * world.step_size
        turn = oo.Quat.from_yaw_pitch_roll(1.2 * math.sin(1.5 * t), 0.5 * math.sin(2.0 * t))
        hand.glide_to((0.25 + 0.2 * math.sin(2 * t), 1.4, -0.4 * math.cos(t)), turn)
        world.step()
        grip = weapon.main_body.local_to_world(weapon.GRIP.position)
        furthest = max(furthest, grip.distance(hand.local_to_world((0.0, 0.0, -0.2))))
        widest = max(widest, (hand.rotation.conjugate() * weapon.main_body.rotation).angle)
    assert furthest < 0.01
    assert 0.0 < widest < math.radians(3.0)


def test_the_three_are_switched_and_only_one_is_in_the_simulation():
    scene = Range()
    before = counts()
    weapons = {}
    for kind in KINDS:
        weapon = kind((0.0, 0.5, 2.0))
        weapons[kind.SLOT] = (weapon, natives_of(weapon))
        scene.give(weapon)
    assert sorted(weapons) == [1, 2, 3]
    arsenal = scene.bearer.arsenal
    assert list(arsenal.weapons) == [1, 2, 3]
    for slot in (1, 3, 2, 2, 1):
        assert arsenal.switch(slot)
        for other, (weapon, natives) in weapons.items():
            assert weapon.held is (other == slot)
            assert weapon.stowed is (other != slot)
            assert weapon.in_simulation is (other == slot)
            if weapon.stowed:
                assert not any(body.is_live for body in weapon.bodies)
                assert not any(geom.is_live for geom in weapon.geoms)
                assert not any(joint.is_live for joint in weapon.joints)
                assert weapon.world is None
                assert weapon.parent is None
            else:
                bodies, geoms, spaces, joints = natives
                held = (bodies, geoms, spaces, joints + 2)  # and the ball joint and the motor
                assert tuple(now - then for now, then in zip(counts(), before, strict=True)) == held
        scene.world.step(5)
    assert not arsenal.switch(7)
    assert arsenal.in_hand is weapons[1][0]


def test_next_goes_round_and_put_away_empties_the_hand():
    scene = Range()
    before = counts()
    assert not scene.bearer.arsenal.next()
    for kind in KINDS:
        scene.give(kind((0.0, 0.5, 2.0)))
    arsenal = scene.bearer.arsenal
    order = [arsenal.in_hand.SLOT]
    for step in (1, 1, 1, -1):
        assert arsenal.next(step)
        order.append(arsenal.in_hand.SLOT)
    assert order == [3, 1, 2, 3, 2]
    arsenal.put_away()
    assert arsenal.in_hand is None
    assert counts() == before
    arsenal.take_out()
    assert arsenal.in_hand.SLOT == 2


def test_a_stowed_weapon_comes_back_where_the_hand_is_and_as_fast():
    scene = Range(iterations=50)
    gun = scene.give(Flail((0.0, 0.5, 2.0)))
    gun.stow()
    hand = scene.bearer.hand
    hand.position, hand.rotation = (5.0, 1.5, 3.0), oo.Quat.from_yaw_pitch_roll(1.0, 0.2)
    hand.linear_velocity = (2.0, 0.0, 0.0)
    gun.draw()
    grip = gun.main_body.local_to_world(gun.GRIP.position)
    assert grip.distance(hand.local_to_world((0.0, 0.0, -0.2))) < 1e-9
    assert all(body.linear_velocity.distance((2.0, 0.0, 0.0)) < 1e-9 for body in gun.bodies)
    assert gun.stretch < 1e-9


def test_a_second_weapon_of_a_slot_is_left_and_a_dropped_one_can_be_taken_again():
    scene = Range()
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    other = scene.moving.attach(ConstructorGun((0.0, 0.5, 3.0), name="other"))
    assert not scene.bearer.arsenal.pick_up(other)
    assert other.hand is None
    assert scene.bearer.arsenal.drop() is gun
    assert scene.bearer.arsenal.weapons == {}
    assert gun.hand is None
    assert gun.in_simulation
    assert not gun.joints
    scene.world.run(seconds=AGAIN - 0.2)
    assert gun.main_body.position.y < 0.3
    scene.bearer.hand.position = gun.main_body.position + oo.Vec3(0.0, 0.3, 0.0)
    scene.world.run(seconds=0.1)
    assert gun.hand is None
    scene.world.run(seconds=0.2)
    assert gun.held
    assert not scene.bearer.arsenal.pick_up(gun)  # nor twice


def test_a_stowed_weapon_that_is_dropped_falls_from_the_hand():
    scene = Range()
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    gun.stow()
    gun.drop()
    assert gun.in_simulation
    assert gun.hand is None
    assert (
        gun.main_body.local_to_world(gun.GRIP.position).distance(scene.bearer.hand.local_to_world((0, 0, -0.2))) < 1e-9
    )
    assert scene.bearer.arsenal.in_hand is None


def test_a_weapon_whose_hand_is_gone_falls():
    scene = Range()
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    scene.moving.detach(scene.bearer)
    scene.world.run(seconds=1.0)
    assert gun.hand is None
    assert not gun.held
    assert gun.main_body.position.y < 0.3
    assert scene.bearer.arsenal.in_hand is None


def test_what_is_not_possible_is_refused():
    scene = Range()
    gun = scene.moving.attach(ConstructorGun((0.0, 0.5, 2.0)))
    with pytest.raises(oo.StateError, match="nobody has it"):
        gun.stow()
    with pytest.raises(oo.StateError, match="no hand"):
        gun.draw()
    with pytest.raises(oo.StateError, match="not in the same World"):
        gun.hold(oo.Body(name="ghost"))
    gun.hold(scene.bearer.hand)
    with pytest.raises(oo.StateError, match="has it already"):
        gun.hold(scene.bearer.hand)
    gun.stow()
    with pytest.raises(oo.StateError, match="in no World"):
        gun.recoil((0.0, 0.0, 1.0))
    with pytest.raises(oo.StateError, match="in no World"):
        gun.target((EYE, AHEAD))
    scene.moving.detach(scene.bearer)
    with pytest.raises(oo.StateError, match="no hand"):
        gun.draw()


def test_recoil_moves_the_hand_by_its_momentum():
    """Hand and weapon float: what they have in the end is the impulse, and nothing is lost on the way."""
    scene = Range(ground=False, kinematic=False, gravity=(0, 0, 0))
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    gun.recoil((3.0, 0.0, 40.0))
    gun.recoil((0.0, 0.0, 10.0))
    scene.world.step()  # it is told after a step
    assert scene.bearer.hand.linear_velocity.length == 0.0
    scene.world.step(round(RECOIL_TIME / scene.world.step_size))
    momentum = scene.bearer.hand.momentum + gun.main_body.momentum
    assert momentum.distance((3.0, 0.0, 50.0)) < 0.01
    assert scene.bearer.hand.linear_velocity.z > 2.0
    scene.world.run(seconds=0.5)
    assert (scene.bearer.hand.momentum + gun.main_body.momentum).distance((3.0, 0.0, 50.0)) < 0.01


class Counter(Weapon):
    """Notes what it is told."""

    SLOT = 9
    FULL_CHARGE = 1.0

    def __init__(self):
        super().__init__(name="counter")
        self.fired = []
        self.attach(oo.Body(position=(0.0, 0.5, 2.0))).attach(oo.Placeable()).attach(oo.Box((0.1, 0.1, 0.1), mass=1.0))

    def fire(self, button, charge, aim):
        self.fired.append((button, charge, aim))


def test_charge_is_counted_in_steps():
    scene = Range()
    weapon = Counter()
    scene.moving.attach(weapon)
    aim = (EYE, AHEAD)
    weapon.press("left")  # nobody holds it
    weapon.release("left", aim)
    scene.bearer.arsenal.pick_up(weapon)
    arsenal = scene.bearer.arsenal
    arsenal.release("left", aim)  # nobody pressed it
    assert weapon.fired == []
    arsenal.press("left")
    scene.world.step(30)
    arsenal.press("right")
    assert weapon.charging
    scene.world.step(30)
    assert weapon.charge("left") == pytest.approx(60 / 120)
    arsenal.release("right", aim)
    scene.world.step(90)
    arsenal.release("left", aim)
    arsenal.press("left")
    arsenal.release("left", aim)
    assert [(button, round(charge, 9)) for button, charge, _ in weapon.fired] == [
        ("right", 0.25),
        ("left", 1.0),
        ("left", round(1 / 120, 9)),
    ]
    arsenal.press("left")
    arsenal.put_away()
    assert not weapon.charging
    arsenal.release("left", aim)
    assert len(weapon.fired) == 3


def test_a_weapon_found_while_another_is_charged_is_put_away_at_once():
    scene = Range()
    weapon = Counter()
    scene.give(weapon)
    weapon.press("left")
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    assert weapon.held
    assert weapon.charging
    assert gun.stowed


def test_held_weapons_pass_through_whoever_holds_them_and_nothing_else():
    scene = Range(gravity=(0, 0, 0))
    torso = scene.bearer.attach(oo.Body(name="torso", position=(0.25, 1.5, -0.9), kinematic=True))
    torso.attach(oo.Placeable()).attach(oo.Box((0.3, 0.3, 0.3), kind="player"))
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    scene.world.run(seconds=0.3)
    assert gun.main_body.linear_velocity.length < 1e-3
    crate = scene.crate((0.25, 1.5, -0.9), mass=1.0)
    scene.world.run(seconds=0.3)
    assert crate.linear_velocity.length > 0.1


def test_the_target_is_what_the_aiming_ray_meets():
    scene = Range()
    gun = scene.give(ConstructorGun((0.0, 0.5, 2.0)))
    scene.fixed.attach(oo.Placeable(position=(0, 2, -20))).attach(oo.Box((10, 4, 1)))
    assert gun.target((EYE, AHEAD)).distance((0.0, 1.6, -19.5)) < 1e-9
    assert gun.target((EYE, oo.Vec3(0.0, 2.0, 0.0))).distance((0.0, 1001.6, 0.0)) < 1e-6
    in_the_way = scene.bearer.hand.position
    assert gun.target((EYE, in_the_way - EYE)).z < -2.0  # through hand and gun
