# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots check`."""

from pathlib import Path
from typing import Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import load, print_result
from palmbots.cli.options import DONE, FAILED, JsonOption, input_argument


@command(
    order=50,
    example="palmbots check box.json",
    results=("palmbots.stability.certificates.checker.verify:CheckResult",),
)
def check(
    certificate: Annotated[Path, input_argument("CERTIFICATE", "JSON file of palmbots certify.")],
    scene: Annotated[
        str | None,
        typer.Option("--scene", metavar="SCENE", help="Require that the box contains this scene."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Verify a certificate independently of the prover.

    The checker shares no code with the prover and computes in exact arithmetic.

    Exit status 1: the certificate does not prove its claim.
    """
    from palmbots.stability.certificates.checker.verify import check as verify

    result = verify(certificate, None if scene is None else load(scene, None))
    print_result(result, as_json=as_json, about=str(certificate))
    return DONE if result.valid else FAILED
