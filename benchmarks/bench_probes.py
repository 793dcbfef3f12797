#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What probes are worth: carries with the default palm angles and with chosen ones.

    .venv/bin/python benchmarks/bench_probes.py [OBJECTS [new]]     100 of each kind by default

The objects are the random ones of tests/support/probed.py. Kinds: both palms have one coefficient
of friction (`--common-friction`) or two different ones, and the prior of friction is the default
one, or 0.1 wide (`palmbots probe --friction`). The prior of the COM is the default one.

Palm angles are chosen from what is known of the object: the prior, the set that `palmbots probe`
leaves (probed), or the object itself (known), which is the most that any probe could be worth. They
are chosen in two ways:

    certificate   by `palmbots design --from`; often no pair of angles has a certificate. Only for
                  the first 17 objects
    carries       the pair of a grid that drops the fewest of some objects of the set, in carries
                  with 3 cm/s of noise; those of the prior are the same ones for all objects

An object takes 20 s of processor time, or a minute with certificates: where angles have one,
`palmbots design` carries for 10 s. A probe takes 3 s, and the grid 1 s.

A row is one object, one choice and one noise; where there is no pair of angles, it has no carries,
and the robots keep the default ones. Some objects are carried in MuJoCo, too, with the same angles.
Writes benchmarks/results/probes.csv after each row and continues where it was stopped; `new` starts
from the beginning.
"""

import math
import sys
import tempfile
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

import palmbots as pb
from _cells import Cells
from palmbots.errors import PalmbotsError
from palmbots.probing.object_set import ObjectSet, Prior
from palmbots.probing.probe import write_probe
from palmbots.simulation import count_outcomes
from palmbots.simulation.batch import DELIVERED, DROPPED, available_cores, run_batch
from palmbots.simulation.prepare import prepare

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from probed import hidden

RESULT = Path(__file__).parent / "results" / "probes.csv"
HEAD = [
    "world", "palms", "prior", "object", "known", "by", "noise_m_s",
    "shallow_deg", "steep_deg", "carries", "dropped", "stalled",
]  # fmt: skip
KINDS = (("same", "default"), ("different", "default"), ("same", "narrow"))
CHOICES = (
    ("nothing", "default"),
    *((known, by) for by in ("certificate", "carries") for known in ("prior", "probed", "known")),
)
NOISES_M_S = (0.01, 0.02, 0.03)
CARRIES = 300
CERTIFIED = 17  # objects
WIDTH, COM_X, COM_Y, FRICTION = 0.25, (0.095, 0.155), (0.03, 0.05), (0.15, 0.6)
NARROW = 0.1
DEFAULT_DEG = (5.0, 15.0)
GRID = [(a, a + d) for a in (0.0, 2.5, 5.0, 7.5) for d in (5.0, 10.0, 15.0, 20.0)]
TRIED, TRIED_SEEDS = 12, range(10_000, 10_020)  # objects of a set, and seeds of carries with each
TRIED_OF_PRIOR = 60  # of the default one, from which angles are chosen once for all objects

# In MuJoCo, where a carry takes half a second:
FEW_OBJECTS, FEW_CARRIES = 10, 10
FEW_CHOICES = (("nothing", "default"), ("prior", "carries"), ("probed", "carries"))
FEW_NOISES_M_S = (0.01, 0.03)

Keys = dict[str, Any]
Angles = tuple[float, float] | None


class Case:
    """One object on palms of one kind, and what is known of it."""

    def __init__(self, seed: int, palms: str, prior: str) -> None:
        self.seed, self.palms, self.prior = seed, palms, prior
        keys = hidden(seed)
        if palms == "same":
            keys["palm.right.friction"] = keys["palm.left.friction"]
        self.shared = {"palm.pivot_offset_m": keys.pop("palm.pivot_offset_m")}
        self.hidden = keys
        self.friction = FRICTION
        if prior == "narrow":
            low = keys["palm.left.friction"] - NARROW * np.random.default_rng(seed).uniform()
            low = min(max(low, FRICTION[0]), FRICTION[1] - NARROW)
            self.friction = (low, low + NARROW)
        self._probe: Any = None

    @property
    def truth(self) -> tuple[float, float, float]:
        """COM from the left contact, and both coefficients."""
        sides = (self.hidden[f"palm.{side}.friction"] for side in ("left", "right"))
        return self.hidden["object.com_m"][0], *sides

    def probe(self) -> Any:
        """What a probe finds."""
        if self._probe is None:
            keys = self.hidden | self.shared
            self._probe = pb.probe(
                "paper", friction=self.friction, overrides=keys, seed=self.seed
            )  # fmt: skip
            assert self._probe.contains_truth
        return self._probe

    def write(self, known: str, file: Path) -> None:
        """What is known, as the file of a probe."""
        if known == "probed":
            write_probe(self.probe(), file.parent)
            return
        x, *palms = ((one, one) for one in self.truth)
        if known == "prior":
            x, palms = COM_X, [self.friction, self.friction]
        rows = {
            "com_x_m": x,
            "com_y_m": COM_Y,
            "friction_left": palms[0],
            "friction_right": palms[1],
        }
        lines = (f"{key} = {[float(end) for end in ends]}\n" for key, ends in rows.items())
        file.write_text("[probed]\n" + "".join(lines))

    def objects(self, known: str) -> list[Keys]:
        """Random objects of those that are possible."""
        draw = np.random.default_rng(self.seed if known == "probed" else 1)
        count = TRIED_OF_PRIOR if known == "prior" and self.prior == "default" else TRIED
        if known == "known":
            x, left, right = self.truth
            cones = math.atan(left), math.atan(right)
            boxes = np.array([[[one, one] for one in (x, *cones)]])
        elif known == "probed":
            boxes = self.probe().found.boxes
        else:
            boxes = ObjectSet(Prior(WIDTH, COM_X, COM_Y, (self.friction, self.friction))).boxes
        if self.palms == "same":  # one angle of friction, in both intervals
            low = np.maximum(boxes[:, 1, 0], boxes[:, 2, 0])
            high = np.minimum(boxes[:, 1, 1], boxes[:, 2, 1])
            boxes = np.stack([boxes[:, 0], *2 * [np.stack([low, high], axis=-1)]], axis=1)
            boxes = boxes[low <= high]
        sizes = np.prod(np.maximum(np.diff(boxes)[..., 0], 1e-12), axis=1)
        chosen = boxes[draw.choice(len(boxes), count, p=sizes / sizes.sum())]
        where = draw.uniform(size=(count, 3))
        if self.palms == "same":
            where[:, 2] = where[:, 1]
        points = chosen[..., 0] + where * np.diff(chosen)[..., 0]
        return [
            {
                "object.com_m": [x, float(draw.uniform(*COM_Y))],
                "palm.left.friction": math.tan(left),
                "palm.right.friction": math.tan(right),
            }
            for x, left, right in points.tolist()
        ]


def counted(objects: Sequence[Keys], angles: Any, noise: float, seeds: range) -> tuple[int, int]:
    """How many carries of these objects are dropped and stall, each with all seeds."""
    shallow, steep = angles
    at = {"palm.shallow_deg": shallow, "palm.steep_deg": steep, "robot.noise_m_s": noise}
    specs = [prepare(pb.load_scene("paper", keys | at), "distributed").spec for keys in objects]
    index = np.repeat(np.arange(len(specs)), len(seeds))
    every = np.tile(np.array(seeds), len(specs))
    outcome = run_batch(specs, index, every, "distributed", threads=available_cores())["outcome"]
    dropped = int((outcome == DROPPED).sum())
    return dropped, len(outcome) - dropped - int((outcome == DELIVERED).sum())


def designed(case: Case, known: str) -> Angles:
    """Angles with a certificate [°]; None: no pair has one."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "probe.toml"
        case.write(known, file)
        try:
            found = pb.design(
                "paper", probe=file, common_friction=case.palms == "same", overrides=case.shared
            )  # fmt: skip
        except PalmbotsError as error:
            if "no pair of angles qualifies" not in str(error):
                raise
            return None
    return (found.shallow_deg, found.steep_deg) if found.is_certified else None


