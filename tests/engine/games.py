"""Small scenes that the tests play."""

import osgode as oo
from osgode.engine import Controllable, ControllableObject, Scene


class Tumble(Scene):
    """Boxes and balls that fall on one another and on the ground, with a controller among them."""

    def populate_world(self):
        self.static.attach(oo.Plane())
        for k in range(8):
            body = self.dynamic.attach(oo.Body(name=f"thing{k}", position=(0.2 * (k % 3), 0.6 + 0.8 * k, 0.1 * k)))
            body.attach(oo.Placeable()).attach(oo.Box((0.6, 0.4, 0.5)) if k % 2 else oo.Sphere(0.3))
        body.schedule(lambda node: node.add_force((3, 0, 0)) or True, 5)


def state(scene):
    """All bits of a scene's bodies, and of its time."""
    world = scene.world
    return (world.steps, world.poses.tobytes(), world.previous_poses.tobytes(), world.velocities.tobytes())


class Cart(ControllableObject):
    """Two bodies held by a joint, that notes what is done with it."""

    EYE = oo.Pose(oo.Vec3(0.0, 1.0, 0.0))

    def __init__(self, name="cart", **fields):
        super().__init__(name=name, **fields)
        self.hull = self.attach(oo.Body(name="hull"))
        self.hull.attach(oo.Placeable()).attach(oo.Box((1.0, 0.5, 2.0), mass=10.0))
        self.arm = self.attach(oo.Body(name="arm", position=(0.0, 0.5, -1.5)))
        self.arm.attach(oo.Placeable()).attach(oo.Box((0.2, 0.2, 1.0), mass=1.0))
        self.hinge = oo.Hinge(self.hull, self.arm, anchor=(0.0, 0.5, -1.0), axis=(1.0, 0.0, 0.0))
        self.controlled = []
        self.riders = []

    def control(self):
        self.controlled.append((self.world.steps, self.controls.moves))

    def boarded(self):
        self.riders.append("boarded")

    def left(self):
        super().left()
        self.riders.append("left")


class Narrow(Cart):
    """A cart that can't turn far."""

    def make_controls(self):
        return Controllable(yaw_limits=(-0.5, 0.5), pitch_limits=(-0.2, 0.2))


class Yard(Scene):
    """A cart without gravity at the origin, and a wall in front of it."""

    CART = Cart

    def populate_world(self):
        self.world.gravity = (0, 0, 0)
        self.cart = self.dynamic.attach(self.CART())
        self.camera.position = (0, 1, 6)
        self.camera.look_at((0, 0, 0))
