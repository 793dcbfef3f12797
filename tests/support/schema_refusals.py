# SPDX-License-Identifier: Apache-2.0
"""What a schema must refuse: a value that it accepts, with one key too few, one too many, or of
another type."""

import copy
from collections.abc import Iterator, Mapping
from typing import Any

from jsonschema import Draft202012Validator

ODD = {"odd": [{"odd": None}]}


def assert_fits_exactly(schema: Mapping[str, Any], value: Any) -> None:
    """The schema accepts the value, and refuses it with any one change."""
    validator = Draft202012Validator(schema)
    validator.validate(value)
    changes = list(_changes(schema, schema, value))
    assert changes
    for what, changed in changes:
        assert not validator.is_valid(changed), what


def _changes(schema: Mapping[str, Any], node: Any, value: Any) -> Iterator[tuple[str, Any]]:
    """Every change inside a value, each with its place; of lists, in the first entry alone."""
    node = _chosen(schema, node, value)
    if node.get("$ref") == "#/$defs/Scene":  # tests/cli/test_json_schemas.py tests these
        return
    if isinstance(value, Mapping) and "properties" in node:
        assert node["additionalProperties"] is False, node
        yield "a further key", {**value, "odd": 0}
        for key, inner in value.items():
            yield f"without {key}", {k: v for k, v in value.items() if k != key}
            yield from _within(schema, node["properties"][key], value, key, inner)
    elif isinstance(value, Mapping) and value:
        key = next(iter(value))
        yield from _within(schema, node.get("additionalProperties", {}), value, key, value[key])
    elif isinstance(value, list) and value:
        inner = node["prefixItems"][0] if "prefixItems" in node else node.get("items", {})
        yield from _within(schema, inner, value, 0, value[0])


def _within(
    schema: Mapping[str, Any], node: Any, value: Any, key: Any, inner: Any
) -> Iterator[tuple[str, Any]]:
    if node in ({}, True):  # anything
        return
    accepts = Draft202012Validator(node | {"$defs": schema.get("$defs", {})}).is_valid
    odd = next(one for one in (ODD, [ODD]) if not accepts(one))
    changes = [("of another type", odd), *_changes(schema, node, inner)]
    types = _types(schema, node)
    if isinstance(inner, bool | int | float) and "string" not in types:
        changes.append(("a number as text", str(inner)))
    if inner is not None and "null" not in types:
        changes.append(("null", None))
    for what, changed in changes:
        whole = copy.copy(value)
        whole[key] = changed
        yield f"{key}: {what}", whole


def _types(schema: Mapping[str, Any], node: Any) -> set[str]:
    """The types that a part of a schema names."""
    if "$ref" in node:
        return _types(schema, schema["$defs"][node["$ref"].removeprefix("#/$defs/")])
    types = node.get("type", [])
    found = {types} if isinstance(types, str) else set(types)
    return found.union(*(_types(schema, one) for one in node.get("anyOf", [])))


def _chosen(schema: Mapping[str, Any], node: Any, value: Any) -> Any:
    """The part of a schema that accepts a value."""
    while True:
        if node.get("$ref", "#/$defs/Scene") != "#/$defs/Scene":
            node = schema["$defs"][node["$ref"].removeprefix("#/$defs/")]
        elif "anyOf" in node:
            defs = {"$defs": schema.get("$defs", {})}
            node = next(
                one for one in node["anyOf"] if Draft202012Validator(one | defs).is_valid(value)
            )
        else:
            return node
