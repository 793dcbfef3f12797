# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of what JSON has of a result, made by pydantic from the annotations.

Every key is required and no other is allowed. A scene is a reference to the definition ``Scene``,
which the caller adds. Importing pydantic takes long, so nothing but the schemas imports this.
"""

import sys
from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import cache
from pathlib import Path
from types import GenericAlias, SimpleNamespace, UnionType
from typing import (
    Annotated,
    Any,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

import numpy as np
from pydantic import BaseModel, ConfigDict, TypeAdapter, WithJsonSchema
from typing_extensions import TypedDict

from palmbots._types import MaybeNaN
from palmbots._util.plain_values import derived, keys_of

_OF_SCENE = "https://palmbots/"  # stands for "#/$defs/" until the definitions are complete


def result_schema(*kinds: Any) -> dict[str, Any]:
    """The schema of what JSON has of these kinds of results, any one of them."""
    adapter: TypeAdapter[Any] = TypeAdapter(_any_of(kinds))
    return _completed(adapter.json_schema())


def _completed(schema: Any) -> Any:
    """The schema with complete references, and without titles, which repeat the keys."""
    if isinstance(schema, list):
        return [_completed(inner) for inner in schema]
    if not isinstance(schema, Mapping):
        return schema
    found: dict[str, Any] = {}
    for key, inner in schema.items():
        if key == "$ref":
            found[key] = inner.replace(_OF_SCENE, "#/$defs/")
        elif not (key == "title" and isinstance(inner, str)):
            found[key] = _completed(inner)
    return found


def _any_of(hints: tuple[Any, ...]) -> Any:
    return Union[tuple(map(_json_type, hints))]  # noqa: UP007  # of a number that varies


@cache
def _json_type(hint: Any) -> Any:
    """The type of what JSON has of a value with this annotation."""
    if hint == MaybeNaN:
        return float | None
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _json_type(inner[0])
    if origin in (Union, UnionType):
        return _any_of(inner)
    kind: Any = origin or hint
    if is_dataclass(kind) or hasattr(kind, "_fields"):
        return _table(kind, inner)
    if is_typeddict(kind):
        types = {key: _json_type(one) for key, one in get_type_hints(kind).items()}
        return _closed(kind.__name__, types)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return Annotated[Any, WithJsonSchema({"$ref": _OF_SCENE + kind.__name__})]
    if isinstance(kind, type) and issubclass(kind, Path):
        return str
    if origin is np.ndarray:
        return list[Any]
    if origin in (tuple, list):
        of: Any = origin
        return of[tuple(_json_type(i) if i is not ... else i for i in inner)]
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return GenericAlias(dict, (str, _json_type(inner[1])))
    return hint


def _table(kind: Any, arguments: tuple[Any, ...]) -> Any:
    """A typed dictionary with the keys that JSON has of a dataclass or named tuple."""
    of = dict(zip(getattr(kind, "__parameters__", ()), arguments, strict=True))
    types = {key: _json_type(_substituted(annotation_of(kind, key), of)) for key in keys_of(kind)}
    return _closed(kind.__name__, types)


def _closed(name: str, types: Mapping[str, Any]) -> Any:
    """A typed dictionary without further keys."""
    table: Any = TypedDict(name, types)  # ty: ignore[invalid-argument-type]  # made at run time
    table.__pydantic_config__ = ConfigDict(extra="forbid")
    return table


def annotation_of(kind: Any, key: str) -> Any:
    """The annotation of one field or derived value; those of other fields need not be known."""
    for owner in kind.__mro__:
        member = vars(owner).get(key)
        if isinstance(member, derived) and member.fget is not None:
            text = member.fget.__annotations__["return"]
        elif key in vars(owner).get("__annotations__", {}):
            text = owner.__annotations__[key]
        else:
            continue
        scope = vars(sys.modules[owner.__module__])
        one: Any = SimpleNamespace(__annotations__={key: text})
        return get_type_hints(one, scope, include_extras=True)[key]
    raise AssertionError(key)


def _substituted(hint: Any, of: Mapping[Any, Any]) -> Any:
    """The annotation with the arguments of a generic class in place of its parameters."""
    if isinstance(hint, TypeVar):
        return of[hint]
    parameters = getattr(hint, "__parameters__", ())
    return hint[tuple(of[one] for one in parameters)] if parameters else hint
