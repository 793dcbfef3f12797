# SPDX-License-Identifier: Apache-2.0
"""Certificates: proofs that the properties hold everywhere in a parameter box, or fail in it.

The prover uses ball arithmetic (Arb, through python-flint), which includes rounding and
trigonometry. The claims consist of obligations (`obligations`). Each is proved at the corners of
its part of the box: properties 0, 1 and 2 in `property_proof`, that no motion jams in `jam_proof`,
and the clearance of the outline from palms of finite length in `clearance_proof`. Where the corners
do not suffice, the part is bisected along the quantity with the largest effect, and each half is
proved. The file contains the scene, the box, the claims and the bisections, and nothing else.
`palmbots.check` verifies it with exact rational numbers and separate code.
Source: docs/theory/stability.md.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack

from palmbots._types import FilePath, Interval, Overrides
from palmbots._util.arguments import one_of, show
from palmbots._util.atomic_files import set_aside, write_whole
from palmbots._util.command import Option, command, writes
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import Result
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import (
    refuse_curved,
    refuse_heels,
    refuse_low_noses,
    refuse_pipe,
)
from palmbots.stability.certificates.box_from_scene import box_of
from palmbots.stability.certificates.box_table import BoxTable
from palmbots.stability.certificates.obligations import (
    CLAIMS,
    FORCE_CLAIMS,
    Obligation,
    Subbox,
    bisect,
    obligations,
)
from palmbots.stability.certificates.parameter_box import ParameterBox, text
from palmbots.stability.certificates.proof_tables import (
    Bisection,
    ClearanceWitness,
    ConditionWitness,
)
from palmbots.stability.probed_object import ProbedObject, read_probed
from palmbots.stability.problem import region_of

_FORMAT = "palmbots certificate 4"
_MAX_BOXES = 20_000
_BITS = 128
_FRICTIONS = {"friction", "friction_right"}

Verdict = Literal["holds", "fails", "undecided"]


@dataclass(frozen=True, repr=False)
class Certificate(Result):
    """The result of a proof; `data` is the content of the file."""

    lines_of = "palmbots.stability.certificates.certificate_lines:certificate_lines"

    verdict: Verdict
    data: dict[str, Any] = field(metadata=NOT_IN_JSON)
    parts: int
    """Number of boxes whose corners were evaluated."""
    undecided: str = ""
    """The first obligation that was neither proved nor refuted."""
    with_common_friction: Verdict | None = None
    """The verdict if both palms have the same friction, anywhere in the interval. None: not tried,
    because the claims hold anyway, or no interval of friction was given."""

    @derived
    def format(self) -> str:
        """The format of the file."""
        return self.data["format"]

    @derived
    def claims(self) -> tuple[str, ...]:
        """What was to be proved."""
        return tuple(self.data["claims"])

    @derived
    def box(self) -> BoxTable:
        """The parameter box."""
        return self.data["box"]

    @derived
    def proof(self) -> dict[str, Bisection] | None:
        """The bisections of each obligation; None: the claims are not proved."""
        return self.data.get("proof")

    @derived
    def witness(self) -> ConditionWitness | ClearanceWitness | None:
        """A point of the box at which a claim fails; None: none was found."""
        return self.data.get("witness")

    @derived
    def scene(self) -> Scene:
        """The scene that the certificate states."""
        return load_scene(self.data["scene"])

    @property
    def holds(self) -> bool:
        """Whether the claims are proved."""
        return self.verdict == "holds"

    def save(self, path: str | PathLike[str]) -> None:
        """Write the certificate, the whole file or nothing."""
        write_whole(path, json.dumps(self.data, indent=1) + "\n")


def prove(
    box: ParameterBox,
    claims: Sequence[str] | None = None,
    *,
    scene: Scene,
    max_boxes: int = _MAX_BOXES,
) -> Certificate:
    """Prove or refute the claims for a whole parameter box.

    Args:
        box: the parameter box.
        claims: some of `CLAIMS`; None: all, or `FORCE_CLAIMS` if a contact vertex is rounded.
        scene: the scene of the box, which the certificate states.
        max_boxes: number of boxes after which the claims count as undecided.

    Raises:
        PalmbotsError: there is no claim, an unknown one, or one about clearance although a contact
            vertex is rounded.
        MissingExtra: python-flint is not installed.
    """
    provable = FORCE_CLAIMS if box.rounded else CLAIMS
    names = provable if claims is None else claims
    if isinstance(names, str) or not names:
        raise PalmbotsError(f"claims: value is {show(names)}; allowed: some of {list(CLAIMS)}")
    for name in names:
        one_of("claims", name, CLAIMS)
        if name not in provable:
            raise PalmbotsError(
                f'claims: "{name}" is about the outline, but a contact vertex is rounded, and then '
                f"only claims about forces are proved; allowed: some of {list(provable)}; "
                "palmbots analyze computes the clearance"
            )
    ctx = require("flint", "certify").ctx  # here and in `_method`: its import is slow
    with ctx.workprec(_BITS):
        return _prove(box, tuple(names), scene, max_boxes)


def _method(obligation: Obligation) -> Any:
    """The module that proves an obligation."""
    from palmbots.stability.certificates import clearance_proof, jam_proof, property_proof

    if obligation.claim == "no jam":
        return jam_proof
    return clearance_proof if _is_clearance(obligation) else property_proof


def _is_clearance(obligation: Obligation) -> bool:
    return obligation.claim.startswith("clearance")


def _halves(box: ParameterBox, obligation: Obligation, part: Subbox) -> Any:
    if not _is_clearance(obligation):
        return bisect(box, part)
    # Where palms of any length are clear, the contact coordinate does not matter.
    contacts = not _method(obligation).endless(box, obligation, part)
    return bisect(box, part, obligation.side, contacts=contacts)


def _prove(box: ParameterBox, claims: tuple[str, ...], scene: Scene, max_boxes: int) -> Certificate:
    head = {
        "format": _FORMAT,
        "claims": list(claims),
        "scene": scene.model_dump(),
        "box": box.as_dict(),
    }

    def fails(witness: dict[str, Any], parts: int) -> Certificate:
        return Certificate("fails", head | {"verdict": "fails", "witness": witness}, parts)

    parts = 0
    proof: dict[str, Any] = {}
    required = list(obligations(box, claims))

    def refuted(obligation: Obligation, part: Subbox) -> dict[str, Any] | None:
        # The enclosure of an arc's touching points contains points that no state has.
        return None if box.rounded else _method(obligation).refuted(box, obligation, part)

    for obligation in required:
        witness = refuted(obligation, obligation.part)
        if witness is not None:
            return fails(witness, parts)
    for obligation in required:
        root: list[Any] = [None]
        pending: list[tuple[Subbox, list[Any], int]] = [(obligation.part, root, 0)]
        while pending:
            part, node, index = pending.pop()
            parts += 1
            if _method(obligation).proved(box, obligation, part):
                node[index] = "corners"
                continue
            halves = _halves(box, obligation, part)
            is_last = halves is None or parts > max_boxes
            # The witness may lie inside the box, and a palm may touch between its corners.
            if is_last or _is_clearance(obligation):
                witness = refuted(obligation, part)
                if witness is not None:
                    return fails(witness, parts)
            if halves is None or is_last:
                return Certificate(
                    "undecided", head | {"verdict": "undecided"}, parts, obligation.name
                )
            name, at, low, high = halves
            child: list[Any] = [name, text(at), None, None]
            node[index] = child
            pending += [(high, child, 3), (low, child, 2)]
        proof[obligation.name] = root[0]
    return Certificate("holds", head | {"verdict": "holds", "proof": proof}, parts)


class Intervals(TypedDict, total=False):
    """The intervals that `certify` takes, as (low, high)."""

    com_x_m: Interval
    """Position of the COM along the object; None: as in the scene."""
    com_y_m: Interval
    """Height of the COM above the contacts; None: as in the scene."""
    com_polygon_m: Sequence[Sequence[float]]
    """Corners of a polygon of COMs, in place of both."""
    friction: Interval
    """Friction coefficient; None: as in the scene."""
    friction_right: Interval
    """Friction coefficient of the right palm; None: as in the scene."""
    shallow_deg: Interval
    """Shallow angle; None: as in the scene."""
    steep_deg: Interval
    """Steep angle; None: as in the scene."""
    width_m: Interval
    """Distance between the contact vertices; None: as in the scene."""
    length_m: Interval
    """Length of the palms; None: as in the scene."""
    offset_m: Interval
    """Pivot offset of the palms; None: as in the scene."""
    slope_deg: Interval
    """Slope of the floor, uphill > 0; None: as in the scene. Uphill is meant in the direction of
    travel; the limits are -45 and 45."""


def with_probed(given: Intervals, found: ProbedObject, common: bool) -> Intervals:
    """The intervals, with those of a probed object where none are given."""
    intervals: Intervals = {}
    if "com_polygon_m" not in given:
        intervals |= {"com_x_m": found.com_x_m, "com_y_m": found.com_y_m}
    if not {*given} & _FRICTIONS:
        left, right = found.frictions(common)
        intervals |= {"friction": left, "friction_right": right}
    return {**intervals, **given}


@command(
    order=40,
    example="palmbots certify --com-x-m 0.12 0.13 --friction 0.28 0.32 -o certificate.json",
    failure=("holds", "the properties fail somewhere, or the prover could not decide"),
    intervals=Option(),
    probe=Option("--from", metavar="PROBE"),
    common_friction=Option("--common-friction/--independent-friction"),
    region_m=Option("--region", metavar="implied|palm|LOW,HIGH"),
    beyond_m=Option(metavar="M"),
    claims=Option(metavar="NAME,…"),
)
def certify(
    scene: SceneLike = "paper",
    *,
    common_friction: bool = False,
    region_m: Interval | Literal["implied", "palm"] = "palm",
    beyond_m: float = 0.0,
    claims: Sequence[str] | None = None,
    probe: FilePath | None = None,
    max_boxes: int = _MAX_BOXES,
    overrides: Overrides = None,
    **intervals: Unpack[Intervals],
) -> Certificate:
    """Prove the properties for all scenes in given intervals.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        common_friction: use one friction for both palms, or one for each. With one for both, it
            may be any of the interval.
        region_m: contact coordinates: what the scene implies, the whole palm, or an interval [m].
        beyond_m: how far past p = 0 corrections continue. Contacts up to there count as not yet
            corrected. 0: as in the paper.
        claims: prove these claims: property 1, property 2, property 0, clearance, property 0
            turning, clearance turning, no jam; None: all, or all without clearance if a contact
            vertex is rounded.
        probe: file of palmbots probe with intervals of COM and friction; None: as in the scene.
        max_boxes: number of boxes after which the claims count as undecided.
        overrides: scene keys to set.
        intervals: as `Intervals` describes them.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: an interval or a claim is unknown, or an interval is out of range.
    """
    for name in intervals:
        one_of("certify", name, tuple(Intervals.__annotations__))
    chosen = load_scene(scene, overrides)
    if probe is not None:
        intervals = with_probed(intervals, read_probed(probe, chosen), common_friction)
    refuse_curved(chosen)
    refuse_pipe(chosen, "the proof")
    refuse_low_noses(chosen)
    refuse_heels(chosen)

    def proved(common: bool) -> Certificate:
        box = box_of(
            chosen,
            common_friction=common,
            region_m=region_of(chosen, region_m),
            beyond_m=beyond_m,
            **intervals,
        )
        return prove(box, claims, scene=chosen, max_boxes=max_boxes)

    found = proved(common_friction)
    if found.holds or common_friction or {*intervals} & _FRICTIONS != {"friction"}:
        return found
    return replace(found, with_common_friction=proved(True).verdict)


@writes("certify", path=Option("--out -o", metavar="FILE"))
def write_certificate(
    certificate: Certificate,
    path: str | PathLike[str],
    *,
    on_warning: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write a certificate; if nothing is proved, rename an older one that could be mistaken for it.

    Args:
        certificate: what was proved.
        path: write the certificate to this file.
        on_warning: called with a line about an older file.
    """
    if certificate.verdict != "undecided":
        certificate.save(path)
        return [user_path(path)]
    kept = set_aside(user_path(path))
    if kept is not None and on_warning is not None:
        on_warning(f"nothing is proved; {path} is from an earlier run and was renamed to {kept}")
    return []
