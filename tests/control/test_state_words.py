# SPDX-License-Identifier: Apache-2.0
"""Every state of a table-driven controller of the core has a meaning in words."""

import re
from pathlib import Path

import pytest

from palmbots.control.state_words import STATE_MEANINGS

CORE = Path(__file__).parent.parent.parent / "include" / "palmbots" / "control"


@pytest.mark.parametrize("controller", STATE_MEANINGS)
def test_each_state_of_the_core_has_a_meaning(controller: str) -> None:
    text = (CORE / f"{controller.replace('-', '_')}.hpp").read_text("utf-8")
    body = re.search(r"enum class State : std::uint8_t \{(.*?)\};", text, re.DOTALL)
    assert body is not None
    names = re.findall(r"^\s*(\w+),", re.sub(r"//.*", "", body[1]), re.MULTILINE)
    assert list(STATE_MEANINGS[controller]) == names
    assert all(STATE_MEANINGS[controller].values())
