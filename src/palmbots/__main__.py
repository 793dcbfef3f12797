# SPDX-License-Identifier: Apache-2.0
"""`python -m palmbots` is the command `palmbots`.

This module imports almost nothing, so that Ctrl-C while the packages are imported is caught too.
"""

import signal
import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line and exit with its status."""
    from palmbots.cli import INTERRUPTION_LINE
    from palmbots.cli._streams import open_closed_streams, say

    open_closed_streams()
    try:
        from palmbots.cli.main import main as run_command

        run_command()
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        say(INTERRUPTION_LINE)
        sys.exit(130)


if __name__ == "__main__":
    main()
