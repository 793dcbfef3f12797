# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of a scene (draft 2020-12), made from the same fields that check a scene.

It states the keys, their types, limits, meanings and defaults. What depends on several keys, such
as a centre of mass inside the outline, only `load_scene` checks.
"""

import json
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from palmbots.scene.core_keys import Optionally
from palmbots.scene.error_messages import table_in_words
from palmbots.scene.fields import KINDS, SWITCH, OneOf, Range, from_list, is_switch, whole
from palmbots.scene.key_reference import field_meanings
from palmbots.scene.object_library import by_name
from palmbots.scene.scene import Scene


def scene_schema() -> dict[str, Any]:
    """The schema of a scene file, and of the key ``scene`` of ``--json``; a new table each time."""
    return json.loads(_text())


def worded_schema() -> dict[str, Any]:
    """The same for the page: nodes also have ``allowed``, the allowed values in words."""
    return Scene.model_json_schema(schema_generator=_WordedSchema)


@cache
def _text() -> str:
    schema = Scene.model_json_schema(schema_generator=_SceneSchema)
    schema["title"] = "Scene of palmbots"
    return json.dumps({"$schema": _SceneSchema.schema_dialect} | schema)


class _SceneSchema(GenerateJsonSchema):
    """Adds the limits of the validators and the docstrings of the fields."""

    def function_before_schema(
        self, schema: core_schema.BeforeValidatorFunctionSchema
    ) -> JsonSchemaValue:
        """The schema of a value that one of our validators checks."""
        inner = dict(super().function_before_schema(schema))
        check: Any = schema["function"]["function"]
        if check is by_name:
            return {"anyOf": [inner, {"type": "string", "description": "An object or file."}]}
        limits = _limits(check)
        if isinstance(check, Optionally):  # they are those of the value, not of null
            inner["anyOf"] = [{**inner["anyOf"][0], **limits}, *inner["anyOf"][1:]]
            return inner
        return inner | limits

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """The schema of a table, with the meanings of its keys."""
        table = super().model_schema(schema)
        model: type[BaseModel] = schema["cls"]
        try:
            meanings = field_meanings(model)
        except OSError:  # a table made at run time has no source
            meanings = {}
        for name, key in table.get("properties", {}).items():
            key.pop("title", None)
            if name in meanings:
                key["description"] = meanings[name]
        return table


class _WordedSchema(_SceneSchema):
    """Adds the allowed values in the words of error messages."""

    def function_before_schema(
        self, schema: core_schema.BeforeValidatorFunctionSchema
    ) -> JsonSchemaValue:
        """The schema of a value that one of our validators checks."""
        found = super().function_before_schema(schema)
        check: Any = schema["function"]["function"]
        check = check.check if isinstance(check, Optionally) else check
        words = SWITCH if check is is_switch else getattr(check, "allowed", None)
        if words is None:
            return found
        value = found["anyOf"][0] if "anyOf" in found else found  # beside null, or beside a list
        value["allowed"] = words if value is found else value.get("allowed", words)
        return found

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """The schema of a table."""
        return super().model_schema(schema) | {"allowed": table_in_words(schema["cls"])}

    def literal_schema(self, schema: core_schema.LiteralSchema) -> JsonSchemaValue:
        """The schema of one of some names."""
        names = tuple(str(name) for name in schema["expected"])
        return super().literal_schema(schema) | {"allowed": OneOf(names).allowed}

    def str_schema(self, schema: core_schema.StringSchema) -> JsonSchemaValue:
        """The schema of a text."""
        return super().str_schema(schema) | {"allowed": KINDS["string"]}


def _limits(check: Any) -> dict[str, Any]:
    """The limits of a validator, in the words of JSON Schema."""
    limits: dict[str, Any] = {}
    if isinstance(check, Optionally):
        check = check.check
    if isinstance(check, OneOf):
        limits = {"enum": list(check.names)}
    elif isinstance(check, Range):
        limits = {
            "minimum": check.least,
            "exclusiveMinimum": check.above,
            "maximum": check.most,
            "exclusiveMaximum": check.below,
        }
    elif isinstance(check, whole):
        limits = {"minimum": check.least, "maximum": check.most}
    elif isinstance(check, from_list):
        limits = {"minItems": check.least, "maxItems": check.most}
    return {word: limit for word, limit in limits.items() if limit is not None}
