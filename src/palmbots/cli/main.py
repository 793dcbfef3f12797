# SPDX-License-Identifier: Apache-2.0
"""Runs one command: collects the commands, parses the arguments, and refuses bad input.

A command is a function with a declaration (`palmbots._util.command`), of which
`palmbots.cli.function_commands` makes a command. Most are public functions. Those of
`palmbots.cli.commands` run processes or screens, and return the exit status.

Every command has ``--json`` (one object on stdout and nothing else). The exit status is 0 when the
command did its job, 1 when the subject of the command failed, 2 for bad input, which is answered
with one line, 130 after Ctrl-C, and 141 where the pipe on stdout is closed (``palmbots keys | head
-1``). Closed streams, as in ``palmbots contact-modes >&-``, discard what is written to them.
"""

import io
import os
import signal
import sys
from functools import cache
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from palmbots._util.end_signal import end_with_starter
from palmbots._util.exit_status import BAD_INPUT, CLOSED_PIPE, DONE, INTERRUPTED
from palmbots._util.exit_status import FAILED as FAILED
from palmbots.cli._exception_hooks import heard_signal, install_exception_hooks
from palmbots.cli._run import Interrupted
from palmbots.cli._streams import discard_unwritable, say, say_interrupted
from palmbots.cli._warnings import hold_warnings
from palmbots.cli.declared_commands import commands_of, declared_commands, is_command
from palmbots.cli.function_commands import typer_function
from palmbots.errors import PalmbotsError, one_line

# The base of all usage errors. Typer contains a copy of click under a private name.
_UsageError: Any = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")
_NUMBERS = {"int_parsing": "a whole number", "float_parsing": "a number"}


def main() -> None:
    """Run the command line and exit with its status."""
    for stream in (sys.stdout, sys.stderr):  # an encoding without ° prints ? instead
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    install_exception_hooks()
    end_with_starter(os.environ)
    try:
        status = run(sys.argv[1:])
        if status == INTERRUPTED:  # a second Ctrl-C must not disturb the exit
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        sys.stdout.flush()  # here, so that a full disk is reported in one line
    except BrokenPipeError:
        status = CLOSED_PIPE
    except OSError as error:
        status = _unwritable(error)
    except (AttributeError, ValueError):
        if sys.stdout is not None and not sys.stdout.closed:
            raise
        status = _refuse("the output cannot be written: the controller has closed stdout")
    discard_unwritable("stdout", "stderr")
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """Run one command; returns the exit status."""
    try:
        return _run(arguments)
    except Exception:
        number = heard_signal()
        if number is None:
            raise
        return _interrupted() if number == signal.SIGINT else 128 + number


def _run(arguments: list[str]) -> int:
    # Commands only write files. A notebook of another environment may have set a backend that is
    # not installed here; matplotlib then refuses to be imported.
    os.environ["MPLBACKEND"] = "agg"
    try:
        with hold_warnings():
            group = _commands(arguments[0] if arguments else None)
            status = group(args=arguments, prog_name="palmbots", standalone_mode=False)
        if status == INTERRUPTED:  # Typer's answer to a KeyboardInterrupt; commands never return it
            return _interrupted()
        return status if isinstance(status, int) else DONE
    except Interrupted:  # it has printed its line
        return INTERRUPTED
    except PalmbotsError as error:
        return _refuse(_with_option_name(str(error), arguments))
    except _UsageError as error:
        return _refuse(_usage_message(error))
    except typer.Exit as stop:
        return stop.exit_code
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted()
    except SystemExit as stop:  # how Typer and Rich answer to a closed pipe
        if isinstance(stop.__context__, BrokenPipeError):
            return CLOSED_PIPE
        raise


def _interrupted() -> int:
    say_interrupted()
    return INTERRUPTED


