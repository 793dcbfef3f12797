# SPDX-License-Identifier: Apache-2.0
"""What people read of a certificate."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from palmbots._types import SIDES
from palmbots._util.report import Item, Line, Table, bad, bold, good, quiet, warn_word
from palmbots.scene.spec import contact_radii, to_spec
from palmbots.stability.analysis_lines import PROPERTIES
from palmbots.stability.linear_conditions import text_of

if TYPE_CHECKING:
    from palmbots.stability.certificates.prover import Certificate


def certificate_lines(certificate: "Certificate") -> Iterator[Item]:
    """What was proved, or where it fails."""
    claims = ", ".join(certificate.claims)
    if certificate.verdict == "holds":
        yield Line(good("CERTIFIED TO HOLD"), bold(f"  {claims}"))
        yield quiet(f"{certificate.parts} boxes proved at their corners")
    elif certificate.witness is not None:
        quantifier = "at least one of " if len(certificate.claims) > 1 else ""
        yield Line(bad("CERTIFIED TO FAIL"), bold(f"  {quantifier}{claims}"))
        yield from _witness(certificate.witness)
    else:
        yield Line(warn_word("UNDECIDED"), bold(f"  {claims}"))
        yield f"neither proved nor refuted: {certificate.undecided} (try narrower intervals)"
    if any(contact_radii(to_spec(certificate.scene))):
        box = (
            "rounded contact vertices: a larger box, with all points where an arc touches a palm, "
        )
        if certificate.verdict == "holds":
            yield Line(f"{box}satisfies the conditions of sharp ones, which suffices")
            yield Line("clearance is not certified; palmbots analyze computes it", indent=2)
        else:
            yield Line(
                f"{box}would have to satisfy the conditions of sharp ones, although a part of it "
                "never occurs; palmbots analyze examines what occurs in the scene"
            )
    if certificate.with_common_friction == "holds":
        yield "where both palms have the same friction, it holds: --common-friction"


def _witness(witness: Mapping[str, Any]) -> Iterator[Item]:
    """The point at which a claim fails, and how."""
    name = witness["claim"]
    if witness["fails"] == "clearance":
        yield (
            f"the {name.split()[1]} palm touches edge {witness['edge']} of the outline "
            "(counted counter-clockwise from the left contact, which is 0)"
        )
    elif name.startswith("jam") and witness["fails"] != "wedged":
        side = "right" if witness["fails"] == "lift_left" else "left"
        yield f"{name}: the COM lies beyond the {side} contact, so a contact need not slide"
    elif name.startswith("jam"):
        yield f"{name}: both contacts are wedged, and neither slides"
    elif name == "0 turning":
        yield f"both palms turning: {_any_palm(text_of(0, witness['fails']))}"
    else:
        number, side = int(name[0]), name.split()[1]
        yield f"{PROPERTIES[number]}, {side}: {text_of(number, witness['fails'])}"
    rows = []
    for label, key, unit in (
        ("palm angles", "angle_deg", "°"),
        ("friction", "friction", ""),
        ("contacts", "contacts_m", " m"),
        ("palm half-length", "half_length_m", " m"),
        ("pivot offset", "offset_m", " m"),
    ):
        if key in witness:
            pair = witness[key]
            rows.append((f"  {label}", *(f"{side} {pair[side]}{unit}" for side in SIDES)))
    if "com_m" in witness:
        x, y = witness["com_m"]
        rows.append(("  COM", f"x {x} m", f"y {y} m"))
    yield Table(rows)


def _any_palm(reason: str) -> str:
    """A reason in which the left palm is called the shallow one, since either may be it."""
    return reason.replace("shallow", "left").replace("steep", "right")
