"""Scenes with something fast in them."""

import osgode as oo

H = 1 / 120


def scene(**world_settings):
    """A World without gravity, its space for what moves and its space for what stands."""
    world = oo.World(gravity=(0, 0, 0), step_size=H, **world_settings)
    moving, fixed = world.attach(oo.HashSpace(name="moving")), world.attach(oo.SimpleSpace(name="fixed"))
    world.collide(moving)
    world.collide(moving, fixed)
    return world, moving, fixed


def still(fixed, geom, position=(0, 0, 0), rotation=(1, 0, 0, 0)):
    return fixed.attach(oo.Placeable(position=position, rotation=rotation)).attach(geom)


def shot(moving, geom, position, velocity, mode="sweep", **fields):
    body = moving.attach(oo.Body(name="shot", position=position, linear_velocity=velocity, tunnelling=mode, **fields))
    body.attach(oo.Placeable()).attach(geom)
    return body


def ball(moving, position, velocity, mode="sweep", radius=0.1, **fields):
    return shot(moving, oo.Sphere(radius, mass=1.0), position, velocity, mode, **fields)


def wall(fixed, surface=None, thick=0.02):
    """A wall whose front is at z = 0, which looks along +Z."""
    return still(fixed, oo.Box((80, 80, thick), surface=surface), (0, 0, -thick / 2))
