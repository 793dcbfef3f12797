# SPDX-License-Identifier: Apache-2.0
"""MCAP logs: writing, reading and replay."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.logs.decoders import decoder_factories
    from palmbots.logs.mcap_reader import Log
    from palmbots.logs.replaying import ReplayResult

__all__ = ["Log", "ReplayResult", "decoder_factories"]

# Imported on first use, because the packages mcap and protobuf take long to import, and because the
# programs of robots need little of it.
_PLACES = {
    "Log": ".mcap_reader",
    "ReplayResult": ".replaying",
    "decoder_factories": ".decoders",
}

__getattr__, __dir__ = lazy_names(__name__, _PLACES)
