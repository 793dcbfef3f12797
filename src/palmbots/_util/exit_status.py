# SPDX-License-Identifier: Apache-2.0
"""The exit statuses of all commands, and of the programs of a pair."""

DONE = 0
FAILED = 1
"""The command worked, and its answer is no: the object was dropped, a proof does not hold."""
BAD_INPUT = 2
INTERRUPTED = 130
"""By Ctrl-C."""
CLOSED_PIPE = 141
"""The pipe on stdout is closed: what a shell reports of programs that SIGPIPE ends."""
