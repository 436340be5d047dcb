"""Frames to draw, made by hand: no nodes and no visitors are needed to test a renderer."""

import math
from dataclasses import replace

import numpy as np

from osgode.graph.appearance import Appearance, Texture
from osgode.graph.frame import Bin, Frame, Light, Rectangle, Sky, Sprites, Sun, Text, View
from osgode.graph.mesh import Mesh
from osgode.graph.primitives import box_mesh, sphere_mesh
from osgode.maths import Pose, Quat, Vec3, look_at

SIZE = (160, 100)
CLEAR = Sky(haze=None)
"""Air that leaves colours alone."""
RED, GREEN, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)


def quad(*, width=2.0, height=2.0):
    """A rectangle about the origin that faces +Z."""
    x, y = width / 2, height / 2
    return Mesh(
        np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
        uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]]),
    )


def place(position=(0.0, 0.0, 0.0), rotation=Quat(1, 0, 0, 0), scale=(1.0, 1.0, 1.0)):
    """A 4x4 matrix."""
    matrix = Pose(Vec3(*position), rotation).matrix()
    matrix[:3, :3] *= scale
    return matrix


def many(mesh, appearance, *matrices):
    """A bin."""
    return Bin(mesh, appearance, np.array(matrices, np.float32))


def unlit(colour, texture=None):
    """An appearance that shows its colour as it is."""
    return Appearance(colour, texture, unlit=True)


def blocks(*rows, size=8):
    """A texture of plain blocks, ``rows`` giving their colours from the top."""
    return Texture(np.kron(np.array(rows), np.ones((size, size, 1))).astype(np.uint8), repeat=False)


def noise(seed, colour, spread):
    """A texture of random blocks about a colour."""
    steps = np.random.default_rng(seed).integers(-spread, spread + 1, (16, 16, 1))
    return Texture(np.kron(np.clip(np.array(colour) + steps, 0, 255), np.ones((8, 8, 1))).astype(np.uint8))


def yard():
    """A little of everything: textured ground and crate, balls, a shadow, glass, haze, overlay."""
    ground = Appearance(texture=noise(1, (140, 150, 110), 20), colour=(1, 1, 1), shininess=0.0)
    crate = Appearance(texture=noise(2, (170, 120, 70), 40), colour=(1, 1, 1))
    box, ball = box_mesh(), sphere_mesh()
    flat = quad(width=60, height=60)
    tiled = Mesh(flat.vertices, flat.triangles, flat.normals, flat.uvs * 10)
    turned = Quat.from_axis_angle((0, 1, 0), 0.5)
    things = [
        many(box, crate, place((-1.2, 0.5, 0), turned), place((-0.9, 1.35, 0.1), scale=(0.7, 0.7, 0.7))),
        many(box, Appearance((0.8, 0.2, 0.15)), place((1.6, 0.15, -1), turned, (3, 0.3, 0.6))),
        many(ball, Appearance((0.8, 0.8, 0.85), shininess=1.0), place((0.7, 0.7, 1.1), scale=(0.7, 0.7, 0.7))),
        many(ball, Appearance((0.2, 0.4, 0.8)), place((2.0, 1.0, -1), scale=(0.7, 1.4, 0.7))),
    ]
    return Frame(
        View(look_at((1.4, 2.0, 4.4), (0.6, 0.7, 0))),
        SIZE,
        opaque=[many(tiled, ground, place(rotation=Quat.from_axis_angle((1, 0, 0), -math.pi / 2))), *things],
        transparent=[many(quad(), Appearance((0.4, 0.8, 0.9, 0.4)), place((-0.4, 0.8, 1.2), scale=(0.7, 0.7, 1)))],
        casters=things,
        overlay=[Rectangle(4, 4, 62, 20), Text(8, 6, "12 m/s", 14, (1, 0.9, 0.4, 1))],
        sun=Sun(direction=Vec3(0.6, -0.8, 0.3)),
        sky=Sky(haze=60.0),
    )


def night():
    """The same by the light of a lamp and a headlight, with smoke and sparks."""
    dice = np.random.default_rng(3)
    puffs, sparks = np.zeros((30, 12), np.float32), np.zeros((120, 12), np.float32)
    puffs[:, :3] = np.array([0.2, 1.7, -0.4]) + dice.normal(0, 0.25, (30, 3))
    puffs[:, 3:8] = (0.35, 1.0, 1.0, 1.0, 0.4)
    ways = dice.normal(0, 1, (120, 3))
    sparks[:, :3] = (1.6, 0.8, -1) + 0.5 * ways
    sparks[:, 3:8] = (0.04, 1.0, 0.8, 0.3, 1.0)
    sparks[:, 8:11] = 0.2 * ways
    return replace(
        yard(),
        sun=Sun(Vec3(0.6, -0.8, 0.3), (0.08, 0.1, 0.16), (0.1, 0.11, 0.16)),
        sky=Sky((0.02, 0.03, 0.08), (0.1, 0.12, 0.2), 60.0),
        lights=[
            Light(Vec3(0.3, 1.6, 0.9), (1.4, 0.8, 0.35), 5.0),
            Light(Vec3(4, 2, 3), (0.5, 0.9, 1.4), 12.0, Vec3(-4, -2, -4).normalized(), 0.45, 0.35),
        ],
        particles=[Sprites(puffs), Sprites(sparks, additive=True)],
    )
