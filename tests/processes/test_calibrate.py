# SPDX-License-Identifier: Apache-2.0
"""`palmbots calibrate` on a terminal of its own, with a workbench as another process."""

import contextlib
import os
import pty
import re
import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from json_output import read_json
from pair_programs import started
from palmbots.pair.pair_file import init_pair, load_pair

RATE = "4"
HIDDEN = {"wheel_scale": 1.04, "trim": 0.03, "servo_zero_deg": 92.0, "servo_scale": 1.05}


class Bench:
    """A workbench process. The test types what hands do, and reads what tape and protractor say."""

    def __init__(self, folder: Path) -> None:
        self.address = f"unix:{folder / 'bench'}"
        command = ["world", "paper", "--bench", "--serve"]
        command += [self.address, "--rate", RATE, "--set", "robot.noise_m_s=0.0"]
        for key, value in HIDDEN.items():
            command += ["--imperfect", f"left.{key}={value}"]
        self.process = started(command, folder, stderr=None)
        self.lines: list[str] = []
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line.strip())

    def type(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def close(self) -> None:
        self.type("quit")
        assert self.process.wait(30) == 0
        self._thread.join()
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            pipe.close()


@contextlib.contextmanager
def bench(folder: Path) -> Iterator[Bench]:
    made = Bench(folder)
    try:
        yield made
    finally:
        made.close()


class Terminal:
    """`palmbots calibrate` on a pseudo-terminal."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.near, far = pty.openpty()
        command = ["calibrate", "pair.toml", "--side", "left", "--rate", RATE, *options]
        self.process = started(command, folder, stdin=far, stderr=far, start_new_session=True)
        os.close(far)
        self.text = ""

    def read_until(self, pattern: str) -> str:
        """The text up to a pattern, or to the end of the program."""
        while not (found := re.search(pattern, self.text, re.DOTALL)):
            try:
                self.text += os.read(self.near, 65536).decode()
            except OSError:  # the program has ended
                return self.text
        taken, self.text = self.text[: found.end()], self.text[found.end() :]
        return taken

    def type(self, line: str) -> None:
        os.write(self.near, line.encode() + b"\n")

    def close(self) -> tuple[int, str]:
        out, _ = self.process.communicate(timeout=60)
        os.close(self.near)
        return self.process.returncode, out


PROMPT = r"Press Enter when that is done: |\[(?:mm|°)\] "


def newest(bench: Bench, count: int) -> str:
    """The newest measurement, once there are more than `count`."""
    until = time.monotonic() + 30
    while len(bench.lines) <= count:
        assert time.monotonic() < until, bench.lines
        time.sleep(0.01)
    return bench.lines[-1]


def measurements(bench: Bench) -> list[str]:
    return [line for line in bench.lines if "along" in line]


def moved(bench: Bench, used: int) -> int:
    """Wait until the bench has measured the robot after its move; returns how often it has."""
    until = time.monotonic() + 30
    while len(measurements(bench)) <= used:
        assert time.monotonic() < until, bench.lines
        time.sleep(0.01)
    return len(measurements(bench))


def person(terminal: Terminal, bench: Bench) -> None:
    """Answer until the program ends."""
    used = 0
    while True:
        seen = len(bench.lines)
        asked = terminal.read_until(PROMPT)
        if terminal.process.poll() is not None or not re.search(PROMPT, asked):
            return
        if asked.endswith("done: "):
            if "tape" in asked:
                bench.type("left home")
                newest(bench, seen)
            terminal.type("")
            continue
        if "mark to the left" not in asked or "halfway" in asked:  # the robot has moved since
            used = moved(bench, used)
        along, left, palm = re.findall(r"-?[\d.]+", measurements(bench)[-1])
        is_left, is_along = "to the left" in asked, "has it come" in asked
        terminal.type(left if is_left else along if is_along else palm)


def new_pair(folder: Path, address: str) -> Path:
    values = {
        "pair.scene": "scene.toml",
        "hardware.servo_rate_deg_s": 500.0,  # the test waits for the palm itself
    }
    return init_pair(folder / "pair.toml", address=address, values=values)[0]


def write_scene(folder: Path) -> None:
    import palmbots as pb

    (folder / "scene.toml").write_text(pb.load_scene("paper", {"robot.noise_m_s": 0.0}).to_toml())


def test_a_person_calibrates_wheels_and_palm(tmp_path: Path) -> None:
    write_scene(tmp_path)
    with bench(tmp_path) as workbench:
        file = new_pair(tmp_path, workbench.address)
        before = file.read_text()
        terminal = Terminal(tmp_path, "--only", "wheels,palm", "--json", "--length", "0.5")
        person(terminal, workbench)
        status, out = terminal.close()
    assert status == 0, terminal.text
    table = read_json("calibrate", out)
    assert set(table) >= {"side", "file", "backup", "hardware", "intervals", "warnings"}
    for key, value in HIDDEN.items():
        low, high = table["intervals"][key]
        assert low <= value <= high, (key, table["intervals"][key])
    assert load_pair(file).settings.hardware.of("left").trim == table["hardware"]["trim"]
    assert Path(tmp_path / table["backup"]).read_text() == before


def test_ctrl_c_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    write_scene(tmp_path)
    with bench(tmp_path) as workbench:
        file = new_pair(tmp_path, workbench.address)
        files = sorted(path.name for path in tmp_path.iterdir())
        before = file.read_text()
        terminal = Terminal(tmp_path, "--only", "palm")
        terminal.read_until("Press Enter when that is done: ")
        terminal.type("")
        terminal.read_until(r"\[°\] ")
        terminal.process.send_signal(signal.SIGINT)
        terminal.read_until("never")
        status, out = terminal.close()
    assert (status, out) == (130, "")
    assert "interrupted (no partial files were written)" in terminal.text
    assert file.read_text() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted({*files} - {"bench"})


def test_without_a_terminal_it_states_what_it_needs(tmp_path: Path) -> None:
    new_pair(tmp_path, "unix:none")
    command = ["calibrate", "pair.toml", "--side", "left"]
    for options in ([], ["--json"]):
        done = started([*command, *options], tmp_path, stdin=subprocess.DEVNULL)
        printed, errors = done.communicate(timeout=60)
        assert (done.returncode, printed) == (2, "")
        assert errors.startswith("palmbots: calibrate: needs a terminal, at which a person ")
        assert errors.count("\n") == 1
