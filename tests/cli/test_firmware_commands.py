# SPDX-License-Identifier: Apache-2.0
"""`palmbots firmware` and `palmbots flash`: images of a pair, and what is refused."""

import json
import random
import resource
import signal
import stat
import zlib
from importlib import resources
from pathlib import Path

import pytest
from intelhex import IntelHex

import palmbots as pb
from commands import Run, assert_refused, unwrapped
from palmbots.boards.flashing import flash
from palmbots.boards.images import image_with
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.stored_state import read_state

PAGE = 0xF000
PAGE_SIZE = 208


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    return init_pair(tmp_path / "pair.toml")[0]


def test_images_hold_what_the_pair_says(pair: Path, tmp_path: Path, here: Run) -> None:
    done = here("firmware", str(pair), "--out", str(tmp_path / "images"), "--json")
    assert done.returncode == 0, done.stderr
    files = [Path(name) for name in json.loads(done.stdout)["files"]]
    assert [file.name for file in files] == ["left.hex", "right.hex", "dongle.hex"]
    key, number = load_pair(pair).key, load_pair(pair).settings.pair.number
    for role, file in enumerate(files):
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        image = IntelHex(str(file))
        page = image.tobinstr(start=PAGE, size=PAGE_SIZE)
        assert int.from_bytes(page[:4], "little") == 0x42504D42
        assert int.from_bytes(page[-4:], "little") == zlib.crc32(page[:-4])
        assert page[80] == role
        if role < 2:
            assert page[8:24] == key
            assert int.from_bytes(page[6:8], "little") == number
            assert int.from_bytes(page[24:28], "little") == 1
        else:
            assert key not in image.tobinstr()
        # The vector table: the stack lies in the first 8 kB of RAM, and the program in flash.
        stack, start = (int.from_bytes(image.tobinstr(start=i, size=4), "little") for i in (0, 4))
        assert 0x20000000 < stack <= 0x20002000
        assert 0x100 < start < PAGE


def test_a_robot_that_stands_aside_has_no_image(tmp_path: Path, here: Run) -> None:
    arm: dict[str, object] = {"hardware.arm_floor_deg": 50.0, "hardware.arm_top_deg": 150.0}
    pair = init_pair(tmp_path / "pair.toml", scene="lone", values=arm)[0]
    done = here("firmware", str(pair), "--out", str(tmp_path / "images"), "--json")
    assert done.returncode == 0, done.stderr
    files = [Path(name).name for name in json.loads(done.stdout)["files"]]
    assert files == ["right.hex", "dongle.hex"]


def test_a_pair_file_that_says_nothing_about_the_robots_gives_one_line(
    pair: Path, tmp_path: Path, here: Run
) -> None:
    done = here("firmware", str(pair), "--out", str(tmp_path / "images"))
    line = f"palmbots: warning: {pair}: all keys of [hardware] have their defaults; "
    assert done.returncode == 0
    printed = unwrapped(done.stderr)
    assert printed.startswith(line) and printed.count("\n") == 1
    text = pair.read_text()
    assert "wheel_radius_m = 0.04" in text
    pair.write_text(text.replace("wheel_radius_m = 0.04", "wheel_radius_m = 0.033"))
    assert here("firmware", str(pair), "--out", str(tmp_path / "images")).stderr == ""


def test_no_two_images_share_an_epoch(pair: Path, tmp_path: Path, here: Run) -> None:
    spans = []
    for _ in range(2):
        assert here("firmware", str(pair), "--out", str(tmp_path / "images")).returncode == 0
        page = IntelHex(str(tmp_path / "images" / "left.hex")).tobinstr(start=PAGE, size=PAGE_SIZE)
        spans.append(tuple(int.from_bytes(page[i : i + 4], "little") for i in (24, 28)))
    (first, last), (next_first, _) = spans
    assert first == 1
    assert next_first == last + 1
    assert read_state(load_pair(pair).state_file("left")).epoch == 2 * last


@pytest.fixture
def image(pair: Path, tmp_path: Path, here: Run) -> Path:
    assert here("firmware", str(pair), "--out", str(tmp_path / "images")).returncode == 0
    return tmp_path / "images" / "left.hex"


def drive(folder: Path) -> Path:
    folder.mkdir()
    (folder / "MICROBIT.HTM").write_text("")
    return folder


