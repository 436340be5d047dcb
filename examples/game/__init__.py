"""The demo game and its objects, each in a module of its own that another game can import."""

from __future__ import annotations

import osgode as oo

KINDS = ("player", "vehicle", "weapon", "shot", "blast")
"""The kinds of objects that the game tells apart, beside "default"."""

for _kind in KINDS:
    oo.define_kind(_kind)
