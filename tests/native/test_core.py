"""The C core: its errors, its counters, its rows, the bits of plain ODE, and nothing that ends the process."""

import gc
import logging
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

import osgode as oo
from osgode import native
from osgode.native import checked, ffi, last_error, lib, row_dtype

NATIVE = Path(native.__file__).parent


def run_python(code, *arguments):
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code), *arguments],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, f"exit code {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


# -- counters


def test_what_lives_is_counted():
    world = oo.World()
    space = world.attach(oo.HashSpace())
    body = space.attach(oo.Body())
    body.attach(oo.Placeable()).attach(oo.Box())
    space.attach(oo.Trimesh(([(0, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1, 2)])))
    oo.Ball(body)
    counts = oo.live_natives()
    assert counts[:6] == (1, 1, 2, 1, 1, 1)
    assert counts._fields[:6] == ("worlds", "bodies", "geoms", "spaces", "joints", "meshes")
    assert counts.blocks > 5
    assert counts.bytes > 1000
    world.step(10)
    del world, space, body
    gc.collect()
    assert oo.live_natives()[:7] == (0,) * 7


def test_worlds_that_come_and_go_leave_no_memory():
    """Blocks return to 0 each time, and bytes to the same number after the first time."""
    from tests.nodes.test_world import heap

    seen = set()
    for _ in range(3):
        world = heap(20)
        world.step(60)
        del world
        gc.collect()
        counts = oo.live_natives()
        assert counts[:7] == (0,) * 7
        seen.add(counts.bytes)
    assert len(seen) == 1


def test_growing_and_shrinking_frees_what_it_took():
    world = oo.World()
    space = world.attach(oo.SweepAndPruneSpace())
    before = oo.live_natives()
    for _ in range(3):
        bodies = [space.attach(oo.Body()) for _ in range(200)]
        for body in bodies:
            body.attach(oo.Placeable()).attach(oo.Box())
            oo.Hinge(body)
        for body in bodies:
            space.detach(body)
    after = oo.live_natives()
    assert after[:6] == before[:6]
    assert after.blocks <= before.blocks + 3


# -- errors


def test_what_ode_refuses_is_a_status_and_a_text():
    """The assert is caught: the process lives, and the text is ODE's."""
    code = """
    from osgode.native import ffi, last_error, lib
    world = lib.oo_world_new()
    tables = ffi.new("double[700]"), ffi.new("double[700]")
    world.poses, world.previous = tables
    world.table_capacity = 100
    assert lib.oo_body_new(world) == 0
    for mass, inertia in ((-1.0, [1, 0, 0, 0, 1, 0, 0, 0, 1]), (1.0, [-1, 0, 0, 0, 1, 0, 0, 0, 1])):
        assert lib.oo_body_set_mass(world, 0, mass, [float(v) for v in inertia]) == lib.OO_ASSERT
        assert "mass" in last_error(), last_error()
    assert lib.oo_geom_new(world, lib.OO_SPHERE, [-1.0], ffi.NULL) == lib.OO_ASSERT
    assert "dxSphere" in last_error(), last_error()
    assert lib.oo_geom_new(world, lib.OO_BOX, [1.0, -1.0, 1.0], ffi.NULL) == lib.OO_ASSERT
    slot = lib.oo_geom_new(world, lib.OO_SPHERE, [1.0], ffi.NULL)
    assert slot >= 0
    world.step_size = 0.01
    assert lib.oo_run(world, 5) == 5
    counts = lib.oo_count_live()
    assert counts.bodies == 1, counts.bodies
    assert counts.geoms == 1, counts.geoms
    lib.oo_world_free(world)
    assert lib.oo_count_live().worlds == 0
    """
    run_python(code)


def test_each_status_has_its_words():
    assert checked(0, "it") == 0
    assert checked(5, "it") == 5
    for status, words in (
        (lib.OO_NO_MEMORY, "it: out of memory"),
        (lib.OO_ASSERT, "it: ODE refused"),
        (lib.OO_BROKEN, "it: an ODE assert while colliding"),
    ):
        with pytest.raises(oo.PhysicsError, match=words):
            checked(status, "it")
    assert isinstance(last_error(), str)


