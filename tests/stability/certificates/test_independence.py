# SPDX-License-Identifier: Apache-2.0
"""The checker of certificates shares no code with the prover."""

import ast
from pathlib import Path

import palmbots as pb

PACKAGE = Path(pb.__file__).parent
CHECKER = "palmbots.stability.certificates.checker"
FOLDER = PACKAGE.joinpath(*CHECKER.split(".")[1:])


def imported_modules(path: Path) -> set[str]:
    """The modules that a file imports, wherever in the file."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            modules |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            modules |= {name.name for name in node.names}
    return modules


def source_of(module: str) -> Path | None:
    """The file of a module of the package; None: there is no such module."""
    path = PACKAGE.joinpath(*module.split(".")[1:])
    candidates = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


def reachable(modules: set[str]) -> set[str]:
    """All modules of the package that these import, directly or through others."""
    found: set[str] = set()
    pending = {module for module in modules if module.startswith("palmbots.")}
    while pending:
        module = pending.pop()
        path = source_of(module)
        if module in found or path is None:
            continue
        found.add(module)
        pending |= {name for name in imported_modules(path) if name.startswith("palmbots.")}
    return found


def computes(module: str) -> bool:
    """Whether a module has code that runs, not only declarations of types."""
    path = source_of(module)
    assert path is not None
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return any(isinstance(node, ast.FunctionDef | ast.Call | ast.Assign) for node in ast.walk(tree))


def test_checker_reaches_no_other_module_of_its_room() -> None:
    modules = {f"{CHECKER}.{path.stem}" for path in FOLDER.glob("*.py")}
    assert len(modules) > 8
    others = {m for m in reachable(modules) if m.startswith("palmbots.stability")}
    others = {m for m in others if source_of(m) is not None and not m.startswith(CHECKER)}
    assert not {m for m in others if computes(m)}, others
    assert computes(f"{CHECKER}.verify") and computes("palmbots.stability.certificates.prover")
    assert "palmbots.scene.scene" in reachable(modules)  # the search follows imports


def test_checker_does_not_compute_the_frame_with_the_package() -> None:
    """Only the scene's reader and what all results and commands share: no geometry, no core and no
    arithmetic of the prover."""
    shared: set[str] = set()
    for path in FOLDER.glob("*.py"):
        modules = imported_modules(path)
        assert not modules & {"flint", "numpy", "palmbots._core"}, path.name
        shared |= {m for m in modules if m.startswith("palmbots") and not m.startswith(CHECKER)}
    packages = {"palmbots.errors", "palmbots.scene.file_kinds", "palmbots.scene.scene"}
    helpers = ("arguments", "command", "plain_values", "report", "results", "user_paths")
    packages |= {f"palmbots._util.{name}" for name in helpers}
    assert {m for m in shared if source_of(m) is not None and computes(m)} == packages


def test_no_module_of_the_room_imports_the_checker() -> None:
    for path in (PACKAGE / "stability").rglob("*.py"):
        if path.parent != FOLDER and path.name != "__init__.py":
            assert not {m for m in imported_modules(path) if m.startswith(CHECKER)}, path
