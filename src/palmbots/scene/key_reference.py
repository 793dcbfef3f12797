# SPDX-License-Identifier: Apache-2.0
"""Lists for people: the scene keys with unit and meaning, the built-in scenes and objects.

The source of a key's meaning is the docstring below its field, of its unit and limits the field's
validator, which has them from the core's table if the core reads the key, and of a scene's or
object's meaning the comment at the top of its file. ``palmbots keys``, ``palmbots init scene`` and
the key table of the docs use these lists.
"""

import ast
import inspect
import os
import textwrap
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import BaseModel, BeforeValidator

from palmbots._types import SIDES
from palmbots._util.atomic_files import write_whole
from palmbots._util.command import Option, command
from palmbots._util.toml_writer import toml_value
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.core_keys import Optionally
from palmbots.scene.fields import SWITCH, is_switch
from palmbots.scene.overrides import HOLDERS
from palmbots.scene.scene import Scene
from palmbots.scene.section import plain_name

_LINE_WIDTH = 78
_LICENCE = "# SPDX-License-Identifier: Apache-2.0"


@dataclass(frozen=True)
class SceneKey:
    """One key of a scene."""

    name: str
    """Dotted, such as ``palm.friction``."""
    default: Any
    """None: not set."""
    unit: str
    """Empty: the key has none, or its name or meaning states it."""
    meaning: str
    allowed: str = ""
    """The values that the key may have; empty: its meaning states them."""

    @property
    def default_text(self) -> str:
        """The default as in a TOML file; empty: not set."""
        return "" if self.default is None else toml_value(self.default)


@cache
def scene_keys() -> tuple[SceneKey, ...]:
    """All keys in the order of the sections."""
    scene = Scene()
    return tuple(
        key
        for section in Scene.model_fields
        for key in section_keys(type(getattr(scene, section)), section)
    )


def section_keys(model: type[BaseModel], section: str) -> Iterator[SceneKey]:
    """The keys of a table and of the tables in it; `section` is its name."""
    meanings = field_meanings(model)
    for name, field in model.model_fields.items():
        # palm.left.… has keys of palm.…; so have the other sections with holders, and hardware.
        if name in (*SIDES, "station") and section in (*HOLDERS, "hardware"):
            continue
        default = field.get_default(call_default_factory=True)
        if isinstance(default, BaseModel):
            yield from section_keys(type(default), f"{section}.{name}")
        else:
            unit, allowed = _limits((*field.metadata, *getattr(field.annotation, "__args__", ())))
            meaning = meanings.get(name, "")
            yield SceneKey(f"{section}.{name}", _plain(default), unit, meaning, allowed)


def _plain(default: Any) -> Any:
    """A default as plain tables and lists."""
    if isinstance(default, tuple):
        return tuple(_plain(item) for item in default)
    return default.model_dump() if isinstance(default, BaseModel) else default


def _limits(annotations: Any) -> tuple[str, str]:
    """Unit and limits, in words, of the validator in the annotations of a field."""
    for annotation in annotations:
        if isinstance(annotation, BeforeValidator):
            check: Any = annotation.func
            check = check.check if isinstance(check, Optionally) else check
            allowed = SWITCH if check is is_switch else getattr(check, "allowed", "")
            return getattr(check, "unit", ""), allowed
        found = _limits(getattr(annotation, "__metadata__", ()))
        if found != ("", ""):
            return found
    return "", ""


@cache
def field_meanings(model: type[BaseModel]) -> Mapping[str, str]:
    """The docstrings below the fields of a model, by field."""
    found: dict[str, str] = {}
    for owner in reversed(model.__mro__):
        if not issubclass(owner, BaseModel) or owner is BaseModel:
            continue
        body = ast.parse(textwrap.dedent(inspect.getsource(owner))).body[0]
        assert isinstance(body, ast.ClassDef)
        for field, text in zip(body.body, body.body[1:], strict=False):
            if (
                isinstance(field, ast.AnnAssign)
                and isinstance(field.target, ast.Name)
                and isinstance(text, ast.Expr)
                and isinstance(text.value, ast.Constant)
            ):
                found[plain_name(field.target.id)] = " ".join(str(text.value.value).split())
    return found


def built_in_meanings(kind: str) -> dict[str, str]:
    """The first sentence of each built-in file, by name; `kind` is ``scenes`` or ``objects``."""
    folder = resources.files("palmbots.scene") / "data" / kind
    files = {f.name.removesuffix(".toml"): f for f in folder.iterdir() if f.name.endswith(".toml")}
    return {name: _first_sentence(files[name].read_text("utf-8")) for name in sorted(files)}


def _first_sentence(text: str) -> str:
    """The first sentence of the comment at the top of a file, after the line with its licence."""
    comment = []
    for line in text.removeprefix(f"{_LICENCE}\n").splitlines():
        if not line.startswith("#"):
            break
        comment.append(line.lstrip("# "))
    sentence = " ".join(comment).split(". ")[0]
    return sentence if sentence.endswith(".") else f"{sentence}."


@command(
    "init scene",
    order=190,
    example="palmbots init scene my.toml",
    then="palmbots assess {path}",
    path=Option(is_argument=True, metavar="FILE"),
)
def init_scene(path: str | os.PathLike[str]) -> Path:
    """Write the default scene with the unit and meaning of every key.

    An existing file is never overwritten.

    Args:
        path: new TOML file.

    Raises:
        PalmbotsError: the name does not end in .toml, the file exists, or it cannot be written.
    """
    file = user_path(path)
    if not file.name.endswith(".toml"):
        raise PalmbotsError(f"FILE: value is {file}; allowed: a name that ends in .toml")
    write_whole(file, default_scene_toml(), new=True)
    return file


def default_scene_toml() -> str:
    """The default scene as TOML, with the meaning and unit of each key as a comment."""
    head = [
        "# A scene for palmbots with the default of every key. A key that you remove",
        "# keeps its default. Keys of one side or sender override those of all:",
        *(f"# [{'], ['.join(f'{table}.{one}' for one in own)}]" for table, own in HOLDERS.items()),
        "# The keys of the paper's box are in comments. With an outline of your own",
        "# (vertices_m or box_m), the others of these keys follow from it.",
        "# Run it: palmbots carry FILE",
    ]
    return commented_toml(head, scene_keys(), _OF_THE_BOX)


_OF_THE_BOX = ("object.vertices_m", "object.contacts", "object.com_m", "object.mass_kg")
"""The keys that follow from an outline if a scene does not set them."""


def commented_toml(
    head: Iterable[str], keys: Iterable[SceneKey], unset: Collection[str] = ()
) -> str:
    """Keys with their defaults as TOML, below `head`, with meaning and unit as comments. The
    defaults of the keys in `unset` are comments, too."""
    lines = [*head]
    section = ""
    for key in keys:
        table, _, name = key.name.rpartition(".")
        if table != section:
            section = table
            lines += ["", f"[{table}]"]
        unit = f" [{key.unit}]" if key.unit else ""
        text = f"{key.meaning}{unit}".strip()
        lines += textwrap.wrap(text, _LINE_WIDTH, initial_indent="# ", subsequent_indent="# ")
        line = f"{name} = {key.default_text}".rstrip()
        lines.append(line if key.default_text and key.name not in unset else f"# {line}")
    return "\n".join(lines) + "\n"
