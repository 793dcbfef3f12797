"""Certificates: proofs that the properties hold for everything in a box of uncertainty, or do not.

The prover works with ball arithmetic (Arb, through python-flint), so rounding and trigonometry are
included. What is claimed comes down to obligations (`parts`), each proved at the corners of its
part of the box: properties 0, 1 and 2 in `property_proof`, the outline's clearance from both palms
as long as they are in `clearance_proof`. Where corners do not suffice, a part is halved along the
quantity that matters most and each half is proved. What is written is the box, the claims and where
it was halved, nothing else; `palmbots.check` verifies it with exact rationals and code of its own.
Source: MECHANICS section 3, "Vertex certificate".
"""

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal

from palmbots.errors import PalmbotsError, one_of, show
from palmbots.files import write_whole
from palmbots.lowering import refuse_curved
from palmbots.scene import Scene, load_scene
from palmbots.stability.box import Box, box_of, text
from palmbots.stability.parts import CLAIMS, Obligation, Part, halved, obligations

__all__ = ["CLAIMS", "Certificate", "certify", "prove"]

_FORMAT = "palmbots certificate 2"
_MOST_PARTS = 20_000
_BITS = 128

Verdict = Literal["holds", "fails", "undecided"]


@dataclass(frozen=True)
class Certificate:
    """What could be proved of a box; `data` is what stands in the file."""

    verdict: Verdict
    data: dict[str, Any]
    parts: int
    """Boxes whose corners were looked at."""
    undecided: str = ""
    """The first obligation that could be neither proved nor refuted."""

    def save(self, path: str | PathLike[str]) -> None:
        """Write the certificate, whole or not at all."""
        write_whole(path, json.dumps(self.data, indent=1) + "\n")


def prove(
    box: Box, claims: tuple[str, ...] = CLAIMS, *, most_parts: int = _MOST_PARTS
) -> Certificate:
    """Prove or refute the claims for a whole box, with at most so many parts looked at.

    Raises:
        PalmbotsError: no claim, or one that is none of `CLAIMS`: of nothing all would hold.
    """
    if isinstance(claims, str) or not claims:
        raise PalmbotsError(f"claims: value is {show(claims)}; allowed: some of {list(CLAIMS)}")
    for claim in claims:
        one_of("claims", claim, CLAIMS)
    from flint import ctx  # here, as in `_way`: whoever proves nothing need not wait for it

    with ctx.workprec(_BITS):
        return _prove(box, claims, most_parts)


def _way(obligation: Obligation) -> Any:
    from palmbots.stability import clearance_proof, property_proof

    return clearance_proof if obligation.claim == "clearance" else property_proof


def _halved(box: Box, obligation: Obligation, part: Part) -> Any:
    if obligation.claim != "clearance":
        return halved(box, part)
    # Where palms of any length clear, it does not matter which place on them the contact has.
    contacts = not _way(obligation).endless(box, obligation, part)
    return halved(box, part, obligation.side, contacts=contacts)


def _prove(box: Box, claims: tuple[str, ...], most_parts: int) -> Certificate:
    head = {"format": _FORMAT, "claims": list(claims), "box": box.as_dict()}

    def fails(witness: dict[str, Any], parts: int) -> Certificate:
        return Certificate("fails", head | {"verdict": "fails", "witness": witness}, parts)

    parts = 0
    proof: dict[str, Any] = {}
    needed = list(obligations(box, claims))
    for obligation in needed:
        witness = _way(obligation).refuted(box, obligation, obligation.part)
        if witness is not None:
            return fails(witness, parts)
    for obligation in needed:
        holder: list[Any] = [None]
        pending: list[tuple[Part, list[Any], int]] = [(obligation.part, holder, 0)]
        while pending:
            part, into, index = pending.pop()
            parts += 1
            if _way(obligation).proved(box, obligation, part):
                into[index] = "corners"
                continue
            halves = _halved(box, obligation, part)
            last = halves is None or parts > most_parts
            # A point that fails may lie inside the box; a palm may touch between its corners.
            if last or obligation.claim == "clearance":
                witness = _way(obligation).refuted(box, obligation, part)
                if witness is not None:
                    return fails(witness, parts)
            if halves is None or last:
                return Certificate(
                    "undecided", head | {"verdict": "undecided"}, parts, obligation.name
                )
            name, at, low, high = halves
            node: list[Any] = [name, text(at), None, None]
            into[index] = node
            pending += [(high, node, 3), (low, node, 2)]
        proof[obligation.name] = holder[0]
    return Certificate("holds", head | {"verdict": "holds", "proof": proof}, parts)


def certify(
    scene: Any = "paper",
    *,
    overrides: Any = None,
    claims: tuple[str, ...] = CLAIMS,
    most_parts: int = _MOST_PARTS,
    **uncertainty: Any,
) -> Certificate:
    """Prove that the properties hold for everything in a box of uncertainty, or that they do not.

    Args:
        scene: as in `palmbots.carry`.
        overrides: scene keys to set.
        claims: of `CLAIMS`, what to prove.
        most_parts: how much work to spend before calling it undecided.
        uncertainty: intervals (low, high) as in `box_of`: com_x_m, com_y_m (or com_polygon_m, a
            list of points), friction, friction_right, common (True: both palms have the same
            coefficient), shallow_deg, steep_deg, width_m, length_m, offset_m, slope, region_m. What
            is not given is as in the scene, exactly.

    Raises:
        SceneError: the scene cannot be read or makes no sense.
        PalmbotsError: an interval is upside down or beyond what a scene allows, or a claim is none.
    """
    chosen: Scene = load_scene(scene, overrides)
    refuse_curved(chosen)
    return prove(box_of(chosen, **uncertainty), claims, most_parts=most_parts)
