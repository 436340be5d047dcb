"""Names and bits of materials and kinds, surfaces, and the table of how pairs of materials meet."""

import itertools
import math

import pytest

import osgode as oo
from osgode import materials
from osgode.materials import ALL_BITS, LIMIT, category_bits, collide_bits, material
from osgode.native import lib


@pytest.fixture
def registry(monkeypatch):
    """The names that osgode comes with, to be added to without a trace."""
    monkeypatch.setattr(materials, "_materials", dict(materials._materials))
    monkeypatch.setattr(materials, "_kinds", {"default": 0})


# -- names


def test_a_material_is_known_by_its_name(registry):
    made = oo.define_material("cork", 240.0, "a table")
    assert material("cork") is made
    assert made.density == 240.0
    assert made.source == "a table"
    assert oo.Box(material="cork", name="it").material == "cork"


def test_defining_a_material_again_changes_nothing(registry):
    made = oo.define_material("cork", 240.0)
    assert oo.define_material("cork", 240.0) is made
    with pytest.raises(oo.FieldError, match="'cork' exists already with 240"):
        oo.define_material("cork", 250.0)


def test_there_are_16_materials_and_16_kinds(registry):
    for i in range(LIMIT - len(materials._materials)):
        oo.define_material(f"m{i}")
    for i in range(LIMIT - len(materials._kinds)):
        oo.define_kind(f"k{i}")
    with pytest.raises(oo.FieldError, match=r"'one more'.*16.*'wood'"):
        oo.define_material("one more")
    with pytest.raises(oo.FieldError, match=r"'one more'.*16.*'default'"):
        oo.define_kind("one more")
    bits = {category_bits(m, k) for m, k in itertools.product(materials._materials, materials._kinds)}
    assert len(bits) == LIMIT * LIMIT
    assert all(0 < b <= 0xFFFFFFFF and b.bit_count() == 2 for b in bits)


@pytest.mark.parametrize("name", ["", None, 5, [], b"wood"])
def test_a_name_is_a_str(name, registry):
    with pytest.raises(oo.FieldError, match="material"):
        oo.define_material(name)
    with pytest.raises(oo.FieldError, match="kind"):
        oo.define_kind(name)
    with pytest.raises(oo.FieldError, match=r"material is .*'wood'"):
        material(name)


@pytest.mark.parametrize("density", [0.0, -1.0, math.nan, math.inf, "heavy", None])
def test_a_density_is_a_number(density, registry):
    with pytest.raises(oo.FieldError, match=r"'cork'.*density"):
        oo.define_material("cork", density)
    assert "cork" not in materials._materials


def test_an_unknown_name_tells_the_known_ones(registry):
    with pytest.raises(oo.FieldError, match=r"Box 'it'\.material is 'wod'.*'wood'.*define_material"):
        oo.Box(name="it", material="wod")
    with pytest.raises(oo.FieldError, match=r"Box 'it'\.kind is 'ghost'.*'default'.*define_kind"):
        oo.Box(name="it", kind="ghost")
    with pytest.raises(oo.FieldError, match=r"Box 'it'\.collides_with is .*'ghost'.*'default'.*define_kind"):
        oo.Box(name="it", collides_with=["default", "ghost"])


def test_published_materials_name_their_sources():
    assert all(entry.source for entry in materials._materials.values() if entry.index < 10)
    assert material("steel").density == pytest.approx(7860)
    assert material("ice").density < material("default").density == 1000


# -- bits


def test_the_lower_bits_say_what_is_met(registry):
    oo.define_kind("player")
    oo.define_kind("shot")
    assert collide_bits(None) == ALL_BITS
    assert collide_bits(frozenset()) == 0
    player, shot = category_bits("wood", "player"), category_bits("steel", "shot")
    assert collide_bits(frozenset({"player"})) & player
    assert not collide_bits(frozenset({"player"})) & shot
    assert collide_bits(frozenset({"player", "shot"})) & shot
    assert player >> LIMIT == 1 << material("wood").index


