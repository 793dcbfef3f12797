# SPDX-License-Identifier: Apache-2.0
"""Carries with two emulated boards, and prints one JSON object per line.

python -m emulator [--scene lift] [--controllers A,B] [--seeds 3] [--loss 0.1] [--faults]
    [--images DIR]
"""

import argparse
import hashlib
import json
import statistics
import sys
from pathlib import Path
from typing import Any

import palmbots as pb
from emulator.board import Image, load_image
from emulator.lockstep import carry_on_boards
from palmbots.control.registry import resolve, shipped_names
from palmbots.scene.spec import to_spec

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "build" / "firmware"
CONTROLLERS = (*shipped_names("robots", "station"), "examples/policies/table-1.toml")
_ROBOTS_FAIL = [
    {"kind": "reboot", "robot": "left", "at_s": 4.0, "duration_s": 0.5},
    {"kind": "freeze", "robot": "right", "at_s": 9.0, "duration_s": 0.08},
    {"kind": "reboot", "robot": "right", "at_s": 12.0, "duration_s": 0.3},
]
_RADIO_FAILS = [
    {"kind": "station-down", "at_s": 6.0, "duration_s": 0.3},
    {"kind": "station-down", "at_s": 15.0, "duration_s": 0.2},
]


JOB: dict[str, Any] = {"arm.height_error_m": 0.0, "radio.lease_s": 0.5437, "task.distance_m": 0.3}
"""Of a job on the floor. Nothing measures the arm of a board, which knows its height by what it has
commanded: so the arm of the world is as exact, and no step of it ends with a tick."""
JOBS: dict[str, dict[str, Any]] = {
    "stand": {
        "task.distance_m": 0.5,
        "floor.stands": [
            {"from_m": x - 0.2, "to_m": x + 0.2, "height_m": 0.1, "gap_m": 0.26} for x in (0.0, 0.5)
        ],
    },
    # Arms arrive, and pass their steps, in the middle of a tick.
    "handover": {"arm.carry_height_m": 0.15034, "radio.lease_s": 0.874},
}
"""The same of some scenes."""


def faults(controller: str) -> dict[str, Any]:
    """The left board loses its supply, and the watchdog resets the right one; so it goes with the
    station's radio, if the controller has a station."""
    has_station = resolve(controller).team == "station"
    return {"faults.script": _ROBOTS_FAIL + (_RADIO_FAILS if has_station else [])}


def robot_image(folder: Path = IMAGES) -> Image:
    """The program of a robot, as `make firmware` has compiled it."""
    return load_image(folder / "robot.hex", folder / "robot.elf")


def dongle_image(folder: Path = IMAGES) -> Image:
    """The program of the station's radio."""
    return load_image(folder / "dongle.hex", folder / "dongle.elf")


def carried(
    image: Image,
    controller: str,
    seed: int,
    overrides: dict[str, Any],
    dongle: Image,
    name: str = "paper",
) -> tuple[dict[str, Any], Any, Any]:
    """One carry on boards, what it cost, and the results on boards and inside one program."""
    scene = pb.load_scene(name, overrides)
    host = pb.carry(scene, controller, seed=seed)
    result, carriers = carry_on_boards(image, scene, controller, seed, dongle=dongle)
    robots = [board.board for board in carriers.boards]
    radio = carriers.dongle
    boards = robots if radio is None else [*robots, radio.board]
    ticks = [count for board in carriers.boards for count in board.instructions]
    ticks += [] if radio is None else radio.instructions
    resets = [why for board in boards for why in board.resets]
    row = {
        "scene": name,
        "controller": controller,
        "seed": seed,
        "loss": overrides.get("radio.loss", 0.0),
        "faults": resets,
        "trace_hash": result.trace_hash,
        "host_trace_hash": host.trace_hash,
        "instructions_per_tick": {"median": int(statistics.median(ticks)), "worst": max(ticks)},
        "stack_bytes": max(board.stack_bytes for board in boards),
        "flash_records": max(board.nvmc.word_writes for board in robots) // 3,
        "image_sha256": hashlib.sha256(image.flash).hexdigest(),
    }
    return row, result, host


def main() -> int:
    """Run the carries; exit status 1 if a trace differs."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="paper")
    parser.add_argument("--controllers", default=",".join(CONTROLLERS))
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--loss", type=float, default=0.0)
    parser.add_argument("--faults", action="store_true")
    parser.add_argument("--images", type=Path, default=IMAGES)
    given = parser.parse_args()
    image = robot_image(given.images)
    dongle = dongle_image(given.images)
    is_same = True
    for controller in given.controllers.split(","):
        overrides: dict[str, Any] = {"radio.loss": given.loss} if given.loss else {}
        if to_spec(pb.load_scene(given.scene)).uses_floor:
            overrides |= JOB | JOBS.get(given.scene, {})
        if given.faults:
            overrides |= faults(controller)
        for seed in range(given.seeds):
            row, _, _ = carried(image, controller, seed, overrides, dongle, given.scene)
            print(json.dumps(row), flush=True)
            is_same = is_same and row["trace_hash"] == row["host_trace_hash"]
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
