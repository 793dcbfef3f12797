# SPDX-License-Identifier: Apache-2.0
"""The base of all sections of a scene.

None means "not set". A dump leaves such keys out, so that it is valid TOML.
"""

from collections.abc import Callable, Collection, Mapping
from typing import Annotated, Any, Optional, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    SerializerFunctionWrapHandler,
    ValidationError,
    create_model,
    model_serializer,
)
from pydantic_core import PydanticCustomError


class Section(BaseModel):
    """A table of the scene: immutable, without unknown keys, without conversion of types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return self.set_values(dump)

    def set_values(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The section as a table, without the keys that are not set."""
        return {k: v for k, v in dump(self).items() if v is not None and v != {}}


def as_given(value: object) -> Any:
    """The tables of a section without the keys that have their default, as the core takes them."""
    if isinstance(value, BaseModel):
        return {name: as_given(getattr(value, name)) for name in value.model_fields_set}
    if isinstance(value, tuple):
        return tuple(as_given(item) for item in value)
    return value


def plain(value: Any) -> Any:
    """A value of a section as plain tables and lists."""
    if isinstance(value, BaseModel):
        return value.model_dump()
    return [plain(item) for item in value] if isinstance(value, tuple) else value


def values_of_side(both: Section, override: Section) -> dict[str, Any]:
    """The keys of one side: the values for both sides, replaced where `override` sets them."""
    own = {name: getattr(override, name) for name in type(override).model_fields}
    return {name: getattr(both, name) if value is None else value for name, value in own.items()}


def key_of_side(override: Section, side: str, name: str) -> str:
    """The key that sets `name` for a side, relative to the section: its own or that of both."""
    return name if getattr(override, name) is None else f"{side}.{name}"


def override_of(
    model: type[Section], keys: Collection[str] | None = None
) -> Callable[[type[Section]], Any]:
    """Gives a class the `keys` (all) of `model`, none of which is set: what differs on one side."""
    fields: dict[str, Any] = {}
    for key, field in model.model_fields.items():
        if keys is not None and key not in keys:
            continue
        kind: Any = field.annotation
        for part in field.metadata:
            kind = Annotated[kind, part]
        fields[key] = (Optional[kind], None)  # noqa: UP045 (an expression)
    return lambda own: create_model(
        own.__name__, __base__=own, __module__=own.__module__, __doc__=own.__doc__, **fields
    )


def plain_name(field: str) -> str:
    """The key of a field whose name ends with an underscore, because it is a word of Python."""
    return field.removesuffix("_")


_AnySection = TypeVar("_AnySection", bound=Section)


def with_plain_names(own: type[_AnySection]) -> type[_AnySection]:
    """A class whose fields have the names of their keys: ``from`` for ``from_``."""
    fields: dict[str, Any] = {
        plain_name(name): (field.annotation, field) for name, field in own.model_fields.items()
    }
    base: Any = own.__base__
    made: Any = create_model(
        own.__name__,
        __base__=base,
        __module__=own.__module__,
        __doc__=own.__doc__,
        **fields,
    )
    return made


def check_sides(both: Section, overrides: Mapping[str, Section], model: type[Section]) -> None:
    """Check the table of each side as a `model`; an error names the key that the user has set."""
    for side, override in overrides.items():
        try:
            model(**values_of_side(both, override))
        except ValidationError as error:
            context: dict[str, Any] = error.errors()[0].get("ctx", {})
            context["key"] = key_of_side(override, side, context["key"])
            text = "{value} {problem}; allowed: {allowed}"
            raise PydanticCustomError("scene", text, context) from None
