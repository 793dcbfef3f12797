"""The commands that know before a carry: `palmbots analyze`, `certify`, `check`, `design`."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from palmbots.cli_options import (
    DONE,
    FAILED,
    JsonOption,
    SceneArgument,
    SetOption,
    app,
    path_given,
    scene_of,
)

__all__ = ["analyze", "certify", "check", "design"]


@app.command(epilog="Example: palmbots analyze --set palm.friction=0.4 --figures out")
def analyze(
    scene: SceneArgument = "paper",
    figures: Annotated[
        Path | None,
        typer.Option(
            "--figures", parser=path_given, metavar="DIR", help="Draw Figures 2 to 7 there."
        ),
    ] = None,
    kind: Annotated[str, typer.Option("--format", help="png, svg or pdf.")] = "png",
    region_m: Annotated[
        tuple[float, float] | None,
        typer.Option("--region-m", metavar="LOW HIGH", help="Contacts [default: whole palms]."),
    ] = None,
    p_left_m: Annotated[
        float | None, typer.Option(help="Contact of the state drawn in Figures 2 to 4.")
    ] = None,
    p_right_m: Annotated[float | None, typer.Option(help="Likewise, on the right palm.")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Say whether the two properties hold, and by how much. And what would break them."""
    from palmbots.errors import PalmbotsError, one_of
    from palmbots.files import check_folder
    from palmbots.stability.analysis import analyze as run_analysis
    from palmbots.stability.report import analysis_report

    one_of("--format", kind, ("png", "svg", "pdf"))
    chosen = None
    if p_left_m is not None or p_right_m is not None:
        chosen = p_left_m or 0.0, p_right_m or 0.0
        if figures is None:
            raise PalmbotsError(
                "--p-left-m, --p-right-m: choose the state that is drawn; allowed: with --figures"
            )
    if figures is not None:
        check_folder(figures)
    found = run_analysis(scene_of(scene, changes), region_m=region_m)
    written: list[Path] = []
    if figures is not None:
        from palmbots.stability.figures import save_all

        written = save_all(found, figures, cast("Any", kind), chosen)
    if as_json:
        print(json.dumps(found.summary(), allow_nan=False))
    else:
        analysis_report(found, scene, written)
    return DONE


Interval = tuple[float, float] | None


def _interval(name: str, told: str) -> Any:
    return typer.Option(name, metavar="LOW HIGH", help=f"{told} [default: as in the scene].")


