"""A scene to try weapons in: level ground, and somebody with a hand."""

import osgode as oo
from osgode.engine import ControllableObject
from osgode.examples.game.arsenal import Arsenal

EYE = oo.Vec3(0.0, 1.6, 0.0)
AHEAD = oo.Vec3(0.0, 0.0, -1.0)


class Bearer(ControllableObject):
    """A stand-in for the player: a hand that nothing can move, or one that floats, and an arsenal."""

    def __init__(self, position=(0.25, 1.4, -0.4), *, kinematic=True):
        super().__init__(name="bearer")
        self.hand = self.attach(oo.Body(name="hand", position=position, kinematic=kinematic, gravity=False))
        self.hand.attach(oo.Placeable()).attach(oo.Box((0.1, 0.1, 0.3), kind="player", mass=6.0))
        self.arsenal = Arsenal(self.hand, (0.0, 0.0, -0.2))

    def pick_up(self, weapon):
        self.arsenal.pick_up(weapon)


class Range:
    """A World with a space for what moves, one for what doesn't, and a bearer."""

    def __init__(self, *, ground=True, bearer=True, kinematic=True, **settings):
        self.world = oo.World(**settings)
        self.moving, self.fixed = self.world.attach(oo.HashSpace()), self.world.attach(oo.SimpleSpace())
        self.world.collide(self.moving)
        self.world.collide(self.moving, self.fixed)
        if ground:
            self.fixed.attach(oo.Plane(material="concrete"))
        self.bearer = self.moving.attach(Bearer(kinematic=kinematic)) if bearer else None

    def give(self, weapon):
        """Have the bearer hold a weapon, at rest."""
        self.moving.attach(weapon)
        assert self.bearer.arsenal.pick_up(weapon)
        return weapon

    def shoot(self, weapon, button="left", charge=1.0, aim=(EYE, AHEAD)):
        """Press, wait, release."""
        weapon.press(button)
        self.world.step(max(round(charge * weapon.FULL_CHARGE / self.world.step_size), 1))
        weapon.release(button, aim)

    def crate(self, position, size=0.5, mass=10.0, **fields):
        body = self.moving.attach(oo.Body(position=position))
        body.attach(oo.Placeable()).attach(oo.Box((size,) * 3, mass=mass, material="wood", **fields))
        return body
