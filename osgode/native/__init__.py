"""The C core: loading it, its errors, its counters. The only package that knows cffi."""

from __future__ import annotations

import logging
from typing import Any, NamedTuple

import numpy as np

from osgode.errors import PhysicsError

try:
    from osgode.native._core import ffi, lib
except ImportError as error:
    raise ImportError(
        f"osgode's C core can't be loaded ({error}). It is compiled when osgode is installed and needs the shared "
        "library libode.so.8: install libode-dev (Debian, Ubuntu) and a C compiler, then run "
        "'pip install --force-reinstall --no-deps osgode', or 'make' in a checkout."
    ) from error

__all__ = ["LiveCounts", "checked", "ffi", "forward_messages", "last_error", "lib", "live_natives", "row_dtype"]

log = logging.getLogger("osgode.ode")

if lib.oo_init() != lib.OO_OK:
    raise ImportError(
        "osgode's C core was loaded, but libode could not be initialised; osgode needs libode 0.16, double precision"
    )


class LiveCounts(NamedTuple):
    """How many natives of each kind exist in the process, and how much memory ODE holds."""

    worlds: int
    bodies: int
    geoms: int
    spaces: int
    joints: int
    meshes: int
    blocks: int
    bytes: int


def live_natives() -> LiveCounts:
    """Count what exists in ODE now; everything is 0 when the last World is gone, except ODE's own caches in bytes."""
    counts = lib.oo_count_live()
    return LiveCounts(*(getattr(counts, name) for name in LiveCounts._fields))


def last_error() -> str:
    """What ODE said when it last refused something in this thread."""
    text: bytes = ffi.string(lib.oo_last_error())
    return text.decode("utf-8", "replace")


def forward_messages() -> None:
    """Hand what ODE has said to the logger ``osgode.ode``: its warnings, and the asserts that became errors."""
    text = ffi.new("char[400]")
    while lib.oo_take_message(text, 400):
        log.warning("%s", ffi.string(text).decode("utf-8", "replace"))


def checked(status: int, doing: str) -> int:
    """Pass a result of 0 or above on, and raise PhysicsError for a status below 0."""
    if status >= 0:
        return status
    forward_messages()
    reasons = {
        lib.OO_NO_MEMORY: "out of memory",
        lib.OO_ASSERT: f"ODE refused: {last_error()}",
        lib.OO_BROKEN: f"an ODE assert while colliding left this World unusable ({last_error()}); make a new one",
    }
    raise PhysicsError(f"{doing}: {reasons.get(status, status)}")


def row_dtype(c_type: str) -> np.dtype[Any]:
    """The numpy type of one C row, with the compiler's own offsets."""
    return _dtype(ffi.typeof(c_type))


def _dtype(c_type: Any) -> np.dtype[Any]:
    if c_type.kind == "struct":
        fields = [(name, field) for name, field in c_type.fields if field.type.kind != "pointer"]
        return np.dtype(
            {
                "names": [name for name, _ in fields],
                "formats": [_dtype(field.type) for _, field in fields],
                "offsets": [field.offset for _, field in fields],
                "itemsize": ffi.sizeof(c_type),
            }
        )
    if c_type.kind == "array":
        return np.dtype((_dtype(c_type.item), (c_type.length,)))
    codes = {"double": "f8", "float": "f4", "int": "i4", "unsigned int": "u4"}
    return np.dtype(codes[c_type.cname])