class _Command(TyperCommand):
    """A command whose help lists the worlds where it says ``{worlds}``."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        try:
            return super().parse_args(ctx, args)
        except _UsageError as error:  # one about an option without its values names no command
            error.ctx = getattr(error, "ctx", None) or ctx
            raise

    def format_help(self, ctx: Any, formatter: Any) -> None:
        texts: dict[Any, str | None] = {p: getattr(p, "help", None) for p in self.params}
        for option, text in texts.items():
            if text and "{worlds}" in text:
                from palmbots.simulation import world_names

                option.help = text.replace("{worlds}", " or ".join(world_names()))
        super().format_help(ctx, formatter)
        for option, text in texts.items():  # other worlds may be registered until it is asked again
            option.help = text


class _Group(TyperGroup):
    """Lists the commands in their order, and makes those that were only listed."""

    def list_commands(self, ctx: Any) -> list[str]:
        return sorted(self.commands, key=[*declared_commands()].index)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        if args[0] in self.commands:  # also when the shell completes what follows
            self.commands[args[0]] = _commands(args[0]).commands[args[0]]
        return super().resolve_command(ctx, args)


@cache
def _commands(wanted: str | None) -> Any:
    """The commands as Typer runs them; only the one that is wanted has options."""
    return get_command(build_app(wanted, listed=True))


@cache
def build_app(wanted: str | None = None, *, listed: bool = False) -> typer.Typer:
    """The application with all commands.

    Args:
        wanted: if there is a command of this name, the application has no other one: it starts
            sooner, because the options of a command take time to collect.
        listed: the others have no options either, and their modules are not imported.
    """
    app = typer.Typer(
        name="palmbots",
        cls=_Group,
        help="Simulate two mobile robots that carry an object between two tilting palms.",
        epilog="Shell completion: palmbots --install-completion",
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(invoke_without_command=True)(_root)
    if wanted is not None and is_command(wanted):
        _add(app, wanted)
        return app
    for name, one in declared_commands().items():
        if listed:
            app.command(name, help=one.summary)(_root)
        else:
            _add(app, name)
    return app


def _add(app: typer.Typer, name: str) -> None:
    """Add a command, or a group of commands."""
    found = commands_of(name)
    if found[0].name != name:
        help = found[0].summary
        group = typer.Typer(help=help, epilog=f"Example: {found[0].declaration.example}")
        app.add_typer(group, name=name)
        app = group
    for one in found:
        function = typer_function(one)
        last = one.name.rpartition(" ")[2]
        app.command(last, cls=_Command, epilog=f"Example: {one.declaration.example}")(function)


def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        from palmbots._version import __version__

        print(f"palmbots {__version__}")
        raise typer.Exit()
    if context.invoked_subcommand is None:
        print(context.get_help())


def _usage_message(error: Any) -> str:
    """One line about arguments that cannot be parsed."""
    context = getattr(error, "ctx", None)
    where = f"{context.command_path}: " if context is not None else ""
    see = f"; see {context.command_path} --help" if context is not None else ""
    fault = _number_fault(error)
    if fault is not None:
        return f"{fault}{see}"
    return f"{where}{error.format_message().rstrip('.')}{see}"


def _with_option_name(message: str, arguments: list[str]) -> str:
    """The message with the option that was given, or should have been, in place of the Python
    argument it stands for: ``--slope-deg: value is …``, not ``slope_deg: value is …``."""
    command = _commands(arguments[0]).commands.get(arguments[0]) if arguments else None
    name, _, rest = message.partition(":")
    for parameter in getattr(command, "params", ()):
        given = any(word.split("=")[0] in parameter.opts for word in arguments)
        is_meant = given or rest.startswith(" none given")
        if parameter.name == name and parameter.opts[0].startswith("--") and is_meant:
            return f"{parameter.opts[0]}:{rest}"
    return message


def _number_fault(error: Any) -> str | None:
    """ "KEY: value is V; allowed: …" for a text that is no number; None: it is another fault."""
    from palmbots._util.arguments import show

    faults = getattr(error.__cause__, "errors", list)()
    parameter = getattr(error, "param", None)
    if not faults or parameter is None or faults[0]["type"] not in _NUMBERS:
        return None
    allowed = _NUMBERS[faults[0]["type"]]
    return f"{parameter.opts[0]}: value is {show(faults[0]['input'])}; allowed: {allowed}"


def _unwritable(error: OSError) -> int:
    what = error.filename or "the output cannot be written"  # stdout has no name
    return _refuse(f"{what}: {error.strerror or error}")


def _refuse(message: str) -> int:
    text = one_line(message)
    say(text if text.startswith("palmbots") else f"palmbots: {text}")
    return BAD_INPUT
