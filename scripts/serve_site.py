# SPDX-License-Identifier: Apache-2.0
"""Serve build/site on this machine until Ctrl-C.

.venv/bin/python scripts/serve_site.py [PORT]
"""

import contextlib
import functools
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


def server(folder: Path = SITE, port: int = 0) -> ThreadingHTTPServer:
    """A server of a folder on the loopback interface; port 0: any that is free."""
    return ThreadingHTTPServer(("127.0.0.1", port), functools.partial(Handler, directory=folder))


def main() -> None:
    """Serve the page."""
    with server(port=int(sys.argv[1]) if len(sys.argv) > 1 else 8000) as serving:
        print(f"http://127.0.0.1:{serving.server_port}/")
        with contextlib.suppress(KeyboardInterrupt):
            serving.serve_forever()


if __name__ == "__main__":
    main()