@app.command(epilog="Example: palmbots certify --com-x-m 0.12 0.13 --friction 0.3 0.35 -o box.json")
def certify(
    scene: SceneArgument = "paper",
    com_x_m: Annotated[Interval, _interval("--com-x-m", "COM along the object")] = None,
    com_y_m: Annotated[Interval, _interval("--com-y-m", "COM above the contacts")] = None,
    friction: Annotated[Interval, _interval("--friction", "Friction, each palm its own")] = None,
    friction_right: Annotated[
        Interval, _interval("--friction-right", "The right palm's, where it differs")
    ] = None,
    common: Annotated[
        bool, typer.Option("--common", help="Both palms have the same friction.")
    ] = False,
    shallow_deg: Annotated[Interval, _interval("--shallow-deg", "Shallow angle")] = None,
    steep_deg: Annotated[Interval, _interval("--steep-deg", "Steep angle")] = None,
    width_m: Annotated[Interval, _interval("--width-m", "Distance of the contact vertices")] = None,
    length_m: Annotated[Interval, _interval("--length-m", "Length of the palms")] = None,
    offset_m: Annotated[Interval, _interval("--offset-m", "Pivot offset of the palms")] = None,
    slope: Annotated[Interval, _interval("--slope", "Tangent of the floor's slope")] = None,
    region_m: Annotated[Interval, _interval("--region-m", "Contacts, within the palms")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", parser=path_given, metavar="FILE", help="Write the certificate."
        ),
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Prove the properties for a box of uncertainty. Exit status 1: they fail, or undecided."""
    from palmbots.stability.certificate import certify as run_proof
    from palmbots.stability.report import certificate_report

    found = run_proof(
        scene_of(scene, changes),
        com_x_m=com_x_m,
        com_y_m=com_y_m,
        friction=friction,
        friction_right=friction_right,
        common=common,
        shallow_deg=shallow_deg,
        steep_deg=steep_deg,
        width_m=width_m,
        length_m=length_m,
        offset_m=offset_m,
        slope=slope,
        region_m=region_m,
    )
    written: list[Path] = []
    if out is not None and found.verdict != "undecided":
        found.save(out)
        written.append(out)
    elif out is not None:
        _set_aside(out)
    if as_json:
        print(json.dumps(found.data | {"parts": found.parts}, allow_nan=False))
    else:
        certificate_report(found, written)
    return DONE if found.verdict == "holds" else FAILED


def _set_aside(certificate: Path) -> None:
    """An older certificate there would pass for what could not be proved now."""
    from palmbots.files import set_aside

    kept = set_aside(certificate)
    if kept is not None:
        print(
            f"palmbots: warning: nothing is proved, and {certificate} was of an earlier run: "
            f"it is {kept} now",
            file=sys.stderr,
        )


@app.command(epilog="Example: palmbots check box.json")
def check(
    certificate: Annotated[Path, typer.Argument(metavar="CERTIFICATE", help="A JSON file.")],
    as_json: JsonOption = False,
) -> int:
    """Verify a certificate with exact rationals. Exit status 1: it proves nothing."""
    from palmbots.check import check as verify
    from palmbots.stability.report import check_report

    found = verify(certificate)
    if as_json:
        print(json.dumps(found.summary(), allow_nan=False))
    else:
        check_report(found, certificate)
    return DONE if found.valid else FAILED


@app.command(epilog="Example: palmbots design --friction 0.3 0.5 --region palm --out out")
def design(
    scene: SceneArgument = "paper",
    maximize: Annotated[
        str,
        typer.Option("--maximize", help="com, friction, slope, acceleration, region or angle."),
    ] = "com",
    friction: Annotated[Interval, _interval("--friction", "Friction of both palms")] = None,
    each: Annotated[
        bool, typer.Option("--each", help="Each palm its own friction, not a common one.")
    ] = False,
    com_y_m: Annotated[Interval, _interval("--com-y-m", "COM above the contacts")] = None,
    slope: Annotated[Interval, _interval("--slope", "Tangent of the floor's slope")] = None,
    region: Annotated[
        str,
        typer.Option(
            "--region",
            metavar="implied|palm|LOW,HIGH",
            help="Contacts it has to hold for: what the scene implies, the whole palm, or metres.",
        ),
    ] = "implied",
    least_difference_deg: Annotated[
        float, typer.Option(help="Least difference of the two angles.")
    ] = 5.0,
    least_clearance_deg: Annotated[
        float, typer.Option(help="Least clearance of the outline.")
    ] = 0.25,
    angles_deg: Annotated[
        tuple[float, float], typer.Option(metavar="LOW HIGH", help="Limits of both angles.")
    ] = (-5.0, 50.0),
    resolution_deg: Annotated[
        float | None, typer.Option(help="Of the grid [default: 0.1 for com, else 0.5].")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            parser=path_given,
            metavar="DIR",
            help="Write design.png, design.json (certificate).",
        ),
    ] = None,
    kind: Annotated[str, typer.Option("--format", help="png, svg or pdf.")] = "png",
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Find the palm angles that tolerate most, with a certificate."""
    from palmbots.errors import one_of
    from palmbots.files import check_folder
    from palmbots.stability.design import design as run_design
    from palmbots.stability.report import design_report

    one_of("--format", kind, ("png", "svg", "pdf"))
    if out is not None:
        check_folder(out)
    where: Any = region if region in ("implied", "palm") else _pair("--region", region)
    found = run_design(
        scene_of(scene, changes),
        maximize=maximize,
        friction=friction,
        common=not each,
        com_y_m=com_y_m,
        slope=slope,
        region_m=where,
        least_difference_deg=least_difference_deg,
        least_clearance_deg=least_clearance_deg,
        angles_deg=angles_deg,
        resolution_deg=resolution_deg,
    )
    written: list[Path] = []
    if out is not None:
        from palmbots.files import folder
        from palmbots.stability.design_figure import save

        target = folder(out)
        written.append(target / f"design.{kind}")
        save(found, written[0])
        if found.certificate.verdict == "holds":
            written.append(target / "design.json")
            found.certificate.save(written[1])
        else:
            _set_aside(target / "design.json")
    if as_json:
        print(json.dumps(found.summary(), allow_nan=False))
    else:
        design_report(found, scene, written)
    return DONE


def _pair(option: str, text: str) -> tuple[float, float]:
    from palmbots.errors import PalmbotsError, show

    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: implied, palm, or two numbers in m with a "
            "comma between, as in -0.05,0.05"
        ) from None
    return low, high
