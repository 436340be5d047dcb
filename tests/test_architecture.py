"""Which module may know which: read from the imports, so that a breach can't be overlooked."""

import ast
import itertools
import os
from pathlib import Path

import pytest

import osgode

ROOT = Path(osgode.__file__).parent

ORDER = [
    "errors",
    "maths",
    "native",
    "fields",
    "springs",
    "mass",
    "materials",
    "scheduler",
    "graph",
    "render",
    "nodes",
    "joints",
    "assemblies",
    "collision",
    "batch",
    "snapshot",
    "engine",
    "testing",
    "examples",
]
"""Each part may import from itself and from those before it."""

ONLY = {
    "render": {"errors", "maths", "graph"},
    "graph": {"errors", "fields", "maths"},
    "native": {"errors"},
}
"""Parts that know less than the order allows."""

NEVER = {"engine": {"native"}, "testing": {"native"}, "render": {"native"}, "examples": {"native"}}

LIBRARIES = {"cffi": {"native"}, "moderngl": {"render"}, "trimesh": {"graph", "examples"}}
"""What is imported in one place only."""

LAZY = {
    # A node asks for the kinds of nodes around it; these are subclasses of its own base.
    ("osgode.nodes.base", "osgode.nodes.spaces"),
    ("osgode.nodes.bodymass", "osgode.nodes.geom"),
}
"""Imports inside functions that close a circle within one part."""


def modules():
    found = [Path(folder) / name for folder, _, names in os.walk(ROOT, followlinks=True) for name in names]
    for path in sorted(path for path in found if path.suffix == ".py"):
        parts = path.relative_to(ROOT).with_suffix("").parts
        yield ".".join(("osgode", *parts)).removesuffix(".__init__"), path


MODULES = dict(modules())


class Imports(ast.NodeVisitor):
    """The modules that one file imports: at its top, in functions, and for type checkers alone."""

    def __init__(self, path):
        self.top, self.lazy, self.types = set(), set(), set()
        self._found = self.top
        self.visit(ast.parse(path.read_text()))

    def _within(self, node, found):
        outer, self._found = self._found, found if self._found is self.top else self._found
        self.generic_visit(node)
        self._found = outer

    def visit_FunctionDef(self, node):
        self._within(node, self.lazy)

    def visit_AsyncFunctionDef(self, node):
        self._within(node, self.lazy)

    def visit_If(self, node):
        is_types = isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        self._within(node, self.types if is_types else self._found)

    def visit_Import(self, node):
        self._found.update(alias.name for alias in node.names)

    def visit_ImportFrom(self, node):
        assert node.level == 0, "imports are absolute, so that they can be read and searched for"
        for alias in node.names:
            module = f"{node.module}.{alias.name}"
            self._found.add(module if module in MODULES else node.module)


IMPORTS = {name: Imports(path) for name, path in MODULES.items()}


def part(module):
    return module.split(".")[1] if module.startswith("osgode.") else None


def inner(names):
    """Those of the package that are written in Python."""
    return {name for name in names if name in MODULES}


def test_the_imports_are_read():
    """The reader sees the three kinds of imports (else the tests below could not fail)."""
    assert "osgode.errors" in IMPORTS["osgode.fields"].top
    assert "osgode.nodes.spaces" in IMPORTS["osgode.nodes.base"].lazy
    assert "osgode.joints.base" in IMPORTS["osgode.nodes.body"].types
    assert "osgode.joints.base" not in IMPORTS["osgode.nodes.body"].top
    assert len(MODULES) > 30


def test_every_part_has_its_place_in_the_order():
    assert {part(name) for name in MODULES} - {None} <= set(ORDER)


@pytest.mark.parametrize("module", sorted(set(MODULES) - {"osgode"}))
def test_imports_run_one_way(module):
    """Each module imports only from parts before its own, wherever in the file the import stands."""
    own = part(module)
    for name in inner(IMPORTS[module].top | IMPORTS[module].lazy):
        if name == "osgode":
            assert own in ("engine", "examples"), f"{module} imports the names of the whole package"
            continue
        other = part(name)
        assert ORDER.index(other) <= ORDER.index(own), f"{module} imports {name}, which is above it"
        assert other == own or other in ONLY.get(own, ORDER), f"{module} imports {name}: {own} knows {ONLY[own]} only"
        assert other not in NEVER.get(own, ()), f"{module} imports {name}: {own} must not know it"


def _path_back(start, edges):
    """A way along the edges from a module to itself, or None."""
    stack, seen = [(start, [start])], set()
    while stack:
        here, way = stack.pop()
        for name in sorted(edges[here]):
            if name == start:
                return [*way, name]
            if name not in seen:
                seen.add(name)
                stack.append((name, [*way, name]))
    return None


def test_there_is_no_circle():
    """Not even one that an import inside a function hides, but for the few that are named above."""
    edges = {
        name: (inner(imports.top) | {lazy for lazy in inner(imports.lazy) if (name, lazy) not in LAZY}) - {name}
        for name, imports in IMPORTS.items()
    }
    for name in edges:
        # `osgode.examples` and the like are run after `osgode` itself; nothing below imports it.
        assert _path_back(name, edges) is None


def test_each_hidden_circle_is_still_there():
    """A line in LAZY that nothing needs any more must go."""
    for name, lazy in LAZY:
        assert lazy in IMPORTS[name].lazy


@pytest.mark.parametrize("library", sorted(LIBRARIES))
def test_a_library_is_known_in_one_place(library):
    users = {
        part(name)
        for name, imports in IMPORTS.items()
        for found in imports.top | imports.lazy | imports.types
        if found.split(".")[0] == library
    }
    assert users <= LIBRARIES[library]


def test_the_top_names_are_all_that_it_imports():
    """``osgode/__init__.py`` lists every public name that it imports, and no other."""
    tree = ast.parse((ROOT / "__init__.py").read_text())
    names = itertools.chain.from_iterable(node.names for node in tree.body if isinstance(node, ast.ImportFrom))
    assert {alias.asname or alias.name for alias in names} - {"annotations"} == set(osgode.__all__)
    assert len(osgode.__all__) == len(set(osgode.__all__))


def test_nothing_but_worlds_has_a_finalizer():
    """``__del__`` appears nowhere, and ``weakref.finalize`` once: no order of garbage collection can matter."""
    finalizers = []
    for name, path in MODULES.items():
        for node in ast.walk(ast.parse(path.read_text())):
            assert not (isinstance(node, ast.FunctionDef) and node.name == "__del__"), name
            if isinstance(node, ast.Attribute) and node.attr == "finalize":
                finalizers.append(name)
    assert finalizers == ["osgode.nodes.world"]
