# SPDX-License-Identifier: Apache-2.0
"""``pair.toml`` and the key: what is written is read, and every fault is one line."""

import stat
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.pair.pair_file import init_pair, load_pair, pair_keys
from palmbots.pair.stored_state import read_state


def test_a_new_pair_has_a_protected_random_key_and_counters_at_zero(tmp_path: Path) -> None:
    files = init_pair(tmp_path / "pair.toml", scene="rough", controller="silent")
    assert [file.name for file in files] == [
        "pair.toml", "pair.key", "left.json", "right.json", "station.json"
    ]  # fmt: skip
    pair = load_pair(files[0])
    assert (pair.scene(), pair.settings.pair.controller) == ("rough", "silent")
    assert stat.S_IMODE(files[1].stat().st_mode) == 0o600
    for side in ("left", "right"):
        assert read_state(pair.state_file(side)).epoch == 0
    other = load_pair(init_pair(tmp_path / "other.toml")[0])
    assert len(pair.key) == 16
    assert pair.key != other.key


def test_the_file_explains_every_key(tmp_path: Path) -> None:
    text = init_pair(tmp_path / "pair.toml")[0].read_text(encoding="utf-8")
    for key in pair_keys():
        assert key.meaning
        assert f"\n{key.name.split('.')[1]} = " in text or f"\n# {key.name.split('.')[1]} =" in text


def test_a_pair_that_cannot_be_written_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise pb.PalmbotsError("left.json: cannot be written: No space left on device")

    monkeypatch.setattr("palmbots.pair.pair_file.write_state", full)
    with pytest.raises(pb.PalmbotsError, match="No space left"):
        init_pair(tmp_path / "pair.toml")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("why", [pb.PalmbotsError("full"), KeyboardInterrupt()])
def test_folders_that_were_made_for_a_pair_go_with_it(
    why: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise why

    monkeypatch.setattr("palmbots.pair.pair_file.write_state", fails)
    with pytest.raises(type(why)):
        init_pair(tmp_path / "pair.toml")
    assert [*tmp_path.iterdir()] == []
    (tmp_path / "old").mkdir()
    with pytest.raises(type(why)):
        init_pair(tmp_path / "old" / "pair.toml")
    assert [*tmp_path.rglob("*")] == [tmp_path / "old"]