@pytest.mark.parametrize("kinds", ["default", ["default"], {"default"}, ("default",), frozenset({"default"})])
def test_kinds_come_in_any_collection(kinds):
    assert oo.Box(collides_with=kinds).collides_with == frozenset({"default"})


# -- surfaces


def test_a_surface_is_a_row_of_odes():
    row = oo.Surface(0.25, bounce=0.5, bounce_velocity=0.2, slip=0.01, soft_erp=0.3, soft_cfm=1e-4).row(0.01)
    assert (row.mu, row.bounce, row.bounce_vel) == (0.25, 0.5, 0.2)
    assert (row.slip1, row.slip2, row.soft_erp, row.soft_cfm) == (0.01, 0.01, 0.3, 1e-4)
    wanted = (
        lib.dContactApprox1
        | lib.dContactBounce
        | lib.dContactSlip1
        | lib.dContactSlip2
        | lib.dContactSoftERP
        | lib.dContactSoftCFM
    )
    assert row.mode == wanted


def test_a_plain_surface_turns_nothing_on():
    assert oo.Surface().row(0.01).mode == lib.dContactApprox1
    assert oo.Surface(model="force limit").row(0.01).mode == lib.dContactApprox0
    assert oo.Surface(math.inf).row(0.01).mu == math.inf
    rolling = oo.Surface(rolling_friction=0.02).row(0.01)
    assert rolling.mode == lib.dContactApprox1 | lib.dContactRolling
    assert (rolling.rho, rolling.rho2, rolling.rhoN) == (0.02, 0.02, 0.02)


@pytest.mark.parametrize(
    ("name", "bad"),
    [
        *(("friction", value) for value in (-0.1, math.nan, "much", None, [1], 10**400)),
        *(("bounce", value) for value in (-0.1, 1.1, math.nan, math.inf, "much", None)),
        *(("bounce_velocity", value) for value in (-0.1, math.nan, math.inf, None)),
        *(("slip", value) for value in (-0.1, math.nan, math.inf, None)),
        *(("soft_erp", value) for value in (-0.1, 1.1, math.nan)),
        *(("soft_cfm", value) for value in (-1.0, 0.0, 1e-13, math.nan, math.inf)),
        *(("rolling_friction", value) for value in (-0.1, math.nan, math.inf)),
        *(("model", value) for value in ("", "cone", None, 1, ["pyramid"])),
    ],
    ids=lambda value: str(value)[:12],
)
def test_a_surface_out_of_range_is_refused(name, bad):
    """No friction from NaN, no energy from a bounce above 1, no endless LCP messages from negative softness."""
    with pytest.raises(oo.FieldError, match=rf"Surface\.{name} is .*must be"):
        oo.Surface(**{name: bad})


# -- the table


def test_the_table_does_not_care_which_comes_first():
    table = oo.SurfaceTable()
    table["wood", "steel"] = oo.Surface(0.25)
    assert table["steel", "wood"] is table["wood", "steel"]
    assert ("steel", "wood") in table
    assert ("steel", "ice") not in table
    assert len(table) == 1
    table["steel", "wood"] = oo.Surface(0.5)
    assert len(table) == 1
    assert table["wood", "steel"].friction == 0.5


def test_a_missing_pair_has_the_fallback():
    table = oo.SurfaceTable({("wood", "wood"): oo.Surface(0.25)}, fallback=oo.Surface(0.75))
    assert table["wood", "ice"].friction == 0.75
    table.fallback = oo.Surface(0.125)
    assert table["wood", "ice"].friction == 0.125
    assert table["wood", "wood"].friction == 0.25


def test_a_copy_of_a_table_is_on_its_own():
    table = oo.SurfaceTable(fallback=oo.Surface(0.75))
    twin = table.copy()
    twin["wood", "wood"] = oo.Surface(0.25)
    twin.fallback = oo.Surface(0.5)
    assert not len(table)
    assert table.fallback.friction == 0.75


