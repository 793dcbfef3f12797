# SPDX-License-Identifier: Apache-2.0
"""Closed forms of picking up and putting down, against linear programs over forces and over contact
modes that share no code with them, and against the exact world."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog, minimize_scalar
from tests.conftest import is_soak

import palmbots as pb
from palmbots._types import Side
from palmbots.mechanics.lifting_bodies import Plate, Standing, edge_lean
from palmbots.mechanics.lifting_forces import (
    Docking,
    docking,
    floor_friction_to_stay,
    least_partner_angle,
)
from palmbots.simulation import FloorState, FloorWorld

STATES = 10_000 if is_soak() else 60


class Contact:
    """A contact in the plane: where it is on the object, its normal into the object, its friction
    angle, and the velocity of what it touches."""

    def __init__(self, at: Any, lean: float, phi: float, velocity: tuple[float, float]) -> None:
        self.at = np.array(at, float)
        self.normal = np.array([math.sin(lean), math.cos(lean)])
        self.along = np.array([math.cos(lean), -math.sin(lean)])
        self.mu = math.tan(phi)
        self.velocity = np.array(velocity, float)

    def wrench(self, force: np.ndarray) -> list[float]:
        return [*force, self.at[0] * force[1] - self.at[1] * force[0]]

    def rays(self, mode: str) -> list[list[float]]:
        """Wrenches of the forces that a mode permits. A contact that slips along +t is rubbed
        along −t."""
        edges = {"stick": (-1, 1), "slip+": (-1,), "slip-": (1,), "break": ()}[mode]
        return [self.wrench(self.normal + edge * self.mu * self.along) for edge in edges]

    def motion(self, mode: str) -> tuple[list[Any], list[Any]]:
        """Rows (a, b) of a · twist = b, and of a · twist ≤ b."""
        jacobian = np.array([[1, 0, -self.at[1]], [0, 1, self.at[0]]])
        n, t = self.normal @ jacobian, self.along @ jacobian
        vn, vt = self.normal @ self.velocity, self.along @ self.velocity
        if mode == "break":
            return [], [(-n, -vn - 1e-6)]
        if mode == "stick":
            return [(n, vn), (t, vt)], []
        sense = 1 if mode == "slip+" else -1
        return [(n, vn)], [(-sense * t, -sense * vt - 1e-6)]


def feasible(equal: list[Any], below: list[Any], size: int, sign: float | None) -> bool:
    result = linprog(
        np.zeros(size),
        A_eq=np.array([a for a, _ in equal]) if equal else None,
        b_eq=np.array([b for _, b in equal]) if equal else None,
        A_ub=np.array([a for a, _ in below]) if below else None,
        b_ub=np.array([b for _, b in below]) if below else None,
        bounds=(sign, None),
    )
    return bool(result.success)


def squeezes(rays: list[list[float]], push: list[float], load: list[float]) -> tuple[float, float]:
    """The least and the greatest value of push · strengths, where the rays carry a load; inf: none
    do."""
    found = []
    for sense in (1, -1):
        result = linprog(sense * np.array(push), A_eq=np.array(rays).T, b_eq=load, bounds=(0, None))
        found.append(sense * result.fun if result.success else math.inf)
    return found[0], found[1]


class State:
    """A random object on the floor between two random palms."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        u = rng.uniform
        self.width, self.weight, self.r = u(0.1, 0.4), u(0.5, 20), u(0.001, 0.01)
        self.com = (u(0.25, 0.75) * self.width, u(0.02, 0.1))
        self.slope = u(-0.03, 0.03) if seed % 2 else 0.0
        self.mu_floor = u(0.1, 0.8)
        self.phi = [math.atan(u(0.15, 0.6)) for _ in range(2)]
        self.theta = [math.radians(u(5, 40)) for _ in range(2)]
        self.nose = [self.r * u(0.02, 0.9) for _ in range(2)]
        self.heel = [self.r * u(0, 4 if seed % 3 == 0 else 1.2) for _ in range(2)]
        self.half = u(0.02, 0.08)

    def body(self) -> Standing:
        return Standing(
            self.width, self.com, (self.r, self.r), self.weight, self.slope, (self.r, self.r)
        )

    def plates(self) -> tuple[Plate, Plate]:
        made = [
            Plate(
                self.theta[k],
                self.phi[k],
                self.nose[k],
                self.nose[k] + self.half * math.sin(self.theta[k]),
                self.half,
                0.0,
                self.heel[k],
            )
            for k in (0, 1)
        ]
        return made[0], made[1]

    def first_lean(self, side: int) -> float:
        """The lean of the first contact of an arc on the floor with the plate that drives towards
        it: of all points from the nose upwards, the one that reaches the arc first."""

        def behind(along: float) -> tuple[float, float]:
            up = self.nose[side] + along * math.sin(self.theta[side]) - self.r
            reach = math.sqrt(max(0.0, self.r**2 - up**2))  # of the arc, at this height
            return along * math.cos(self.theta[side]) - reach, math.asin(reach / self.r)

        found = minimize_scalar(
            lambda along: behind(along)[0],
            bounds=(0.0, self.r),
            method="bounded",
            options={"xatol": 1e-13},
        )
        return behind(min(0.0, found.x, key=lambda along: behind(along)[0]))[1]

    def load(self, com: Any) -> list[float]:
        """What the contacts have to carry: the weight, turned round."""
        x, y = com
        return [self.slope * self.weight, self.weight,
                self.weight * x - self.slope * self.weight * y]  # fmt: skip

    def placed(self, heights: list[float]) -> tuple[list[Any], Any]:
        """Centres of the arcs and the COM at these heights."""
        turn = math.asin((heights[1] - heights[0]) / self.width)
        ex = np.array([math.cos(turn), math.sin(turn)])
        ey = np.array([-math.sin(turn), math.cos(turn)])
        left = np.array([0.0, heights[0]])
        return [left, left + self.width * ex], left + self.com[0] * ex + self.com[1] * ey

    def touch(self, centre: Any, side: int, lean: float, phi: float, moves: bool) -> Contact:
        sense = (1, -1)[side]
        lean = sense * lean
        at = np.array(centre) - self.r * np.array([math.sin(lean), math.cos(lean)])
        return Contact(at, lean, phi, (float(sense) if moves else 0.0, 0.0))


