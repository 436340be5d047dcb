"""Builds the C extension: reads the declarations in osgode/native/, compiles the C files, links Debian's libode."""

from pathlib import Path

from cffi import FFI

NATIVE = Path("osgode") / "native"
UNITS = (
    *(
        "support",
        "core",
        "glide",
        "geoms",
        "heightfield",
        "terrain",
        "polytope",
        "collide",
        "contacts",
        "seams",
        "lying",
        "capsules",
        "joints",
        "gears",
    ),
    *("boxtree", "broad", "movers", "broadqueries", "islands", "step", "queries", "gjk", "triangles", "sweep"),
)
HEADERS = ("core.h", "internal.h", "heightfield.h", "broad.h", "onmesh.h", "shapes.h", "ode.cdef")

ffi = FFI()
ffi.cdef((NATIVE / "ode.cdef").read_text() + (NATIVE / "core.h").read_text())
ffi.set_source(
    "osgode.native._core",
    '#include <ode/ode.h>\n#include "core.h"\n',
    sources=[str(NATIVE / f"{name}.c") for name in UNITS],
    include_dirs=[str(NATIVE)],
    depends=[str(NATIVE / name) for name in HEADERS],
    libraries=["ode", "m", "dl", "pthread"],
    extra_compile_args=["-O2", "-std=gnu11", "-Wall"],
)

if __name__ == "__main__":
    ffi.compile(verbose=True)
