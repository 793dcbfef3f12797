# SPDX-License-Identifier: Apache-2.0
"""The log of a robot: every step of its program.

A log holds no secret. Its packets carry the tag of a key that was made for the log and is
written in it, so a log can be checked without the key of the pair, and no robot accepts a packet
of it.
"""

import secrets
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

import palmbots._core as _core
from palmbots._types import Side
from palmbots.logs.run_channels import RobotTick
from palmbots.logs.run_log_writer import RunLogWriter
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState
from palmbots.robot.core_program import controller_of
from palmbots.scene.scene import Scene
from palmbots.wire import KEY_SIZE

READING: dict[str, Any] = {
    "contact": True,
    "battery_ok": True,
    "driver_ok": True,
    "storage_ok": True,
    "covered": False,
    "stop": False,
    "overruns": 0,
    "battery_mv": 0xFFFF,
    "progress": 0,
    "stopping": 0,
    "arm_there": False,
    "arm_steps": 0,
    "beneath": False,
}
"""The arguments of the core's Reading that have a default."""


class RobotLog:
    """The log of a robot's program since its start; empty if the pair has no logs.

    Args:
        pair: the pair.
        side: which of its robots.
        state: what the robot had stored, this boot included.
        scene: the scene.
        settings: the arguments of the core's RuntimeSettings.
        on_warning: called with one line if nothing can be logged.
    """

    def __init__(
        self,
        pair: Pair,
        side: Side,
        state: StoredState,
        scene: Scene,
        settings: dict[str, Any],
        on_warning: Callable[[str], None],
    ) -> None:
        self._side: Side = side
        self._number = 0
        self._tick: tuple[Callable[[], Any], int] | None = None
        self._withheld: list[int] = []
        self._log: RunLogWriter | None = None
        folder = pair.log_folder()
        if folder is None:
            return
        key = secrets.token_bytes(KEY_SIZE)
        self._key = key
        source = controller_of(pair).source
        facts = {
            "pair": pair.settings.pair.number,
            "key": key.hex(),
            "scene": scene.model_dump(mode="json"),
            "controller": pair.settings.pair.controller,
            "controller_source": None if source is None else asdict(source),
            "state": asdict(state),
            "settings": settings,
        }
        self._log = RunLogWriter(folder, side, state.epoch, facts, on_warning)

    def take(
        self, robot: Any, elapsed: int, values: dict[str, Any], packets: list[bytes], answer: Any
    ) -> None:
        """The core's program has made a step: its arguments, those of its reading, its answer."""
        self._number += 1
        if self._log is None:
            return
        self._log_tick()
        facts = (
            self._number, elapsed, values, robot.phase, robot.mode, robot.fault, robot.wheels,
        )  # fmt: skip
        arrived = list(zip(packets, robot.judged, strict=True))
        self._withheld = []
        fill = partial(self._message, facts, arrived, answer, self._withheld)
        self._tick = (fill, self._log.now_ns())

    def withhold(self, receiver: int) -> None:
        """The packet of this step to this receiver is not sent."""
        self._withheld.append(receiver)

    def _log_tick(self) -> None:
        """Log the last step, once it is known what was sent."""
        if self._log is not None and self._tick is not None:
            fill, instant_ns = self._tick
            self._log.add(f"/{self._side}/ticks", fill, instant_ns)
            self._tick = None

    def _message(
        self, facts: tuple[Any, ...], arrived: Sequence[Any], answer: Any, withheld: list[int]
    ) -> Any:
        number, elapsed, values, phase, mode, fault, wheels = facts
        palm, move, rests, sent, case, *_, assists = answer
        return RobotTick(
            number=number,
            elapsed=elapsed,
            **READING | values,
            received=[
                self._retagged(data) if sender >= 0 else data for data, (_, sender, *_) in arrived
            ],
            palm=palm,
            move=move,
            rests=rests,
            wheels=wheels,
            case=chr(case),
            assists=assists,
            phase=phase,
            mode=mode,
            fault=fault,
            sent=[self._retagged(data) for _, data, _ in sent],
            receivers=[to for to, _, _ in sent],
            words=[message for *_, message in sent],
            withheld=withheld,
        )

    def _retagged(self, data: bytes) -> bytes:
        """The packet with the tag of the log's key."""
        return _core.wire.retagged(data, self._key)

    def close(self) -> None:
        """Write what is left of the log."""
        if self._log is not None:
            self._log_tick()
            self._log.close()