def slipping(side: int) -> str:
    """The object slips outward, up the surface, as seen along +t."""
    return "slip-" if side == 0 else "slip+"


def holding(state: State, side: int, at_heel: bool) -> tuple[list[Contact], list[float]]:
    """The contacts of the state in which `side` gets under second: its nose, the floor below it,
    and the other palm with its heel if the other corner is there; and what they carry."""
    other, sense = 1 - side, (-1, 1)[1 - side]
    theta, r, heel = state.theta[other], state.r, state.heel[other]
    along = np.array([sense * math.cos(theta), math.sin(theta)])
    across = np.array([-sense * math.sin(theta), math.cos(theta)])
    pivot = state.nose[other] + state.half * math.sin(theta)

    def placed(p: float) -> tuple[list[Any], Any]:
        heights = [r, r]
        heights[other] = pivot + p * math.sin(theta) + r * math.cos(theta)
        return state.placed(heights)

    def pressed(p: float) -> tuple[float, Any, float]:
        """How far the upper edge of the heel is from the object, the point that is nearest to it,
        and the lean of the normal there."""
        centres, _ = placed(p)
        edge = centres[other] + (state.half - p) * along + (heel - r) * across
        ways = (centres[1] - centres[0]) / state.width
        wall = np.array([-ways[1], ways[0]])
        up = max(0.0, float((edge - centres[other]) @ wall))
        foot = centres[other] + up * wall  # the side of the object is r away from it
        if up > 0:
            out, inward = sense * (edge - foot) @ ways, -sense * ways
        else:
            out = float(np.linalg.norm(edge - foot))
            inward = (foot - edge) / out
        if heel >= r and state.half - p <= out:  # its face touches the arc
            out, inward, foot = state.half - p, -along, centres[other]
        return out - r, foot - r * inward, math.atan2(inward[0], inward[1])

    # On the palm, but not below the floor.
    p = max(-state.half, (r - r * math.cos(theta) - pivot) / math.sin(theta))
    if at_heel:
        low, high = state.half - 6 * state.r - heel, state.half
        for _ in range(60):
            p = 0.5 * (low + high)
            low, high = (p, high) if pressed(p)[0] > 0 else (low, p)
    centres, com = placed(p)
    psi = state.first_lean(side)
    contacts = [
        state.touch(centres[side], side, psi, state.phi[side], True),
        state.touch(centres[side], side, 0.0, math.atan(state.mu_floor), False),
        state.touch(centres[other], other, theta, state.phi[other], True),
    ]
    if at_heel:
        _, at, lean = pressed(p)
        contacts.append(Contact(at, lean, state.phi[other], (-float(sense), 0.0)))
    return contacts, state.load(com)


@pytest.mark.parametrize("height", [0.0, 0.3, 1.0, 2.0])
def test_an_edge_leans_as_a_chord_of_its_arc(height: float) -> None:
    """The point of the arc at the height of a step is as far from its centre as all others."""
    psi = edge_lean(height, 1.0)
    assert 1 - math.cos(psi) == pytest.approx(min(height, 1.0))


