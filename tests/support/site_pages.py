# SPDX-License-Identifier: Apache-2.0
"""What tests of the page have in common: addresses, and the commands that the page prints."""

import base64
import json
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest

from commands import Run, runner
from palmbots.mechanics.contact_modes import CONTACT_MODES

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "build" / "site"

Open = Callable[..., Any]
"""``open_page("#carry?seed=3", width=390, touch=True)``: a page at this address, with the core
loaded; a `playwright.sync_api.Page`."""


def hash_of(view: str, query: Mapping[str, object] | None = None, **keys: object) -> str:
    """The address of a view; `keys` are overrides with `__` in place of the dot."""
    pairs = [(name, str(value)) for name, value in (query or {}).items()]
    pairs += [("set", f"{k.replace('__', '.')}={json.dumps(v)}") for k, v in keys.items()]
    return f"#{view}?{urlencode(pairs)}" if pairs else f"#{view}"


def mode_name(mode: int) -> str:
    """What the page calls a contact mode, given as in `ContactModesBatch.closing`."""
    return {-1: "not held", -2: "jammed"}.get(mode) or "-".join(CONTACT_MODES[mode])


def go(page: Any, place: str) -> None:
    """Open another address in the same page."""
    page.evaluate("place => { location.hash = place; }", place)


def pictures(page: Any, *names: str) -> list[bytes]:
    """What these canvases show, as PNG files, after the effects that are due have drawn.

    The page shows words at once and draws after the next frame.
    """
    found = page.evaluate(
        "async names => {"
        "  await new Promise(done => requestAnimationFrame(() => setTimeout(done)));"
        "  return names.map(name => document.getElementById(name).toDataURL()); }",
        names,
    )
    return [base64.b64decode(url.partition(",")[2]) for url in found]


def command_of(page: Any, line: int = 0) -> list[str]:
    """The words of a command that the page prints, without the name of the program."""
    words = shlex.split(page.locator(".command").inner_text().splitlines()[line])
    assert words[0] == "palmbots"
    return words[1:]


def run_json(run: Run, words: list[str]) -> dict[str, Any]:
    """What the command prints as JSON."""
    result = run(*words, "--json")
    assert result.returncode in (0, 1), result.stderr
    return json.loads(result.stdout)


def seconds(page: Any) -> float:
    """The time that the player shows."""
    return float(page.locator(".player .time").inner_text().removesuffix(" s"))


def overrides_of(page: Any) -> dict[str, Any]:
    """The overrides that the command of the page sets."""
    from palmbots.scene.overrides import parse_overrides

    words = command_of(page)
    return dict(parse_overrides([words[k + 1] for k, w in enumerate(words) if w == "--set"]))


def assert_reproduced(page: Any, capsys: Any) -> None:
    """The command that the page prints gives the hash that it shows."""
    expect = pytest.importorskip("playwright.sync_api").expect  # installed for tests/site only
    found = run_json(runner(capsys), command_of(page))
    expect(page.locator("#hash")).to_have_text(found["trace_hash"])
