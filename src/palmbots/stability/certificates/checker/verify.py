# SPDX-License-Identifier: Apache-2.0
"""Verification of certificates with exact rational numbers, independent of the prover.

The conditions that have to hold at the corners of a box, and why the corners suffice, are in
`property_conditions` for the properties, in `jam_conditions` for motions that jam, and in
`clearance_conditions` for the clearance. Where the corners of the whole box do not suffice, the
certificate states at which value of which quantity to bisect it. The checker follows these
bisections and trusts nothing else in the file: it reads the box again, compares it with the scene
that the certificate states, and lists the obligations itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from os import PathLike

from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table, bad, quiet, verdict
from palmbots._util.results import Result
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.stability.certificates.box_table import BoxTable
from palmbots.stability.certificates.checker.box_text import box_facts, scene_text
from palmbots.stability.certificates.checker.certificate_file import Entry, read_certificate
from palmbots.stability.certificates.checker.claimed_box import ClaimedBox, read_box
from palmbots.stability.certificates.checker.clearance_conditions import (
    prove_clear,
    prove_touching,
)
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.jam_conditions import prove_no_jam, refute_no_jam
from palmbots.stability.certificates.checker.property_conditions import (
    CheckFailed,
    ObjectParams,
    ParameterBox,
    corners,
    prove_property,
    refute_property,
)
from palmbots.stability.certificates.checker.required_obligations import (
    CLAIMS,
    Obligation,
    required_obligations,
)
from palmbots.stability.certificates.checker.scene_comparison import (
    contact_radii,
    has_outline_of,
    values_outside,
)
from palmbots.stability.certificates.checker.touching_points import ContactArcs


@dataclass(frozen=True, repr=False)
class CheckResult(Result):
    """The result of a check."""

    valid: bool
    claim: str
    reason: str
    """The first fault of a certificate that is not valid; empty: there is none."""
    box: BoxTable | None = None
    """The box, as in the file; None where it cannot be read."""
    scene: Scene | None = None
    """The scene that the certificate states; None where it cannot be read."""
    box_text: dict[str, str] = field(default_factory=dict, metadata=NOT_IN_JSON)
    """The box with units, by quantity, and the keys of the scene."""
    outside: tuple[str, ...] = ()
    """Values of that scene that lie outside of the box, so that the certificate says nothing about
    the scene itself."""

    def lines(self) -> Iterator[Item]:
        """Whether the certificate proves its claim, and the box."""
        if self.valid and self.claim.startswith("fails"):
            yield Line(bad("FAILS"), "  the certificate proves it (it is valid)")
        else:
            yield verdict(self.valid, "VALID", "INVALID")
        if not self.valid:
            yield Line(self.reason, indent=2)
        yield Line(quiet(self.claim), indent=2)
        yield Table([(f"  {name}", text) for name, text in self.box_text.items()])
        if self.valid and self.outside:
            yield Line(
                f"the scene is not in the parameter box: {'; '.join(self.outside)}", indent=2
            )


@command(
    order=50,
    example="palmbots check certificate.json",
    failure=("valid", "the certificate does not prove its claim"),
    certificate=Option(is_file=True),
    scene=Option(metavar="SCENE"),
)
def check(certificate: str | PathLike[str], scene: SceneLike | None = None) -> CheckResult:
    """Verify a certificate independently of the prover.

    The checker shares no code with the prover and computes in exact arithmetic.

    Args:
        certificate: JSON file of ``palmbots certify``.
        scene: require that the parameter box contains this scene. It may have any form that
            `load_scene` reads; the box must have its outline and contain its values.
            None: the box is compared with the scene that the certificate states; its values may lie
            outside of the box (`CheckResult.outside`), but the outline must be the same.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: the file cannot be read, is not a certificate or has another format.
    """
    data = read_certificate(certificate)
    given = None if scene is None else load_scene(scene)
    result = CheckResult(False, "", "")
    try:
        claim, run = _claim(Entry(data))
        result = replace(result, claim=claim)
        box = read_box(Entry(data)["box"])
        result = replace(result, box=data["box"], box_text=box_facts(box))
        own = _stated_scene(Entry(data)["scene"])
        result = replace(
            result,
            scene=own,
            box_text=result.box_text | {"scene": scene_text(own)},
            outside=values_outside(box, own),
        )
        _require_scene(box, own, given)
        run(_with_arcs(box, own), Entry(data))
    except CheckFailed as error:
        return replace(result, reason=str(error))
    return replace(result, valid=True)


def _claim(certificate: Entry) -> tuple[str, Callable[[ClaimedBox, Entry], None]]:
    """What a certificate claims, in words, and the function that checks it."""
    verdict = certificate["verdict"]
    claims = [claim.text() for claim in certificate["claims"].items()]
    if not claims or set(claims) - CLAIMS:
        raise certificate["claims"].fault(f"one or more of {', '.join(sorted(CLAIMS))}")
    text = f"{verdict.value}: {', '.join(claims)}"
    if verdict.value == "holds":
        return text, _check_holds
    if verdict.value != "fails":
        raise verdict.fault("holds, fails")
    return text.replace(": ", ": at least one of ", 1) if len(claims) > 1 else text, _check_fails


def _stated_scene(entry: Entry) -> Scene:
    if not isinstance(entry.value, dict):
        raise entry.fault("a table")
    try:
        return load_scene(entry.value)
    except SceneError as error:
        raise CheckFailed(str(error)) from None


def _require_scene(box: ClaimedBox, stated: Scene, given: Scene | None) -> None:
    """The outline must be that of the stated scene; a given scene must be in the box."""
    if not has_outline_of(box, stated):
        raise CheckFailed(
            "the outline of the parameter box is not the object of the certificate's scene"
        )
    if given is None:
        return
    if not has_outline_of(box, given) or contact_radii(given) != contact_radii(stated):
        raise CheckFailed("the certificate is about another object than the scene's")
    outside = values_outside(box, given)
    if outside:
        raise CheckFailed(f"the scene is not in the parameter box: {'; '.join(outside)}")


def _with_arcs(box: ClaimedBox, stated: Scene) -> ClaimedBox:
    radii = contact_radii(stated)
    return replace(box, arcs=ContactArcs.of(box.outline, radii)) if any(radii) else box


def _follow(proof: Entry, box: ParameterBox, prove: Callable[[ParameterBox], None]) -> None:
    """Follow the bisections of a proof down to boxes whose corners suffice."""
    pending = [(proof.value, box)]
    while pending:
        node, part = pending.pop()
        if node == "corners":
            prove(part)
            continue
        if not (isinstance(node, list) and len(node) == 4 and isinstance(node[0], str)):
            raise CheckFailed("a proof is neither 'corners' nor [quantity, value, below, above]")
        low, high = part.halves(node[0], Entry(node[1], "value of a proof").number())
        pending += [(node[3], high), (node[2], low)]


def _check_holds(box: ClaimedBox, certificate: Entry) -> None:
    proofs = certificate["proof"]
    for name, obligation in required_obligations(box, certificate["claims"].value).items():
        whole = ParameterBox(
            obligation.angles, box.friction, box.width, obligation.contacts, box.common_friction
        )

        def prove(part: ParameterBox, obligation: Obligation = obligation) -> None:
            if obligation.is_clearance:
                if box.arcs is not None:
                    raise CheckFailed("no proof covers the clearance of rounded contact vertices")
                prove_clear(obligation.side, part, box.params, box.outline)
                return
            params = box.params
            if box.arcs is not None:
                part, params = box.arcs.touching(part, params)
            at = list(corners(part, params))
            if obligation.claim == "no jam":
                prove_no_jam(obligation.number, at)
            else:
                prove_property(obligation.number, obligation.side, at)

        proof = proofs[name]
        try:
            _follow(proof, whole, prove)
        except CheckFailed as error:
            raise CheckFailed(f"{name}: {error}") from None


def _check_fails(box: ClaimedBox, certificate: Entry) -> None:
    """Require that a claim certainly fails at one point of the box."""
    if box.arcs is not None:
        raise CheckFailed("no witness proves that a claim fails for rounded contact vertices")
    witness = certificate["witness"]
    obligations = required_obligations(box, certificate["claims"].value)
    if witness["claim"].text() not in obligations:
        raise witness["claim"].fault(", ".join(obligations))
    obligation = obligations[witness["claim"].text()]

    def both(key: str, within: tuple[Ends, Ends]) -> tuple[Ends, Ends]:
        left, right = (witness[key][side].number() for side in ("left", "right"))
        return _inside(left, within[0]), _inside(right, within[1])

    angles = both("angle_deg", obligation.angles)
    contacts = both("contacts_m", obligation.contacts)
    offset = both("offset_m", box.params.offset)
    w = _inside(witness["width_m"].number(), box.width)
    if obligation.is_clearance:
        unused = (Fraction(0), Fraction(0))
        point = ParameterBox(angles, (unused, unused), w, contacts, False)
        half_length = both("half_length_m", box.outline.half_length)
        prove_touching(
            obligation.side,
            witness["edge"].index(0, len(box.outline.outline)),
            point,
            replace(box.params, offset=offset),
            replace(box.outline, half_length=half_length),
        )
        return
    mu = both("friction", box.friction)
    if box.common_friction and mu[0] != mu[1]:
        raise CheckFailed("the witness is not a point of the parameter box")
    x, y = (value.number() for value in witness["com_m"].items(2))
    if (x, y) not in box.params.com:
        raise CheckFailed("the witness is not a point of the parameter box")
    slope = _inside(witness["slope"].number(), box.params.slope)
    params = ObjectParams(((x, y),), slope, offset)
    point = ParameterBox(angles, mu, w, contacts, False)
    at, what = list(corners(point, params)), witness["fails"].text()
    if obligation.claim == "no jam":
        refute_no_jam(obligation.number, what, at)
    else:
        refute_property(obligation.number, obligation.side, what, at)


def _inside(value: Fraction, ends: Ends) -> Ends:
    if not ends[0] <= value <= ends[1]:
        raise CheckFailed("the witness is not a point of the parameter box")
    return value, value
