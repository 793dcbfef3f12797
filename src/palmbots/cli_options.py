"""What the commands of the command line share: exit statuses, options, a progress bar."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from palmbots.scene import Scene

__all__ = [
    "BAD_INPUT",
    "DONE",
    "FAILED",
    "ControllerOption",
    "JsonOption",
    "PrecisionOption",
    "SceneArgument",
    "SeedOption",
    "SetOption",
    "app",
    "path_given",
    "progress",
    "scene_of",
]

DONE, FAILED, BAD_INPUT = 0, 1, 2

# As a newcomer needs them; a command that is not here comes last.
_ORDER = (
    "carry", "modes", "analyze", "certify", "check", "design", "compare", "study", "rare", "speed",
    "validate", "export", "replay", "derive",
)  # fmt: skip


class _InOrder(TyperGroup):
    """The commands, the main one first, whichever module brought them."""

    def list_commands(self, ctx: Any) -> list[str]:
        return sorted(self.commands, key=lambda n: _ORDER.index(n) if n in _ORDER else len(_ORDER))


app = typer.Typer(
    name="palmbots",
    cls=_InOrder,
    help="Two robots, a flat tiltable palm each, carry one object together.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

SceneArgument = Annotated[
    str, typer.Argument(metavar="[SCENE]", help="A built-in scene or a TOML file.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a scene key; may be given often."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]
ControllerOption = Annotated[
    str, typer.Option("--controller", "-c", help="none, centralized, distributed or resilient.")
]
SeedOption = Annotated[int, typer.Option("--seed", help="Seed of all that is random.")]
PrecisionOption = Annotated[str, typer.Option("--precision", help="double or float.")]


def path_given(text: str) -> Path:
    """Where to write, as the parser of an option; an empty name would mean the working directory.

    An unset variable of a shell is the usual reason: ``--out "$DIR"``.
    """
    if not text:
        raise typer.BadParameter('value is ""; allowed: a name (. is the working directory)')
    return Path(text)


def scene_of(source: str, changes: list[str] | None) -> Scene:
    """The scene of a command, with what --set changes."""
    from palmbots.overrides import parse_overrides
    from palmbots.scene import load_scene

    return load_scene(source, parse_overrides(changes or []), called="--set")


@contextmanager
def progress(what: str, quiet: bool, simulated_s: float = 0.0) -> Iterator[Callable[[float], None]]:
    """A progress bar on stderr, where a person looks at it; gives a function to report to.

    `simulated_s`: about how long what is simulated lasts, to tell how much faster it goes.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda fraction: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=1.0)
        began = time.monotonic()

        def report(fraction: float) -> None:
            told = what
            if simulated_s > 0:
                factor = fraction * simulated_s / max(1e-3, time.monotonic() - began)
                told = f"{what}, {factor:.1f} × real time"
            bar.update(task, completed=fraction, description=told)

        yield report
