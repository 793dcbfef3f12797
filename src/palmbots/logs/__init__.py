# SPDX-License-Identifier: Apache-2.0
"""MCAP logs: writing, reading and replay."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palmbots.logs.decoders import decoder_factories
    from palmbots.logs.mcap_reader import Log
    from palmbots.logs.replaying import ReplayResult

__all__ = ["Log", "ReplayResult", "decoder_factories"]

# Imported on first use, because the packages mcap and protobuf take long to import, and because the
# programs of robots need little of it.
_LAZY = {
    "Log": "mcap_reader",
    "ReplayResult": "replaying",
    "decoder_factories": "decoders",
}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'palmbots.logs' has no attribute {name!r}")
    return getattr(importlib.import_module(f"palmbots.logs.{_LAZY[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
