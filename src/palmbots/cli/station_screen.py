# SPDX-License-Identifier: Apache-2.0
"""The operator's screen in a terminal (Textual, the extra ``station``).

The screen only shows and asks: the loop that talks to the robots is another process, so a slow
terminal delays no stop.
"""

import time
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from palmbots._types import SIDES, Side
from palmbots._util.optional_imports import require
from palmbots.cli.plain_station import ended
from palmbots.cli.station_text import (
    battery_text,
    case_text,
    link_text,
    palm_text,
    progress_text,
    sign_text,
)
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import ConnectionLost
from palmbots.station.station_client import StationClient
from palmbots.wire import Operation

if TYPE_CHECKING:
    from textual.app import App

_REFRESH_S = 0.1
_COLOURS: dict[Side, str] = {"left": "#56B4E9", "right": "#E69F00"}
_MODE_COLOURS = {
    "carrying": "bold #009E73",
    "holding": "bold #009E73",
    "done": "bold #009E73",
    "ready": "bold #F0E442",
    "armed": "bold #F0E442",
    "stopped": "bold white on #B00020",
    "fault": "bold white on #B00020",
}
_STYLE = """
Screen { layout: vertical; }
#head { height: 1; background: $primary-darken-3; padding: 0 1; }
#robots { height: 9; }
.robot { width: 1fr; height: 9; border: round #8A8A8A; padding: 0 1; }
#warnings { height: auto; max-height: 3; padding: 0 1; color: #F0E442; }
#lines { height: 1fr; min-height: 4; border: round #8A8A8A; padding: 0 1;
         background: $background; }
#stop { height: 3; content-align: center middle; background: #B00020; color: white;
        text-style: bold; }
#keys { height: 1; padding: 0 1; }
"""


def run_screen(client: StationClient, restarts_within_s: float = 0.0) -> dict[str, Any]:
    """Show a station until it ends, or until an operator or viewer leaves.

    Args:
        client: attached to the station.
        restarts_within_s: how long to wait for a station that was killed and starts again.

    Returns:
        How the station ended.

    Raises:
        MissingExtra: Textual is not installed.
        PalmbotsError: the station is gone, or has failed.
    """
    app = station_app(client, restarts_within_s)
    app.run()
    if client.end is not None:
        return ended(client.end)
    if client.role == "viewer":
        return {"done": True, "modes": {}, "links": None}
    raise PalmbotsError("station: its process is gone")


