# SPDX-License-Identifier: Apache-2.0
"""Every key of every kind of file refuses what its limits exclude, in one line with the limits.

The keys are those of the models; keys of the core have the limits of its table.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

import pytest
from pydantic import BaseModel, BeforeValidator, ValidationError

from palmbots.errors import SceneError
from palmbots.pair.pair_keys import PairFile
from palmbots.scene.core_keys import ROWS, Optionally
from palmbots.scene.error_messages import dotted_keys, validation_message
from palmbots.scene.fields import OneOf, OneOrList, Range, from_list, is_switch, whole
from palmbots.scene.scene import Scene, load_scene
from palmbots.studies.study_file import Study, load_plan

READ_FIRST = ("task.path.file",)
"""Keys that are read before the model looks at its fields."""


@dataclass(frozen=True)
class Key:
    """A key with limits."""

    model: type[BaseModel]
    path: str
    """As messages spell it: ``faults.script[0].ppm``."""
    check: Any
    beside: dict[str, Any]
    """The other keys that its table needs."""

    @property
    def row(self) -> dict[str, Any] | None:
        """The key in the table of the core, if it is there."""
        name = re.sub(r"\.(left|right|station)\.", ".", self.path.replace("[0]", "[]"))
        row = ROWS.get(name) or ROWS.get(f"{name}[]")  # of an item, where the key may be a list
        return row if self.model is Scene else None

    def line_for(self, value: object) -> str:
        """What is said about a value of this key."""
        return line_for(self.model, self.path, value, self.beside)


def line_for(model: type[BaseModel], path: str, value: object, beside: dict[str, Any]) -> str:
    """What is said about a file with this value, without the name of the file in front."""
    table: Any = {**beside, path.rpartition(".")[2]: value}
    for part in reversed(path.split(".")[:-1]):
        table = {part.removesuffix("[0]"): [table] if part.endswith("[0]") else table}
    if model is PairFile:
        with pytest.raises(ValidationError) as fault:
            model.model_validate(table)
        return validation_message(fault.value, model)
    with pytest.raises(SceneError) as error:
        load_scene(table) if model is Scene else load_plan(table)
    return str(error.value).partition(": ")[2]


def checks_in(kind: Any) -> Iterator[Any]:
    """The validators of a type, but not those of the items of a list."""
    if get_origin(kind) is Literal:
        yield kind
    elif get_origin(kind) is not tuple:
        yield from (one.func for one in get_args(kind) if isinstance(one, BeforeValidator))
        for part in get_args(kind):
            yield from checks_in(part)


def check_of(field: Any) -> Any:
    """What checks the values of a field; None: they have no limits."""
    found = [one.func for one in field.metadata if isinstance(one, BeforeValidator)]
    found = [*found, *checks_in(field.annotation)]
    found = [one.check if isinstance(one, Optionally) else one for one in found]
    kinds = Range | whole | OneOf | OneOrList | from_list
    known = [one for one in found if isinstance(one, kinds) or one is is_switch
             or get_origin(one) is Literal]  # fmt: skip
    if not found and field.annotation in (str, str | None):
        return str
    return known[0] if known else None


def models_in(kind: Any) -> Iterator[tuple[type[BaseModel], bool]]:
    """The tables of a type, and whether it is a list of them."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind, False
    for part in get_args(kind):
        for model, is_list in models_in(part):
            yield model, is_list or get_origin(kind) is tuple


def allowed_value(check: Any) -> Any:
    """A value that a check allows."""
    if get_origin(check) is Literal:
        return get_args(check)[0]
    if isinstance(check, OneOf):
        return check.names[0]
    return True if check is is_switch else check.least


def keys_of(
    root: type[BaseModel], model: type[BaseModel] | None = None, prefix: str = ""
) -> Iterator[Key]:
    """All keys with limits of a kind of file."""
    fields = (model or root).model_fields
    needed = {
        name: allowed_value(check_of(field))
        for name, field in fields.items()
        if field.is_required()
    }
    for name, field in fields.items():
        check = check_of(field)
        if check is not None and prefix + name not in READ_FIRST:
            yield Key(root, prefix + name, check, needed)
        for inner, is_list in models_in(field.annotation):
            yield from keys_of(root, inner, f"{prefix}{name}{'[0]' * is_list}.")


