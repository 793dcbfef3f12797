# SPDX-License-Identifier: Apache-2.0
"""What the reasons of a drop mean, in words."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palmbots.simulation.outcome_counts import OutcomeCounts

TURNED = "the object turned by more than 60° on the palms"
"""What `tipping` means in MuJoCo."""
REASONS = {
    "off-palm": "a contact left the usable part of its palm at an end or a side",
    "sliding": "no squeeze force balances the object: it slides on both palms",
    "flush": "a palm and an edge of the object coincide",
    "tip": "the end of a palm is inside the object",
    "tipping": "the object tipped over a contact",
    "jammed": "no motion that the palms allow is in balance",
    "lifting": "the object lifted off a palm",
    "robot tipped": "a robot lost its balance under the load (palmbots load)",
}


def reason_text(reason: str, world: str) -> str:
    """The reason of a drop and what it means."""
    is_turned = reason == "tipping" and world == "mujoco"
    meaning = TURNED if is_turned else REASONS.get(reason, "")
    return f"{reason}: {meaning}".rstrip(": ")


def usual_reason(counts: "OutcomeCounts", world: str) -> str | None:
    """The most frequent reason of the drops, and what it means; None: nothing dropped."""
    return next((reason_text(reason, world) for reason in counts.reasons), None)