def station_app(client: StationClient, restarts_within_s: float = 0.0) -> "App[None]":
    """The screen as a Textual application.

    Raises:
        MissingExtra: Textual is not installed.
    """
    require("textual", "station")
    from rich.table import Table
    from rich.text import Text
    from textual.app import App, ComposeResult
    from textual.binding import Binding
    from textual.containers import Horizontal
    from textual.widgets import RichLog, Static

    is_operator = client.role == "operator"

    class StationApp(App[None]):
        """Both robots, what happens, and the keys."""

        TITLE = "palmbots station"
        ENABLE_COMMAND_PALETTE = False
        CSS = _STYLE
        BINDINGS: ClassVar = [
            Binding("space,escape", "wish('e_stop')", "e-stop", priority=True),
            Binding("a", "wish('arm')", "arm"),
            Binding("s", "wish('start')", "start"),
            Binding("x", "wish('stop')", "stop"),
            Binding("r", "wish('release')", "release"),
            Binding("d", "wish('disarm')", "disarm"),
            Binding("q,ctrl+q,ctrl+c", "leave", "quit", priority=True),
        ]

        def compose(self) -> ComposeResult:
            yield Static(id="head")
            with Horizontal(id="robots"):
                for side in SIDES:
                    yield Static(id=side, classes="robot")
            yield Static(id="warnings")
            yield RichLog(id="lines", wrap=True, max_lines=1000)
            if is_operator:
                yield Static("E-STOP:  space  or  Escape", id="stop")
                yield Static(Text(_KEYS, no_wrap=True), id="keys")
            else:
                yield Static(Text("view only: takes no orders     q quit"), id="keys")

        def on_mount(self) -> None:
            for side in SIDES:
                self.query_one(f"#{side}", Static).border_title = f"{side} robot"
            self._printed = 0
            self._lost_s: float | None = None
            self._refresh_view()
            self.set_interval(_REFRESH_S, self._refresh_view)

        def on_click(self, event: Any) -> None:
            """A click on the large field is the e-stop, too."""
            if is_operator and getattr(event.widget, "id", None) == "stop":
                self.action_wish("e_stop")

        def action_wish(self, operation: Operation) -> None:
            if is_operator:
                self._send(operation)

        def action_leave(self) -> None:
            if is_operator and client.is_connected:
                self._send("quit")
            else:
                self.exit()

        def _send(self, wish: Operation | Literal["quit"]) -> None:
            try:
                client.wish(wish)
            except ConnectionLost:
                self._note_loss()

        def _refresh_view(self) -> None:
            if not self.is_running:  # closing: the fields go away one by one
                return
            client.poll()
            self._note_loss()
            log = self.query_one("#lines", RichLog)
            for line in client.lines[self._printed :]:
                log.write(Text(line))
            self._printed = len(client.lines)
            self._draw()
            if client.end is not None:
                self.exit()

        def _note_loss(self) -> None:
            """Wait for a station that is gone to come back, but not forever."""
            if client.is_connected or client.end is not None:
                self._lost_s = None
                return
            now = time.monotonic()
            self._lost_s = self._lost_s or now
            if client.reconnect():
                self._lost_s, self._printed = None, 0
            elif now - self._lost_s >= restarts_within_s:
                self.exit()

        def _draw(self) -> None:
            self.query_one("#head", Static).update(self._head())
            state = client.state
            robots = dict.fromkeys(SIDES) if state is None else state["robots"]
            for side in SIDES:
                shown = Text("\nstands aside")
                if side in robots:
                    shown = self._robot(robots[side], side)
                self.query_one(f"#{side}", Static).update(shown)
            warnings = [] if state is None else state["warnings"]
            if not client.is_connected:
                warnings = ["the station is gone: the robots stop on their own", *warnings]
            text = Text("\n".join(f"! {warning}" for warning in warnings[:3]))
            self.query_one("#warnings", Static).update(text)

        def _head(self) -> Table:
            facts, state = client.facts, client.state
            head = Table.grid(expand=True)
            head.add_column(ratio=1, no_wrap=True, overflow="ellipsis")
            head.add_column(justify="right", no_wrap=True)
            names = f"pair {facts['pair']}: {facts['controller']}, {facts['scene']}"
            wish = ""
            if state is not None and state["wish"] is not None:
                wish = f"wish: {state['wish']}{', done' if state['wish_is_done'] else ''}   "
            time_s = 0.0 if state is None else state["time_s"]
            head.add_row(
                Text.assemble(("palmbots station  ", "bold"), names),
                Text(f"{wish.replace('_', '-')}{time_s:.0f} s"),
            )
            return head

        def _robot(self, robot: dict[str, Any] | None, side: Side) -> Table | Text:
            if robot is None:
                return Text("\nnot heard yet")
            grid = Table.grid(padding=(0, 1))
            grid.add_column(style="dim", no_wrap=True)
            grid.add_column(no_wrap=True, overflow="ellipsis")
            why = f" ({robot['reason']})" if robot["reason"] else ""
            mode = Text(f"{robot['mode']}{why}", _MODE_COLOURS.get(robot["mode"], "bold"))
            if not robot["is_heard"]:
                mode = Text(f"silent {robot['silent_s']:.0f} s ({robot['mode']})", "bold")
            rows = {
                "mode": mode,
                "progress": Text(progress_text(robot), _COLOURS[side]),
                "sign": Text(sign_text(robot)),
                "palm": Text(palm_text(robot)),
                "case": Text(self._case(robot, side)),
                "link": Text(link_text(robot)),
                "battery": Text(battery_text(robot)),
            }
            for name, value in rows.items():
                grid.add_row(name, value)
            return grid

        def _case(self, robot: dict[str, Any], side: Side) -> str:
            """The case, with the label of the correction that the robot takes part in."""
            state = client.state or {"corrections": []}
            labels = [label for label, *who in state["corrections"] if side in (who[0], who[2])]
            text = case_text(robot, client.facts["controller"])
            return f"{labels[0]}: {text}" if labels else text

    return StationApp()


_KEYS = "a arm   s start   x stop   r release   d disarm   q quit"
