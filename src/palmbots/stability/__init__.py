# SPDX-License-Identifier: Apache-2.0
"""Stability: analysis of the properties, certificates, palm-angle design, and their figures."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.stability.analysis import Analysis as Analysis
    from palmbots.stability.analysis import Bands as Bands
    from palmbots.stability.analysis import Margins as Margins
    from palmbots.stability.analysis import PropertyReport as PropertyReport
    from palmbots.stability.angle_grid import QUANTITIES as QUANTITIES
    from palmbots.stability.angle_grid import Quantity as Quantity
    from palmbots.stability.certificates.checker.verify import CheckResult as CheckResult
    from palmbots.stability.certificates.obligations import CLAIMS as CLAIMS
    from palmbots.stability.certificates.prover import Certificate as Certificate
    from palmbots.stability.clearance import Clearance as Clearance
    from palmbots.stability.clearance import ClosestState as ClosestState
    from palmbots.stability.clearance import outline_clearance as outline_clearance
    from palmbots.stability.design_result import Design as Design
    from palmbots.stability.design_result import OwnAngles as OwnAngles
    from palmbots.stability.design_result import Plate as Plate
    from palmbots.stability.design_result import PlateDesign as PlateDesign
    from palmbots.stability.drop_hints import analyze_hint as analyze_hint
    from palmbots.stability.drop_hints import missing_properties as missing_properties
    from palmbots.stability.drop_hints import touch_start_hint as touch_start_hint
    from palmbots.stability.first_contact import FirstTouch as FirstTouch
    from palmbots.stability.first_contact import first_touch as first_touch
    from palmbots.stability.lateral_tipping import Sideways as Sideways
    from palmbots.stability.margins import Wedging as Wedging
    from palmbots.stability.palm_angles import PAPER_DEG as PAPER_DEG
    from palmbots.stability.palm_angles import GridOptions as GridOptions
    from palmbots.stability.palm_angles import with_angles as with_angles
    from palmbots.stability.problem import StabilityProblem as StabilityProblem
    from palmbots.stability.problem import stability_problem as stability_problem
    from palmbots.stability.reaction_region import Reaction as Reaction
    from palmbots.stability.reaction_region import reaction as reaction
    from palmbots.stability.scene_limits import self_check as self_check
    from palmbots.stability.tightest_margins import RankedMargin as RankedMargin
else:
    __getattr__, __dir__ = lazy_names(__name__)

for _name, _function in (
    ("stability-geometry", "analysis_figures:geometry"),
    ("friction-cones", "analysis_figures:friction_cones"),
    ("meeting-points", "analysis_figures:meeting_points"),
    ("operating-region", "analysis_figures:operating_region"),
    ("permitted-com", "analysis_figures:permitted_com"),
    ("tactile-zones", "analysis_figures:tactile_zones"),
    ("lifting-forces", "lifting_figure:lifting_forces"),
    ("palm-angles", "palm_angles_figure:palm_angles"),
):
    FIGURES.register(_name, f"palmbots.stability.figures.{_function}")
