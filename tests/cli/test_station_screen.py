# SPDX-License-Identifier: Apache-2.0
"""The operator's screen, with Textual's pilot: what it shows and which keys do what."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any, get_args

import pytest

from palmbots._types import SIDES
from palmbots.cli.plain_station import _print
from palmbots.cli.station_text import plain_status
from palmbots.wire import RobotMode

pytest.importorskip("textual")

from palmbots.cli.station_screen import station_app

ROBOT: dict[str, Any] = {
    "is_heard": True, "silent_s": 0.0, "mode": "carrying", "fault": "none", "reason": "", "sign": 1,
    "palm": "steep", "palm_at_target": True, "case": "a", "at_rest": False, "stop": False,
    "progress": 0.43, "battery_v": 11.84, "overruns": 0, "loss": 0.03, "round_trip_s": 0.062,
    "boots": 3, "phase": "",
}  # fmt: skip
OTHER = ROBOT | {
    "mode": "holding", "sign": -1, "palm": "shallow", "palm_at_target": False, "case": "c",
    "battery_v": None, "loss": None, "round_trip_s": None,
}  # fmt: skip
STATE = {
    "time_s": 12.3,
    "wish": "start",
    "wish_is_done": False,
    "robots": {"left": ROBOT, "right": OTHER},
    "corrections": [["B", "left", "a", "right"]],
    "warnings": ["left: 12 % of its packets are lost"],
}


class Client:
    """What the screen uses of a `StationClient`."""

    def __init__(self, role: str = "operator", state: Any = STATE) -> None:
        self.role, self.state = role, state
        self.facts = {"pair": 31337, "controller": "resilient", "scene": "paper"}
        self.lines = ["   1.00 s  left: armed"]
        self.end: Any = None
        self.is_connected = True
        self.wished: list[str] = []
        self.reconnects = 0

    def poll(self) -> bool:
        return False

    def wish(self, operation: str) -> None:
        self.wished.append(operation)

    def reconnect(self) -> bool:
        self.reconnects += 1
        return False


def shown(app: Any) -> str:
    """The text of the whole screen."""
    strips = app.screen._compositor.render_strips()
    return "\n".join("".join(segment.text for segment in strip) for strip in strips)


def run(
    client: Any, act: Callable[[Any, Any], Awaitable[None]], size: tuple[int, int] = (80, 24)
) -> Any:
    async def main() -> Any:
        app = station_app(client)
        async with app.run_test(size=size) as pilot:
            await pilot.pause()
            await act(app, pilot)
        return app

    return asyncio.run(main())


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
def test_everything_is_visible(size: tuple[int, int]) -> None:
    texts: list[str] = []

    async def look(app: Any, pilot: Any) -> None:
        texts.append(shown(app))

    run(Client(), look, size)
    for part in (
        "pair 31337: resilient, paper", "wish: start", "12 s", "left robot", "right robot",
        "carrying", "holding", "43 %", "+1, contact outward", "−1, contact inward", "steep",
        "shallow, turning", "B: (a) own p > 0", "B: (c) assists", "3 % lost, 62 ms round trip",
        "11.8 V", "not measured", "! left: 12 % of its packets are lost", "1.00 s  left: armed",
        "E-STOP:  space  or  Escape", "a arm   s start   x stop   r release   d disarm   q quit",
    ):  # fmt: skip
        assert part in texts[0], (part, texts[0])


def test_nothing_is_drawn_while_the_screen_closes() -> None:
    """Textual removes the fields one by one while the timer still runs."""
    closed: list[bool] = []

    async def close_slowly(app: Any, pilot: Any) -> None:
        close_all = app._close_all

        async def remove_one_field_first() -> None:
            await app.query_one("#head").remove()
            app._refresh_view()
            closed.append(True)
            await close_all()

        app._close_all = remove_one_field_first

    run(Client(), close_slowly)
    assert closed == [True]


def test_plain_lines_have_the_same_content() -> None:
    left, right, warning = plain_status(STATE)
    assert left == "  12.30 s  left   carrying, sign +1, palm steep, 43 %, 3 % lost, 62 ms, 11.8 V"
    assert right.startswith("  12.30 s  right  holding, sign -1, turns to shallow, 43 %, –, –")
    assert warning == "  12.30 s  warning: left: 12 % of its packets are lost"


@pytest.mark.parametrize("mode", get_args(RobotMode))
@pytest.mark.parametrize(
    "reason", ["", "partner_lost", "operator: e-stop", "script (right not heard for 10 s): stop"]
)
def test_plain_lines_of_robots_fit_80_columns(mode: str, reason: str) -> None:
    widest = {
        "mode": mode, "reason": reason, "sign": -1, "palm": "shallow", "palm_at_target": False,
        "progress": 1.0, "loss": 0.234, "round_trip_s": 0.999, "battery_v": 11.8,
    }  # fmt: skip
    state = STATE | {"time_s": 3599.9, "robots": dict.fromkeys(SIDES, ROBOT | widest)}
    for line in plain_status(state)[:2]:
        assert len(line) <= 80
        assert line[18:].startswith(f"{mode} ({reason}), sign -1" if reason else f"{mode}, sign -1")


@pytest.mark.parametrize(
    ("key", "wish"),
    [
        ("space", "e_stop"), ("escape", "e_stop"), ("a", "arm"), ("s", "start"), ("x", "stop"),
        ("r", "release"), ("d", "disarm"), ("q", "quit"), ("ctrl+c", "quit"),
    ],
)  # fmt: skip
def test_keys(key: str, wish: str) -> None:
    client = Client()

    async def press(app: Any, pilot: Any) -> None:
        await pilot.press(key)
        await pilot.pause()

    run(client, press)
    assert client.wished == [wish]


def test_the_large_field_is_the_e_stop() -> None:
    client = Client()

    async def click(app: Any, pilot: Any) -> None:
        await pilot.click("#stop")
        await pilot.click("#left")
        await pilot.pause()

    run(client, click)
    assert client.wished == ["e_stop"]


def test_a_viewer_has_no_keys_but_the_one_to_leave() -> None:
    client, texts = Client("viewer"), list[str]()

    async def press(app: Any, pilot: Any) -> None:
        texts.append(shown(app))
        for key in ("space", "escape", "a", "s", "x", "r", "d"):
            await pilot.press(key)
        assert app.is_running
        await pilot.press("q")
        await pilot.pause()

    app = run(client, press)
    assert not app.is_running
    assert client.wished == []
    assert "E-STOP" not in texts[0]
    assert "takes no orders" in texts[0]


def test_it_ends_with_the_station() -> None:
    client = Client()

    async def end(app: Any, pilot: Any) -> None:
        client.end = {"done": True}
        await pilot.pause(0.3)

    assert not run(client, end).is_running


def test_robots_that_are_not_heard() -> None:
    silent = ROBOT | {"is_heard": False, "silent_s": 4.2}
    state = STATE | {"robots": {"left": None, "right": silent}, "corrections": []}
    texts: list[str] = []

    async def look(app: Any, pilot: Any) -> None:
        texts.append(shown(app))

    run(Client(state=state), look)
    assert "not heard yet" in texts[0]
    assert "silent 4 s (carrying)" in texts[0]
    assert plain_status(state)[1].endswith("right  not heard for 4 s; was carrying")


def test_plain_lines_are_wrapped_beside_their_time(capsys: pytest.CaptureFixture[str]) -> None:
    """Reasons and remedies may be long; objects of JSON stay whole."""
    text = "left: fault: " + 20 * "the palm does not follow "
    for head, indent in (("   7.25 s  ", 11), ("1234.50 s  ", 11), ("", 2)):
        _print(head + text.rstrip())
        first, *others = capsys.readouterr().out.splitlines()
        assert others and max(map(len, (first, *others))) <= 80
        assert {len(line) - len(line.lstrip()) for line in others} == {indent}
        assert " ".join([first, *map(str.strip, others)]) == head + text.rstrip()
    _print({"line": text})
    assert capsys.readouterr().out.count("\n") == 1
