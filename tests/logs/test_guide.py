# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/guide/logs.md run as they stand there."""

import re
from pathlib import Path


def test_examples_of_the_page_run(tmp_path, monkeypatch, capsys):
    page = Path(__file__).parents[2] / "docs" / "guide" / "logs.md"
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) == 3
    monkeypatch.chdir(tmp_path)
    exec("\n".join(blocks), {})
    assert capsys.readouterr().out.startswith("delivered ")
