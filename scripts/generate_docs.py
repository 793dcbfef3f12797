#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the generated parts of the docs from the code and from the results of the benchmarks.

Run it with the tree's own Python: .venv/bin/python scripts/generate_docs.py [--check]

A generated part stands on some page of the docs between two markers, `<!-- NAME -->` and
`<!-- end of NAME -->`. With --check nothing is written, and the exit status is 1 if a part is out
of date.
"""

import importlib
import pkgutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import docs_generators

ROOT = Path(__file__).resolve().parent.parent
GENERATORS = [
    importlib.import_module(f"{docs_generators.__name__}.{module.name}")
    for module in pkgutil.iter_modules(docs_generators.__path__)
]


def main() -> int:
    """Write or check all pages; return the exit status."""
    pages = {path: path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")}
    wanted = dict(pages)
    for generator in GENERATORS:
        for name, content in generator.blocks().items():
            start, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
            (page,) = (path for path, text in wanted.items() if start in text)
            before, _, rest = wanted[page].partition(start)
            wanted[page] = f"{before}{start}\n{content}\n{end}{rest.partition(end)[2]}"
    stale = [path for path, text in pages.items() if wanted[path] != text]
    for page in stale:
        if "--check" not in sys.argv:
            page.write_text(wanted[page], encoding="utf-8")
    news = "is out of date; run: make docs" if "--check" in sys.argv else "written"
    for page in stale:
        print(f"{page.relative_to(ROOT)}: {news}")
    return int("--check" in sys.argv and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
