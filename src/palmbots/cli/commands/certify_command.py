# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots certify`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import load, print_result, set_aside_certificate
from palmbots.cli.options import (
    DONE,
    FAILED,
    JsonOption,
    SceneArgument,
    SetOption,
    interval_option,
    output_option,
)

Interval = tuple[float, float] | None


@command(
    order=40,
    example="palmbots certify --com-x-m -0.01 0.01 --friction 0.25 0.35 -o box.json",
    results=("palmbots.stability.certificates.prover:Certificate",),
)
def certify(
    scene: SceneArgument = "paper",
    com_x_m: Annotated[
        Interval, interval_option("--com-x-m", "Position of the COM along the object")
    ] = None,
    com_y_m: Annotated[
        Interval, interval_option("--com-y-m", "Height of the COM above the contacts")
    ] = None,
    friction: Annotated[Interval, interval_option("--friction", "Friction coefficient")] = None,
    friction_right: Annotated[
        Interval,
        interval_option("--friction-right", "Friction coefficient of the right palm"),
    ] = None,
    common_friction: Annotated[
        bool,
        typer.Option(
            "--common-friction/--independent-friction",
            help="Use one friction for both palms, or one for each [default: one for each].",
            show_default=False,
        ),
    ] = False,
    shallow_deg: Annotated[Interval, interval_option("--shallow-deg", "Shallow angle")] = None,
    steep_deg: Annotated[Interval, interval_option("--steep-deg", "Steep angle")] = None,
    width_m: Annotated[
        Interval, interval_option("--width-m", "Distance between the contact vertices")
    ] = None,
    length_m: Annotated[Interval, interval_option("--length-m", "Length of the palms")] = None,
    offset_m: Annotated[
        Interval, interval_option("--offset-m", "Pivot offset of the palms")
    ] = None,
    slope_deg: Annotated[
        Interval, interval_option("--slope-deg", "Slope of the floor, uphill > 0")
    ] = None,
    region_m: Annotated[
        Interval, interval_option("--region-m", "Contact coordinates, within the palms")
    ] = None,
    beyond_m: Annotated[
        float,
        typer.Option(
            "--beyond-m",
            metavar="M",
            help="How far past p = 0 corrections continue [default: 0].",
            show_default=False,
        ),
    ] = 0.0,
    claims: Annotated[
        str | None,
        typer.Option(
            "--claims",
            metavar="NAME,…",
            help="Prove these claims: property 1, property 2, property 0, clearance, property 0 "
            "turning, clearance turning, no jam [default: all].",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        output_option("Write the certificate to this file.", "--out", "-o", metavar="FILE"),
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Prove the properties for all scenes in given intervals.

    Exit status 1: the properties fail somewhere, or the prover could not decide.
    """
    from palmbots._util.atomic_files import check_file
    from palmbots.stability.certificates.prover import certify as run_proof

    if out is not None:
        check_file(out)
    result = run_proof(
        load(scene, changes),
        claims=None if claims is None else tuple(name.strip() for name in claims.split(",")),
        com_x_m=com_x_m,
        com_y_m=com_y_m,
        friction=friction,
        friction_right=friction_right,
        common_friction=common_friction,
        shallow_deg=shallow_deg,
        steep_deg=steep_deg,
        width_m=width_m,
        length_m=length_m,
        offset_m=offset_m,
        slope_deg=slope_deg,
        region_m=region_m,
        beyond_m=beyond_m,
    )
    written: list[Path] = []
    if out is not None and result.verdict != "undecided":
        result.save(out)
        written.append(out)
    elif out is not None:
        set_aside_certificate(out)
    print_result(result, as_json=as_json, written=written)
    return DONE if result.verdict == "holds" else FAILED