def test_an_assert_while_colliding_breaks_one_world_and_says_so():
    """Its space stays locked for good, so it only says so from then on; other Worlds go on, and nothing crashes."""
    run_python(
        """
        import gc, pytest
        import osgode as oo
        from osgode.native import lib
        from tests.nodes.test_world import bits, heap

        reference, other, world = (heap(10, broad_phase="ode") for _ in range(3))
        reference.step(40)
        other.step(20)
        world.step(20)
        body = world.bodies[3]
        lib.dBodySetPosition(body._id, float("nan"), 0, 0)
        with pytest.raises(oo.PhysicsError, match="make a new one"):
            world.step()
        for _ in range(3):
            with pytest.raises(oo.PhysicsError, match="make a new one"):
                world.step()
        assert world._realm.ptr.broken
        geom, space = body.geoms[0], body.parent
        for change in (
            lambda: setattr(geom, "material", "ice"),
            lambda: setattr(body.children[0], "position", (1, 2, 3)),
            lambda: setattr(body, "position", (0, 0, 0)),
            lambda: space.detach(body),
            lambda: space.attach(oo.Body()),
            lambda: space.attach(oo.Box()),
            lambda: body.move_to(world),
            lambda: oo.Ball(world.bodies[0]),
            lambda: body.on_touch(print),
            lambda: world.collide(space),
            lambda: setattr(geom, "mass", 3.0),
        ):
            with pytest.raises(oo.PhysicsError, match="make a new one"):
                change()
        assert world.bodies[0].position.y > 0
        assert len(geom.bounds) == 2
        other.step(20)
        assert bits(other) == bits(reference)
        rescued = world.bodies[0]
        velocity = rescued.linear_velocity
        del world
        gc.collect()
        assert not body.is_live
        assert rescued.linear_velocity == velocity
        rescued_space = oo.World().attach(oo.SimpleSpace())
        rescued.move_to(rescued_space)
        fresh = heap(10, broad_phase="ode")
        fresh.step(40)
        assert bits(fresh) == bits(reference)
        """
    )


def test_messages_of_ode_reach_the_log_and_not_the_terminal(caplog, capfd):
    """The exact solver complains about a tower of boxes; that is a warning of the logger osgode.ode."""
    world = oo.World(solver="exact")
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    space.attach(oo.Plane())
    for i in range(12):
        body = space.attach(oo.Body(position=(0, 0.5 + i, 0)))
        body.attach(oo.Placeable()).attach(oo.Box(density=1.0))
    with caplog.at_level(logging.WARNING, logger="osgode.ode"):
        for _ in range(40):
            world.step(5)
            if caplog.records:
                break
    assert caplog.records
    assert {record.name for record in caplog.records} == {"osgode.ode"}
    assert capfd.readouterr() == ("", "")


# -- rows


@pytest.mark.parametrize("name", ["oo_contact", "oo_touch", "oo_body", "oo_geom", "dContactGeom", "dSurfaceParameters"])
def test_rows_in_numpy_are_those_of_the_compiler(name):
    """Each number lies where cffi finds it."""
    dtype = row_dtype(name)
    assert dtype.itemsize == ffi.sizeof(name)
    raw = np.zeros(3, dtype)
    rows = ffi.from_buffer(f"{name}[]", raw)
    for field, info in ffi.typeof(name).fields:
        if info.type.kind == "pointer":
            assert field not in dtype.names
        elif info.type.kind == "primitive":
            setattr(rows[1], field, 7)
            assert raw[1][field] == 7
            assert raw[0][field] == raw[2][field] == 0
        elif info.type.kind == "array":
            getattr(rows[2], field)[1] = 2.5
            assert raw[2][field][1] == 2.5


