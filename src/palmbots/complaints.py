"""From pydantic's account of what is wrong with a scene to one line that helps.

Only the first fault is told: with a misspelt key the others often follow from it, so unknown keys
come first.
"""

import difflib
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

from palmbots.errors import show

__all__ = ["complaint", "dotted_keys"]


def complaint(error: ValidationError, model: type[BaseModel]) -> str:
    """One line "key: value is …; allowed: …" about the first fault of data given to `model`."""
    faults = error.errors(include_url=False)
    first = min(faults, key=lambda f: f["type"] != "extra_forbidden")
    where, given, kind = first["loc"], first["input"], first["type"]
    context: Mapping[str, Any] = first.get("ctx", {})
    if kind == "scene":
        below = context["key"]
        key = ".".join(part for part in (_spelt(where), below) if part)
        return f"{key}: {context['value']} {context['problem']}; allowed: {context['allowed']}"
    key = _spelt(where)
    if kind == "extra_forbidden":
        return f"{key}: {show(given)} is given to an unknown key; {_known_keys(where, model)}"
    if kind == "missing":
        table = _model_at(where[:-1], model)
        legal = (
            ", ".join(n for n, f in table.model_fields.items() if f.is_required()) if table else ""
        )
        return f"{key}: is missing; needed there: {legal}"
    if kind == "literal_error":
        return f"{key}: {show(given)} is not known; allowed: {context['expected']}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        table = _model_at(where, model)
        legal = f" with the keys {', '.join(table.model_fields)}" if table else ""
        return f"{key}: {show(given)} is not a table; allowed: a table{legal}"
    return f"{key}: {show(given)} is wrong: {first['msg']}"


def dotted_keys(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """Every key of a model and the tables in it: "palm.friction", "palm.left.friction", …"""
    for name, field in model.model_fields.items():
        table = _table(field.annotation)
        if table is None:
            yield prefix + name
        else:
            yield from dotted_keys(table, f"{prefix}{name}.")


def _known_keys(where: Sequence[int | str], model: type[BaseModel]) -> str:
    """What could have been meant by the unknown key `where`, and what is legal in its table."""
    table = _model_at(where[:-1], model)
    legal = list(table.model_fields) if table else []
    wrong = str(where[-1])
    inside = _spelt(where[:-1])
    elsewhere = [k for k in dotted_keys(model) if k.rsplit(".", 1)[-1] == wrong]
    near = difflib.get_close_matches(wrong, legal, n=1)
    if near:
        hint = f"did you mean {inside}.{near[0]}? " if inside else f"did you mean {near[0]}? "
    elif elsewhere:
        hint = f"did you mean {elsewhere[0]}? "
    else:
        hint = ""
    place = f"in {inside}" if inside else "at the top"
    return f"{hint}allowed {place}: {', '.join(legal)}"


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
            found = _table(part, through_lists)
            if found is not None:
                return found
    return None


def _spelt(where: Sequence[int | str]) -> str:
    """A location as a user writes it: bumps.script[2].shift_m."""
    text = ""
    for step in where:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else str(step)
    return text
