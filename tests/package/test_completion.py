# SPDX-License-Identifier: Apache-2.0
"""Editors and notebooks complete the public names, which are imported on first use."""

from pathlib import Path

import pytest

import palmbots as pb

jedi = pytest.importorskip("jedi")


def test_an_editor_completes_public_names(tmp_path: Path) -> None:
    """From the source alone. The import hook of an editable installation hides it from jedi, so the
    package has another name here."""
    (tmp_path / "pbots").symlink_to(Path(pb.__file__).parent)
    project = jedi.Project(tmp_path)
    for text, names in (
        ("import pbots\npbots.", dir(pb)),
        ("import pbots.viz as v\nv.", dir(pb.viz)),
    ):
        found = {one.name for one in jedi.Script(text, project=project).complete()}
        assert found >= {name for name in names if not name.startswith("__")}


def test_a_notebook_completes_public_names() -> None:
    found = {one.name for one in jedi.Interpreter("pb.", [{"pb": pb}]).complete()}
    assert found >= {*dir(pb)} - {"__version__"}
