"""docs/joints.md says what the classes say, and shows every kind."""

import inspect
import re
import runpy
from pathlib import Path

import pytest

import osgode as oo

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "joints.md").read_text()
TOOL = runpy.run_path(str(ROOT / "tools" / "joints.py"))
GALLERY = PAGE.partition("## Gallery")[2].partition("\n## ")[0]
PICTURES = re.findall(r"!\[(.+)\]\(pictures/(\w+)\.png\)", GALLERY)


def test_the_table_is_up_to_date():
    assert TOOL["page"](PAGE) == PAGE, "run: python tools/joints.py"


def test_the_table_has_every_kind_once():
    rows = re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE)
    joints = [name for name in oo.__all__ if inspect.isclass(cls := getattr(oo, name)) and issubclass(cls, oo.Joint)]
    assert sorted([*rows, "Joint"]) == sorted(joints)


@pytest.mark.parametrize(
    ("kind", "cells"),
    {
        "Ball": {"bodies": "1 or 2", "anchors": "`anchor`", "springs": "the joint", "stops, bounce": "", "servo": ""},
        "Hinge2": {"bodies": "2", "motors": "1, 2", "stops, bounce": "1", "springs": "the stops, the suspension"},
        "Slider": {"anchors": "", "axes": "`axis`", "reads": "`position`", "servo": "yes"},
        "Plane2D": {"bodies": "1", "motors": "1, 2, 3", "stops, bounce": "", "axes": ""},
        "DoubleHinge": {"in ODE": "DHinge", "anchors": "`anchor1`, `anchor2`", "reads": "`length`", "motors": ""},
    }.items(),
)
def test_a_row_says_what_odes_manual_says(kind, cells):
    """Of each feature a kind that has it and one that hasn't."""
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("|")]
    (row,) = (line for line in lines if line[0] == f"`{kind}`")
    assert {name: row[lines[0].index(name)] for name in cells} == cells


def test_the_gallery_shows_every_kind_and_every_picture_has_its_example():
    shown = " ".join(re.findall(r"^### (.*)", GALLERY, re.MULTILINE)).replace(",", " ").split()
    assert {kind.__name__ for kind in TOOL["kinds"]()} <= set(shown)
    examples = set((ROOT / "tools" / "gallery.py").read_text().split('"')[1::2])
    assert {name for _, name in PICTURES} <= examples
    for _, name in PICTURES:
        assert f"[{name}.py](../examples/{name}.py)" in GALLERY
        assert "show_joints(" in (source := (ROOT / "examples" / f"{name}.py").read_text()) or "joint_marks(" in source


@pytest.mark.parametrize("name", [name for _, name in PICTURES])
def test_a_picture_is_small_and_shows_marks(name):
    """Under 250 kB, and with some of the pure colours that only marks have."""
    images = pytest.importorskip("PIL.Image")
    path = ROOT / "docs" / "pictures" / f"{name}.png"
    assert path.stat().st_size < 250_000
    with images.open(path) as image:
        assert image.size == (800, 450)
        colours = image.convert("RGB").getcolors(800 * 450)
    halo = sum(count for count, (red, green, blue) in colours if min(green, blue) - red > 60 and abs(green - blue) < 60)
    red = sum(count for count, (red, green, blue) in colours if red > 190 and max(green, blue) < 60)
    assert halo + red > 40
