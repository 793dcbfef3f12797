# SPDX-License-Identifier: Apache-2.0
"""Two emulated boards carry as one program does, bit for bit."""

from typing import Any

import pytest

from emulator.__main__ import CONTROLLERS, IMAGES, JOB, carried, dongle_image, faults
from emulator.__main__ import JOBS as JOBS_OF_SCENES
from emulator.board import Image

HARD_RADIO = {
    "radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04, "radio.reorder": True,
    "radio.duplicate": 0.1, "radio.corruption": 0.05,
}  # fmt: skip
DRIFT = {"robot.left.clock_ppm": 20000.0, "robot.right.clock_ppm": -15000.0}
CLANG_IMAGES = IMAGES / "clang"
MOST_INSTRUCTIONS = 32_000
MOST_STACK = 3072


@pytest.fixture(scope="session")
def images(image: Image) -> tuple[Image, Image]:
    """The programs of a robot and of the station's radio."""
    return image, dongle_image()


def everything(controller: str) -> tuple[str, dict[str, Any]]:
    return controller, HARD_RADIO | faults(controller) | DRIFT


CASES: dict[str, tuple[str, dict[str, Any]]] = {name: (name, {}) for name in CONTROLLERS} | {
    "resilient, everything": everything("resilient"),
    "centralized, everything": everything("centralized"),
}
MORE: dict[str, tuple[str, dict[str, Any]]] = {
    f"{name}, everything": everything(name) for name in CONTROLLERS
} | {f"{name}, faults": (name, faults(name) | {"radio.loss": 0.02}) for name in CONTROLLERS}


def check(
    images: tuple[Image, Image],
    controller: str,
    overrides: dict[str, Any],
    seed: int = 3,
    scene: str = "paper",
) -> None:
    image, dongle = images
    row, result, host = carried(image, controller, seed, overrides, dongle, scene)
    assert row["trace_hash"] == row["host_trace_hash"]
    assert list(row) == [
        "scene", "controller", "seed", "loss", "faults", "trace_hash", "host_trace_hash",
        "instructions_per_tick", "stack_bytes", "flash_records", "image_sha256",
    ]  # fmt: skip
    assert list(row["instructions_per_tick"]) == ["median", "worst"]
    assert result.summary() == host.summary()
    assert result.message_log == host.message_log
    assert 0 < row["instructions_per_tick"]["worst"] <= MOST_INSTRUCTIONS
    assert 0 < row["stack_bytes"] <= MOST_STACK
    script = overrides.get("faults.script", [])
    robots = [event["robot"] for event in script if event["kind"] == "reboot"]
    expected = ["power"] * robots.count("left") + ["watchdog"] * robots.count("right")
    if script and controller == "centralized":
        expected += ["power", "watchdog"]  # of the station's radio
    assert row["faults"] == expected


@pytest.mark.parametrize("case", CASES)
def test_boards_carry_as_one_program(images: tuple[Image, Image], case: str) -> None:
    check(images, *CASES[case])


REBOOTS = {
    "faults.script": [
        {"kind": "reboot", "robot": "left", "at_s": 2.0, "duration_s": 0.5},
        {"kind": "reboot", "robot": "right", "at_s": 14.0, "duration_s": 0.3},
    ],
    "radio.loss": 0.1,
}


# Before the arms sink: a board does not see that its palm still turns then.
REBOOTS_EARLY = REBOOTS | {
    "faults.script": [
        {"kind": "reboot", "robot": "left", "at_s": 2.0, "duration_s": 0.5},
        {"kind": "reboot", "robot": "right", "at_s": 4.0, "duration_s": 0.3},
    ]
}
JOBS: dict[str, dict[str, Any]] = {
    "as it is": {},
    "reboots and losses": REBOOTS,
    "at level pivots only, reboots and losses": REBOOTS | {"object": "bottle"},
    "from the palms, reboots and losses": REBOOTS_EARLY | {"task.from": "palms"},
    "onto the palms, reboots and losses": REBOOTS | {"task.to": "palms"},
}


@pytest.mark.parametrize("case", JOBS)
def test_boards_do_a_job_on_the_floor_as_one_program(
    images: tuple[Image, Image], case: str
) -> None:
    check(images, "shared-sign", JOB | JOBS[case], scene="lift")


def rebooted(*reboots: tuple[str, float]) -> dict[str, Any]:
    """These robots restart at these times. While an arm goes up or down, a board goes on elsewhere
    than in the simulation."""
    events = [
        {"kind": "reboot", "robot": side, "at_s": at_s, "duration_s": 0.5} for side, at_s in reboots
    ]
    return {"faults.script": events, "radio.loss": 0.1}


STAND, HANDOVER = (JOB | JOBS_OF_SCENES[scene] for scene in ("stand", "handover"))
OTHER_JOBS: dict[str, tuple[str, dict[str, Any]]] = {
    "from a stand onto a stand": ("stand", STAND),
    "from a stand onto a stand, reboots and losses": (
        "stand",
        STAND | rebooted(("left", 2.0), ("right", 8.0), ("left", 17.0)),
    ),
    "from a stand onto the floor": (
        "stand",
        STAND | {"task.to": "floor", "floor.stands": STAND["floor.stands"][:1]},
    ),
    "one robot alone": ("lone", JOB),
    # On the floor it goes on; in the air it lowers its arm and stands.
    "one robot alone, reboots": ("lone", JOB | rebooted(("right", 5.0), ("right", 20.0))),
    "from palm to palm": ("handover", HANDOVER),
    "from palm to palm, reboots and losses": (
        "handover",
        HANDOVER | rebooted(("right", 2.0), ("left", 26.0)),
    ),
}


@pytest.mark.parametrize("case", OTHER_JOBS)
def test_boards_do_other_jobs_as_one_program(images: tuple[Image, Image], case: str) -> None:
    scene, overrides = OTHER_JOBS[case]
    check(images, "shared-sign", overrides, scene=scene)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("case", MORE)
def test_boards_carry_as_one_program_in_all_conditions(
    images: tuple[Image, Image], case: str, seed: int
) -> None:
    check(images, *MORE[case], seed=seed)


@pytest.mark.parametrize("controller", ["resilient", "centralized"])
def test_the_images_of_another_compiler_carry_as_one_program(
    clang_image: Image, controller: str
) -> None:
    images = clang_image, dongle_image(CLANG_IMAGES)
    check(images, controller, {"task.distance_m": 0.5})