def test_nothing_is_declared_that_nobody_calls():
    """Each function of ODE in ode.cdef is used by the package, or by a test of it."""
    text = re.sub(r"/\*.*?\*/", "", (NATIVE / "ode.cdef").read_text(), flags=re.DOTALL)
    declared = set(re.findall(r"\b(d[A-Z]\w+)\s*\(", text))
    folders = [NATIVE.parent / name for name in ("native", "nodes", "joints")] + [Path(__file__).parents[1]]
    sources = "".join(path.read_text() for folder in folders for path in folder.rglob("*.py"))
    used = set(re.findall(r"\bd[A-Z]\w+", sources))
    used |= {f"dWorld{verb}{name}" for verb in ("Get", "Set") for name in re.findall(r'"([A-Z]\w+)"', sources)}
    assert len(declared) > 100
    assert declared - used == set()


def test_libode_is_the_build_that_is_meant():
    """Double precision, with triangle meshes and threading of its own."""
    said = ffi.string(lib.dGetConfiguration()).decode().split()
    assert {"ODE_double_precision", "ODE_EXT_trimesh", "ODE_OPC_new_collider", "ODE_THR_builtin_impl"} <= set(said)


def test_odes_random_numbers_are_ours():
    assert lib.oo_random_is_local() == 1


# -- the oracle

RAW = """
import sys
from cffi import FFI
ffi = FFI()
ffi.cdef('''
typedef double dVector3[4];
typedef struct { int mode; double mu, mu2, rho, rho2, rhoN, bounce, bounce_vel, soft_erp, soft_cfm, motion1, motion2,
    motionN, slip1, slip2; } dSurfaceParameters;
typedef struct { dVector3 pos, normal; double depth; void *g1, *g2; int side1, side2; } dContactGeom;
typedef struct { dSurfaceParameters surface; dContactGeom geom; dVector3 fdir1; } dContact;
typedef struct { double mass; dVector3 c; double I[12]; } dMass;
int dInitODE2(unsigned int); void *dWorldCreate(void); void dWorldSetGravity(void *, double, double, double);
void *dHashSpaceCreate(void *); void *dJointGroupCreate(int); void dJointGroupEmpty(void *);
void *dCreatePlane(void *, double, double, double, double); void *dCreateBox(void *, double, double, double);
void *dCreateSphere(void *, double); void *dBodyCreate(void *); void dGeomSetBody(void *, void *);
void dBodySetPosition(void *, double, double, double); void dBodySetMass(void *, const dMass *);
void dMassSetBox(dMass *, double, double, double, double); void dMassSetSphere(dMass *, double, double);
void dSpaceCollide(void *, void *, void (*)(void *, void *, void *)); void *dGeomGetBody(void *);
int dCollide(void *, void *, int, dContactGeom *, int); void *dJointCreateContact(void *, void *, const dContact *);
void dJointAttach(void *, void *, void *); int dWorldQuickStep(void *, double); int dWorldStep(void *, double);
const double *dBodyGetPosition(void *); const double *dBodyGetQuaternion(void *); void dRandSetSeed(unsigned long);
''')
ode = ffi.dlopen("libode.so.8")
ode.dInitODE2(0)
world, space, group = ode.dWorldCreate(), ode.dHashSpaceCreate(ffi.NULL), ode.dJointGroupCreate(0)
ode.dWorldSetGravity(world, 0, -9.81, 0)
ode.dCreatePlane(space, 0, 1, 0, 0)
bodies = []
for i in range(30):
    body, mass = ode.dBodyCreate(world), ffi.new("dMass *")
    if i % 2:
        ode.dMassSetBox(mass, 100.0, 1, 0.8, 0.9)
        geom = ode.dCreateBox(space, 1, 0.8, 0.9)
    else:
        ode.dMassSetSphere(mass, 100.0, 0.5)
        geom = ode.dCreateSphere(space, 0.5)
    ode.dBodySetMass(body, mass)
    ode.dGeomSetBody(geom, body)
    ode.dBodySetPosition(body, 0.3 * (i % 3), 1.0 + 0.9 * i, 0.2 * (i % 2))
    bodies.append(body)
contacts = ffi.new("dContact[16]")

@ffi.callback("void(void *, void *, void *)")
def near(_, g1, g2):
    found = ode.dCollide(g1, g2, 16, ffi.addressof(contacts[0], "geom"), ffi.sizeof("dContact"))
    for k in range(found):
        contacts[k].surface.mode = APPROX1
        contacts[k].surface.mu = 0.5
        joint = ode.dJointCreateContact(world, group, contacts + k)
        ode.dJointAttach(joint, ode.dGeomGetBody(g1), ode.dGeomGetBody(g2))

APPROX1 = int(sys.argv[2])
ode.dRandSetSeed(0)
for _ in range(200):
    ode.dSpaceCollide(space, ffi.NULL, near)
    (ode.dWorldStep if sys.argv[1] == "exact" else ode.dWorldQuickStep)(world, 1 / 120)
    ode.dJointGroupEmpty(group)
for body in bodies:
    place, turn = ffi.unpack(ode.dBodyGetPosition(body), 3), ffi.unpack(ode.dBodyGetQuaternion(body), 4)
    print(*[v.hex() for v in (*place, *turn)])
"""


