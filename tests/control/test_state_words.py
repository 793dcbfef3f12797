# SPDX-License-Identifier: Apache-2.0
"""Every named state of a controller of the core has its own name and a meaning in words."""

import re
from pathlib import Path

import pytest

from palmbots.control.registry import resolve, shipped_names

CORE = Path(__file__).parent.parent.parent / "include" / "palmbots" / "control"


@pytest.mark.parametrize("controller", [name for name in shipped_names() if resolve(name).states])
def test_each_state_of_the_core_has_a_meaning(controller: str) -> None:
    text = (CORE / f"{controller.replace('-', '_')}.hpp").read_text("utf-8")
    body = re.search(r"enum class State : std::uint8_t \{(.*?)\};", text, re.DOTALL)
    assert body is not None
    names = re.findall(r"^\s*(\w+),", re.sub(r"//.*", "", body[1]), re.MULTILINE)
    assert list(resolve(controller).states) == names
    assert all(resolve(controller).states.values())
