# SPDX-License-Identifier: Apache-2.0
"""Paper, section 3: equations (1) to (8), Figures 3 to 6, and the COM ranges of section 3.4.

The geometry here is the paper's own (points B, D, L₁, R₁, R₂; q, s, γ, δ, α₁, β₁, β₂), written from
its text for φ < θ, where it holds, and compared with the code's squeezes.
"""

import math
from itertools import product

import numpy as np
import pytest

import palmbots as pb
from palmbots.stability.linear_conditions import failing
from palmbots.stability.problem import StabilityProblem, permitted, stability_problem

W, COM = 0.25, (0.125, 0.04)
SHALLOW, STEEP = math.radians(5), math.radians(15)
HALF = 0.075


def situation(friction: float, com: tuple[float, float] = COM) -> StabilityProblem:
    scene = pb.load_scene("paper", {"palm.friction": friction})
    return stability_problem(scene).with_(com=com)


class PaperGeometry:
    """Figure 4 for SL–ST with the left palm shallow."""

    def __init__(self, friction: float, com: tuple[float, float] = COM) -> None:
        phi = math.atan(friction)
        self.q = math.hypot(*com)
        self.gamma = math.atan2(com[1], com[0])
        self.s = math.hypot(W - com[0], com[1])
        self.delta = math.atan2(com[1], W - com[0])
        # Angles of the cone edges from the horizontal, as the figure draws them.
        self.alpha1 = math.pi / 2 - (SHALLOW + phi)
        self.beta1 = math.pi / 2 - (STEEP + phi)
        self.beta2 = math.pi / 2 - (STEEP - phi)

    def heights(self, p_left: float, p_right: float) -> tuple[float, float, float, float]:
        """z by (1), and the heights of L₁, R₁, R₂ by (2) to (4), above the left contact."""
        z = -p_left * math.sin(SHALLOW) + p_right * math.sin(STEEP)
        theta = math.asin(z / W)
        l1 = self.q * math.cos(theta + self.gamma) * math.tan(self.alpha1)
        r1 = self.s * math.cos(self.delta - theta) * math.tan(self.beta1) + z
        r2 = self.s * math.cos(self.delta - theta) * math.tan(self.beta2) + z
        return z, l1, r1, r2


def closing_is_sl_st(at: StabilityProblem, p_left: float, p_right: float) -> bool:
    # The paper's inequalities know nothing of the rest of the outline, so neither may this.
    found = pb.contact_modes_batch(
        width=W,
        com_x=at.com[0],
        com_y=at.com[1],
        theta_left=SHALLOW,
        theta_right=STEEP,
        p_left=p_left,
        p_right=p_right,
        friction_left=at.friction[0],
        friction_right=at.friction[0],
    )
    return found.closing == pb.mechanics.CONTACT_MODES.index(("SL", "ST"))


def test_equation_1_object_angle() -> None:
    for p_left, p_right in product((-0.07, 0.0, 0.03), repeat=2):
        found = pb.contact_modes(
            p_left_m=p_left, p_right_m=p_right, theta_left_deg=5, theta_right_deg=15
        )
        z = -p_left * math.sin(SHALLOW) + p_right * math.sin(STEEP)
        assert found.object_deg == pytest.approx(math.degrees(math.asin(z / W)), abs=1e-12)


def test_figure_3_st_st_needs_gravity_through_both_cones() -> None:
    """The line of gravity passes through the intersection of the two cones iff ST–ST balances."""
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(400):
        friction, x, y = rng.uniform(0.05, 0.6), rng.uniform(0.005, 0.245), rng.uniform(0.01, 0.15)
        p_left, p_right = rng.uniform(-HALF, HALF, 2)
        angles = rng.uniform(math.radians(2), math.radians(30), 2)
        phi = math.atan(friction)
        z = p_right * math.sin(angles[1]) - p_left * math.sin(angles[0])
        turn = math.asin(z / W)
        line = x * math.cos(turn) - y * math.sin(turn)  # of gravity, from the left contact
        d = W * math.cos(turn)
        if not 0 < line < d:
            continue  # the figure has the COM between the contacts
        # On that vertical line each cone covers an interval of heights (above its contact only).
        cones = []
        for lean, across, base in ((angles[0], line, 0.0), (angles[1], d - line, z)):
            steepest, flattest = lean - phi, lean + phi
            top = across / math.tan(steepest) + base if steepest > 0 else math.inf
            cones.append((across / math.tan(flattest) + base, top))
        meets = max(c[0] for c in cones) <= min(c[1] for c in cones)
        found = pb.contact_modes_batch(
            width=W,
            com_x=x,
            com_y=y,
            theta_left=angles[0],
            theta_right=angles[1],
            p_left=p_left,
            p_right=p_right,
            friction_left=friction,
            friction_right=friction,
        )
        assert found.feasible[pb.mechanics.CONTACT_MODES.index(("ST", "ST"))] == meets
        seen.add(meets)
    assert seen == {True, False}


def test_section_3_1_nine_three_five_one() -> None:
    """9 modes, 3 in balance, 5 consistent with closing, one that is both."""
    found = pb.contact_modes(p_left_m=-0.02, p_right_m=0.03, theta_left_deg=5, theta_right_deg=15)
    assert len(pb.mechanics.CONTACT_MODES) == 9
    assert len(found.feasible) == 3
    assert len(found.consistent_closing) == 5
    both = set(found.feasible) & set(found.consistent_closing)
    assert both == {("SL", "ST")} == {found.closing}


