# SPDX-License-Identifier: Apache-2.0
"""Each claim about forces, certified alone, is true at random points of its box."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from claims_oracle import CLAIMS, States, failing, random_box, sampled
from palmbots.errors import PalmbotsError
from palmbots.mechanics.contact_modes import contact_modes_batch
from palmbots.stability.certificates.prover import certify
from sampled import in_soak

JAMMED = -2
# Palms like a Λ, and a tall object that is held at a tilt, with its COM beyond the right contact.
LAMBDA: dict[str, Any] = {
    "object": {"box_m": [0.25, 0.4], "com_m": [0.2, 0.25], "mass_kg": 0.3},
    "palm": {"shallow_deg": -25.0, "steep_deg": -22.0, "friction": 1.5},
}


@pytest.mark.slow
@pytest.mark.parametrize("claim", CLAIMS)
@pytest.mark.parametrize(
    ("radius_m", "boxes", "states"),
    [(0, 12, 500), (0.024, 25, 500), in_soak(0, 400, 100_000), in_soak(0.024, 400, 100_000)],
)
def test_claim_alone_is_true_where_it_is_certified(
    claim: str, radius_m: float, boxes: int, states: int
) -> None:
    """And it certainly fails at many points of boxes for which it is not certified."""
    rng = np.random.default_rng(CLAIMS.index(claim))
    verdicts: Counter[str] = Counter()
    seen = false = 0
    for _ in range(boxes):
        radii = (radius_m * rng.random(), radius_m * rng.random()) if radius_m else (0.0, 0.0)
        scene, given = random_box(rng, radii)
        try:
            found = certify(scene, claims=(claim,), max_boxes=60, **given)
        except PalmbotsError:  # the object cannot span its contacts, or is no valid scene
            continue
        verdicts[found.verdict] += 1
        box = json.loads(json.dumps(found.data["box"]))
        for points, shallow in sampled(claim, box, rng, max(20, 10 * states // boxes)):
            wrong = failing(claim, points.touching(radii), shallow)
            if found.verdict == "holds":
                seen += wrong.size
                assert not wrong.any(), (scene, given)
            else:
                false += int(np.count_nonzero(wrong))
    assert seen >= states, verdicts
    assert not (radius_m and verdicts["fails"])
    assert false > 0 or claim == "no jam", verdicts  # few of its boxes jam anywhere


def test_com_beyond_a_contact_jams_and_is_no_certificate(tmp_path: Path) -> None:
    """No edge is wedged, but on closing no contact slides: by the modes, and by the program."""
    theta, p, mu = np.radians([[-25.0], [-25.0]]), np.array([[-0.075], [0.075]]), [1.5]
    modes = contact_modes_batch(
        width=0.25, com_x=0.2, com_y=0.25, theta_left=theta[0], theta_right=theta[1], p_left=p[0],
        p_right=p[1], friction_left=mu, friction_right=mu, offset_left=0.0, offset_right=0.0,
        slope=0.0,
    )  # fmt: skip
    assert modes.feasible[0, 0] and modes.closing[0] == JAMMED != modes.opening[0]
    one = np.ones((2, 1))
    state = States(
        np.array([0.25]), np.array([[0.2], [0.25]]), theta, p, 1.5 * one, 0 * one, np.zeros(1)
    )
    assert failing("no jam", state, 0).all() and not failing("property 0 turning", state, 0).any()
    tilt = math.asin(0.15 * math.sin(theta[1, 0]) / 0.25)
    assert 0.2 * math.cos(tilt) - 0.25 * math.sin(tilt) > 0.25 * math.cos(tilt)  # beyond the right

    found = certify(LAMBDA, claims=("no jam",))
    assert found.verdict == "fails" and found.data["witness"]["fails"] == "lift_left"
    assert "the COM lies beyond the right contact" in repr(found)
    path = tmp_path / "jam.json"
    path.write_text(json.dumps(found.data))
    assert pb.check(path).valid
    forged = found.data | {"verdict": "holds", "proof": dict.fromkeys(PROOFS, "corners")}
    del forged["witness"]
    path.write_text(json.dumps(forged))
    refused = pb.check(path)
    assert not refused.valid
    assert refused.reason == "jam closing: the COM may lie beyond a contact"


PROOFS = ("jam closing", "jam opening")
