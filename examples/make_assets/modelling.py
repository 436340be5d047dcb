"""A model under construction: flat faces of several materials, written as .obj and .mtl.

Metres, Y up, faces counter-clockwise from outside. Textures are laid on in metres, level along each
face, so that courses of bricks meet at the corners. Normals are left to whoever loads the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

Point: TypeAlias = tuple[float, float, float]

UP: Point = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Material:
    """How a face looks.

    Args:
        colour: red, green and blue, 0 to 1, multiplied with the texture.
        texture: the name of one of the textures, or none.
        tile: metres that one repeat of the texture covers.
        shine: the specular exponent of the .mtl file.
    """

    colour: Point = (1.0, 1.0, 1.0)
    texture: str = ""
    tile: float = 1.0
    shine: float = 1.0


class Face(NamedTuple):
    """A flat convex face: its corners, and where they are in the texture."""

    points: Sequence[Point]
    uvs: Sequence[tuple[float, float]]


@dataclass
class Model:
    """Materials by name, and the faces of each."""

    materials: dict[str, Material]
    faces: dict[str, list[Face]] = field(default_factory=dict)

    def face(self, material: str, *points: Point, along: Point = UP) -> None:
        """Add a flat convex face; the texture's upward direction is the one nearest to ``along``.

        A face that has lost its area because points coincide is left out, or loses those points.
        """
        points = tuple(p for k, p in enumerate(points) if p != points[k - 1])
        if len(set(points)) < 3:
            return
        corners = np.array(points)
        normal = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
        normal /= np.linalg.norm(normal)
        up = np.array(along) - normal * (normal @ along)
        if np.linalg.norm(up) < 0.1:
            up = np.array([0.0, 0.0, -1.0]) if abs(normal[1]) > 0.5 else np.array(UP)
        up /= np.linalg.norm(up)
        uvs = corners @ np.stack([np.cross(up, normal), up], axis=1) / self.materials[material].tile
        uvs -= np.floor(uvs.min(axis=0) + 1e-6)  # small numbers, for a small file
        self.faces.setdefault(material, []).append(Face(points, [(float(u), float(v)) for u, v in uvs]))

    def box(self, material: str, low: Point, high: Point, along: Point = UP) -> None:
        """Add a closed box between two corners."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        a, b, c, d = (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)
        e, f, g, h = (x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)
        for points in ((a, b, c, d), (f, e, h, g), (b, f, g, c), (e, a, d, h), (d, c, g, h), (e, f, b, a)):
            self.face(material, *points, along=along)

    def prism(
        self, materials: Sequence[str], profile: Sequence[tuple[float, float]], ends: tuple[float, float]
    ) -> None:
        """Draw a (z, y) profile, counter-clockwise with Z to the right, along X: its sides, each of a material."""
        x0, x1 = ends
        for material, (z, y), (w, v) in zip(materials, profile, [*profile[1:], profile[0]], strict=True):
            along = (1.0, 0.0, 0.0) if material == "beam" else UP
            self.face(material, (x0, y, z), (x1, y, z), (x1, v, w), (x0, v, w), along=along)

    def panel(self, frame: str, pane: str, points: Sequence[Point], rim: float, depth: float) -> None:
        """A four-sided face with a pane let into it: ``rim`` metres from its edges, ``depth`` below them."""
        corners = np.array(points)
        normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
        normal /= np.linalg.norm(normal)
        edges = np.roll(corners, -1, axis=0) - corners
        edges /= np.linalg.norm(edges, axis=1, keepdims=True)
        # Each corner moves inwards by `rim` from both edges that meet in it.
        before = np.roll(edges, 1, axis=0)
        sine = np.einsum("ij,j->i", np.cross(before, edges), normal)[:, None]
        inner = corners + rim * (edges - before) / sine
        sunk = inner - depth * normal
        rings = [[rounded(p) for p in ring] for ring in (corners, inner, sunk)]
        for outer, within in ((rings[0], rings[1]), (rings[1], rings[2])):
            for k in range(4):
                n = (k + 1) % 4
                self.face(frame, outer[k], outer[n], within[n], within[k])
        self.face(pane, *rings[2])

    def write(self, path: Path) -> None:
        """Write ``path`` and the .mtl file beside it, corners at the same millimetre made one."""
        points: dict[str, int] = {}
        uvs: dict[str, int] = {}
        body: list[str] = []
        for name, faces in self.faces.items():
            body.append(f"usemtl {name}")
            for corners, places in faces:
                refs = [
                    f"{points.setdefault(_words(p), len(points) + 1)}/{uvs.setdefault(_words(t), len(uvs) + 1)}"
                    for p, t in zip(corners, places, strict=True)
                ]
                body += [f"f {refs[0]} {refs[k]} {refs[k + 1]}" for k in range(1, len(refs) - 1)]
        lines = ["# made by make_assets", f"mtllib {path.stem}.mtl"]
        lines += [f"v {p}" for p in points] + [f"vt {t}" for t in uvs] + body
        path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")

        lines = ["# made by make_assets"]
        for name in self.faces:
            material = self.materials[name]
            lines += [f"newmtl {name}", f"Kd {_words(material.colour)}", f"Ns {_words([material.shine])}"]
            lines += [f"map_Kd {material.texture}.png"] if material.texture else []
        path.with_suffix(".mtl").write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def _words(values: Iterable[float]) -> str:
    """Numbers to the third decimal, without what says nothing."""
    # Halves go up even where another processor's last digit puts them a little lower.
    thousands = (math.floor(value * 1000 + 0.5 + 1e-6) for value in values)
    return " ".join(f"{number / 1000:g}" for number in thousands)


def rounded(values: npt.ArrayLike) -> Point:
    """The point with what floating point makes of equal sums rounded off."""
    x, y, z = (round(float(v), 6) for v in np.asarray(values))
    return x, y, z


def mirrored(points: Iterable[Point]) -> list[Point]:
    """The same face on the other side of X = 0, which turns its order round."""
    return [(-x if x else 0.0, y, z) for x, y, z in reversed(list(points))]
