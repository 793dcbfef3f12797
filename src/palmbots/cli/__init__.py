# SPDX-License-Identifier: Apache-2.0
"""The command line: `palmbots carry`, `contact-modes`, `analyze` and the other commands."""

INTERRUPTION_LINE = "palmbots: interrupted (no partial files were written)"
"""What a command prints on stderr after Ctrl-C."""
