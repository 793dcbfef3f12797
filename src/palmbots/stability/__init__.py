# SPDX-License-Identifier: Apache-2.0
"""Stability: analysis of the properties, certificates, palm-angle design, and their figures."""

from palmbots._util.results import FIGURES
from palmbots.stability.analysis import Analysis, Bands, Margins, PropertyReport
from palmbots.stability.angle_grid import QUANTITIES, GridOptions, Quantity
from palmbots.stability.certificates.checker.verify import CheckResult
from palmbots.stability.certificates.obligations import CLAIMS
from palmbots.stability.certificates.prover import Certificate
from palmbots.stability.clearance import Clearance, ClosestState, outline_clearance
from palmbots.stability.design_result import Design, OwnAngles
from palmbots.stability.drop_diagnosis import (
    analyze_hint,
    missing_properties,
    touch_start_hint,
)
from palmbots.stability.first_contact import FirstTouch, first_touch
from palmbots.stability.lateral_tipping import Sideways
from palmbots.stability.margins import Wedging
from palmbots.stability.palm_angles import PAPER_DEG, with_angles
from palmbots.stability.problem import StabilityProblem, stability_problem
from palmbots.stability.reaction_region import Reaction, reaction
from palmbots.stability.scene_limits import self_check

__all__ = [
    "CLAIMS",
    "PAPER_DEG",
    "QUANTITIES",
    "Analysis",
    "Bands",
    "Certificate",
    "CheckResult",
    "Clearance",
    "ClosestState",
    "Design",
    "FirstTouch",
    "GridOptions",
    "Margins",
    "OwnAngles",
    "PropertyReport",
    "Quantity",
    "Reaction",
    "Sideways",
    "StabilityProblem",
    "Wedging",
    "analyze_hint",
    "first_touch",
    "missing_properties",
    "outline_clearance",
    "reaction",
    "self_check",
    "stability_problem",
    "touch_start_hint",
    "with_angles",
]

for _name, _function in (
    ("stability-geometry", "analysis_figures:geometry"),
    ("friction-cones", "analysis_figures:friction_cones"),
    ("meeting-points", "analysis_figures:meeting_points"),
    ("operating-region", "analysis_figures:operating_region"),
    ("permitted-com", "analysis_figures:permitted_com"),
    ("tactile-zones", "analysis_figures:tactile_zones"),
    ("palm-angles", "palm_angles_figure:palm_angles"),
):
    FIGURES.register(_name, f"palmbots.stability.figures.{_function}")


def __dir__() -> list[str]:
    return sorted(__all__)
