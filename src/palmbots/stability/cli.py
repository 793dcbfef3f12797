"""The commands that know before a carry: `palmbots analyze`, `certify`, `check`."""

import json
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from palmbots.cli_options import DONE, FAILED, JsonOption, SceneArgument, SetOption, app, scene_of

__all__ = ["analyze", "certify", "check"]


@app.command(epilog="Example: palmbots analyze --set palm.friction=0.4 --figures out")
def analyze(
    scene: SceneArgument = "paper",
    figures: Annotated[
        Path | None, typer.Option("--figures", metavar="DIR", help="Draw Figures 2 to 7 there.")
    ] = None,
    kind: Annotated[str, typer.Option("--format", help="png, svg or pdf.")] = "png",
    region_m: Annotated[
        tuple[float, float] | None,
        typer.Option("--region-m", metavar="LOW HIGH", help="Contacts [default: whole palms]."),
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Say whether the two properties hold, by how much, and what would break them."""
    from palmbots.carry import one_of
    from palmbots.stability.analysis import analyze as run_analysis
    from palmbots.stability.report import analysis_report

    one_of("--format", kind, ("png", "svg", "pdf"))
    found = run_analysis(scene_of(scene, changes), region_m=region_m)
    written: list[Path] = []
    if figures is not None:
        from palmbots.files import folder
        from palmbots.stability.figures import save_all

        written = save_all(found, folder(figures), cast("Any", kind))
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
    slope: Annotated[Interval, _interval("--slope", "Tangent of the floor's slope")] = None,
    region_m: Annotated[Interval, _interval("--region-m", "Contacts, within the palms")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the certificate.")
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
        slope=slope,
        region_m=region_m,
    )
    written: list[Path] = []
    if out is not None and found.verdict != "undecided":
        found.save(out)
        written.append(out)
    if as_json:
        print(json.dumps(found.data | {"parts": found.parts}, allow_nan=False))
    else:
        certificate_report(found, written)
    return DONE if found.verdict == "holds" else FAILED


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
