"""Worlds in which assemblies are built, and what is measured on them."""

import math

import osgode as oo

DOWN = 9.81


def ground(**settings):
    """A World with a space for what moves, on a plane of concrete."""
    world = oo.World(**settings)
    moving, fixed = world.attach(oo.HashSpace(name="moving")), world.attach(oo.SimpleSpace(name="fixed"))
    fixed.attach(oo.Plane(material="concrete"))
    world.collide(moving)
    world.collide(moving, fixed)
    return world, moving


def empty(**settings):
    """A World with a space for what moves, and nothing else."""
    world = oo.World(**settings)
    moving = world.attach(oo.HashSpace(name="moving"))
    world.collide(moving)
    return world, moving


def fastest(assembly):
    return max(body.linear_velocity.length for body in assembly.bodies)


def strayed(doll):
    """How far the worst joint is past its stops, degrees."""
    return math.degrees(
        max(
            max(doll.ranges[joint][movement][0] - angle, angle - doll.ranges[joint][movement][1])
            for joint, movements in doll.angles.items()
            for movement, angle in movements.items()
        )
    )


def snapshot(*spaces):
    """What must be unchanged after a failed call: the tree, and the joints of every body in it."""
    nodes = [node for space in spaces for node in space.walk()]
    return [(id(node), tuple(map(id, getattr(node, "joints", ())))) for node in nodes]
