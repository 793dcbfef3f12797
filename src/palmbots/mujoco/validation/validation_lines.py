# SPDX-License-Identifier: Apache-2.0
"""What people read of a comparison of both worlds."""

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from palmbots._util.optional_imports import install_command
from palmbots._util.report import Item, Line, Table, bold, quiet, verdict
from palmbots._util.text import plural

if TYPE_CHECKING:
    from palmbots.mujoco.validation.validation import Validation


def validation_lines(validation: "Validation") -> Iterator[Item]:
    """How well the MuJoCo world agrees with the quasistatic one."""
    own = validation.own
    n = sum(one.decisive_n for one in own)
    rate = sum(one.decisive_rate * one.decisive_n for one in own) / max(1, n)
    share = f"  {100 * rate:.1f} % of {n} states with a margin above 1°"
    yield Line(verdict(validation.holds, "AGREES", "DIFFERS"), bold(share))
    yield from _agreement(validation)
    creep = max(map(abs, validation.creep_m))
    yield f"a sticking contact drifts {1e3 * creep:.2f} mm in 25 s at 5° and 15°"
    errors = [
        abs(line.seen_m - line.known_m)
        for line in validation.switch_lines
        if line.seen_m is not None and line.known_m is not None
    ]
    if errors:
        yield f"switch lines agree within {1e3 * max(errors):.1f} mm of COM"
    error = max(
        abs(seen - known)
        for t in validation.tilts
        for seen, known in zip(t.seen_m, t.known_m, strict=True)
    )
    yield f"displacements caused by a tilt agree within {1e3 * error:.1f} mm"
    yield from _paired_carries(validation)


def _agreement(validation: "Validation") -> Iterator[Item]:
    heads = ("margin > 1°", "95 % interval", "all states")
    rows = []
    for one in validation.agreement:
        low, high = one.decisive_interval
        rows.append((
            f"{one.engine}, {one.contacts}",
            f"{100 * one.decisive_rate:.1f} % of {one.decisive_n}",
            f"{100 * low:.1f} to {100 * high:.1f} %",
            f"{100 * one.rate:.1f} % of {one.n}",
        ))  # fmt: skip
    yield Table(rows, ("which contact slides", *heads), right=heads)
    for one in validation.agreement:
        causes = Counter(
            t.cause
            for t in validation.differences
            if (t.engine, t.contacts) == (one.engine, one.contacts)
        )
        for cause, n in sorted(causes.items(), key=str):
            yield quiet(f"  {one.engine}, {one.contacts}: {plural(n, 'difference')}: {cause}")
    if validation.missing:
        missing = ", ".join(validation.missing)
        yield quiet(f"  not installed: {missing} (run: {install_command('bench')})")


def _paired_carries(validation: "Validation") -> Iterator[Item]:
    carries, both = validation.carries, (0, 1)
    n = len(carries)
    delivered = [sum(one.outcome[k] == "delivered" for one in carries) for k in both]
    rms = [1e3 * sum(one.rms_m[k] for one in carries) / n for k in both]
    corrections = [sum(one.corrections[k] for one in carries) / n for k in both]
    peaks = [1e3 * max(one.peak_m[k] for one in carries) for k in both]
    heads = ("quasistatic", "mujoco")
    rows = [
        ("delivered", *map(str, delivered)),
        ("contact rms, mean [mm]", *(f"{one:.1f}" for one in rms)),
        ("corrections, mean", *(f"{one:.1f}" for one in corrections)),
        ("contact peak, largest [mm]", *(f"{one:.1f}" for one in peaks)),
    ]
    yield Table(rows, (f"{plural(n, 'carry')} paired by seed", *heads), right=heads)
    delivery = validation.delivery
    low, high = delivery.interval
    yield (
        f"delivered: mujoco {100 * low:.0f} to {100 * high:.0f} % (95 %), quasistatic "
        f"{100 * delivery.known:.1f} %"
    )
    if different := sum(one.outcome[0] != one.outcome[1] for one in carries):
        yield quiet(f"  {plural(different, 'pair')} with different outcomes")
