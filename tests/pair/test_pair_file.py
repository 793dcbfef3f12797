# SPDX-License-Identifier: Apache-2.0
"""``pair.toml`` and the key: what is written is read; changes keep comments and other values."""

import stat
import tomllib
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from pair_programs import new_pair
from palmbots.drivers.driver_registry import DRIVERS
from palmbots.pair import pair_edit
from palmbots.pair.live_ends import open_pair_driver
from palmbots.pair.pair_edit import write_hardware
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.pair_keys import pair_keys
from palmbots.pair.stored_state import read_state

ZONES = [
    {"sign": "-", "from_m": -0.07, "to_m": -0.004},
    {"sign": "0", "from_m": -0.004, "to_m": 0.006},
]


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


def test_a_limit_of_just_the_fastest_speed_suffices(tmp_path: Path) -> None:
    pair = load_pair(new_pair(tmp_path, driver__kind="dry-run", limits__max_speed_m_s=0.09))
    open_pair_driver(pair, "left", pb.load_scene("paper"), epoch=1).close()


def test_kinds_of_the_package_can_be_imported() -> None:
    assert set(DRIVERS.names()) == {"simulated", "serial", "dry-run", "ros2"}
    assert all(callable(DRIVERS.get(name)) for name in DRIVERS.names())


# --- changes of the file ---


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
