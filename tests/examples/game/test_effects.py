"""Smoke and sparks: they outlive what they come from, and not by much."""

import osgode as oo
from osgode.examples.game.effects import LINGER, burst, leave_behind, trail
from osgode.examples.game.explosion import BURSTS, Explosion
from osgode.examples.game.rocket import Rocket
from tests.examples.game.bearer import Range


def emitters(scene):
    return [node for node in scene.moving.walk() if isinstance(node, oo.Particles)]


def update(scene):
    oo.UpdateVisitor(scene.world).update()


def test_a_burst_is_there_at_once_and_its_emitter_goes_when_it_is_over():
    scene = Range(bearer=False)
    burst(scene.moving, (1.0, 2.0, 3.0), oo.SPARKS, 50)
    (emitter,) = emitters(scene)
    assert len(emitter) == 50
    assert abs(emitter.positions - (1.0, 2.0, 3.0)).max() < 0.5
    scene.world.run(seconds=0.1)
    update(scene)
    assert abs(emitter.positions - (1.0, 2.0, 3.0)).max() > 0.1
    scene.world.run(seconds=LINGER)
    assert emitters(scene) == []
    assert len(scene.moving.children) == 0


def test_a_trail_stays_where_it_came_out_when_its_body_is_gone():
    scene = Range(bearer=False, ground=False, gravity=(0, 0, 0))
    body = scene.moving.attach(oo.Body(linear_velocity=(0, 0, -10.0)))
    smoke = trail(body, (0.0, 0.0, 1.0), oo.SMOKE, 100.0)
    for _ in range(10):
        scene.world.step(6)
        update(scene)
    assert 40 <= len(smoke) <= 51  # of half a second
    assert smoke.positions[:, 2].max() - smoke.positions[:, 2].min() > 3.0
    leave_behind(smoke, scene.moving)
    scene.moving.detach(body)
    before = len(smoke)
    scene.world.step(12)
    update(scene)
    assert emitters(scene) == [smoke]
    assert 0 < len(smoke) <= before
    scene.world.run(seconds=LINGER)
    assert emitters(scene) == []


def test_explosions_and_rockets_have_smoke_and_leave_nothing():
    scene = Range(bearer=False)
    scene.moving.attach(Explosion((0.0, 3.0, 0.0)))
    assert [len(emitter) for emitter in emitters(scene)] == [count for _, count in BURSTS]
    rocket = scene.moving.attach(Rocket((0.0, 0.4, 10.0), oo.Quat.from_yaw_pitch_roll(0.0, -0.1)))
    assert len(emitters(scene)) == len(BURSTS) + 1
    scene.world.run(seconds=1.5)
    assert rocket.explosion is not None
    assert len(emitters(scene)) == 2 * len(BURSTS) + 1
    scene.world.run(seconds=LINGER + 1.0)
    assert len(scene.moving.children) == 0


def test_effects_change_nothing_of_the_simulation():
    """Whether pictures are updated or not."""
    ends = []
    for drawn in (False, True):
        scene = Range(bearer=False)
        crate = scene.crate((1.0, 0.25, 0.0))
        scene.moving.attach(Explosion((0.0, 0.2, 0.0)))
        for _ in range(60):
            scene.world.step()
            if drawn:
                update(scene)
        ends.append((crate.position, crate.rotation))
    assert ends[0] == ends[1]
