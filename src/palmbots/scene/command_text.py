# SPDX-License-Identifier: Apache-2.0
"""Commands as reports print them. No other module builds one around a scene.

A printed command runs as it stands: it names the scene as the user did, with everything that was
set, gives each key once, and repeats the options that the user gave.
"""

import shlex
from collections.abc import Mapping
from typing import Any

from palmbots._util.text import format_number
from palmbots.scene.overrides import SUPERSEDES


def command_text(
    command: str, place: str = "", changes: Mapping[str, Any] | None = None, **options: Any
) -> str:
    """A command line of palmbots.

    Args:
        command: its name.
        place: what it is about, as words of a command line: `Scene.spelled`, or a quoted file.
        changes: scene keys that are set in place of what `place` sets.
        options: by parameter. None and False are left out, True is a flag, a pair of numbers is
            two words, and a list is one word with commas. A string is taken as words of a command
            line.
    """
    words = ["palmbots", command]
    if place:
        words.append(respelled(place, changes) if changes else place)
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("-c" if name == "controller" else f"--{name.replace('_', '-')}")
        if isinstance(value, list):
            words.append(",".join(map(_word, value)))
        elif isinstance(value, tuple):
            words += map(_word, value)
        elif value is not True:
            words.append(_word(value))
    return " ".join(words)


def _word(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.10g}"


def settings_of(changes: Mapping[str, Any]) -> str:
    """Changed keys as options of a command, each with a blank in front."""
    return "".join(
        f" --set {shlex.quote(f'{key}={format_number(value)}')}" for key, value in changes.items()
    )


def respelled(place: str, changes: Mapping[str, Any]) -> str:
    """A scene as a command line names it, with changed keys: each key is given once, and without
    those that the changes make obsolete, such as those of a path that becomes straight."""
    obsolete = {
        f"{table}.{other}"
        for table, rules in SUPERSEDES.items()
        for rule, others in rules.items()
        for key, _, value in [rule.partition("=")]
        if f"{table}.{key}" in changes and value in ("", changes[f"{table}.{key}"])
        for other in others
    }
    words, kept = shlex.split(place), []
    while words:
        count = 2 if words[0] == "--set" else 1
        option, words = words[:count], words[count:]
        key = option[-1].partition("=")[0].strip() if count == 2 else ""
        if key not in changes and key not in obsolete:
            kept += option
    return shlex.join(kept) + settings_of(changes)
