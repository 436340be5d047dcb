"""Wheels that are cylinders on meshes: seams are not felt however they lean and steer, and real edges are."""

import math

import numpy as np
import pytest

import osgode as oo

RADIUS, WIDTH = 0.33, 0.2


def floor(rows=6, columns=9, seed=0):
    """A level mesh at height 0 of uneven triangles, 9 by 6 metres."""
    chance = np.random.default_rng(seed)
    x, z = np.meshgrid(np.linspace(-4.5, 4.5, columns + 1), np.linspace(-3, 3, rows + 1))
    x[:, 1:-1] += chance.uniform(-0.3, 0.3, x[:, 1:-1].shape)
    z[1:-1] += chance.uniform(-0.3, 0.3, z[1:-1].shape)
    points = np.column_stack([x.ravel(), np.zeros(x.size), z.ravel()])
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    a, b = i * (columns + 1) + j, (i + 1) * (columns + 1) + j
    return oo.Trimesh((points, np.vstack([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])))


def wheel_over(mesh):
    world = oo.World(gravity=(0, 0, 0))
    moving, still = world.attach(oo.HashSpace()), world.attach(oo.SimpleSpace())
    world.collide(moving, still)
    still.attach(oo.Placeable()).attach(mesh)
    wheel = moving.attach(oo.Body())
    wheel.attach(oo.Placeable()).attach(oo.Cylinder(RADIUS, WIDTH, mass=20.0))
    return world, wheel


def normals_of(world, wheel, position, axle):
    """Of its contacts where it is put, upwards; (n, 3)."""
    wheel.position, wheel.rotation = position, oo.Quat.between((0, 0, 1), axle)
    wheel.linear_velocity = wheel.angular_velocity = (0, 0, 0)
    world.step()
    normals = world.contacts["geom"]["normal"][:, :3]
    return normals * np.where(normals[:, 1:2] < 0, -1, 1)


@pytest.mark.parametrize("seed", range(3))
def test_a_wheel_that_leans_and_steers_feels_no_seam_of_a_flat_mesh(seed):
    """All contacts have the normal of the floor, also where it is as deep as a landing presses it in one step."""
    chance = np.random.default_rng(seed)
    world, wheel = wheel_over(floor(seed=seed))
    for _ in range(200):
        camber, steering = chance.normal(0, 0.08), chance.normal(0, 0.4)
        axle = oo.Vec3(math.cos(steering), camber, math.sin(steering)).normalized()
        lowest = RADIUS * math.sqrt(1 - axle.y**2) + WIDTH / 2 * abs(axle.y)
        x, z = chance.uniform(-3.5, 3.5), chance.uniform(-2, 2)
        normals = normals_of(world, wheel, (x, lowest - chance.uniform(0.001, 0.03), z), axle)
        assert len(normals) >= 1
        assert normals[:, 1].min() > 0.999


def test_a_wheel_meets_the_edge_of_a_step_by_the_way_from_the_edge_to_its_axle():
    """A step 0.15 m high at z = 0: the edge presses towards the axle, the floor upwards."""
    corners = [(x, y, z) for x in (-3, 3) for y, z in ((0, 4), (0, 0), (0.15, 0), (0.15, -4))]
    triangles = [t for k in range(3) for t in ((k, 4 + k, 5 + k), (k, 5 + k, k + 1))]
    world, wheel = wheel_over(oo.Trimesh((np.array(corners, float), triangles)))
    deep = 0.004
    ahead = math.sqrt((RADIUS - deep) ** 2 - (RADIUS - deep - 0.15) ** 2)
    normals = normals_of(world, wheel, (0.0, RADIUS - deep, ahead), (1.0, 0.0, 0.0))
    edge = np.array([0.0, RADIUS - deep - 0.15, ahead]) / (RADIUS - deep)
    assert (normals @ (0, 1, 0)).max() > 0.999
    assert (normals @ edge).max() > 0.99
