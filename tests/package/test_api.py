# SPDX-License-Identifier: Apache-2.0
"""The public interface: names and signatures are those of api.txt, and help() can show them.

After a deliberate change, `make docs` writes the file.
"""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

import palmbots as pb
from palmbots.errors import PalmbotsError

API = Path(__file__).with_name("api.txt")
MODULES = [pb, *(getattr(pb, n) for n in dir(pb) if inspect.ismodule(getattr(pb, n)))]
LONGEST_ANNOTATION, LONGEST_SIGNATURE = 40, 400


def public_names(module: Any) -> list[tuple[str, Any]]:
    """The names with their values, sorted."""
    return [(name, getattr(module, name)) for name in dir(module)]


def signature_of(function: Any) -> str:
    """As help() shows it: annotations are quoted where their evaluation is deferred."""
    text = str(inspect.signature(function)).replace("'", "")
    return re.sub(r"<(\S+) (\S+) at 0x\w+>", r"<\1 \2>", text)


def kind_of(value: Any) -> str:
    if inspect.ismodule(value):
        return "module"
    if inspect.isclass(value):
        return "class"
    return "function" if callable(value) and hasattr(value, "__qualname__") else "value"


def api_lines() -> list[str]:
    """One line for each public name."""
    lines = []
    for module in MODULES:
        for name, value in public_names(module):
            kind = kind_of(value)
            text = signature_of(value) if isinstance(value, FunctionType) else ""
            lines.append(f"{kind} {module.__name__}.{name}{text}")
    return lines


def public_functions() -> list[Any]:
    functions = {}
    for module in MODULES:
        for name, value in public_names(module):
            if isinstance(value, FunctionType):
                functions[f"{module.__name__}.{name}"] = value
    return [pytest.param(value, id=name) for name, value in functions.items()]


def test_public_interface_is_that_of_the_file() -> None:
    """When this fails on purpose: `make docs`."""
    assert api_lines() == API.read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("function", public_functions())
def test_signature_is_readable(function: Any) -> None:
    for parameter in inspect.signature(function).parameters.values():
        shown = inspect.formatannotation(parameter.annotation).strip("'")
        assert len(shown) <= LONGEST_ANNOTATION, f"{parameter.name}: {shown}"
    assert len(signature_of(function)) <= LONGEST_SIGNATURE
    assert function.__doc__


@pytest.mark.parametrize(
    "name", sorted(set(dir(pb)) - {"feasible_contact_modes", "contact_modes_batch"})
)
def test_arguments_after_the_second_are_keywords(name: str) -> None:
    function = getattr(pb, name)
    if isinstance(function, FunctionType):
        parameters = list(inspect.signature(function).parameters.values())
        assert all(p.kind in (p.KEYWORD_ONLY, p.VAR_KEYWORD) for p in parameters[2:])


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_names_that_type_checkers_see_are_those_of_the_module(module: Any) -> None:
    """Each is listed once: as an import of the name as itself."""
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    imports = [alias for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)
               for alias in node.names]  # fmt: skip
    assert dir(module) == module.__all__ == sorted(a.name for a in imports if a.asname == a.name)
    assert all(alias.asname in (None, alias.name) for alias in imports)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        module.nonsense  # noqa: B018


def test_every_public_name_is_exported_by_one_module() -> None:
    places: dict[str, list[str]] = {}
    for module in MODULES:
        for name in dir(module):
            places.setdefault(name, []).append(module.__name__)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_no_public_function_shadows_a_module() -> None:
    """`palmbots.room.function` and a module of that name could not both be reached."""
    for module in MODULES:
        modules = {path.stem for path in Path(module.__file__).parent.iterdir()}
        assert not modules & {n for n, value in public_names(module) if not inspect.ismodule(value)}


def test_importing_palmbots_imports_no_optional_and_no_slow_package() -> None:
    slow = {"mujoco", "scipy", "xarray", "pandas", "matplotlib", "zarr", "pettingzoo", "mcap"}
    program = f"import sys, palmbots; print(sorted({slow!r} & set(sys.modules)))"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout == "[]\n"


def test_exceptions_have_one_base() -> None:
    assert issubclass(pb.SceneError, PalmbotsError)


if __name__ == "__main__":
    API.write_text("\n".join(api_lines()) + "\n", encoding="utf-8")
