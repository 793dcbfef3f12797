# SPDX-License-Identifier: Apache-2.0
"""Builds the software paper as PDF, with pandoc and Typst, and counts its words."""

import re
import sys
import tempfile
from pathlib import Path

import pypandoc
import typst

HERE = Path(__file__).parent
MOST_WORDS = 1000
"""The limit of the Journal of Open Source Software."""


def words(text: str) -> int:
    """The words of the paper, without its header and references."""
    body = text.split("---", 2)[2].split("# References")[0]
    return len(re.findall(r"\S+", body))


def main(out: Path) -> None:
    """Write the PDF."""
    text = (HERE / "paper.md").read_text(encoding="utf-8")
    count = words(text)
    if count > MOST_WORDS:
        sys.exit(f"paper.md: {count} words; allowed: at most {MOST_WORDS}")
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "paper.typ"
        options = [
            "--standalone",
            "--citeproc",
            f"--bibliography={HERE / 'paper.bib'}",
            "--variable=mainfont:Libertinus Serif",
            "--variable=papersize:a4",
        ]
        pypandoc.convert_text(
            text.replace("bibliography: paper.bib\n", ""),
            "typst",
            "markdown",
            outputfile=str(source),
            extra_args=[
                *options,
                "--variable=mainfont:Libertinus Serif",
                "--variable=papersize:a4",
            ],
        )
        typst.compile(str(source), output=str(out))
    print(f"{out}: {count} words")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build/paper.pdf"))
