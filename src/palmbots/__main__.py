# SPDX-License-Identifier: Apache-2.0
"""`python -m palmbots` is the command `palmbots`.

This module imports almost nothing, so that Ctrl-C while the packages are imported is heard, too.
There it ends the process at once: an exception that is raised while Python imports may be lost.
"""

import gc
import os
import signal
import sys
from typing import Any

_ALLOCATIONS_PER_COLLECTION = 50_000


def main() -> None:
    """Run the command line and exit with its status."""
    from palmbots._util.exit_status import INTERRUPTED
    from palmbots.cli._streams import open_closed_streams, say_interrupted

    open_closed_streams()
    # Imports make many objects and little garbage: rarer collections save a fifth of the start.
    gc.set_threshold(_ALLOCATIONS_PER_COLLECTION)
    # Pydantic would look for plugins in the metadata of every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    usual = signal.getsignal(signal.SIGINT)  # ignored, where a shell without job control says so

    def end(*_: Any) -> None:
        say_interrupted()
        os._exit(INTERRUPTED)

    if usual is signal.default_int_handler:
        signal.signal(signal.SIGINT, end)
    from palmbots.cli.main import main as run_command

    try:
        signal.signal(signal.SIGINT, usual)
        run_command()
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        say_interrupted()
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
