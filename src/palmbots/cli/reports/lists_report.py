# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots scenes`, `objects`, `controllers` and `keys`."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from palmbots.cli.reports.console import QUIET, definitions, indented, report_console

if TYPE_CHECKING:
    from palmbots.scene.key_reference import SceneKey

__all__ = ["keys_report", "names_report"]


def names_report(meanings: Mapping[str, str]) -> None:
    """Print names with their meanings."""
    report_console().print(definitions(meanings.items()))


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