@pytest.mark.parametrize("friction", [0.1, 0.15, 0.2, 0.25])
def test_equations_2_to_5_figure_4(friction: float) -> None:
    """L₁ lies between B and D, R₁ ≤ L₁ ≤ R₂, iff closing is SL–ST."""
    rng = np.random.default_rng(2)
    seen = set()
    for _ in range(60):
        com = (rng.uniform(0.02, 0.23), rng.uniform(0.01, 0.1))
        paper = PaperGeometry(friction, com)
        p_left, p_right = rng.uniform(-HALF, 0), rng.uniform(-HALF, HALF)
        _, l1, r1, r2 = paper.heights(p_left, p_right)
        stable = r1 <= l1 <= r2
        assert closing_is_sl_st(situation(friction, com), p_left, p_right) == stable
        seen.add(stable)
    assert seen == {True, False}


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.25])
def test_equation_6_k_b_and_k_d(friction: float) -> None:
    """At z = k_B the points L₁ and R₁ meet, at z = k_D the points L₁ and R₂."""
    com = (0.115, 0.04)
    at = situation(friction, com)
    paper = PaperGeometry(friction, com)
    k = {}
    for form in at.forms(1, "left", at.palms("left")):
        bad = failing(form, W)
        if form.name == "first" and bad:
            k["B"] = bad[0]
        if form.name == "second" and bad:
            k["D"] = bad[1]
    for name, other in (("B", 2), ("D", 3)):
        z = k[name]
        p_right = z / math.sin(STEEP)  # p_L = 0
        heights = paper.heights(0.0, p_right)
        assert heights[1] == pytest.approx(heights[other], abs=1e-10)
    bands = pb.analyze(
        "paper", overrides={"palm.friction": friction, "object.com_m": list(com)}
    ).bands
    assert bands[1, "left"].k_upper == pytest.approx(k["B"])
    assert bands[1, "left"].k_lower == pytest.approx(k["D"])


def test_equations_7_and_8_figure_5_half_planes() -> None:
    """In the plane of contacts the band's edges have slope sin θ_L / sin θ_R."""
    com = (0.100, 0.04)
    at = situation(0.2, com)
    bands = pb.analyze("paper", overrides={"palm.friction": 0.2, "object.com_m": list(com)}).bands
    k_b, k_d = bands[1, "left"].k_upper, bands[1, "left"].k_lower
    assert k_b is not None
    assert k_d is not None
    slope = math.sin(SHALLOW) / math.sin(STEEP)
    rng = np.random.default_rng(4)
    seen = set()
    for p_left, p_right in rng.uniform(-HALF, HALF, (300, 2)):
        below_b = p_right <= slope * p_left + k_b / math.sin(STEEP)
        above_d = p_right >= slope * p_left + k_d / math.sin(STEEP)
        stable = below_b and above_d
        assert closing_is_sl_st(at, p_left, p_right) == stable
        seen.add(stable)
    assert seen == {True, False}


def test_section_3_3_two_corners_suffice() -> None:
    """Property 1 over the left half of the square holds iff it holds at E and F."""
    seen = set()
    for x in np.linspace(0.09, 0.16, 15):
        at = situation(0.2, (x, 0.04))
        corners = [(-HALF, HALF), (0.0, -HALF)]
        at_corners = all(closing_is_sl_st(at, *corner) for corner in corners)
        grid = product(np.linspace(-HALF, 0, 5), np.linspace(-HALF, HALF, 7))
        assert at_corners == all(closing_is_sl_st(at, *p) for p in grid)
        low, high = permitted(at.envelope(), 1, "left", at.angles)
        assert at_corners == (low <= x <= high)
        seen.add(bool(at_corners))
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("friction", "low", "high"),
    [(0.2, 0.1019, 0.2007), (0.3, 0.1084, 0.2178), (0.4, 0.1128, 0.1787), (0.5, 0.1160, 0.1646)],
)
def test_section_3_4_and_figure_6_com_ranges(friction: float, low: float, high: float) -> None:
    """COM bands for 5° and 15° at c_y = 0.04 m, left palm shallow, over the whole palms."""
    at = situation(friction)
    both = [permitted(at.envelope(), number, "left", at.angles) for number in (1, 2)]
    assert max(b[0] for b in both) == pytest.approx(low, abs=1e-4)
    assert min(b[1] for b in both) == pytest.approx(high, abs=1e-4)


def test_with_either_palm_shallow_the_symmetric_part_is_left() -> None:
    found = pb.analyze("paper", overrides={"palm.friction": 0.4})
    assert found.com_x_m is not None
    assert found.com_x_m[0] + found.com_x_m[1] == pytest.approx(W)
    assert found.com_x_m[1] - W / 2 == pytest.approx(0.012, abs=5e-4)


@pytest.mark.parametrize(("friction", "tangent", "above"), [(0.3, -4.5, True), (0.5, 6.8, False)])
def test_golden_cases_beyond_the_steep_angle(friction: float, tangent: float, above: bool) -> None:
    """Where G(L⁺, R⁻) ≤ 0, with φ > θ_steep, equation (8) read literally is wrong."""
    at = situation(friction)
    form = next(f for f in at.forms(1, "left", at.palms("left")) if f.name == "second")
    assert -form.p / form.q == pytest.approx(tangent, abs=0.05)
    assert (form.q > 0) == above
