# SPDX-License-Identifier: Apache-2.0
"""Builds the software paper as PDF, with pandoc and Typst, and counts its words."""

import re
import sys
import tempfile
from pathlib import Path

import pypandoc
import typst

HERE = Path(__file__).parent
WORDS = range(750, 1751)
"""The limits of the Journal of Open Source Software (docs/paper.md of openjournals/joss)."""
SECTIONS = [
    "Summary", "Statement of need", "State of the field", "Software design",
    "Research impact statement", "AI usage disclosure", "Acknowledgements", "References",
]  # fmt: skip
"""The sections that it demands, in their order."""


def words(text: str) -> int:
    """The words of the paper, without its header and references."""
    body = text.split("---", 2)[2].split("# References")[0]
    return len(re.findall(r"\S+", body))


def main(out: Path) -> None:
    """Write the PDF."""
    text = (HERE / "paper.md").read_text(encoding="utf-8")
    count = words(text)
    if count not in WORDS:
        sys.exit(f"paper.md: {count} words; allowed: {WORDS[0]} to {WORDS[-1]}")
    found = re.findall(r"^# (.+)$", text, re.MULTILINE)
    if found != SECTIONS:
        sys.exit(f"paper.md: sections {', '.join(found)}; allowed: {', '.join(SECTIONS)}")
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
            extra_args=options,
        )
        typst.compile(str(source), output=str(out))
    print(f"{out}: {count} words")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build/paper.pdf"))