def test_the_first_squeeze_is_that_of_a_linear_program() -> None:
    for seed in range(STATES):
        state = State(seed)
        r = state.r
        for side in (0, 1):
            closed = docking(state.body(), state.plates(), side)
            psi = state.first_lean(side)
            centres, com = state.placed([r, r])
            own = state.touch(centres[side], side, psi, state.phi[side], True)
            # The other corner stands on the floor, which may be as rough as you like, or on the
            # nose of its palm: the force that lifts is the same whatever carries the other one
            # through a given point.
            most = 0.0
            lean = state.first_lean(1 - side)
            for foot in (0.0, lean):
                foot_of = state.touch(centres[1 - side], 1 - side, foot, 1.5, False)
                rays = own.rays(slipping(side)) + [
                    foot_of.wrench(np.array(way)) for way in ((1, 0), (-1, 0), (0, 1))
                ]
                push = [abs(ray[0]) * (k == 0) for k, ray in enumerate(rays)]
                low, high = squeezes(rays, push, state.load(com))
                if psi + state.phi[side] >= math.pi / 2:
                    assert math.isinf(closed.alone)
                    continue
                assert low == pytest.approx(high, rel=1e-6)
                most = max(most, low)
            if math.isfinite(closed.alone):
                assert closed.alone == pytest.approx(most, rel=1e-6), (seed, side)


def test_the_second_squeeze_and_what_holds_it_are_those_of_a_linear_program() -> None:
    held = [0, 0]
    for seed in range(STATES):
        state = State(seed)
        for side, at_heel in itertools.product((0, 1), (False, True)):
            closed = docking(state.body(), state.plates(), side)
            second = closed.at_heel if at_heel else closed.just_on
            squeeze, most = second.squeeze, second.held
            if not math.isfinite(squeeze):
                continue
            # The nose slips, the floor below it carries nothing, and the partner's palm sticks.
            contacts, load = holding(state, side, at_heel)
            own = contacts[0].rays(slipping(side))
            rays = own + [ray for contact in contacts[2:] for ray in contact.rays("stick")]
            low, _ = squeezes(rays, [abs(own[0][0])] + [0.0] * (len(rays) - 1), load)
            near = 1e-6
            if math.isfinite(low):
                held[1] += 1
                # With heel and surface, the balance leaves an unknown.
                assert squeeze == pytest.approx(low, rel=near), (seed, side, at_heel)
            if abs(squeeze - most) <= near * squeeze:
                continue
            if squeeze > most:
                held[0] += 1
                assert math.isinf(low), (seed, side, at_heel)
            elif not math.isfinite(low):
                # Only because the partner's corner would slide down its palm, inward.
                theta, phi = state.theta[1 - side], state.phi[1 - side]
                assert theta > phi and not at_heel, (seed, side, at_heel, squeeze, most)
                assert squeeze <= (state.weight - 0) * math.tan(theta - phi)
    assert min(held) > STATES // 10


def outcomes(contacts: list[Contact], load: list[float]) -> list[tuple[str, ...]]:
    """All contact modes that are in balance and possible as a motion."""
    found = []
    kinds = ("stick", "slip+", "slip-", "break")
    for modes in itertools.product(kinds, repeat=len(contacts)):
        rays = [ray for contact, mode in zip(contacts, modes, strict=True)
                for ray in contact.rays(mode)]  # fmt: skip
        if not rays:
            continue
        equal: list[Any] = []
        below: list[Any] = []
        for contact, mode in zip(contacts, modes, strict=True):
            one, two = contact.motion(mode)
            equal += one
            below += two
        balance = list(zip(np.array(rays).T, load, strict=True))
        if feasible(balance, [], len(rays), 0) and feasible(equal, below, 3, None):
            found.append(modes)
    return found


def test_the_contact_modes_that_are_possible_say_whether_a_nose_gets_under() -> None:
    """All contact modes of nose, partner's palm and floor while both palms drive in: the nose gets
    under if one of them leaves the floor without the partner's corner climbing."""
    seen = set()
    for seed in range(STATES if is_soak() else 5):
        state = State(seed)
        state.slope = 0.0
        for side in (0, 1):
            closed = docking(state.body(), state.plates(), side)
            contacts, load = holding(state, side, False)
            if (
                not closed.is_possible
                or abs(closed.just_on.squeeze / closed.just_on.held - 1) < 0.01
            ):
                continue
            modes = outcomes(contacts, load)
            up = slipping(side), slipping(1 - side)
            enters = any(m[1] == "break" and m[0] == up[0] and m[2] != up[1] for m in modes)
            climbs = any(m[2] == up[1] for m in modes)
            seen.add((enters, climbs))
            if closed.just_on.works:
                assert enters or not climbs, (seed, side, modes)
            else:
                assert climbs and not enters, (seed, side, modes)
    assert len(seen) > 1


