# SPDX-License-Identifier: Apache-2.0
"""Offers: a registry has entries of rooms that are not imported until they are used."""

import subprocess
import sys

import pytest

import palmbots as pb
from palmbots._util.named_registry import Registry


def test_offered_entries_follow_those_of_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(pb._OFFERS, "shape", {"later": "math:pi"})
    registry: Registry[object] = Registry("shape", {"first": "math:e"})
    assert registry.names() == ("first", "later")
    assert registry.get("later") == 3.141592653589793
    assert Registry("other shape").names() == ()


def test_offered_module_is_imported_when_the_registry_is_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(pb._OFFERS, "sound", {"many": "this_module_does_not_exist"})
    registry: Registry[object] = Registry("sound")
    registry.register("mine", 5)
    with pytest.raises(ModuleNotFoundError, match="this_module_does_not_exist"):
        registry.names()


def test_names_are_known_without_importing_higher_rooms() -> None:
    code = (
        "import sys\n"
        "from palmbots.control.registry import reference_names, resolve\n"
        "from palmbots.simulation import world_names\n"
        "assert set(reference_names()) >= {'optimal', 'optimal-stopping', 'kalman', 'exact-p'}\n"
        "assert world_names() == ('quasistatic', 'mujoco')\n"
        "rooms = {name.split('.')[1] for name in sys.modules if name.startswith('palmbots.')}\n"
        "assert not rooms & {'optimum', 'derivation', 'mujoco', 'viz', 'cli'}, rooms\n"
        "assert resolve('optimal').is_reference\n"
        "assert 'palmbots.optimum' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
