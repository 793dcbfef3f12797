"""What every table of a scene is: immutable, unknown keys refused, nothing converted.

None means "not set". It is left out when a section is dumped, so that a dump is valid TOML too.
"""

from typing import Any

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

__all__ = ["Section"]


class Section(BaseModel):
    """A table of the scene: immutable, unknown keys refused, nothing converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {k: v for k, v in dump(self).items() if v is not None and v != {}}
