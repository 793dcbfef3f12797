# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots scenes`, `objects`, `controllers` and `keys`."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots.cli.console import GOOD, QUIET, definitions, indented, report_console

if TYPE_CHECKING:
    from palmbots.control.registry import ControllerEntry
    from palmbots.scene.key_reference import SceneKey


def names_report(meanings: Mapping[str, str]) -> None:
    """Print names with their meanings."""
    report_console().print(definitions(meanings.items()))


def controllers_report(entries: Sequence["ControllerEntry"]) -> None:
    """Print each controller with σ*, its messages, what it requires, and its meaning."""
    from palmbots.control.tolerated_noise import RECOMMENDED, tolerated_noise

    console = report_console()
    for entry in entries:
        head = Text(entry.name, style="bold")
        if (noise := tolerated_noise(entry.name)) is not None:
            head.append(f"  σ* {100 * noise.sigma_star_m_s:.2f} cm/s", "not bold")
        if entry.name == RECOMMENDED:
            head.append("  recommended", f"not bold {GOOD}")
        console.print(head)
        console.print(indented(entry.description, 4))
        if entry.messages:
            console.print(indented(f"messages: {', '.join(entry.messages)}", 4), style=QUIET)
        for need in entry.requirements:
            console.print(indented(f"needs {need}", 4), style=QUIET)
    console.print(
        "σ*: the speed noise at which 1 % of carries drop the object in the default scene; "
        "measured with: palmbots noise-limit -c CONTROLLER --relative-error-percent 0.3",
        style=QUIET,
    )


def keys_report(keys: Sequence["SceneKey"]) -> None:
    """Print each key with its default and unit, and its meaning below."""
    console = report_console()
    for key in keys:
        head = Text(key.name, style="bold")
        head.append(f" = {key.default_text}" if key.default_text else "  (not set)", "not bold")
        if key.unit:
            head.append(f"  {key.unit}", f"not bold {QUIET}")
        console.print(head)
        if key.meaning:
            console.print(indented(key.meaning, 4))
