"""The impact event: how hard things hit each other, for sounds, damage and dust.

It is taken from the collision listener, before the contact pushes: only there are the speeds at which things meet.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import osgode as oo

THRESHOLD = 1.0
"""Joules below which nobody is told: a kilogram that falls 10 cm."""

Node = oo.Geom | oo.Body | oo.Space | oo.World


@dataclass(frozen=True, slots=True)
class Impact:
    """Two things that begin to touch.

    Args:
        energy: what a hit without any bounce would take from their motion along the normal, J.
        speed: at which they close in on each other along the normal, m/s.
        point: the middle of where they touch, metres in the world.
        normal: of length 1, out of the other towards the own geom.
        geom: the own geom: of the node that is listened to.
        other: the geom that it hits.
    """

    energy: float
    speed: float
    point: oo.Vec3
    normal: oo.Vec3
    geom: oo.Geom
    other: oo.Geom

    @property
    def materials(self) -> tuple[str, str]:
        """What the own geom and the other are made of."""
        return self.geom.material, self.other.material


def on_impact(
    node: Node, listener: Callable[[Impact], object], threshold: float = THRESHOLD
) -> Callable[[oo.CollisionFeedback], None]:
    """Have ``listener`` called when something of ``node`` begins to touch something with more energy than that.

    It is called before the contact acts, in the step in which they meet; what is a sensor is left out. It costs a call
    in Python for each pair that touches, in each step: listen to what matters, not to a World full of heaps.

    Args:
        node: a geom, a body, a space (such as an object of the game), or a World.
        listener: what is called with an `Impact`.
        threshold: J.

    Returns:
        What ``node.remove_on_collide`` takes to end it.
    """

    def collided(feedback: oo.CollisionFeedback) -> None:
        if not feedback.begin or feedback.refused or feedback.geom.sensor or feedback.other.sensor:
            return
        impact = impact_of(feedback)
        if impact is not None and impact.energy >= threshold:
            listener(impact)

    node.on_collide(collided)
    return collided


def impact_of(feedback: oo.CollisionFeedback) -> Impact | None:
    """How two things meet, None if they part.

    The energy is ``v^2 / (2 W)``: v the speed along the normal n at the middle of the contacts, W how readily the
    bodies give way there, the sum of ``1/m + ((I^-1 (r x n)) x r) . n`` over those that can be pushed.
    """
    point = oo.Vec3(*np.mean(feedback.points, axis=0).tolist())
    total = oo.Vec3(*np.sum(feedback.normals, axis=0).tolist())
    if total.length < 1e-9:  # from opposite sides: wedged in, not hit
        return None
    normal = total.normalized()
    speed, give = 0.0, 0.0
    for body, sign in ((feedback.body, -1.0), (feedback.other_body, 1.0)):
        if body is None:
            continue
        speed += sign * body.velocity_at(point).dot(normal)
        if not body.kinematic:
            arm = point - body.world_centre_of_mass
            turning = np.linalg.solve(body.world_inertia, np.array(arm.cross(normal)))
            give += 1.0 / body.mass + oo.Vec3(*turning.tolist()).cross(arm).dot(normal)
    if speed <= 0.0 or give <= 0.0:
        return None
    return Impact(speed**2 / (2.0 * give), speed, point, normal, feedback.geom, feedback.other)