def tried(case: Case, known: str) -> Angles:
    """The angles of the grid with the fewest failures [°]."""
    objects = [one | case.shared for one in case.objects(known)]
    return min(GRID, key=lambda pair: sum(counted(objects, pair, NOISES_M_S[-1], TRIED_SEEDS)))


def main() -> None:
    """Compute the rows that the file lacks."""
    objects = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    done = Cells(RESULT, HEAD, 7)
    quasistatic(done, objects)
    in_mujoco(done, min(objects, FEW_OBJECTS))


def quasistatic(done: Cells, objects: int) -> None:
    """Choose all angles and carry with them."""
    priors: dict[Any, Angles] = {}
    for palms, prior in KINDS:
        for seed in range(objects):
            case = Case(seed, palms, prior)
            for known, by in CHOICES:
                if by == "certificate" and seed >= CERTIFIED:
                    continue
                keys = [
                    ("quasistatic", palms, prior, seed, known, by, noise) for noise in NOISES_M_S
                ]
                if prior == "narrow" and known in ("nothing", "known"):
                    # The friction is not used, so the rows are those of the default prior.
                    for key in keys:
                        twin = done.row(*key[:2], "default", *key[3:])
                        if twin is not None and done.row(*key) is None:
                            done.add(*key, *twin[7:])
                if all(done.row(*key) for key in keys):
                    continue
                choose = designed if by == "certificate" else tried
                shared = by, palms, case.friction, *case.shared.values()
                if by == "default":
                    angles: Angles = DEFAULT_DEG
                elif known == "prior":
                    if shared not in priors:
                        priors[shared] = choose(case, known)
                    angles = priors[shared]
                else:
                    angles = choose(case, known)
                for key in keys:
                    if done.row(*key) is None:
                        row: list[Any] = [""] * 5
                        if angles is not None:
                            own = [case.hidden | case.shared]
                            row = [*angles, CARRIES, *counted(own, angles, key[-1], range(CARRIES))]
                        done.add(*key, *row)


def in_mujoco(done: Cells, objects: int) -> None:
    """Carry in MuJoCo with the angles that have been chosen for palms with one friction."""
    for seed, (known, by), noise in product(range(objects), FEW_CHOICES, FEW_NOISES_M_S):
        case = Case(seed, "same", "default")
        key = "same", "default", seed, known, by, noise
        chosen = done.row("quasistatic", *key)
        if chosen is None or done.row("mujoco", *key) is not None:
            continue
        shallow, steep = map(float, chosen[7:9])
        at = {"palm.shallow_deg": shallow, "palm.steep_deg": steep, "robot.noise_m_s": noise}
        keys = case.hidden | case.shared | at
        found = count_outcomes("paper", seeds=FEW_CARRIES, world="mujoco", overrides=keys)
        row = shallow, steep, found.carries, found.dropped, found.stalled
        done.add("mujoco", *key, *row)


if __name__ == "__main__":
    main()
