# SPDX-License-Identifier: Apache-2.0
"""What a schema must refuse: a value that it accepts, with one key too few, one too many, or of
another type."""

import copy
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from jsonschema import Draft202012Validator

ODD = {"odd": [{"odd": None}]}


def assert_fits_exactly(schema: Mapping[str, Any], value: Any) -> None:
    """The schema accepts the value, and refuses it with any one change."""
    Draft202012Validator(schema).validate(value)
    changes = list(_changes(schema, schema, value))
    assert changes
    for change in changes:
        judge = Draft202012Validator(change.judge | {"$defs": schema.get("$defs", {})})
        assert not judge.is_valid(change.judged), change.what


class Change(NamedTuple):
    """One change, and the part of the schema that must refuse it.

    What a part refuses, the whole refuses, unless there is a choice (anyOf) between them. So most
    changes need not be tried with all that stands around them.
    """

    what: str
    judge: dict[str, Any]
    judged: Any
    whole: Any
    """The value that was given, changed."""


def _changes(schema: Mapping[str, Any], given: Any, value: Any) -> Iterator[Change]:
    """Every change inside a value, each with its place; of lists, in the first entry alone."""
    node, is_choice = _chosen(schema, given, value)
    if node.get("$ref") == "#/$defs/Scene":  # tests/cli/test_json_schemas.py tests these
        return
    parts: list[tuple[Any, Any]] = []  # key and its schema
    if isinstance(value, Mapping) and "properties" in node:
        assert node["additionalProperties"] is False, node
        further = {**value, "odd": 0}
        yield Change("a further key", given, further, further)
        for key in value:
            less = {k: v for k, v in value.items() if k != key}
            yield Change(f"without {key}", given, less, less)
        parts = [(key, node["properties"][key]) for key in value]
    elif isinstance(value, Mapping) and value:
        parts = [(next(iter(value)), node.get("additionalProperties", {}))]
    elif isinstance(value, list) and value:
        parts = [(0, node["prefixItems"][0] if "prefixItems" in node else node.get("items", {}))]
    for key, part in parts:
        for change in _within(schema, part, value[key]):
            whole = copy.copy(value)
            whole[key] = change.whole
            what = f"{key}: {change.what}"
            if is_choice:
                yield Change(what, given, whole, whole)
            else:
                yield change._replace(what=what, whole=whole)


def _within(schema: Mapping[str, Any], node: Any, inner: Any) -> Iterator[Change]:
    if node in ({}, True):  # anything
        return
    accepts = Draft202012Validator(node | {"$defs": schema.get("$defs", {})}).is_valid
    odd = next(one for one in (ODD, [ODD]) if not accepts(one))
    yield Change("of another type", node, odd, odd)
    yield from _changes(schema, node, inner)
    types = _types(schema, node)
    if isinstance(inner, bool | int | float) and "string" not in types:
        yield Change("a number as text", node, str(inner), str(inner))
    if inner is not None and "null" not in types:
        yield Change("null", node, None, None)


def _types(schema: Mapping[str, Any], node: Any) -> set[str]:
    """The types that a part of a schema names."""
    if "$ref" in node:
        return _types(schema, schema["$defs"][node["$ref"].removeprefix("#/$defs/")])
    types = node.get("type", [])
    found = {types} if isinstance(types, str) else set(types)
    return found.union(*(_types(schema, one) for one in node.get("anyOf", [])))


def _chosen(schema: Mapping[str, Any], node: Any, value: Any) -> tuple[Any, bool]:
    """The part of a schema that accepts a value, and whether there was a choice."""
    is_choice = False
    while True:
        if node.get("$ref", "#/$defs/Scene") != "#/$defs/Scene":
            node = schema["$defs"][node["$ref"].removeprefix("#/$defs/")]
        elif "anyOf" in node:
            is_choice = True
            defs = {"$defs": schema.get("$defs", {})}
            node = next(
                one for one in node["anyOf"] if Draft202012Validator(one | defs).is_valid(value)
            )
        else:
            return node, is_choice
