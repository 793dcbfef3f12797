# SPDX-License-Identifier: Apache-2.0
"""Changes of pair.toml: comments and other values stay, and a failure changes nothing."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.pair.pair_edit import write_hardware
from palmbots.pair.pair_file import init_pair, load_pair

ZONES = [
    {"sign": "-", "from_m": -0.07, "to_m": -0.004},
    {"sign": "0", "from_m": -0.004, "to_m": 0.006},
]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = init_pair(tmp_path / "pair.toml")[0]
    path.write_text(path.read_text().replace("trim = 0.0", "trim = 0.0  # by eye"))
    return path


def test_only_the_keys_of_this_side_change(file: Path) -> None:
    before = file.read_text()
    backup = write_hardware(file, "left", {"trim": 0.0123, "switches": ZONES})
    after = file.read_text()
    assert backup.read_text() == before
    lines = iter(after.splitlines())
    assert all(line in lines for line in before.splitlines())  # with comments, in their order
    table, old = tomllib.loads(after), tomllib.loads(before)
    assert table["hardware"].pop("left") == {"trim": 0.0123, "switches": ZONES}
    assert table == old
    pair = load_pair(file)
    assert pair.settings.hardware.of("left").trim == 0.0123
    assert pair.settings.hardware.of("right").trim == 0.0


def test_a_second_calibration_replaces_the_first_and_keeps_both_backups(file: Path) -> None:
    first = write_hardware(file, "left", {"trim": 0.01, "wheel_scale": 1.1})
    write_hardware(file, "right", {"trim": 0.5 / 10})
    third = write_hardware(file, "left", {"trim": 0.02})
    hardware = load_pair(file).settings.hardware
    assert (hardware.of("left").trim, hardware.of("left").wheel_scale) == (0.02, 1.1)
    assert hardware.of("right").trim == 0.05
    assert first != third
    assert len([*file.parent.glob("pair.toml.before*")]) == 3


def test_a_full_disk_changes_nothing(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import palmbots.pair.pair_edit as pair_edit

    before = file.read_text()
    write = pair_edit.write_whole

    def full(path: Path, data: Any, *, new: bool = False) -> None:
        if not new:
            raise pb.PalmbotsError(f"{path}: cannot be written: No space left on device")
        write(path, data, new=new)

    monkeypatch.setattr(pair_edit, "write_whole", full)
    with pytest.raises(pb.PalmbotsError, match="No space left"):
        write_hardware(file, "left", {"trim": 0.01})
    assert file.read_text() == before
