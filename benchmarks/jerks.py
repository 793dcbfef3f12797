"""Why the quasistatic world is kind at high noise: what its accelerations do, tick by tick.

    .venv/bin/python benchmarks/jerks.py [SEEDS]

Carries the default scene at 4 cm/s of noise, with control periods of 20 to 2.5 ms, and with the
pair's acceleration averaged over some time before the world sees it (first order). Prints how many
arrive.
"""

import math
import sys

from palmbots import _core
from palmbots.batch import DELIVERED, run_seeds
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene

NOISE = 0.04


def seen(world: _core.World, midpoint: float, motion: tuple[int, int], end: str) -> _core.Sight:
    """The world as the robots see it."""
    return _core.Sight(
        world.contacts, world.lift, world.contacts, (True, True), world.palms, world.palms,
        world.separation, midpoint, world.span[1], motion, end,
    )  # fmt: skip


def arrives(scene: Scene, seed: int, average_s: float) -> bool:
    """One carry with averaged accelerations."""
    spec = lower(scene)
    world, midpoint, smooth = _core.World(spec), 0.0, 0.0
    share = 1 - math.exp(-scene.control.period_s / average_s)
    crew = _core.Crew(spec, "distributed", seed, seen(world, 0.0, (0, 0), world.check()))
    while not crew.done:
        _, angles, change, push, travel = crew.command()
        smooth += share * (push - smooth)
        end, part, left, right, _ = world.advance(change, angles, smooth)
        midpoint += travel * part if end else travel
        crew.observe(seen(world, midpoint, (left, right), end))
    return bool(crew.run().outcome == "delivered")


def main() -> None:
    """Carry and count."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for period in (0.02, 0.01, 0.005, 0.0025):
        scene = load_scene("paper", {"robot.noise_m_s": NOISE, "control.period_s": period})
        ends = run_seeds(lower(scene), "distributed", 0, seeds, "double")["outcome"]
        print(f"ticks of {1e3 * period:g} ms: {100 * float((ends == DELIVERED).mean()):.1f} %")
    scene = load_scene("paper", {"robot.noise_m_s": NOISE})
    for average in (0.02, 0.05, 0.1):
        share = sum(arrives(scene, seed, average) for seed in range(seeds)) / seeds
        print(f"accelerations averaged over {1e3 * average:g} ms: {100 * share:.1f} %")


if __name__ == "__main__":
    main()
