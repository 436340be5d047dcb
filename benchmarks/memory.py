"""Memory of a body with a Placeable and a Box in a World, beyond what ODE itself takes for it."""

from __future__ import annotations

import gc
import json
import resource
import tracemalloc
from pathlib import Path

import osgode as oo
from benchmarks.raw import Raw
from benchmarks.scenes import Part, Scene
from benchmarks.timing import fresh, row
from osgode.native import ffi, lib
from osgode.nodes.realm import Realm

AIM = 4096
"""Bytes a body."""
COUNT = 5000
ARRAYS = {
    "body_capacity": "oo_body",
    "geom_capacity": "oo_geom",
    "contact_capacity": "oo_contact",
    "island_capacity": "oo_island",
    "feedback_capacity": "dJointFeedback",
    "touching_capacity": "oo_touch",
    "touched_capacity": "oo_touch",
    "event_capacity": "oo_touch",
}
"""The C core's own arrays; its two lists of slots, and what the broad phase keeps, are added by hand."""


def standing(count: int) -> Scene:
    """Boxes that stand on the ground, so that each has its contacts."""
    scene = Scene(f"{count} standing boxes", settle=5, turn=1)
    for k in range(count):
        scene.bodies.append(Part("box", (0.5, 0.5, 0.5), oo.Vec3(k % 70, 0.25, k // 70), mass=60.0))
    return scene


def core_bytes(realm: Realm) -> int:
    """What the C core has allocated beside ODE."""
    ptr = realm.ptr
    rows = sum(getattr(ptr, capacity) * ffi.sizeof(kind) for capacity, kind in ARRAYS.items())
    slots = 2 * ptr.slot_capacity * ffi.sizeof("unsigned int")
    return int(rows + slots + lib.oo_broad_bytes(ptr))


def resident(pid: int | str = "self") -> int:
    """Bytes of a process that are in memory now."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * resource.getpagesize()


def probe(*, traced: bool) -> None:
    """Build the scene in this process and print what it took, as JSON."""
    standing(10).world().step(5)  # what is made once in a process is no body's
    scene = standing(COUNT)
    gc.collect()
    if traced:
        tracemalloc.start()
    ode, size = oo.live_natives().bytes, resident()
    world = scene.world()
    gc.collect()
    size = resident() - size
    realm = world._realm
    assert realm is not None
    built = (tracemalloc.get_traced_memory()[0] if traced else 0) + core_bytes(realm)
    ode = oo.live_natives().bytes - ode
    world.step(scene.settle)
    if len(world.contacts) < COUNT:
        raise AssertionError("not every box stands on the ground")
    gc.collect()
    stepped = (tracemalloc.get_traced_memory()[0] if traced else 0) + core_bytes(realm)
    print(json.dumps({"built": built, "stepped": stepped, "ode": ode, "resident": size}))


def probed(*, traced: bool) -> dict[str, float]:
    """The results of `probe` in a fresh process, bytes a body."""
    result = fresh(f"from benchmarks import memory; memory.probe(traced={traced})")
    return {name: value / COUNT for name, value in result.items()}


def run() -> None:
    """Print the bytes of a body, counted, and as seen from outside."""
    print(f"Memory a body (Body, Placeable, Box), {COUNT} of them, beyond ODE's own")
    counted, seen = probed(traced=True), probed(traced=False)
    built, stepped = counted["built"], counted["stepped"]
    row("Python's objects and the core's arrays", f"{built:.0f} bytes", f"{AIM}", good=built <= AIM)
    row("the same with its contacts, after a step", f"{stepped:.0f} bytes", f"{AIM}", good=stepped <= AIM)
    row("ODE's own, for comparison", f"{counted['ode']:.0f} bytes")
    with Raw(Scene("nothing", settle=0, turn=1)) as empty, Raw(standing(COUNT)) as raw:
        in_c = (resident(raw.pid) - resident(empty.pid)) / COUNT
    row("resident: osgode's process less C's", f"{seen['resident'] - in_c:.0f} bytes")