def row_in_words(row: dict[str, Any]) -> str:
    """What a row of the core's table allows."""
    if row["kind"] == "flag":
        return "true or false"
    if row["kind"] == "choice":
        *others, last = map(repr, row["choices"])
        return f"{', '.join(others)} or {last}"
    noun, form = ("a whole number", ".0f") if row["kind"] == "whole" else ("a number", "g")
    unit = f" in {row['unit']}" * bool(row["unit"])
    least, most = (None if end is None else f"{end:{form}}" for end in (row["least"], row["most"]))
    if most is None:
        return f"{noun}{unit}, at least {least}"
    if row["is_open"]:
        return f"{noun}{unit}, more than {least} and less than {most}"
    return f"{noun}{unit}, from {least} to {most}"


def outside(check: Any) -> Iterator[tuple[Any, str, str]]:
    """Values that a check excludes, as they are shown, and what is wrong with them."""
    if get_origin(check) is Literal:
        yield "no such name", '"no such name"', "is not known"
    elif isinstance(check, OneOrList):
        yield from (case for case in outside(check.one) if not isinstance(case[0], list))
    elif isinstance(check, OneOf):
        yield "no such name", '"no such name"', "is not known"
        yield 3, "3", "is not known"
    elif check is str:
        yield 3, "3", "is not a string"
    elif check is is_switch:
        yield 1, "1", "is a whole number, not a boolean"
        yield "true", '"true"', "is a string, not a boolean"
    elif isinstance(check, from_list):
        yield 3, "3", "is a whole number, not a list"
        if check.least:
            yield [], "[]", "has 0 items"
        if check.most is not None:
            items = "[" + ", ".join("3" * (check.most + 1)) + "]"
            shown = items if len(items) <= 60 else items[:59] + "…"
            yield [3] * (check.most + 1), shown, f"has {check.most + 1} items"
    elif isinstance(check, whole):
        yield check.least - 1, str(check.least - 1), "is too small"
        if check.most is not None:
            yield check.most + 1, str(check.most + 1), "is too large"
        yield 1.0, "1.0", "is a number, not a whole number"
        yield True, "true", "is a boolean, not a whole number"
    else:
        low, high = check.least, check.most
        low, high = (check.above, check.below) if low is None else (low - 1e-6, high + 1e-6)
        yield low, f"{low!r}", "is too small"
        yield high, f"{high!r}", "is too large"
        for text in ("nan", "inf", "-inf"):
            yield float(text), text, "is not finite"
        yield True, "true", "is a boolean, not a number"
        yield "0.1", '"0.1"', "is a string, not a number"
        yield [0.1], "[0.1]", "is a list, not a number"


def allowed_by(check: Any) -> str:
    """What messages say that a check allows."""
    if check is str:
        return "a string"
    words = [repr(word) for word in get_args(check)] or ["true", "false"]
    listed = " or ".join(part for part in (", ".join(words[:-1]), words[-1]) if part)
    return getattr(check, "allowed", listed)


FILES = (Scene, PairFile, Study)
KEYS = [key for model in FILES for key in keys_of(model)]


@pytest.mark.parametrize("key", KEYS, ids=lambda key: f"{key.model.__name__}: {key.path}")
def test_values_outside_the_limits_of_a_key_are_refused(key: Key) -> None:
    allowed = row_in_words(key.row) if key.row else allowed_by(key.check)
    for value, shown, fault in outside(key.check):
        assert key.line_for(value) == f"{key.path}: {shown} {fault}; allowed: {allowed}"


def test_every_key_of_the_core_has_its_limits() -> None:
    found = {key.row["name"] for key in KEYS if key.row}
    assert found == {name for name in ROWS if not name.endswith(("0]", "1]"))}
    places = Counter(key.row["name"] for key in KEYS if key.row and key.row["holders"])
    assert places == {name: 1 + len(row["holders"]) for name, row in ROWS.items() if row["holders"]}


@pytest.mark.parametrize("model", FILES)
def test_misspelt_key_suggests_the_right_one(model: type[BaseModel]) -> None:
    keys = sorted(dotted_keys(model))
    for key in keys:
        table, _, name = key.rpartition(".")
        if len(name) < 3:  # a letter less, and nothing is left that resembles it
            continue
        beside = {other.removeprefix(f"{table}.").split(".")[0]
                  for other in keys if other.startswith(f"{table}." if table else "")}  # fmt: skip
        for wrong in {name[1:], name[:1] + name[2:], name[1] + name[0] + name[2:], name + "s"}:
            path = f"{table}.{wrong}".lstrip(".")
            line = line_for(model, path, 1, {})
            assert line.startswith(f"{path}: 1 is the value of an unknown key; "), key
            # A long list is left out, which would hide the key that was meant.
            is_long = len(beside) > 12
            assert line.endswith(f"did you mean {key}?") == is_long, line
            place = f"in {table}" if table else "at the top"
            assert (f"did you mean {key}? allowed {place}: " in line) != is_long, line
