# SPDX-License-Identifier: Apache-2.0
"""One line for the user from pydantic's list of the faults of a scene.

Only the first fault is reported. Unknown keys take precedence, because the other faults often
follow from a misspelt key.
"""

import difflib
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from palmbots._util.arguments import show
from palmbots.errors import SceneError, UnknownSceneKey
from palmbots.scene.fields import KINDS, PROBLEMS

_MOST_LISTED = 12  # keys, where the one that was probably meant is named


def validation_message(error: ValidationError, model: type[BaseModel]) -> str:
    """One line "key: value is …; allowed: …" about the first fault of data given to `model`."""
    return str(validation_error("", error, model))


def validation_error(called: str, error: ValidationError, model: type[BaseModel]) -> SceneError:
    """The same as an exception; its message begins with `called`, which names the data."""
    faults = error.errors(include_url=False)
    first = min(faults, key=lambda fault: fault["type"] != "extra_forbidden")
    prefix = f"{called} " if called else ""
    if first["type"] != "extra_forbidden":
        return SceneError(prefix + _message(first, model))
    where, key = first["loc"], _spelt(first["loc"])
    suggestion, known = _known_keys(where, model)
    hint = f"did you mean {suggestion}? " if suggestion else ""
    line = f"{key}: {show(first['input'])} {PROBLEMS['key']}; {hint}{known}".rstrip()
    return UnknownSceneKey(prefix + line, key, suggestion)


def _message(fault: ErrorDetails, model: type[BaseModel]) -> str:
    where, given, kind = fault["loc"], fault["input"], fault["type"]
    context: Mapping[str, Any] = fault.get("ctx", {})
    key = _spelt(where)
    if kind == "scene":
        key = ".".join(part for part in (key, context["key"]) if part)
        return f"{key}: {context['value']} {context['problem']}; allowed: {context['allowed']}"
    if kind == "missing":
        table = _model_at(where[:-1], model)
        needed = [n for n, f in table.model_fields.items() if f.is_required()] if table else []
        return f"{key}: {PROBLEMS['missing'].format(keys=', '.join(needed))}"
    if kind == "literal_error":
        return f"{key}: {show(given)} {PROBLEMS['unknown']}; allowed: {context['expected']}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        table = _model_at(where, model)
        legal = table_in_words(table) if table else KINDS["table"]
        return f"{key}: {show(given)} {PROBLEMS['table']}; allowed: {legal}"
    if kind in ("string_type", "string_unicode"):
        return f"{key}: {show(given)} {PROBLEMS['string']}; allowed: {KINDS['string']}"
    return f"{key}: {show(given)} is wrong: {fault['msg']}"


def table_in_words(model: type[BaseModel]) -> str:
    """What a table may hold."""
    return f"{KINDS['table']} with the keys {', '.join(model.model_fields)}"


def dotted_keys(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """Every key of a model and the tables in it: "palm.friction", "palm.left.friction", …"""
    for name, field in model.model_fields.items():
        table = _table(field.annotation)
        if table is None:
            yield prefix + name
        else:
            yield from dotted_keys(table, f"{prefix}{name}.")


def _known_keys(where: Sequence[int | str], model: type[BaseModel]) -> tuple[str | None, str]:
    """The key that was probably meant by the unknown key `where`, and the keys of its table."""
    table = _model_at(where[:-1], model)
    legal = list(table.model_fields) if table else []
    wrong = str(where[-1])
    inside = _spelt(where[:-1])
    elsewhere = [k for k in dotted_keys(model) if k.rsplit(".", 1)[-1] == wrong]
    near = difflib.get_close_matches(wrong, legal, n=1)
    suggestion = None
    if near:
        suggestion = f"{inside}.{near[0]}" if inside else near[0]
    elif elsewhere:
        suggestion = elsewhere[0]
    place = f"in {inside}" if inside else "at the top"
    if suggestion and len(legal) > _MOST_LISTED:  # a long list would hide the key that was meant
        return suggestion, ""
    return suggestion, f"allowed {place}: {', '.join(legal)}"


def _model_at(where: Sequence[int | str], model: type[BaseModel]) -> type[BaseModel] | None:
    """The model of the table at a location, or None where there is none."""
    at: type[BaseModel] | None = model
    for step in where:
        if at is None:
            return None
        if isinstance(step, str):
            field = at.model_fields.get(step)
            at = None if field is None else _table(field.annotation, through_lists=True)
    return at


def _table(annotation: Any, through_lists: bool = False) -> type[BaseModel] | None:
    """The model that a field's type holds, if it is a table (or, if asked, a list of tables)."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    origin = typing.get_origin(annotation)
    if origin in (typing.Union, types.UnionType, typing.Annotated) or (
        through_lists and origin is tuple
    ):
        for part in typing.get_args(annotation):
            table = _table(part, through_lists)
            if table is not None:
                return table
    return None


def _spelt(where: Sequence[int | str]) -> str:
    """A location as a user writes it: bumps.script[2].shift_m."""
    text = ""
    for step in where:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else str(step)
    return text
