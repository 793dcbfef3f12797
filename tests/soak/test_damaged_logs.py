# SPDX-License-Identifier: Apache-2.0
"""Logs of robots and station in which any field has any value: one line, and no traceback."""

import copy
import random
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.logs.run_log_reader import RunLog, run_log_of
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run, replay_run

DAMAGES = 1000
NUMBERS = (0, 1, 2, 7, 255, 256, 65535, 65536, 2**31, 2**32, 2**63 - 1)
TEXTS = ("", "x", "left", "station", "carrying", "stop", "a", "€", "\0", "9" * 5000)
FACTS: tuple[Any, ...] = (None, "x", True, -1, 0, 2**40, 1.5, float("nan"), [], {}, "€", [[]])


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[RunLog]:
    """Those of a short carry."""
    pair = SimulatedPair(tmp_path_factory.mktemp("run"), "resilient", Air(), UP, logs=True)
    pair.start()
    pair.run(150)
    pair.close()
    folder = pair.pair.log_folder()
    assert folder is not None
    return read_run([folder])


def any_value(field: Any, chance: random.Random) -> Any:
    """One that the type of a field allows."""
    if field.type == field.TYPE_BOOL:
        return chance.random() < 0.5
    if field.type == field.TYPE_STRING:
        return chance.choice(TEXTS)
    if field.type == field.TYPE_BYTES:
        return chance.randbytes(chance.choice((0, 1, 8, 36, 200)))
    number = chance.choice(NUMBERS)
    return -number if field.type == field.TYPE_SINT64 and chance.random() < 0.5 else number


def damage_message(log: RunLog, chance: random.Random) -> str:
    kind = chance.choice([kind for kind, found in log.messages.items() if found])
    place = chance.randrange(len(log.messages[kind]))
    time_s, message = log.messages[kind][place]
    message = copy.deepcopy(message)
    field = chance.choice(message.DESCRIPTOR.fields)
    if isinstance(getattr(message, field.name), str | bytes | bool | int):
        setattr(message, field.name, any_value(field, chance))
    else:
        message.ClearField(field.name)
        count = chance.randrange(4)
        getattr(message, field.name).extend(any_value(field, chance) for _ in range(count))
    log.messages[kind][place] = (chance.choice((time_s, -time_s, 1e9)), message)
    return f"{log.end}: {kind} {place} {field.name} = {getattr(message, field.name)!r}"


def damage_fact(log: RunLog, chance: random.Random) -> str:
    table: Any = log.facts
    while True:
        name = chance.choice(list(table))
        if not isinstance(table[name], dict) or not table[name] or chance.random() < 0.2:
            break
        table = table[name]
    if chance.random() < 0.2:
        del table[name]
        return f"{log.end}: {name} is missing"
    table[name] = chance.choice(FACTS)
    return f"{log.end}: {name} = {table[name]!r}"


def test_any_field_may_have_any_value(logs: list[RunLog], soak_seed: int) -> None:
    chance = random.Random(soak_seed)
    for _ in range(DAMAGES):
        damaged = [
            RunLog(
                Path(log.path), log.end, log.epoch, copy.deepcopy(log.facts),
                {kind: list(found) for kind, found in log.messages.items()}, log.is_cut,
            )
            for log in logs
        ]  # fmt: skip
        log = chance.choice(damaged)
        damages = [
            (damage_fact if chance.random() < 0.3 else damage_message)(log, chance)
            for _ in range(chance.choice((1, 1, 1, 3)))
        ]
        try:
            checked = [
                run_log_of(one.path, one.facts, one.messages, is_cut=one.is_cut) for one in damaged
            ]
            replay = replay_run(checked)
            for _ in replay.lines():
                pass
            carry_of(checked, replay.clocks)
        except pb.PalmbotsError as error:
            assert "\n" not in str(error)
        except Exception as error:
            raise AssertionError(f"{damages}: {error!r}") from error
