#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the generated parts of the docs from the code and from the results of the benchmarks.

Run it with the tree's own Python: .venv/bin/python scripts/generate_docs.py [--check]

A generated part stands between two markers, `<!-- NAME -->` and `<!-- end of NAME -->`. With
--check nothing is written, and the exit status is 1 if a part is out of date.
"""

import importlib
import pkgutil
import re
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
    stale = []
    for generator in GENERATORS:
        page = ROOT / generator.PAGE
        text = wanted = page.read_text(encoding="utf-8")
        for name, content in generator.blocks().items():
            block = f"<!-- {name} -->\n{content}\n<!-- end of {name} -->"
            pattern = rf"<!-- {re.escape(name)} -->.*?<!-- end of {re.escape(name)} -->"
            wanted, count = re.subn(pattern, lambda _, b=block: b, wanted, flags=re.DOTALL)
            assert count == 1, f"{generator.PAGE}: {count} places for {name}"
        if wanted != text:
            stale.append(generator.PAGE)
            if "--check" not in sys.argv:
                page.write_text(wanted, encoding="utf-8")
    for page in stale:
        print(f"{page}: {'is out of date; run: make docs' if '--check' in sys.argv else 'written'}")
    return int("--check" in sys.argv and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
