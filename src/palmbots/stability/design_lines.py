# SPDX-License-Identifier: Apache-2.0
"""What people read of a design."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from palmbots._util.report import Item, Line, Table, bold, good, quiet, warn_word, warning
from palmbots._util.text import millimetres
from palmbots.scene.command_text import command_text
from palmbots.stability.analysis_lines import friction_note
from palmbots.stability.angle_grid import LIFT, NOISE, QUANTITIES
from palmbots.stability.certificates.obligations import BOTH_TURN
from palmbots.stability.design_result import failures_text, limit_text

if TYPE_CHECKING:
    from palmbots.stability.design_result import Design


def design_lines(design: "Design") -> Iterator[Item]:
    """The angles, what they tolerate beside the scene's own, and how to use them."""
    if design.plate is None:
        yield from _angle_lines(design)
    else:
        yield from design.plate.lines()
    controller = None if design.counts is None else design.words or design.counts.controller
    keys = {key: float(f"{value:g}") for key, value in design.angle_keys.items()}
    run = command_text("carry", design.scene.spelled, keys, controller=controller)
    yield Line(f"run: {run}", indent=2, is_whole=True)
    yield from map(warning, design.warnings)


def _angle_lines(design: "Design") -> Iterator[Item]:
    assert design.quantity != LIFT
    name = QUANTITIES[design.quantity][-1]
    aim = "tolerate the most noise" if design.maximize == NOISE else f"largest tolerance: {name}"
    yield Line(good(f"{design.shallow_deg:g}° and {design.steep_deg:g}°"), bold(f"  {aim}"))
    yield from _comparison(design, name)
    low, high = design.region_m
    reaction = design.reaction_s
    rows = [
        ("  contacts", f"{1e3 * low:.1f} to {millimetres(high)}", "for which this holds"),
    ]
    if design.friction is not None:
        note = friction_note([design.friction], design.shallow_deg, design.steep_deg)
        low, high = design.friction
        rows.append(("  friction", f"{low:.3f} to {high:.3f}", f"the same on both palms{note}"))
    times = f"{reaction.own:.2f} s, {reaction.asked:.2f} s"
    rows.append(("  reaction", times, "in case (d), in case (a) with the partner's help"))
    yield Table(rows)
    certificate = design.certificate
    assert certificate is not None
    if certificate.verdict == "holds":
        yield f"certified under these conditions: {', '.join(certificate.claims)}"
        if "clearance" not in certificate.claims:
            yield "clearance: computed, not certified, because a contact vertex is rounded"
        if missing := [claim for claim in BOTH_TURN if claim not in certificate.claims]:
            yield f"not certified for palms that turn at the same time: {', '.join(missing)}"
    else:
        yield warn_word(f"certificate: {certificate.verdict} ({certificate.undecided})")


def _comparison(design: "Design", name: str) -> Iterator[Item]:
    """Noise limit and tolerance of the designed angles and of the scene's own."""
    own = design.own
    limits = (design.noise_limit, own.noise_limit)
    rows = []
    if limits != (None, None):
        texts = ("none" if one is None else limit_text(one) for one in limits)
        rows.append(("  σ* (95 %)", *texts))
    tolerance = "none: a property fails"
    if own.tolerance is not None:
        tolerance = design.tolerance_text(own.tolerance)
    elif own.angles_deg is None:
        tolerance = "the palms differ"
    short = name.split(" along")[0]
    rows.append((f"  tolerance, {short}", design.tolerance_text(design.tolerance), tolerance))
    if design.counts is not None:
        rows.append(("  fails in this scene", *map(failures_text, (design.counts, own.counts))))
    clearances = (design.clearance_deg, own.clearance_deg)
    rows.append(("  clearance", *(f"{angle:.2f}°" for angle in clearances)))
    designed = f"designed, {design.shallow_deg:g}° and {design.steep_deg:g}°"
    yield Table(rows, ("", designed, own.name()))
    limit = design.noise_limit or own.noise_limit
    if design.is_better_here is False:
        yield "  in this scene, these angles do not fail measurably less than the scene's own"
    if limit is not None:
        yield quiet(
            f"  σ*: robot.noise_m_s at which 1 % of carries drop the object with {limit.controller}"
        )
