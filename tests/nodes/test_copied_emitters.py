"""What hangs below a body that is copied: shared where it can be, made anew where it can't."""

import osgode as oo


def test_a_copied_body_smokes_by_itself():
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    rocket = space.attach(oo.Body(position=(0, 5, 0)))
    smoke = rocket.attach(oo.Particles(oo.SMOKE, rate=10, velocity=(0, 0, 0), radius=0, name="smoke"))
    model = rocket.attach(oo.Leaf([oo.box_drawable((1, 1, 1))], name="model"))
    twin = rocket.copy()
    twin.position = (9, 5, 0)
    space.attach(twin)
    other = twin.find("smoke")
    assert isinstance(other, oo.Particles)
    assert other is not smoke
    assert twin.find("model") is model
    for emitter, x in ((smoke, 0), (other, 9)):
        emitter.advance(0.1)
        assert emitter.positions.round(6).tolist() == [[x, 5, 0]]
