# SPDX-License-Identifier: Apache-2.0
"""How long the permanent memory of a board lasts; prints one JSON object.

python -m emulator.wear

Counted in the emulator, with everything that wears the memory most: two boards carry the paper's
box by their buttons, from power-up to the end. What the pages hold and stand is what Nordic gives
for the nRF52833. How much the robots are used is assumed.
"""

import json
import sys
import tempfile
from pathlib import Path

import palmbots as pb
from emulator.__main__ import robot_image
from emulator.board import Image
from emulator.live import LivePair
from emulator.peripherals.storage import MOST_ERASES, PAGE
from palmbots.boards.pair_settings import BOOTS_PER_IMAGE, board_pair
from palmbots.pair.pair_file import init_pair, load_pair

PAGES = 2
RECORD = 12
"""Bytes of a record."""
CARRIES_PER_DAY = 100
"""Each after a boot of its own. Assumed."""


def records_of_a_carry(image: Image, controller: str = "resilient") -> tuple[int, int]:
    """Records that a boot, and a carry after it, make a board write: the most of both boards."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.toml").write_text(pb.load_scene("paper").to_toml())
        values = {"limits.station_lost": "carry-on", "hardware.acceleration_m_s2": 1000.0}
        file = init_pair(
            Path(folder, "pair.toml"), scene="scene.toml", controller=controller, values=values
        )[0]
        pair = LivePair(image, board_pair(load_pair(file)))
        pair.run(0.5)
        memories = [robot.board.nvmc for robot in pair.robots]
        boot = max(memory.word_writes * 4 // RECORD for memory in memories)
        if not pair.start() or not pair.run_until("done", within_s=60.0):
            raise RuntimeError(f"the carry does not end: {pair.state()}")
        return boot, max(memory.word_writes * 4 // RECORD for memory in memories) - boot


def wear(boot: int, carry: int) -> dict[str, float]:
    """What the memory lasts.

    Args:
        boot: records of a boot.
        carry: records of a carry.
    """
    per_page = PAGE // RECORD
    records = PAGES * per_page * MOST_ERASES
    per_day = CARRIES_PER_DAY * (boot + carry)
    return {
        "pages": PAGES,
        "records_per_page": per_page,
        "erases_per_page": MOST_ERASES,
        "records": records,
        "records_per_boot": boot,
        "records_per_carry": carry,
        "erases_per_carry_with_boot": round((boot + carry) / per_page, 4),
        "carries_with_boot": records // (boot + carry),
        "carries_per_day": CARRIES_PER_DAY,
        "years": round(records / per_day / 365.25, 1),
        "boots_per_image": BOOTS_PER_IMAGE,
    }


def main() -> int:
    """Count and print."""
    print(json.dumps(wear(*records_of_a_carry(robot_image()))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
