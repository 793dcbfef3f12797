# SPDX-License-Identifier: Apache-2.0
"""Checks environment variables that make an import, or Typer's shell completion, fail."""

import re
from collections.abc import Mapping

SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
"""The shells for which Typer completes commands."""

_COMPLETION = "_PALMBOTS_COMPLETE"
_LAST_SECOND = 253402300799  # of the year 9999, the last year of `datetime`


def environment_fault(variables: Mapping[str, str]) -> str | None:
    """One line about a variable that no command can use; None: there is none."""
    instruction = variables.get(_COMPLETION)
    if instruction:
        return _completion_fault(instruction, variables)
    epoch = variables.get("SOURCE_DATE_EPOCH")
    if epoch is not None and not (_is_whole(epoch) and int(epoch) <= _LAST_SECOND):
        return _line("SOURCE_DATE_EPOCH", epoch, f"a whole number from 0 to {_LAST_SECOND}")
    return None


def _completion_fault(instruction: str, variables: Mapping[str, str]) -> str | None:
    if not re.fullmatch(rf"(source|complete)_({'|'.join(SHELLS)})", instruction):
        shells = ", ".join(SHELLS)
        return _line(_COMPLETION, instruction, f"source_SHELL or complete_SHELL, SHELL: {shells}")
    if instruction == "complete_bash":  # the other shells pass variables that may be absent
        if "COMP_WORDS" not in variables:
            return (
                f"COMP_WORDS: is not set; {_COMPLETION}=complete_bash needs the words to complete"
            )
        number = variables.get("COMP_CWORD", "")
        if not _is_whole(number):
            return _line("COMP_CWORD", number, "the number of a word, from 0")
    return None


def _is_whole(text: str) -> bool:
    return re.fullmatch("[0-9]{1,18}", text) is not None


def _line(name: str, value: str, allowed: str) -> str:
    from palmbots._util.arguments import show

    return f"{name}: value is {show(value)}; allowed: {allowed}"
