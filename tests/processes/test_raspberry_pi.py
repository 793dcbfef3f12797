# SPDX-License-Identifier: Apache-2.0
"""The example of a driver for a Raspberry Pi, with the mock pins of gpiozero."""

import importlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from cxx import ROOT
from distributions import installed_example
from pair_programs import children, new_pair, operator, running
from palmbots.drivers.driver import Drive, DriverSettings, RawCommand
from palmbots.drivers.hardware import HardwareParameters
from waiting import wait_until

PINS: dict[str, Any] = {"left": [17, 27], "right": [22, 23], "servo": 18,
        "switches": [5, 6, 12, 13, 16, 19, 20, 21, 26]}  # fmt: skip
ZONES: Any = [
    {"sign": sign, "from_m": -0.09 + 0.02 * i, "to_m": -0.07 + 0.02 * i}
    for i, sign in enumerate("----0++++")
]
HARDWARE = HardwareParameters(
    switches=ZONES,
    encoder_ticks_per_turn=0.0, right_reversed=True,
)  # fmt: skip


@pytest.fixture
def pins(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The pins; the driver's module can be imported."""
    gpiozero = pytest.importorskip("gpiozero")
    mock = importlib.import_module("gpiozero.pins.mock")
    factory = mock.MockFactory(pin_class=mock.MockPWMPin)
    monkeypatch.setattr(gpiozero.Device, "pin_factory", factory)
    monkeypatch.syspath_prepend(ROOT / "examples" / "raspberry_pi")
    yield factory
    factory.reset()


def driver(options: dict[str, Any]) -> Any:
    module = importlib.import_module("palmbots_raspberry_pi")
    return module.RaspberryPi(
        DriverSettings(
            side="left", leads=False, address="", period_s=0.01, watchdog_s=0.1,
            hardware=HARDWARE, options=options,
        )
    )  # fmt: skip


def test_switches_give_the_sign(pins: Any) -> None:
    made = driver(PINS)
    signs = []
    for pin in PINS["switches"]:
        assert made.read().has_contact is False
        pins.pin(pin).drive_low()
        seen = made.read()
        assert seen.has_contact
        assert math.isnan(seen.distance_m)
        signs.append(seen.sign)
        pins.pin(pin).drive_high()
    assert signs == [-1, -1, -1, -1, 0, 1, 1, 1, 1]
    made.close()


def test_motors_and_servo_get_power_and_pulses(pins: Any) -> None:
    made = driver(PINS)
    # Half and a quarter of 0.25 m/s with wheels of 4 cm; the right motor is wired the other way.
    made.write_raw(RawCommand((3.125, 1.5625), math.pi / 2))
    assert [pins.pin(n).state for n in (17, 27, 22, 23)] == pytest.approx([0.5, 0, 0, 0.25])
    assert pins.pin(18).state == pytest.approx(50 * 0.0015)
    made.write_raw(RawCommand((-99.0, 0.0)))
    assert [pins.pin(n).state for n in (17, 27, 22, 23)] == [0, 1, 0, 0]
    assert pins.pin(18).state == pytest.approx(50 * 0.0015)  # the palm keeps its angle
    made.write(Drive(0, 0, False, False, 0.0, 0.06))
    assert [pins.pin(n).state for n in (17, 27, 22, 23)] == [0, 0, 0, 0]
    made.write_raw(RawCommand((3.0, 3.0)))
    made.close()
    assert [pins.pin(n).state for n in (17, 27, 22, 23)] == [0, 0, 0, 0]


@pytest.mark.parametrize("name", PINS)
def test_a_missing_pin_is_named(name: str, pins: Any) -> None:
    options = {key: value for key, value in PINS.items() if key != name}
    with pytest.raises(pb.PalmbotsError, match=rf"^driver.options: {name} is missing$"):
        driver(options)


def test_too_few_switches_are_named(pins: Any) -> None:
    made = driver(PINS | {"switches": [5, 6]})
    with pytest.raises(pb.PalmbotsError, match=r"9 switches are listed; the driver reads 2$"):
        made.read()
    made.close()


def test_it_is_installed_and_runs_in_a_guard_process(tmp_path: Path) -> None:
    pytest.importorskip("gpiozero")
    found = installed_example("raspberry_pi", tmp_path / "site")
    found |= {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
    file = new_pair(
        tmp_path, pair__controller="silent", driver__kind="raspberry-pi", driver__options=PINS,
        hardware__switches=ZONES, hardware__encoder_ticks_per_turn=0.0,
    )  # fmt: skip
    robot = ["robot", "pair.toml", "--side", "left"]
    with (
        running(robot, folder=tmp_path, environment=found) as (process,),
        operator(file) as user,
    ):
        user.until(lambda: user.mode("left") == "disarmed")
        user.station.wish("arm")
        user.until(lambda: user.station.status["left"].fault == "contact")  # no switch is closed
        ((command, guard),) = children(process).items()
        assert "guard_process" in command
        assert process.poll() is None
        process.kill()
        wait_until(lambda: not Path(f"/proc/{guard}").exists())


def test_examples_have_at_most_60_lines() -> None:
    for name in ("zenoh_link/palmbots_zenoh.py", "raspberry_pi/palmbots_raspberry_pi.py"):
        assert len((ROOT / "examples" / name).read_text().splitlines()) <= 60