@pytest.mark.parametrize("pair", ["wood", ("wood",), ("wood", "wod"), ("wood", "ice", "ice"), 5, None, ([], {})])
def test_a_pair_is_two_names(pair):
    table = oo.SurfaceTable()
    with pytest.raises(oo.FieldError):
        table[pair] = oo.Surface()
    with pytest.raises(oo.FieldError):
        table[pair]
    assert not len(table)


def test_only_surfaces_go_into_a_table():
    table = oo.SurfaceTable()
    with pytest.raises(oo.FieldError, match="must be a Surface"):
        table["wood", "wood"] = 0.5
    with pytest.raises(oo.FieldError, match="must be a Surface"):
        table.fallback = 0.5
    with pytest.raises(oo.FieldError, match="must be a Surface"):
        oo.SurfaceTable(fallback=0.5)
    with pytest.raises(oo.FieldError, match="must be a SurfaceTable"):
        oo.World(name="it").surfaces = {}
    assert not len(table)


def test_the_published_pairs_name_their_sources():
    assert all(oo.PUBLISHED[pair].source for pair in oo.PUBLISHED)
    assert oo.PUBLISHED["rubber", "concrete"].friction == 1.0
    assert oo.PUBLISHED["steel", "ice"].friction < 0.05


# -- in a World


def row_of(world, one, other):
    return world._realm.ptr.surfaces[LIMIT * material(one).index + material(other).index]


def test_a_world_starts_with_the_published_pairs_and_has_its_own_copy():
    world = oo.World()
    world.surfaces["wood", "ice"] = oo.Surface(0.03)
    assert ("wood", "ice") not in oo.PUBLISHED
    assert row_of(world, "wood", "ice").mu == row_of(world, "ice", "wood").mu == 0.03
    assert row_of(world, "rubber", "concrete").mu == 1.0
    assert row_of(world, "glass", "rubber").mu == 0.5
    world.surfaces.fallback = oo.Surface(0.25)
    assert row_of(world, "glass", "rubber").mu == 0.25
    assert row_of(oo.World(), "wood", "ice").mu == 0.5


def test_a_table_can_be_put_in_as_a_whole_and_stays_apart():
    table = oo.SurfaceTable({("wood", "wood"): oo.Surface(0.125)}, fallback=oo.Surface(0.375))
    first, second = oo.World(), oo.World()
    first.surfaces = second.surfaces = table
    first.surfaces["wood", "wood"] = oo.Surface(0.5)
    assert row_of(first, "wood", "wood").mu == 0.5
    assert row_of(second, "wood", "wood").mu == table["wood", "wood"].friction == 0.125
    assert row_of(first, "steel", "ice").mu == 0.375


def test_a_geoms_own_surface_goes_before_the_table_and_the_slipperier_of_two_counts():
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    world.collide(space)
    body = space.attach(oo.Body(position=(0, 0.4, 0)))
    box = body.attach(oo.Placeable()).attach(oo.Box(surface=oo.Surface(0.75)))
    floor = space.attach(oo.Plane())

    def friction():
        world.step()
        surface = {int(row["surface"]) for row in world.contacts}.pop()
        return world._realm.ptr.surfaces[surface].mu

    assert friction() == 0.75
    floor.surface = oo.Surface(0.25)
    assert friction() == 0.25
    box.surface = oo.Surface(0.125)
    assert friction() == 0.125
    box.surface = floor.surface = None
    assert friction() == world.surfaces["default", "default"].friction


def test_places_of_own_surfaces_are_used_again():
    world = oo.World()
    space = world.attach(oo.SimpleSpace())
    sphere = oo.Sphere(surface=oo.Surface(0.25))
    for _ in range(10):
        space.attach(sphere)
        sphere.surface = oo.Surface(0.75)
        space.detach(sphere)
    assert world._realm.ptr.surface_count == LIMIT * LIMIT + 1
