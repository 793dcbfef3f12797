# SPDX-License-Identifier: Apache-2.0
"""Imports go downwards only: layers.toml against the C++ includes and every Python import. Within a
room, and on the page, no circle of files import each other.

Imports inside functions and under TYPE_CHECKING count, and so do modules that a text names, such as
``"palmbots.viz.animation:save"``. Docstrings may name every room.
"""

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Callable
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

import pytest

from cxx import ROOT, build

LAYERS = tomllib.loads((Path(__file__).parent / "layers.toml").read_text(encoding="utf-8"))
CORE = {row["room"]: set(row["may_include"]) for row in LAYERS["core"]}
HEADERS = sorted((ROOT / "include" / "palmbots").rglob("*.hpp"))
PACKAGE = ROOT / "src" / "palmbots"

# Imports that still point upwards, file by file. This list may only become shorter.
UPWARD: dict[str, set[str]] = {}

# Imports for types alone that close a circle, by module. This list may only become shorter.
CIRCLES = {
    "palmbots.stability.tightest_margins": {"palmbots.stability.analysis"},
}


def _closed(rows: list[dict[str, Any]]) -> dict[str, set[str]]:
    """Each Python room with all rooms that it may import: those of its row, and what they may
    import."""
    allowed: dict[str, set[str]] = {}
    for row in rows:
        below = set(map(str, row["may_import"]))
        assert below <= set(allowed), f"{row['room']}: a room stands above those that it may import"
        allowed[str(row["room"])] = below.union(*(allowed[room] for room in below))
    return allowed


PYTHON = _closed(LAYERS["python"])


def python_room(module: str) -> str:
    """The room of a dotted module name."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "palmbots"


def imported_modules(path: Path) -> set[str]:
    """The modules of the package that a file imports, anywhere in the file."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module
            for name in node.names:
                inside = PACKAGE.parent / Path(*node.module.split("."), name.name)
                is_module = inside.is_dir() or inside.with_suffix(".py").exists()
                modules.add(f"{node.module}.{name.name}" if is_module else node.module)
    return {m for m in modules if m.split(".")[0] == "palmbots"}


def named_modules(source: str) -> set[str]:
    """The modules of the package that the texts in a source name, docstrings excepted."""
    nodes = list(ast.walk(ast.parse(source)))
    docstrings = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    texts = [
        node.value
        for node in nodes
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and id(node) not in docstrings
    ]
    names = {name for text in texts for name in re.findall(r"\bpalmbots(?:\.\w+)+", text)}
    return {name for name in names if python_room(name) in PYTHON}


def upward(modules_of: Callable[[Path], set[str]]) -> dict[str, set[str]]:
    """The modules of higher rooms that `modules_of` finds in each file."""
    table: dict[str, set[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        relative = path.relative_to(PACKAGE)
        room = relative.parts[0].removesuffix(".py").replace("__init__", "palmbots")
        legal = PYTHON[room] | {room}
        bad = {m for m in modules_of(path) if python_room(m) not in legal}
        if bad:
            table[relative.as_posix()] = bad
    return table


def test_python_imports_go_downwards() -> None:
    assert upward(imported_modules) == UPWARD


def test_modules_import_each_other_in_no_circle() -> None:
    table: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        module = ".".join(parts).removesuffix(".__init__")
        table[module] = imported_modules(path)
    assert all(left_out <= table[module] for module, left_out in CIRCLES.items())
    graph = {module: found - CIRCLES.get(module, set()) for module, found in table.items()}
    TopologicalSorter(graph).prepare()  # raises CycleError, which names the modules


def test_files_of_the_page_import_each_other_in_no_circle() -> None:
    """And those of `shared` import nothing from above."""
    pattern = r'(?:from |import[ (])"(\.[^"]+)'
    graph = {
        path.with_suffix(""): {
            (path.parent / name).resolve()
            for name in re.findall(pattern, path.read_text(encoding="utf-8"))
        }
        for path in (ROOT / "site" / "src").rglob("*.ts*")
    }
    TopologicalSorter(graph).prepare()
    shared = [found for path, found in graph.items() if path.parent.name == "shared"]
    assert {name.parent.name for name in set.union(*shared)} == {"shared", "generated"}


def test_texts_name_no_higher_room() -> None:
    """A name in a text is an import that is done later."""
    assert upward(lambda path: named_modules(path.read_text(encoding="utf-8"))) == {}


def test_modules_in_texts_are_found() -> None:
    source = (
        '"""See `palmbots.cli`."""\n'
        'load("palmbots.viz.animation:save", f"palmbots.studies.{name}")\n'
        'class A:\n    b = "palmbots.cli.main"\n    """As in `palmbots.learn`."""\n'
        'print("palmbots derive", "palmbots.mcap", "palmbots.object_names", "my.palmbots_viz")\n'
    )
    found = {"palmbots.viz.animation", "palmbots.studies", "palmbots.cli.main"}
    assert named_modules(source) == found


def test_every_python_room_is_listed() -> None:
    sources = [path for path in PACKAGE.rglob("*") if path.suffix in (".py", ".pyi")]
    rooms = {
        path.relative_to(PACKAGE).parts[0].split(".")[0].replace("__init__", "palmbots")
        for path in sources
    }
    assert rooms == set(PYTHON)


def core_room(include: str) -> str:
    return include.split("/")[1]


def core_includes(path: Path) -> list[str]:
    return re.findall(r'^#include "(palmbots/.+)"', path.read_text(encoding="utf-8"), re.MULTILINE)


def test_core_includes_go_downwards() -> None:
    result = set()
    for path in HEADERS:
        room = path.relative_to(ROOT / "include" / "palmbots").parts[0]
        for include in core_includes(path):
            if core_room(include) not in CORE[room] | {room}:
                result.add((path.relative_to(ROOT / "include" / "palmbots").as_posix(), include))
    assert result == set()


def test_every_core_room_is_listed() -> None:
    rooms = {path.name for path in (ROOT / "include" / "palmbots").iterdir() if path.is_dir()}
    assert rooms == set(CORE)


def test_no_two_modules_share_a_name() -> None:
    names = Counter(path.name for path in PACKAGE.rglob("*.py") if path.name != "__init__.py")
    assert [name for name, count in names.items() if count > 1] == []


@pytest.mark.soak
def test_headers_compile_on_their_own() -> None:
    result = build("headers")
    assert result.returncode == 0, result.stdout + result.stderr
