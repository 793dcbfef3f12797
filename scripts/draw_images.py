#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Redraw the images of the docs (docs/images).

Run it with the tree's own Python, after `make build`: .venv/bin/python scripts/draw_images.py
To redraw only some of them, append their names. All of them take some minutes.

`COMMANDS` states the command that draws each picture. The pages show the same commands; a test
compares them.
"""

import os
import shlex
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from PIL import Image

import palmbots as pb

_EXACT = 128  # number of colours that stay as they are

IMAGES = Path(__file__).parent.parent / "docs" / "images"

COMMANDS: Mapping[str, Mapping[str, str]] = {
    "palmbots carry figure8 --out out": {
        "figure8.gif": "out/carry.gif",
        "figure8.png": "out/carry.png",
    },
    "palmbots compare --out out": {"compare.png": "out/compare.png"},
    "palmbots compare --sweep radio.loss --values 0,0.01,0.05,0.1,0.2,0.4 --out out": {
        "losses.png": "out/compare.png"
    },
    "palmbots compare --controllers centralized,distributed,resilient,shared-sign,silent "
    "--sweep radio.loss --values 0,0.01,0.02,0.03,0.05,0.1,0.2,0.3 --set robot.noise_m_s=0.02 "
    "-n 4000 --out out": {"small-radios.png": "out/compare.png"},
    "palmbots analyze --out out": {
        "figure5.png": "out/figure5.png",
        "figure6.png": "out/figure6.png",
    },
    "palmbots analyze lift --out out": {"lifting-forces.png": "out/lifting-forces.png"},
    "palmbots carry lift --out out": {"lifting-phases.png": "out/phases.png"},
    "palmbots carry stand --out out": {"stand-phases.png": "out/phases.png"},
    "palmbots carry lone --out out": {"lone-phases.png": "out/phases.png"},
    "palmbots carry handover --out out": {"handover-phases.png": "out/phases.png"},
    "palmbots noise-limit --out out": {"noise_limit.png": "out/noise_limit.png"},
    "palmbots bound --out out": {"bound.png": "out/bound.png"},
    "palmbots design --out out": {"design.png": "out/design.png"},
    "palmbots design --maximize com --friction 0.3 0.5 --common-friction --region palm --out out": {
        "design-com.png": "out/design.png"
    },
    "palmbots study centralized-vs-distributed --plot": {
        "centralized-vs-distributed.png": "centralized-vs-distributed.study/study.png"
    },
    "palmbots study silent-map --plot": {"silent-map.png": "silent-map.study/study.png"},
    "palmbots study what-matters --plot": {"what-matters.png": "what-matters.study/study.png"},
    "palmbots carry --world mujoco --set task.path.kind=s --set task.path.radius_m=1 "
    "--set task.distance_m=2.27 --out out": {"curve-plan.png": "out/plan.png"},
    "palmbots carry around-wall -c shared-sign --world mujoco --animation none --out out": {
        "route.png": "out/route.png"
    },
    "palmbots validate --out out": {"validation.png": "out/validation.png"},
    "palmbots speed-limits --out out": {"speed.png": "out/speed.png"},
}
"""The files that a command writes, by the name of the picture."""

CIRCLE = {
    "task.path.kind": "arc",
    "task.path.radius_m": 1.0,
    "task.distance_m": 1.5,
    "palm.lip_height_m": 0.03,
    "palm.lip_clearance_m": 0.01,
}
"""The scene of curve-3d.png."""
CIRCLE_TIME_S = 15.0


def task(path: Path) -> None:
    """The labelled picture of the task."""
    import draw_task  # here: the tests read the names of the pictures, and draw none

    draw_task.draw(path)


def noise(path: Path) -> None:
    """Drop rates over the noise, from the results of benchmarks/bench_noise.py."""
    import draw_noise

    draw_noise.draw(path)


def recorded(path: Path) -> None:
    """Drop rates with recorded robots and radios, from benchmarks/bench_recorded.py."""
    import draw_recorded

    draw_recorded.draw(path)


def probed_angles(path: Path) -> None:
    """Drop rates with palm angles from probes, from benchmarks/bench_probes.py."""
    import draw_probed_angles

    draw_probed_angles.draw(path)


def squeeze(path: Path) -> None:
    """The intervals of squeezes that the contacts allow."""
    import draw_squeeze

    draw_squeeze.draw(path)


def contacts(path: Path) -> None:
    """The kinds of contact."""
    import draw_contacts

    draw_contacts.draw(path)


def carry_3d(path: Path) -> None:
    """The still of `palmbots carry --world mujoco --video`, without the video."""
    from palmbots.mujoco import save_still

    save_still(pb.carry("paper", world="mujoco"), path)


def curve_3d(path: Path) -> None:
    """A moment on a circle, palms with lips."""
    from palmbots.mujoco import save_still

    carry = pb.carry("paper", world="mujoco", overrides=CIRCLE)
    assert carry.trace is not None
    save_still(carry, path, row=int(np.searchsorted(carry.trace["time"], CIRCLE_TIME_S)))


def design_law(path: Path) -> None:
    """The design law beside the optimum."""
    from palmbots.optimum import compare_with_law

    compare_with_law().save_figure(path)


FUNCTIONS: Mapping[str, Callable[[Path], None]] = {
    "contacts.png": contacts,
    "design-law.png": design_law,
    "noise.png": noise,
    "probed-angles.png": probed_angles,
    "recorded.png": recorded,
    "squeeze.png": squeeze,
    "task.png": task,
    "carry-3d.png": carry_3d,
    "curve-3d.png": curve_3d,
}
"""Functions that write a picture, by its name."""


def keep(name: str, drawn: Path) -> None:
    """Put a picture into the docs; a PNG of a drawing gets at most 256 colours."""
    target = IMAGES / name
    if target.suffix != ".png":
        target.write_bytes(drawn.read_bytes())
        return
    with Image.open(drawn) as image:
        picture = image.convert("RGB")
    is_render = name.endswith("-3d.png")  # its shades need all colours
    (picture if is_render else with_few_colours(picture)).save(target, optimize=True)


def with_few_colours(picture: Image.Image) -> Image.Image:
    """The picture with a palette, which takes a third of the space.

    The most frequent colours are kept exactly. Blended colours at the edges of lines are replaced
    by the nearest colour of the palette.
    """
    pixels = np.asarray(picture)
    colours, where, counts = np.unique(
        pixels.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True
    )
    plain = colours[np.argsort(counts)[::-1]].astype(int)
    palette = list(plain[:_EXACT])
    apart = np.min([np.abs(plain - one).max(axis=1) for one in palette], axis=0)
    while len(palette) < 256 and apart.max() > 0:  # the colour that is farthest from all of them
        palette.append(plain[int(np.argmax(apart))])
        apart = np.minimum(apart, np.abs(plain - palette[-1]).max(axis=1))
    distances = np.abs(colours[:, None].astype(int) - np.array(palette)).max(axis=2)
    numbers = distances.argmin(axis=1)[where.reshape(-1)].reshape(pixels.shape[:2])
    few = Image.fromarray(numbers.astype(np.uint8))
    few.putpalette(np.array(palette, np.uint8).tobytes())
    return few


def main(names: list[str]) -> int:
    """Draw the named pictures, or all if none is named."""
    from palmbots.cli import main as cli

    every = {*FUNCTIONS, *(name for written in COMMANDS.values() for name in written)}
    unknown = set(names) - every
    if unknown:
        print(f"{', '.join(sorted(unknown))}: not a picture; allowed: {', '.join(sorted(every))}")
        return 2
    wanted = set(names) or every
    for name in sorted(wanted & set(FUNCTIONS)):
        with tempfile.TemporaryDirectory() as folder:
            FUNCTIONS[name](Path(folder) / name)
            keep(name, Path(folder) / name)
    for command, written in COMMANDS.items():
        if not wanted & set(written):
            continue
        print(f"$ {command}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            if cli.run(shlex.split(command)[1:]) == cli.BAD_INPUT:
                return 2
            for name in sorted(wanted & set(written)):
                keep(name, Path(folder, written[name]))
            os.chdir(IMAGES)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