def test_an_image_is_flashed_once(image: Path, tmp_path: Path, here: Run) -> None:
    target = drive(tmp_path / "MICROBIT")
    done = here("flash", str(image), "--drive", str(target), "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["files"] == [str(target / "left.hex")]
    assert (target / "left.hex").read_text() == image.read_text()
    done = here("flash", str(image), "--drive", str(target))
    assert_refused(done, "has been flashed already")
    copy = tmp_path / "copy.hex"
    copy.write_text(image.read_text())
    assert_refused(here("flash", str(copy), "--drive", str(target)), "itself or a copy of it")
    assert not (target / "copy.hex").exists()
    assert here("flash", str(image), "--drive", str(target), "--again").returncode == 0
    dongle = image.with_name("dongle.hex")  # it counts no boots
    for _ in range(2):
        assert here("flash", str(dongle), "--drive", str(target)).returncode == 0


def test_what_is_no_board_is_refused(image: Path, tmp_path: Path, here: Run) -> None:
    done = here("flash", str(image), "--drive", str(tmp_path))
    assert_refused(done, "is no drive of a board")


def test_an_image_without_settings_is_refused(image: Path, tmp_path: Path, here: Run) -> None:
    target = drive(tmp_path / "MICROBIT")
    whole = image.read_text().splitlines(keepends=True)
    ready_made = resources.files("palmbots.boards") / "data" / "robot.hex"
    cases = {
        "empty.hex": "",
        "cut.hex": "".join(whole[:-9]),
        "endless.hex": "".join(whole[:-1]),
        "ready-made.hex": ready_made.read_text("ascii"),
    }
    for name, text in cases.items():
        file = tmp_path / name
        file.write_text(text)
        done = here("flash", str(file), "--drive", str(target))
        assert_refused(done, f"{name}: ")
        assert list(target.iterdir()) == [target / "MICROBIT.HTM"]
        assert not file.with_name(f"{name}.flashed").exists()


@pytest.mark.slow
def test_a_copy_that_fails_leaves_no_part(image: Path, tmp_path: Path) -> None:
    """A limit on the size of files takes the place of a drive that is full."""
    target = drive(tmp_path / "MICROBIT")
    limit = image.stat().st_size // 2
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limits[1]))
    try:
        with pytest.raises(pb.PalmbotsError, match="too large; connect the board anew, and flash"):
            flash(image, target)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, before)
    assert not (target / image.name).exists()


def test_no_damaged_image_is_flashed(image: Path, tmp_path: Path) -> None:
    """Lines that are missing, swapped or repeated, and settings forged with a right check."""
    target = drive(tmp_path / "MICROBIT")
    lines = image.read_text().splitlines(keepends=True)
    chance = random.Random(5)
    texts = []
    for _ in range(10):
        at = chance.randrange(1, len(lines) - 2)
        texts.append([*lines[:at], *lines[at + 1 :]])
        texts.append([*lines[:at], lines[at + 1], lines[at], *lines[at + 2 :]])
        texts.append([*lines[:at], lines[at], *lines[at:]])
    file = tmp_path / "mutant.hex"
    for text in texts:
        file.write_text("".join(text))
        with pytest.raises(pb.PalmbotsError, match=r"is damaged|is no image|has no settings"):
            flash(file, target)
    content = IntelHex(str(image))
    page = content.tobinstr(start=PAGE, size=0x1000)
    forged = {80: 2, 82: 255, 83: 100, 84: 2, 92: 2, 93: 0, 98: 7}
    changes = [(at, bytes([value])) for at, value in forged.items()]
    # No period, no epoch, watchdog after 10.000001 s.
    changes += [(at, value.to_bytes(4, "little")) for at, value in
                ((36, 0), (28, 0), (40, 10_000_001))]  # fmt: skip
    # Palm and wheels without a slew; pulses of the palm and of wheels that no servo gets.
    for value, *places in ((0, 94, 96), (499, 108, 110, 112, 134), (2501, 108, 110, 112, 134)):
        changes += [(at, value.to_bytes(2, "little")) for at in places]
    for at, value in changes:
        body = page[:at] + value + page[at + len(value) : 196]
        check = zlib.crc32(body).to_bytes(4, "little")
        file.write_text(image_with("robot", body + check + page[200:]))
        with pytest.raises(pb.PalmbotsError, match=r"is damaged|has no settings that a board"):
            flash(file, target)
    assert list(target.iterdir()) == [target / "MICROBIT.HTM"]


def test_a_failure_that_the_board_reports(image: Path, tmp_path: Path, here: Run) -> None:
    target = drive(tmp_path / "MICROBIT")
    (target / "FAIL.TXT").write_text("error: The hex file cannot be decoded.\n")
    done = here("flash", str(image), "--drive", str(target))
    assert_refused(done, "the board reports: error: The hex file cannot be decoded.")
