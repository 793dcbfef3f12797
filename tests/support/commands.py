# SPDX-License-Identifier: Apache-2.0
"""The command line, run in this process."""

import re
from collections.abc import Callable
from subprocess import CompletedProcess

import pytest

from json_output import read_json
from palmbots.cli import main as cli
from palmbots.cli.declared_commands import REQUIRED, Declared, commands_of, declared_commands

Run = Callable[..., CompletedProcess[str]]
"""``run("carry", "--json")``: the exit status, stdout and stderr of ``palmbots carry --json``."""


FUNCTIONS = [
    one
    for name in declared_commands()
    for one in commands_of(name)
    if not one.module.startswith("palmbots.cli.")
]
"""The commands around public functions."""


def required(one: Declared) -> list[str]:
    """Words in place of the arguments without which a command cannot run."""
    return [key for key, given in one.parameters.items() if given.default is REQUIRED]


def runner(capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: str) -> CompletedProcess[str]:
        capsys.readouterr()
        status = cli.run(list(arguments))
        printed = capsys.readouterr()
        if "--json" in arguments and status in (cli.DONE, cli.FAILED) and printed.out:
            read_json(arguments[0], printed.out)
        return CompletedProcess(arguments, status, printed.out, printed.err)

    return run


def unwrapped(printed: str) -> str:
    """What was printed on stderr, with each warning on one line again."""
    return re.sub(r"\n  (?=\S)", " ", printed)


def assert_refused(result: CompletedProcess[str], *words: str) -> None:
    """Exit status 2, nothing on stdout, and one line on stderr that contains these words."""
    assert result.returncode == 2, result
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1, result.stderr
    for word in words:
        assert word in result.stderr, (word, result.stderr)
