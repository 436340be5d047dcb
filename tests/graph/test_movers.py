"""Tables of what moves, against one product after another."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from osgode.graph.movers import Anchor, Movers, Place, Tables
from osgode.maths import FloatArray, Pose, Quat, Vec3

small = st.floats(-5, 5).map(lambda x: round(x, 3))
matrices = st.builds(Pose, st.builds(Vec3, small, small, small), st.builds(Quat.from_yaw_pitch_roll, small, small)).map(
    Pose.matrix
)


class Source:
    """Three poses, and how often they were asked for."""

    def __init__(self, table: list[FloatArray]) -> None:
        self.table, self.asked = table, 0

    def matrices(self, interpolation: float) -> FloatArray:
        self.asked += 1
        return np.array(self.table) * interpolation


sources = st.builds(Source, st.lists(matrices, min_size=3, max_size=3))
maybe = st.none() | matrices


@given(
    st.lists(st.builds(Anchor, sources, maybe), min_size=2, max_size=2),
    st.lists(st.builds(Place, maybe, st.sampled_from([None, 0, 1]), st.integers(0, 2)), max_size=8),
    st.booleans(),
)
def test_everything_is_where_its_place_says(anchors: list[Anchor], places: list[Place], same: bool) -> None:
    """In whatever order things are kept: ``anchor @ pose @ matrix`` for each; each source is asked once at most."""
    if same:
        anchors = [anchors[0], Anchor(anchors[0].source, anchors[1].matrix)]
    columns = np.random.default_rng(1).normal(size=(len(places), 4, 2))
    movers = Movers(places, columns, anchors)
    found = movers.start.copy()
    tables = Tables(1.0)
    for part, moved in movers.moved(tables):
        found[part] = moved
    assert sorted(movers.slots.tolist()) == list(range(len(places)))
    for place, column, slot in zip(places, columns, movers.slots.tolist(), strict=True):
        matrix = np.identity(4) if place.matrix is None else place.matrix
        if place.anchor is not None:
            source, above = anchors[place.anchor]
            matrix = source.table[place.row] @ matrix  # type: ignore[attr-defined]
            matrix = matrix if above is None else above @ matrix
        assert np.allclose(found[slot], matrix @ column)
    assert all(anchor.source.asked <= 1 for anchor in anchors)  # type: ignore[attr-defined]
