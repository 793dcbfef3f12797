# SPDX-License-Identifier: Apache-2.0
"""Check the links inside a folder of HTML files: every target and every anchor exists.

    .venv/bin/python scripts/check_links.py [FOLDER]        build/site by default

Exit status 1: a link has no target; one line for each. Links to other sites are not followed (the
public CI file does that), and neither is a link to the page while only the book is built.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "build" / "site"
_LINKS = {"a": "href", "link": "href", "img": "src", "script": "src", "source": "srcset"}


class _Anchors(HTMLParser):
    """The links of a file, and the names that others can link to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.names: set[str] = set()
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        link = found.get(_LINKS.get(tag, ""))
        if link:
            self.links.append(link)
        self.names |= {name for name in (found.get("id"), found.get("name")) if name}


def broken_links(folder: Path) -> list[str]:
    """One line for each link of the HTML files in a folder that has no target there."""
    folder = folder.resolve()
    files = {path: _Anchors(path) for path in sorted(folder.rglob("*.html"))}
    page = folder / "index.html"
    found = []
    for path, anchors in files.items():
        for link in anchors.links:
            target, fragment = _target(path, link)
            if target is None or (target == page and page not in files):
                continue
            if not target.is_relative_to(folder):
                fault = "leaves the folder"
            elif not target.is_file():
                fault = "has no target"
            elif fragment and target in files and fragment not in files[target].names:
                fault = "has no such anchor"
            else:
                continue
            found.append(f"{path.relative_to(folder)}: {link}: {fault}")
    return found


def _target(path: Path, link: str) -> tuple[Path | None, str]:
    """The file and the anchor that a link of a file names; no file for another site."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None, ""
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    return target / "index.html" if target.is_dir() else target, unquote(parts.fragment)


def main() -> int:
    """Print what is wrong."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else SITE
    found = broken_links(folder)
    for line in found:
        print(line)
    count = len(list(folder.rglob("*.html")))
    print(f"{folder}: {count} files, {len(found)} broken links")
    return 1 if found or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
