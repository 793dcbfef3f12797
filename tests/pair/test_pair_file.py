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


@pytest.mark.parametrize("name", ["pair.toml", "pair.key", "pair-state/left.json"])
def test_existing_files_are_never_overwritten(name: str, tmp_path: Path) -> None:
    taken = tmp_path / name
    taken.parent.mkdir(exist_ok=True)
    taken.write_text("mine")
    with pytest.raises(pb.PalmbotsError, match=r"exists already and is never overwritten$"):
        init_pair(tmp_path / "pair.toml")
    assert [*tmp_path.rglob("*.*")] == [taken]
    assert taken.read_text() == "mine"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("number = ", "numbr = 1 #", "did you mean pair.number? allowed in pair: number, key_file"),
        ('kind = "simulated"', "kind = 5", "driver.kind: 5 is not a string; allowed: a string"),
        ('kind = "simulated"', "options = 5", "driver.options: 5 is not a table; allowed: a table"),
        ("baud = 115200", "baud = 1", "driver.baud: 1 is too small; allowed: a whole number, from"),
        (
            'after_reboot = "disarm"',
            'after_reboot = "mind"',
            'limits.after_reboot: "mind" is not known; allowed: ',
        ),
        ("[driver]", "[driver", "not valid TOML: "),
        ('"pair.key"', '"lost.key"', "lost.key: cannot be read: No such file or directory"),
        ('"pair.key"', '"a\\u0000b"', "cannot be read: embedded null byte"),
        ("number = ", "number = " + "9" * 5000 + " #", "not valid TOML: "),
        ("number = ", "number = " + "[" * 100_000, "not valid TOML: lists nested too deeply"),
        ('"pair.key"', "5", "pair.key_file: 5 is not a string; allowed: a string"),
    ],
)
def test_faults_of_the_file_are_one_line(old: str, new: str, message: str, tmp_path: Path) -> None:
    file = init_pair(tmp_path / "pair.toml")[0]
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(pb.PalmbotsError) as error:
        load_pair(file)
    assert message in str(error.value)
    assert str(tmp_path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("key", ["", "00" * 15, "00" * 17, "no key", "\xff"])
def test_a_file_without_a_key_is_refused(key: str, tmp_path: Path) -> None:
    file, key_file, *_ = init_pair(tmp_path / "pair.toml")
    key_file.write_text(key, encoding="latin-1")
    with pytest.raises(pb.PalmbotsError, match=r"is no key; allowed: 32 hexadecimal digits$"):
        load_pair(file)


def test_a_key_that_others_can_read_is_refused(tmp_path: Path) -> None:
    file, key_file, *_ = init_pair(tmp_path / "pair.toml")
    key_file.chmod(0o640)
    with pytest.raises(pb.PalmbotsError, match=r"others can read the key \(mode 640\); run: chmod"):
        load_pair(file)


def test_a_pair_that_cannot_be_written_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise pb.PalmbotsError("left.json: cannot be written: No space left on device")

    monkeypatch.setattr("palmbots.pair.pair_file.write_state", full)
    with pytest.raises(pb.PalmbotsError, match="No space left"):
        init_pair(tmp_path / "pair.toml")
    assert [*tmp_path.iterdir()] == []


def test_a_missing_folder_is_refused_and_not_made(tmp_path: Path) -> None:
    """It may be a misspelt name."""
    with pytest.raises(
        pb.PalmbotsError, match=r"/new/pair\.toml: cannot be written: .*/new does not"
    ):
        init_pair(tmp_path / "new" / "pair.toml")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (b"\x7fELF\x02\x01\x01\x00", "is not a text file; allowed: a pair file in TOML"),
        ("\u2013 {".encode("utf-16"), "is not a text file; "),
        ("[pair]\nscene = 'm\u00e4'".encode("latin-1"), "line 2 is not UTF-8 (byte 0xe4); "),
    ],
)
def test_a_file_that_is_no_text_is_called_so(data: bytes, line: str, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_bytes(data)
    with pytest.raises(pb.PalmbotsError) as error:
        load_pair(file)
    assert str(error.value).startswith(f"{file}: {line}")


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