@pytest.mark.parametrize("solver", ["quick", "exact"])
def test_the_bits_are_those_of_plain_ode(solver):
    """The same heap in a program that calls libode itself, with a near callback as in its manual."""
    from tests.nodes.test_world import heap

    world = heap(30, solver=solver, broad_phase="ode")
    world.step(200)
    ours = [" ".join(float(v).hex() for v in row) for row in world.poses]
    assert run_python(RAW, solver, str(lib.dContactApprox1)).splitlines() == ours


# -- nothing ends the process

FUZZ = """
import math, random, sys, warnings
import numpy as np
import osgode as oo
from tests.strategies import CASES, JOINED, MAKERS, NEEDS_TWO, WRONG_KIND, OUTSIDE, Stand, accepted, join
from tests.trees import is_consistent

warnings.simplefilter("ignore")
draw = random.Random(int(sys.argv[1]))
NASTY = [*WRONG_KIND, None, True, "", (), [], -1, 0, 0.0, -0.0, 1e300, -1e300, 1e-320, 1e9, 1e8, 1e-6, 1e7, 2**31,
         2**63, math.inf, -math.inf, math.pi, (math.inf, 0.0, 0.0), (0, 0, 0), (0, 0, 0, 0), (1e8, -1e8, 1e8),
         (1e9, 1e9, 1e9), (1e-6, 1e7, 1.0), (1e15, 0, 0), np.float64("nan"), np.zeros(3), np.zeros((3, 3)),
         "wood", "default", "exact",
         oo.Mass(1e-12, (0, 0, 0), ((1e-12, 0, 0), (0, 1e-12, 0), (0, 0, 1e-12))), oo.Mass(1e15), oo.Surface(math.inf),
         oo.Surface(0.0, bounce=1.0, slip=1e6, soft_cfm=1e6), *(v for bad in OUTSIDE.values() for v in bad)]
GOOD = {case: accepted(case) for case in CASES}
expected = (oo.OsgodeError, TypeError, ValueError, AttributeError, ExceptionGroup)
steps = refused = 0


def attempt(call):
    global refused
    try:
        return call()
    except expected as error:
        refused += 1
        return error


def value(case=None):
    if case is not None and GOOD[case] and draw.random() < 0.3:
        return draw.choice(GOOD[case])
    return draw.choice(NASTY)


def build():
    world = oo.World()
    spaces = [world.attach(cls()) for cls in (oo.SimpleSpace, oo.HashSpace, oo.QuadTreeSpace, oo.SweepAndPruneSpace)]
    for space in spaces:
        world.collide(space)
    space.attach(oo.Plane())
    bodies = []
    for i in range(8):
        body = draw.choice(spaces).attach(oo.Body(position=(i * 0.7, 0.4, 0)))
        stand = Stand(draw.choice([cls for cls in MAKERS if issubclass(cls, oo.Geom) and cls is not oo.Plane]))
        if isinstance(stand.node, oo.Heightfield):
            stand.node.mass = 0
        body.attach(oo.Placeable()).attach(stand.node)
        bodies.append(body)
    joints = [oo.Hinge(bodies[0], bodies[1]), oo.Slider(bodies[2]), oo.Ball(bodies[3], bodies[4]), oo.Fixed(bodies[5])]
    for kind in draw.sample(list(JOINED), 6):
        one, two = draw.sample(bodies, 2)
        joints.append(join(kind, one, two if kind in NEEDS_TWO or draw.random() < 0.5 else None))
    joints[0].servo = oo.Servo(target=1.0)
    return world, joints


VERBS = {
    oo.Body: ["add_force", "add_torque", "add_local_force", "add_local_torque", "apply_impulse",
              "apply_angular_impulse", "on_touch", "remove_on_touch", "move_to", "attach", "detach"],
    oo.Hinge: ["add_torque"], oo.Slider: ["add_force"], oo.Piston: ["add_force", "add_torque"], oo.PR: ["add_torque"],
    oo.Joint: ["anchor_anew", "on_let_go"], oo.AngularMotor: ["add_torques"],
    oo.World: ["attach", "detach", "collide", "stop_colliding", "step"],
    oo.Space: ["attach", "detach", "move_to"], oo.Geom: ["on_touch", "move_to"], oo.Placeable: ["attach", "move_to"],
}
for round_number in range(int(sys.argv[2])):
    world, joints = build()
    for _ in range(60):
        things = [node for node in world.walk() if isinstance(node, oo.PhysicsNode)] + list(joints)
        thing = draw.choice(things)
        kind = draw.random()
        if kind < 0.55 and thing.FIELDS:
            name = draw.choice(list(thing.FIELDS))
            case = next((c for c in CASES if c.cls is type(thing) and c.name == name), None)
            attempt(lambda: setattr(thing, name, value(case)))
        elif kind < 0.7:
            verbs = [verb for cls, names in VERBS.items() if isinstance(thing, cls) for verb in names]
            verb = draw.choice(verbs or ["move_to"]) if hasattr(thing, "move_to") or verbs else None
            argument = draw.choice([value(), draw.choice(things)])
            if verb and not (verb == "step" and isinstance(argument, int | float) and argument > 3):
                attempt(lambda: getattr(thing, verb)(argument))
        elif kind < 0.75 and isinstance(thing, oo.Joint):
            spots = [*type(thing).SPOTS, "axes", "anchor"]
            attempt(lambda: setattr(thing, draw.choice(spots), value()))
            attempt(lambda: thing.anchor_anew(**{draw.choice(spots): value()}))
            attempt(lambda: setattr(thing.servo, draw.choice(list(oo.Servo.FIELDS)), value()))
            attempt(lambda: (thing.reaction, thing.error, thing.angular_error))
        elif kind < 0.8:
            kind = draw.choice(list(JOINED))
            attempt(lambda: join(kind, draw.choice(things), draw.choice(things)))
            cls, spots = JOINED[kind][0], {name: value() for name in JOINED[kind][0].SPOTS if draw.random() < 0.5}
            attempt(lambda: cls(draw.choice(things), draw.choice(things), **JOINED[kind][2] | spots))
            attempt(lambda: world.joint_states)
        elif kind < 0.83:
            attempt(lambda: world.surfaces.__setitem__(("default", "default"), value()))
        elif kind < 0.87 and isinstance(thing, oo.PhysicsNode) and thing.parent is not None:
            parent = thing.parent
            attempt(lambda: parent.detach(thing))
        else:
            if not isinstance(attempt(lambda: world.step(draw.randint(1, 3))), Exception):
                steps += 1
        for body in [b for b in world.walk() if isinstance(b, oo.Body)]:
            for listener in body._touch_listeners:
                body.remove_on_touch(listener)
    is_consistent(world)
print(steps, refused)
"""


@pytest.mark.parametrize("seed", range(2))
def test_no_value_and_no_call_ends_the_process(seed):
    """Random nasty values for all fields and verbs, with steps between: errors of ours, never a crash or a hang."""
    steps, refused = map(int, run_python(FUZZ, str(seed), "40").split())
    assert steps > 50
    assert refused > 300