def test_the_floor_holds_the_other_corner_as_in_a_linear_program() -> None:
    for seed in range(STATES):
        state = State(seed)
        state.slope = 0.0
        for side in (0, 1):
            closed = floor_friction_to_stay(state.body(), state.plates(), side)
            stays = {}
            for share in (0.999, 1.001):
                good = True
                for p in (-state.half, 0.0):
                    pivot = state.nose[side] + state.half * math.sin(state.theta[side])
                    heights = [state.r, state.r]
                    heights[side] = (
                        pivot
                        + p * math.sin(state.theta[side])
                        + state.r * math.cos(state.theta[side])
                    )
                    centres, com = state.placed(heights)
                    own = state.touch(centres[side], side, state.theta[side], state.phi[side], True)
                    foot = state.touch(
                        centres[1 - side], 1 - side, 0.0, math.atan(share * closed), False
                    )
                    # The palm leaves from below its corner, which slips inward on it.
                    rays = own.rays(slipping(1 - side)) + foot.rays("stick")
                    good &= linprog(
                        np.zeros(3), A_eq=np.array(rays).T, b_eq=state.load(com), bounds=(0, None)
                    ).success
                stays[share] = good
            assert stays == {0.999: False, 1.001: True}, (seed, side, closed)


def test_the_least_angle_of_a_partner_is_where_it_just_holds() -> None:
    for seed in range(20):
        state = State(seed)
        state.slope = 0.0
        for side in (0, 1):
            angle = least_partner_angle(state.body(), state.plates(), side)
            psi = state.first_lean(side)
            if psi + state.phi[side] >= math.pi / 2 or angle <= 1e-6:
                continue
            centres, com = state.placed([state.r, state.r])
            own = state.touch(centres[side], side, psi, state.phi[side], True)
            holds = []
            for more in (-0.01, 0.01):
                other = state.touch(
                    centres[1 - side], 1 - side, angle + more, state.phi[1 - side], True
                )
                rays = own.rays(slipping(side)) + other.rays("stick")
                holds.append(
                    linprog(
                        np.zeros(3), A_eq=np.array(rays).T, b_eq=state.load(com), bounds=(0, None)
                    ).success
                )
            assert holds == [False, True], (seed, side)


def dock(keys: dict[str, Any]) -> Docking:
    from palmbots.mechanics.lifting_bodies import plate_on_floor, standing
    from palmbots.scene.spec import to_spec

    spec = to_spec(pb.load_scene("lift", keys))
    left, right = (plate_on_floor(palm, palm.steep) for palm in spec.palms)
    return docking(standing(spec, 1.0), (left, right), 1)


@pytest.mark.parametrize(("nose_m", "friction"), [(0.0006, 0.3), (0.0008, 0.3), (0.0007, 0.2)])
def test_the_exact_world_jams_and_lifts_as_the_closed_forms_say(
    nose_m: float, friction: float
) -> None:
    """The left palm has the thinner nose, and therefore is under the object first."""
    keys = {
        "palm.nose_m": nose_m,
        "palm.left.nose_m": 5e-5,
        "palm.bevel_m": 0.02,
        "palm.friction": friction,
    }
    low, high = 0.0, 0.003
    for _ in range(40):
        middle = 0.5 * (low + high)
        may = dock(keys | {"palm.heel_m": middle}).may_get_under
        low, high = (low, middle) if may else (middle, high)
    for heel, works in ((0.0, False), (0.9 * high, False), (0.003, True), (0.012, True)):
        assert dock(keys | {"palm.heel_m": heel}).gets_under == works
        world = FloorWorld("lift", overrides=keys | {"palm.heel_m": heel}, floor_friction=0.3)
        state = world.move(0.012, -0.012)
        assert on_palm(state, "left") and not on_palm(state, "right")
        for _ in range(150):
            if state.end or not on_palm(state, "left") or on_palm(state, "right"):
                break
            state = world.move(0.002, -0.002)
        gets_under = not state.end and on_palm(state, "left") and on_palm(state, "right")
        assert gets_under == works, (heel, state)


def on_palm(state: FloorState, side: Side) -> bool:
    """Whether the centre of an arc is above the top of its palm, between nose and outer end."""
    sense = -1 if side == "left" else 1
    turn, theta = math.radians(state.tilt_deg), math.radians(state.palms_deg[side])
    x, y = sense * 0.122, -0.037
    pivot = state.pivots_m[side]
    across = state.com_m[0] + x * math.cos(turn) - y * math.sin(turn) - pivot[0]
    up = state.com_m[1] + x * math.sin(turn) + y * math.cos(turn) - pivot[1]
    along = sense * across * math.cos(theta) + up * math.sin(theta)
    return state.touched_m[side] is not None and -0.0745 < along < 0.075
