# SPDX-License-Identifier: Apache-2.0
"""The base of all sections of a scene.

None means "not set". A dump leaves such keys out, so that it is valid TOML.
"""

from typing import Any

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

__all__ = ["Section", "key_of_side", "values_of_side"]


class Section(BaseModel):
    """A table of the scene: immutable, without unknown keys, without conversion of types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return self.set_values(dump)

    def set_values(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The section as a table, without the keys that are not set."""
        return {k: v for k, v in dump(self).items() if v is not None and v != {}}


def values_of_side(both: Section, override: Section) -> dict[str, Any]:
    """The keys of one side: the values for both sides, replaced where `override` sets them."""
    own = {name: getattr(override, name) for name in type(override).model_fields}
    return {name: getattr(both, name) if value is None else value for name, value in own.items()}


def key_of_side(override: Section, side: str, name: str) -> str:
    """The key that sets `name` for a side, relative to the section: its own or that of both."""
    return name if getattr(override, name) is None else f"{side}.{name}"
