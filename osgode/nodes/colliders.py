"""What a model collides as, when it becomes a thing that moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from osgode.errors import FieldError
from osgode.fields import choice, number, optional, whole
from osgode.materials import material as named_material
from osgode.nodes.convex import ConvexHull, HullFields
from osgode.nodes.hulls import extra, hull_of, merged
from osgode.nodes.meshdata import MeshData
from osgode.nodes.trimesh import Triangles, Trimesh, mesh_data

if TYPE_CHECKING:
    from osgode.nodes.geom import Geom

POLICY = choice("hull", "decompose", "mesh")


def colliders(
    model: Triangles,
    policy: str,
    *,
    most_hulls: int = 16,
    resolution: int = 100_000,
    name: str = "",
    **fields: Unpack[HullFields],
) -> tuple[Geom, ...]:
    """Make the geoms of a model that is to be a moving thing; attach them all below one Placeable of a body.

    There is no best way, so the ``policy`` has to be said:

    - ``"hull"``: one `ConvexHull` around all of it. Quick and quiet; hollows are filled.
    - ``"decompose"``: several hulls that follow the shape, computed by V-HACD. Seconds of work, once; hollows
      stay hollow, each hull costs as much as a geom.
    - ``"mesh"``: a `Trimesh` of the triangles as they are. Exact; but a surface, that small things get through, with
      contacts on all inner edges, and the slowest against other meshes.

    All geoms stand in the axes of the model. The first one shows the model, the others nothing. ``mass``, or the
    density times the volume of the model, is that of all together, shared out by their volumes; the volume of a model
    that is not closed is that of its hulls. The other keyword arguments are those of the geoms.

    Args:
        model: a loaded model, a Mesh, MeshData, or a pair (vertices, triangles).
        policy: "hull", "decompose" or "mesh".
        most_hulls: how many hulls "decompose" may make, 1 to 1024.
        resolution: into how many cells it divides the model, 1000 to 10 million; more follow it more closely.
        name: of the geoms; of several with a number.
        **fields: of the geoms; ``solid`` not with "mesh".

    Raises:
        ModelError: if the triangles can't be used.
        FieldError: for a value that an argument may not have.
        MissingExtraError: if a hull has to be computed, and the extra ``convex`` is not installed.
    """
    label = "colliders()"
    policy = POLICY(label, "policy", policy)
    most, cells = whole(1, 1024)(label, "most_hulls", most_hulls), whole(1000, 10**7)(label, "resolution", resolution)
    data = mesh_data(model, label, name)
    if policy == "mesh":
        return (Trimesh(model, name=name, **_without_solid(fields)),)
    mass = _total(data, fields)
    shown = fields.pop("shown", None)
    if shown is None:
        looks: Any = {key: fields[key] for key in ("material", "appearance") if key in fields}
        shown = Trimesh(model, **looks).drawables()
    given: Any = {**fields, "density": None, "mass": None}
    if policy == "hull":
        geoms = [ConvexHull(data, name=name, **given)]
    else:
        parts = _decomposed(merged(data), most, cells)
        geoms = [ConvexHull(part, name=f"{name} {k}" if name else "", **given) for k, part in enumerate(parts, 1)]
    whole_volume = sum(geom.volume for geom in geoms)
    for geom in geoms:
        geom.shown = ()
        geom.mass = _density(fields) * geom.volume if mass is None else mass * geom.volume / whole_volume
    geoms[0].shown = shown
    return tuple(geoms)


def _without_solid(fields: HullFields) -> Any:
    if fields.pop("solid", False) is not False:
        raise FieldError("colliders().solid is given with the policy 'mesh'; only hulls can be solid")
    return fields


def _density(fields: HullFields) -> float:
    return fields.get("density") or named_material(fields.get("material", "default")).density


def _total(data: MeshData, fields: HullFields) -> float | None:
    """The mass of all; None if only the hulls will know."""
    mass, density = fields.get("mass"), fields.get("density")
    if mass is not None and density is not None:
        raise FieldError(f"colliders(): mass={mass} and density={density}; give one, the other None")
    mass = optional(number(0.0, 1e15))("colliders()", "mass", mass)
    optional(number(1e-6, 1e9))("colliders()", "density", density)
    if mass is not None:
        return mass
    try:
        return data.water.mass * _density(fields) / 1000.0
    except FieldError:  # open, or turned inside out
        return None


def _decomposed(data: MeshData, most: int, resolution: int) -> list[MeshData]:
    compute = extra("vhacdx").compute_vhacd
    extra("scipy.spatial")
    corners = np.column_stack([np.full(len(data.triangles), 3, np.uint32), data.triangles]).ravel()
    parts = compute(
        data.vertices,
        corners,
        maxConvexHulls=most,
        resolution=resolution,
        asyncACD=False,  # in threads the order of the parts would differ from run to run
    )
    return [hull_of(points, "colliders()", f"{data.name} part {k}") for k, (points, _) in enumerate(parts, 1)]
