"""Worlds for cars: level ground, or the track."""

import math

import osgode as oo
from osgode.examples.game.car import Car
from osgode.examples.game.track import Track

G = 9.81
STEP = 1 / 120


def empty_world():
    """A World with a space of what moves and one of what stands, level ground in it."""
    world = oo.World(step_size=STEP)
    moving, still = world.attach(oo.HashSpace()), world.attach(oo.SimpleSpace())
    world.collide(moving)
    world.collide(moving, still)
    still.attach(oo.Plane(material="concrete"))
    return world, moving, still


def with_car(position=(0.0, 0.0, 0.0), yaw=0.0, **options):
    """A World with a car on level ground."""
    world, moving, still = empty_world()
    return world, moving.attach(Car(position, yaw, **options)), still


def on_track(where, **placed):
    """A World with the track, and a car at the place and the yaw that ``where(track)`` tells."""
    world, moving, still = empty_world()
    track = still.attach(Track(**placed))
    return world, moving.attach(Car(*where(track))), track


def slope(world, degrees, *, across=False):
    """Make the ground a slope, by leaning gravity: up along -Z, or up along +X."""
    down, along = G * math.cos(math.radians(degrees)), G * math.sin(math.radians(degrees))
    world.gravity = (-along, -down, 0.0) if across else (0.0, -down, along)


def up(car):
    """How upright it is: 1 upright, 0 on its side."""
    return car.hull.vector_to_world((0, 1, 0)).y
