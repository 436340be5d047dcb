"""Smoke, fire and sparks that outlive what they come from."""

from __future__ import annotations

import osgode as oo

LINGER = 6.0
"""Seconds after which an emitter that has nothing more to do is taken away; by then its smoke is gone."""


def burst(space: oo.Space, position: oo.Vec3Like, spray: oo.Spray, count: int, seed: int = 0) -> None:
    """Let so many particles out at once, at a place in the world.

    Args:
        space: in whose World; the emitter stands below it until the particles are gone.
        position: metres in the world.
        spray: what comes out.
        count: of particles.
        seed: of their random numbers.
    """
    place = space.attach(oo.PositionAttitudeTransform(position=position))
    emitter = place.attach(oo.Particles(spray, seed=seed))
    _run(space, emitter)
    emitter.burst(count)
    space.schedule(lambda _: _detach(place), seconds=LINGER)


def trail(body: oo.Body, offset: oo.Vec3Like, spray: oo.Spray, rate: float, seed: int = 0) -> oo.Particles:
    """Let so many particles a second out of a body as it goes.

    Args:
        body: in a space.
        offset: where in its axes, metres.
        spray: what comes out.
        rate: particles per second.
        seed: of their random numbers.
    """
    place = body.attach(oo.PositionAttitudeTransform(position=offset))
    emitter = place.attach(oo.Particles(spray, rate=rate, seed=seed))
    if body.space is not None:
        _run(body.space, emitter)
    return emitter


def leave_behind(emitter: oo.Particles, space: oo.Space) -> None:
    """Let what has come out of an emitter drift away by itself, when what it hangs on is going to be removed."""
    emitter.rate = 0.0
    if emitter.parent is not None:
        emitter.parent.detach(emitter)
    space.attach(emitter)
    space.schedule(lambda _: _detach(emitter), seconds=LINGER)


def _run(space: oo.Space, emitter: oo.Particles) -> None:
    world = space.world
    if world is not None:
        emitter.follow(lambda: world.time)


def _detach(node: oo.Node) -> None:
    for parent in node.parents:
        parent.detach(node)
