# SPDX-License-Identifier: Apache-2.0
"""What the station logs: the packets that it sent and received, and its lines."""

from collections.abc import Callable
from functools import partial
from typing import Any

from palmbots.logs.run_channels import LineEvent, PacketEvent, StatusEvent
from palmbots.logs.run_log_writer import RunLogWriter
from palmbots.pair.pair_file import Pair
from palmbots.scene.scene import Scene
from palmbots.wire import Operate, Packet, Role


class StationLog:
    """The log of a station: to be passed to `Station.on_note`."""

    def __init__(
        self, pair: Pair, epoch: int, scene: Scene, on_warning: Callable[[str], None]
    ) -> None:
        self._log: RunLogWriter | None = None
        folder = pair.log_folder()
        if folder is not None:
            facts = {
                "pair": pair.settings.pair.number,
                "scene": scene.model_dump(mode="json"),
                "controller": pair.settings.pair.controller,
            }
            self._log = RunLogWriter(folder, "station", epoch, facts, on_warning)

    def __call__(self, kind: str, what: Any) -> None:
        """Log a packet that was sent or received, a wish, or a line."""
        if self._log is None:
            return
        if kind == "sent":
            self._log.add("/station/sent", partial(_sent_event, *what))
        elif kind == "received":
            self._log.add("/station/received", partial(_status_event, what))
        elif kind == "line":
            self._log.add("/station/lines", partial(LineEvent, text=what))

    def close(self) -> None:
        """Write what is left of the log."""
        if self._log is not None:
            self._log.close()


def _sent_event(receiver: Role, stamp: tuple[int, int], body: Any) -> Any:
    content = body.operation if isinstance(body, Operate) else "hello"
    epoch, sequence = stamp
    return PacketEvent(receiver=receiver, epoch=epoch, sequence=sequence, content=content)


def _status_event(packet: Packet) -> Any:
    body: Any = packet.body
    names = ("mode", "fault", "sign", "palm", "palm_at_target", "case", "item", "value")
    return StatusEvent(
        sender=packet.sender,
        epoch=packet.epoch,
        sequence=packet.sequence,
        acknowledged_epoch=packet.acknowledged[0],
        acknowledged_sequence=packet.acknowledged[1],
        at_rest=body.at_rest,
        stop=body.stop,
        **{name: getattr(body, name) for name in names},
    )
