# SPDX-License-Identifier: Apache-2.0
"""Serve build/site until Ctrl-C, for this machine or for others in its network."""

import argparse
import contextlib
import functools
import socket
import sys
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

SITE = Path(__file__).parent.parent / "build" / "site"


class Handler(SimpleHTTPRequestHandler):
    """Serves files, with the types that a browser demands of modules."""

    extensions_map = {  # noqa: RUF012  # as in the base class
        **SimpleHTTPRequestHandler.extensions_map,
        ".js": "text/javascript",
        ".wasm": "application/wasm",
    }

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""


def server(folder: Path = SITE, port: int = 0, host: str = "127.0.0.1") -> ThreadingHTTPServer:
    """A server of a folder at an address of this machine; port 0: any that is free."""
    return ThreadingHTTPServer((host, port), functools.partial(Handler, directory=folder))


def own_address() -> str:
    """The address under which other machines in the network reach this one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing; chooses the outgoing interface
        except OSError:  # no network
            return "127.0.0.1"
        return probe.getsockname()[0]


def parse(words: list[str] | None = None) -> argparse.Namespace:
    """The options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--host", default="127.0.0.1",
        help="address to serve at; 0.0.0.0: every machine in the network can open the page "
        "(default: %(default)s, this machine only)",
    )  # fmt: skip
    parser.add_argument("--port", type=int, default=8000, help="default: %(default)s; 0: any")
    return parser.parse_args(words)


def main() -> int:
    """Serve the page."""
    chosen = parse()
    try:
        serving = server(port=chosen.port, host=chosen.host)
    except (OSError, OverflowError) as error:
        print(f"cannot serve at {chosen.host}:{chosen.port}: {error}", file=sys.stderr)
        return 2
    with serving:
        host = own_address() if chosen.host in ("", "0.0.0.0") else chosen.host
        print(f"http://{host}:{serving.server_port}/", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            serving.serve_forever()
    return 0


if __name__ == "__main__":
    sys.exit(main())
