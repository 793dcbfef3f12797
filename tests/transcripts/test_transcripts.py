# SPDX-License-Identifier: Apache-2.0
"""Conversations of the robots, as text that a reviewer reads: `pytest tests/transcripts --rewrite`
writes it anew.

Each file NAME.txt has conversations of the controller NAME, in scenes without noise: a title, the
keys of the scene, and after a line ``--`` what each robot reads, does, says and hears. A new
controller gets a file with the first rewrite.
"""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.control.registry import shipped_names

HERE = Path(__file__).parent
USUAL = {"robot.noise_m_s": 0.0, "task.distance_m": 0.3}
OUTWARD = (-1, 1)


def conversations(path: Path) -> Iterator[tuple[str, str, str]]:
    """Title, keys and text of each."""
    for part in re.split(r"^== ", path.read_text(), flags=re.MULTILINE)[1:]:
        title, rest = part.split("\n", 1)
        keys, _, text = rest.partition("--\n")
        yield title, keys, text.strip("\n")


def carried(controller: str, keys: str, **more: Any) -> pb.simulation.Carry:
    given = {".".join(name): value for name, value in flat(tomllib.loads(keys))}
    return pb.carry("paper", controller, overrides={**USUAL, **given, **more})


def flat(table: dict[str, Any], inside: tuple[str, ...] = ()) -> Iterator[tuple[Any, Any]]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from flat(value, (*inside, name))
        else:
            yield (*inside, name), value


def events(carry: pb.simulation.Carry) -> Iterator[tuple[float, int, str]]:
    """What changes in a robot: tick by tick, and in a tick in the order of a control step."""
    assert carry.trace is not None
    rows = {name: carry.trace[name].to_numpy() for name in ("time", "sign", "case", "palm")}
    commanded = carry.trace["commanded"].to_numpy()
    forward = 1 if carry.scene.task.direction == "forward" else -1
    for s, side in enumerate(SIDES):
        nominal = forward * carry.scene.robot_of(side).speed_m_s
        drives = np.sign(np.round(OUTWARD[s] * (commanded[:, s] - nominal), 9)).astype(int)
        drives[np.abs(commanded[:, s]) < 1e-9] = 2
        turns = np.sign(np.diff(rows["palm"][:, s], prepend=rows["palm"][0, s])).astype(int)
        tracks = (
            (rows["sign"][:, s], {-1: "reads -", 0: "reads 0", 1: "reads +"}),
            (rows["case"][:, s], {}),
            (turns, {-1: "tilts up", 1: "tilts down"}),
            (drives, {-1: "closer", 0: "nominal speed", 1: "away", 2: "stands"}),
        )
        for track, words in tracks:
            for k in np.flatnonzero(track[1:-1] != track[:-2]) + 1:
                value = track[k]
                text = words.get(value, f"case {value}" if str(value).strip() else "no case")
                if track is not turns or value:
                    yield rows["time"][k], s, text
    entry = carry.controller_entry
    said: dict[str, str] = {}
    for message in carry.message_log:
        if said.get(message.sender) == message.kind and entry is not None and entry.is_periodic:
            continue
        said[message.sender] = message.kind
        sender, receiver = (SIDES.index(name) for name in (message.sender, message.receiver))
        lost = ", which is lost" if message.received_s is None else ""
        yield message.sent_s, sender, f"says {message.kind}{lost}"
        if message.received_s is not None:
            yield message.received_s, receiver, f"hears {message.kind}"


def transcript(carry: pb.simulation.Carry) -> str:
    """A line for each time, with a column for each robot."""
    lines: dict[float, list[list[str]]] = {}
    for time_s, side, text in events(carry):
        lines.setdefault(round(time_s, 6), [[], []])[side].append(text)
    rows = [(f"{t:6.2f}", *(", ".join(one) for one in lines[t])) for t in sorted(lines)]
    wide = max((len(left) for _, left, _ in rows), default=0)
    shown = [f"{time}  {left:{wide}}  {right}".rstrip() for time, left, right in rows]
    return "\n".join([*shown, carry.headline().split("   ")[0].strip()])


@pytest.mark.parametrize("controller", shipped_names("robots", "station"))
def test_conversations(controller: str, pytestconfig: pytest.Config) -> None:
    path = HERE / f"{controller}.txt"
    known = list(conversations(path if path.exists() else HERE / "distributed.txt"))
    found = [(title, keys, transcript(carried(controller, keys))) for title, keys, _ in known]
    if pytestconfig.getoption("--rewrite"):
        blocks = [f"== {title}\n{keys}--\n{text}\n" for title, keys, text in found]
        path.write_text("\n".join(blocks))
    assert path.exists(), f"no conversations of {controller}; write them with --rewrite"
    assert [*conversations(path)] == found


def words(carry: pb.simulation.Carry) -> list[list[str]]:
    """What each robot says, and its cases, without their times."""
    own: list[list[str]] = [[], []]
    for _, side, text in sorted(events(carry), key=lambda event: event[0]):
        if text.startswith(("says", "case")):
            own[side].append(text)
    return own


@pytest.mark.parametrize("latency_s", [0.01, 0.07, 0.2])
@pytest.mark.parametrize("rate_deg_s", [2000.0, 25.0])
def test_timing_does_not_change_a_conversation(latency_s: float, rate_deg_s: float) -> None:
    """Of the algorithm of Table 2, where requests do not cross."""
    timing = {"radio.latency_s": latency_s, "palm.rate_deg_s": rate_deg_s}
    for title, keys, _ in conversations(HERE / "distributed.txt"):
        if title.startswith("one bump"):
            usual, other = (carried("distributed", keys, **more) for more in ({}, timing))
            assert words(usual) == words(other), title
