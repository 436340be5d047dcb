"""Three struts that don't touch each other are held up by nine cables, and dropped.

Shows `DoubleBall`: two points kept at a distance, as by a rod with a ball at each end. With ``stiffness`` and
``damping`` it is a spring, whose rest length is ``distance``: here a little shorter than the way between the ends,
which makes the whole tight. The cables have no mass and no shape; what is seen of them are the lines of the marks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import osgode as oo
from osgode.examples.runner import Example, Orbit, expect, painted, run

RADIUS, HEIGHT, DROP = 0.7, 1.3, 0.8
"""Of the triangles below and above, how far these are apart, and how high it starts, metres."""
TWIST = math.radians(150)
"""By how much the upper triangle is turned: where three struts and nine cables are in balance."""
STIFFNESS, DAMPING, TIGHT = 4000.0, 60.0, 0.96
"""N/m, N s/m, and rest length by length."""
COLOURS = ((0.75, 0.1, 0.08), (0.9, 0.6, 0.05), (0.08, 0.35, 0.75))


class Tensegrity(Example):
    """Struts, cables, ground."""

    SECONDS = 5.0
    MOMENTS = (0.9,)
    WORLD: ClassVar = {"iterations": 60}

    def build(self) -> None:
        """Struts from each corner below to one above, cables along the triangles and between them."""
        self.orbit = Orbit(oo.Vec3(0.0, 0.6, 0.0), 2.9, yaw=0.3, pitch=0.25)
        self.ground()
        third = math.tau / 3
        low = [self.corner(k * third, DROP) for k in range(3)]
        high = [self.corner(k * third + TWIST, DROP + HEIGHT) for k in range(3)]
        self.struts = []
        for start, end, colour in zip(low, high, COLOURS, strict=True):
            bar = oo.Capsule(0.05, start.distance(end), mass=3.0, material="wood", appearance=painted(*colour))
            self.struts.append(self.body(bar, (start + end) / 2, oo.Quat.between((0, 0, 1), end - start), name="strut"))
        self.touching = 0
        for k, strut in enumerate(self.struts):
            following = (k + 1) % 3
            self.cable(k, low[k], following, low[following])
            self.cable(k, high[k], following, high[following])
            self.cable(following, low[following], k, high[k])
            strut.on_touch(self.hear)
        self.show_joints(0.45)

    def corner(self, angle: float, height: float) -> oo.Vec3:
        """A corner of one of the triangles."""
        return oo.Vec3(RADIUS * math.cos(angle), height, -RADIUS * math.sin(angle))

    def cable(self, one: int, start: oo.Vec3, other: int, end: oo.Vec3) -> None:
        """A cable between two struts."""
        oo.DoubleBall(
            self.struts[one],
            self.struts[other],
            anchor1=start,
            anchor2=end,
            distance=TIGHT * start.distance(end),
            stiffness=STIFFNESS,
            damping=DAMPING,
        )

    def hear(self, touch: oo.Touch) -> None:
        """Count what struts do to each other."""
        self.touching += touch.other_body is not None

    def check(self) -> None:
        """It stands on its lower ends, no strut touches another, and every cable is tight."""
        expect(self.struts[0].position.y < DROP, "it falls")
        expect(self.touching == 0, "no strut touches another")
        for strut in self.struts:
            expect(abs(strut.position.y - HEIGHT / 2) < 0.12, "it stands upright")
            expect(strut.linear_velocity.length < 0.05, "it comes to rest")
        for joint in self.world.joints:
            if isinstance(joint, oo.DoubleBall):
                expect(joint.length > joint.target_distance, "every cable pulls")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run it as the command line says."""
    run(Tensegrity, arguments)


if __name__ == "__main__":
    main()
