# SPDX-License-Identifier: Apache-2.0
"""MCAP logs: writing, reading and replay."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.logs.decoders import decoder_factories as decoder_factories
    from palmbots.logs.mcap_reader import Log as Log
    from palmbots.logs.replaying import ReplayResult as ReplayResult
else:
    __getattr__, __dir__ = lazy_names(__name__)
