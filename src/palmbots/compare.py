"""Controllers side by side over a swept scene key: section 5.3 of the paper as one figure."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots.batch import DELIVERED, DROPPED, cores, run_seeds
from palmbots.bounds import bounds_of
from palmbots.carry import CONTROLLERS, PRECISIONS
from palmbots.errors import PalmbotsError, SceneError, one_of, seed_of, show, whole_number
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene
from palmbots.scene_at import scene_at
from palmbots.wire import PACKET_SIZE

__all__ = ["Comparison", "Row", "compare", "wilson"]

DEFAULT_SWEEP = "radio.latency_s"
DEFAULT_VALUES = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)

_Z95 = 1.959963984540054  # 97.5 % quantile of the normal distribution


Interval = tuple[float, float]
"""95 %; NaN where a single carry cannot tell."""


@dataclass(frozen=True, slots=True)
class Row:
    """One controller at one value of the swept key."""

    controller: str
    key: str
    value: float
    n: int
    """Carries."""
    drop_rate: float
    interval: Interval
    """Wilson's 95 % interval of the drop rate."""
    stall_rate: float
    stall_interval: Interval
    """Wilson's too."""
    rms_m: float
    """Root mean square of both contact coordinates; of a dropped carry until it was dropped."""
    rms_interval_m: Interval
    messages_per_m: float
    """Of all robots and the station, sent."""
    messages_interval_per_m: Interval
    bytes_per_s: float
    """What these packets are on the wire, each of 28 bytes; a radio's rate is the limit of it."""
    corrections: float
    """Mean number of corrections a carry."""


@dataclass(frozen=True)
class Comparison:
    """Rows for every controller and value, with the same seeds throughout."""

    scene: Scene
    key: str
    seed: int
    rows: tuple[Row, ...]
    refused: tuple[str, ...] = ()
    """Of the resilient algorithm, why it has no row at some values: its bounds cannot be kept."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots compare --json`` prints."""
        return {
            "rows": [
                {field: _told(getattr(row, field)) for field in Row.__slots__} for row in self.rows
            ],
            "refused": list(self.refused),
            "key": self.key,
            "seed": self.seed,
            "scene": self.scene.model_dump(),
        }


def _told(entry: Any) -> Any:
    """An entry of a row as JSON has it, null for what is not known."""
    if isinstance(entry, tuple):
        return [_told(end) for end in entry]
    return None if isinstance(entry, float) and math.isnan(entry) else entry


def compare(
    scene: Any = "paper",
    *,
    key: str = DEFAULT_SWEEP,
    values: Sequence[float] = DEFAULT_VALUES,
    controllers: Sequence[str] = CONTROLLERS,
    carries: int = 200,
    seed: int = 0,
    precision: str = "double",
    overrides: Mapping[str, Any] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Comparison:
    """Run every controller at every value of a numeric scene key, over the same seeds.

    Args:
        scene: as in `palmbots.carry`.
        key: the scene key to sweep, a number, such as ``radio.latency_s`` or ``object.com_m[0]``.
        values: what to set it to.
        controllers: which controllers.
        carries: how many for each controller and value; seeds are seed, seed + 1, …
        seed: the first seed.
        precision: ``double`` or ``float``.
        overrides: further scene keys to set.
        progress: called with the fraction that is done.

    Raises:
        SceneError: a scene cannot be read or makes no sense.
        PalmbotsError: any other argument is not one of those above.
    """
    for controller in controllers:
        one_of("controller", controller, CONTROLLERS)
    _each_once("controllers", controllers)
    one_of("precision", precision, PRECISIONS)
    carries = whole_number("carries", carries, 1, 10**8)
    seed = seed_of(seed)
    if not isinstance(key, str):
        raise SceneError(f"sweep: {show(key)} is not a key; allowed: a dotted key")
    base = load_scene(scene, overrides)
    scenes = [scene_at(base, [key], [value], called="sweep:") for value in values]
    _each_once("values", values)
    rows, refused = [], []
    cells = [(c, v, s) for c in controllers for v, s in zip(values, scenes, strict=True)]
    for i, (controller, value, at) in enumerate(cells):
        problem = _refusal(at) if controller == "resilient" else None
        if problem is None:
            rows.append(_cell(controller, key, value, at, carries, seed, precision))
        else:
            refused.append(f"{key} = {value:g}: {problem}")
        if progress is not None:
            progress((i + 1) / len(cells))
    return Comparison(scene=base, key=key, seed=seed, rows=tuple(rows), refused=tuple(refused))


def _refusal(scene: Scene) -> str | None:
    try:
        bounds_of(scene)
    except SceneError as error:
        return str(error)
    return None


def _each_once(what: str, given: Sequence[object]) -> None:
    """Raise `PalmbotsError` for nothing at all, or for the same thing twice."""
    if len(given) == 0:
        raise PalmbotsError(f"{what}: none given; allowed: at least one")
    for i, one in enumerate(given):
        if one in given[:i]:
            raise PalmbotsError(f"{what}: {show(one)} is given twice; allowed: each one once")


def _cell(
    controller: str, key: str, value: float, scene: Scene, n: int, seed: int, precision: str
) -> Row:
    run = run_seeds(lower(scene), controller, seed, n, precision, threads=cores())
    dropped = int(np.count_nonzero(run["outcome"] == DROPPED))
    delivered = int(np.count_nonzero(run["outcome"] == DELIVERED))
    square, low, high = _ratio(np.mean(run["contact_rms_m"] ** 2, axis=1), np.ones(n))
    sent = run["messages"].astype(float)
    messages, *messages_interval = _ratio(sent, run["distance_m"])
    return Row(
        controller=controller,
        key=key,
        value=value,
        n=n,
        drop_rate=dropped / n,
        interval=wilson(dropped, n),
        stall_rate=(n - dropped - delivered) / n,
        stall_interval=wilson(n - dropped - delivered, n),
        rms_m=math.sqrt(square),
        rms_interval_m=(math.sqrt(low), math.sqrt(high)),
        messages_per_m=messages,
        messages_interval_per_m=(messages_interval[0], messages_interval[1]),
        bytes_per_s=PACKET_SIZE * _ratio(sent, run["time_s"])[0],
        corrections=float(np.mean(run["corrections"])),
    )


def _ratio(of: NDArray[Any], to: NDArray[Any]) -> tuple[float, float, float]:
    """The ratio of two sums over carries and its 95 % interval, from the carries' scatter about it.

    No less than 0; of a single carry the ratio alone, with an interval of NaN.
    """
    total = float(np.sum(to))
    if total <= 0:  # nobody got anywhere
        return 0.0, 0.0, 0.0
    n, ratio = len(of), float(np.sum(of)) / total
    if n == 1:  # which tells nothing of how carries scatter
        return ratio, math.nan, math.nan
    half = _Z95 * float(np.std(of - ratio * to, ddof=1)) * math.sqrt(n) / total
    return ratio, max(ratio - half, 0.0), ratio + half


def wilson(events: int, n: int, z: float = _Z95) -> tuple[float, float]:
    """Wilson's score interval for a rate of `events` in `n`; 95 % by default."""
    rate = events / n
    spread = z * math.sqrt(rate * (1 - rate) / n + z * z / (4 * n * n))
    centre = rate + z * z / (2 * n)
    scale = 1 + z * z / n
    low = 0.0 if events == 0 else (centre - spread) / scale
    high = 1.0 if events == n else (centre + spread) / scale
    return low, high
