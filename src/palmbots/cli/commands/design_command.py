# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots design`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._progress import progress
from palmbots.cli._run import (
    check_output,
    controller_of,
    load,
    print_result,
    set_aside_certificate,
)
from palmbots.cli._warnings import warn
from palmbots.cli.options import (
    DONE,
    FAILED,
    ControllerOption,
    FormatOption,
    JsonOption,
    SceneArgument,
    SeedOption,
    SetOption,
    UnprovedOption,
    interval_option,
    output_option,
)

Interval = tuple[float, float] | None


@command(
    order=60,
    example="palmbots design --friction 0.3 0.4 --region palm --out out",
    results=("palmbots.stability.design_result:Design",),
)
def design(
    scene: SceneArgument = "paper",
    maximize: Annotated[
        str,
        typer.Option(
            "--maximize",
            metavar="NAME",
            help="noise, or a tolerance: com, friction, slope, acceleration, region or angle.",
        ),
    ] = "noise",
    controller: ControllerOption = "distributed",
    unproved: UnprovedOption = False,
    friction: Annotated[Interval, interval_option("--friction", "Friction coefficient")] = None,
    common_friction: Annotated[
        bool,
        typer.Option(
            "--common-friction/--independent-friction",
            help="Use one friction for both palms, or one for each [default: one for each].",
            show_default=False,
        ),
    ] = False,
    com_y_m: Annotated[
        Interval, interval_option("--com-y-m", "Height of the COM above the contacts")
    ] = None,
    slope_deg: Annotated[
        Interval, interval_option("--slope-deg", "Slope of the floor, uphill > 0")
    ] = None,
    region: Annotated[
        str,
        typer.Option(
            "--region",
            metavar="implied|palm|LOW,HIGH",
            help="Contact coordinates: what the scene implies, the whole palm, or an interval [m].",
        ),
    ] = "implied",
    min_angle_difference_deg: Annotated[
        float, typer.Option(help="Smallest difference of the two angles.")
    ] = 5.0,
    min_clearance_deg: Annotated[
        float, typer.Option(help="Smallest clearance between outline and palms.")
    ] = 0.25,
    angle_range_deg: Annotated[
        tuple[float, float], typer.Option(metavar="LOW HIGH", help="Limits of both angles.")
    ] = (-5.0, 50.0),
    resolution_deg: Annotated[
        float | None,
        typer.Option(help="Spacing of the angle grid [default: 0.1 for com, otherwise 0.5]."),
    ] = None,
    seed: SeedOption = 0,
    out: Annotated[
        Path | None,
        output_option("Write design.png, design.json (certificate) and scene.toml there."),
    ] = None,
    file_format: FormatOption = "png",
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Find and certify the most noise-tolerant palm angles.

    --maximize selects the error of another quantity instead of the noise.
    """
    from palmbots._util.arguments import one_of
    from palmbots._util.report import Line
    from palmbots.stability.palm_angles import design as run_design

    one_of("--format", file_format, ("png", "svg", "pdf"))
    check_output(out)
    entry = controller_of(controller, unproved=unproved, quiet=as_json)
    with progress("designing", as_json) as report:
        result = run_design(
            load(scene, changes),
            maximize=maximize,
            controller=entry,
            friction=friction,
            common_friction=common_friction,
            com_y_m=com_y_m,
            slope_deg=slope_deg,
            region_m=_region(region),
            seed=seed,
            on_progress=report,
            min_angle_difference_deg=min_angle_difference_deg,
            min_clearance_deg=min_clearance_deg,
            angle_range_deg=angle_range_deg,
            resolution_deg=resolution_deg,
        )
    for text in result.warnings:
        warn(text)
    written: list[Path] = []
    if out is not None:
        from palmbots._util.atomic_files import folder, write_whole
        from palmbots.stability.figures.palm_angles_figure import save

        target = folder(out)
        written.append(target / f"design.{file_format}")
        save(result, written[0])
        written.append(target / "scene.toml")
        write_whole(written[1], result.designed_scene.to_toml())
        if result.certificate.verdict == "holds":
            written.append(target / "design.json")
            result.certificate.save(written[2])
        else:
            set_aside_certificate(target / "design.json")
    files = [str(path) for path in written if path.suffix == ".toml"]
    angles = (f"{key}={angle:g}" for key, angle in result.angle_keys.items())
    settings = "".join(f" --set {change}" for change in (*(changes or ()), *angles))
    following = files[0] if files else scene + settings
    hint = Line(f"to try them, run: palmbots carry {following}", is_whole=True)
    print_result(result, as_json=as_json, about=scene, written=written, after=[hint])
    return DONE if result.certificate.verdict == "holds" else FAILED


def _region(text: str) -> Any:
    """The argument ``region_m`` that an option text stands for."""
    from palmbots._util.arguments import show
    from palmbots.errors import PalmbotsError

    if text in ("implied", "palm"):
        return text
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise PalmbotsError(
            f"--region: value is {show(text)}; allowed: implied, palm, or two numbers in m "
            "separated by a comma, as in -0.05,0.05"
        ) from None
    return low, high
