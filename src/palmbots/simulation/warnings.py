# SPDX-License-Identifier: Apache-2.0
"""Warnings at the end of a carry, from what the core measured."""

from typing import Any

from palmbots._types import SIDES
from palmbots.control.registry import ControllerEntry
from palmbots.scene.scene import Scene

_PATIENCE_S = 2.0  # how long an answer may take, besides the delay of the radio


def warnings_after(measured: Any, scene: Scene, controller: ControllerEntry) -> tuple[str, ...]:
    """The warnings of a finished carry."""
    lines = _standing(measured) if controller.stops_in_silence else _waiting(measured, scene)
    lines += [
        f"limit cycle: the {side} robot's corrections follow each other with alternating sign"
        for side, cycles in zip(SIDES, measured.limit_cycle, strict=True)
        if cycles
    ]
    if measured.correction_count > len(measured.corrections):
        lines.append(f"{measured.correction_count} corrections; only the first are listed")
    if measured.contact_event_count > len(measured.contact_events):
        lines.append(f"{measured.contact_event_count} contact events; only the first are listed")
    return tuple(lines)


def _standing(measured: Any) -> list[str]:
    """Robots that stand at the end of a carry that timed out."""
    if measured.outcome != "stalled":
        return []
    return [
        f"the {side} robot stands: it hears nothing fresh from its partner, or waits for p = 0"
        for side, stands in zip(SIDES, measured.stopped, strict=True)
        if stands
    ]


def _waiting(measured: Any, scene: Scene) -> list[str]:
    """Robots that still wait at the end of a carry in which a message was lost or not accepted;
    they would wait forever."""
    reason = _reason(measured, scene)
    if not reason:
        return []
    longest = _PATIENCE_S + 2 * scene.radio.longest_delay_s
    return [
        f"the {side} robot has waited since {since:.1f} s for {_a(kind)} that does not arrive "
        f"(a message {reason})"
        for side, (since, duration, kind) in zip(SIDES, measured.hanging, strict=True)
        if duration > longest
    ]


def _reason(measured: Any, scene: Scene) -> str:
    """Why a message may be missing; empty: none is."""
    if measured.messages_lost:
        return "was lost"
    if not any(rejected for *_, rejected in measured.links):
        return ""
    if scene.radio.corruption > 0:
        return "arrived damaged"
    boots = scene.faults.random_reboots or any(
        fault.kind in ("reboot", "freeze") for fault in scene.faults.script
    )
    return "had no session after a reboot" if boots else ""  # else it was a copy


def _a(kind: str) -> str:
    """A kind of message with its article; empty: any message."""
    return f"{'an' if kind[:1] in 'AEIOU' else 'a'} {kind}" if kind else "a message"
