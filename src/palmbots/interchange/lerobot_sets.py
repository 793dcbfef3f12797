# SPDX-License-Identifier: Apache-2.0
"""Carries as a dataset of LeRobot, format 3.0: an episode for each carry, a frame for each tick.

Both robots are in one frame: the names in ``meta/info.json`` say whose value is which. There is no
video. Needs the extra ``parquet``.
"""

import json
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.atomic_files import new_folder
from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.interchange.distances import distances
from palmbots.scene.scene import Scene
from palmbots.simulation.result import Carry

_VERSION = "v3.0"
_IN_A_FILE, _IN_A_CHUNK = 500, 1000  # carries in a file, and files in a folder
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_EPISODES = "meta/episodes/chunk-000/file-000.parquet"
_VECTORS = {
    "observation.state": ("sign", "palm_rad", "distance_m", "pivot_height_m"),
    "observation.environment_state": ("contact_m", "speed_m_s"),
    "action": ("next_palm_rad", "commanded_m_s", "next_pivot_height_m"),
}
"""Features with a value for each robot: what it measures, what only the simulation knows, and what
it commands. Its palm and its arm are commanded to where they are at the end of the tick. What is
unknown in the carry, as is the contact coordinate in logs of robots, is left out, and so is the arm
where the job does not need it."""
_NUMBERS = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


Statistics = dict[str, dict[str, list[float]]]
"""For each feature: min, max, mean, std and count."""


def frames_per_second(scene: Scene) -> int:
    """Ticks in a second.

    Raises:
        PalmbotsError: it is no whole number, which the format wants.
    """
    period_s = scene.control.period_s
    if abs(1 / period_s - round(1 / period_s)) > 1e-9:
        raise PalmbotsError(
            f"control.period_s: value is {period_s:g}; allowed with --lerobot: a whole number of "
            "ticks in a second"
        )
    return round(1 / period_s)


def write_dataset(carries: Iterable[Carry], path: Path) -> None:
    """Write carries to a new folder, the dataset.

    Raises:
        PalmbotsError: pyarrow is missing, the folder exists or cannot be written, or a second is no
            whole number of ticks.
    """
    arrow, parquet = require("pyarrow", "parquet"), require("pyarrow.parquet", "parquet")
    episodes: list[dict[str, Any]] = []
    statistics: list[Statistics] = []
    frames, rate, task = 0, 0, ""
    vectors: dict[str, list[str]] = {}
    with new_folder(path) as place, ExitStack() as closing:
        writer: Any = None
        for number, carry in enumerate(carries):
            rate, task = frames_per_second(carry.scene), _task(carry)
            file = number // _IN_A_FILE
            where = {"chunk_index": file // _IN_A_CHUNK, "file_index": file % _IN_A_CHUNK}
            vectors = vectors or _vectors(carry)
            schema = _schema(arrow, vectors)
            if number % _IN_A_FILE == 0:
                closing.close()
                data = place / _DATA.format(**where)
                data.parent.mkdir(parents=True, exist_ok=True)
                writer = closing.enter_context(parquet.ParquetWriter(data, schema))
            columns = _columns(carry, vectors, number, frames, rate)
            writer.write_table(
                arrow.table({name: [*rows] for name, rows in columns.items()}, schema=schema)
            )
            statistics.append(_statistics(columns))
            count = len(columns["index"])
            episodes.append(
                {"episode_index": number, "tasks": [task], "length": count}
                | {f"data/{key}": value for key, value in where.items()}
                | {"dataset_from_index": frames, "dataset_to_index": frames + count}
                | {"meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
                | {"seed": carry.seed, "outcome": carry.outcome}
                | {
                    f"stats/{name}/{key}": value
                    for name, one in statistics[-1].items()
                    for key, value in one.items()
                }
            )
            frames += count
        closing.close()
        (place / _EPISODES).parent.mkdir(parents=True)
        parquet.write_table(arrow.Table.from_pylist(episodes), place / _EPISODES)
        _write_tasks(arrow, parquet, task, place / "meta" / "tasks.parquet")
        info = _info(vectors, len(episodes), frames, rate)
        for name, content in (("info", info), ("stats", _pooled(statistics))):
            (place / "meta" / f"{name}.json").write_text(json.dumps(content, indent=4))


def _task(carry: Carry) -> str:
    task = carry.scene.task
    begin, end = task.ends
    parts = [f"carry the object {task.distance_m:g} m on two tilting palms"]
    if begin != "palms":
        parts.insert(0, f"pick the object up from the {begin}")
    if end != "palms":
        parts.append(f"put the object down on the {end}")
    return ", then ".join(parts)


def _values(carry: Carry) -> dict[str, NDArray[Any]]:
    """What the features consist of, each (time, side)."""
    trace = carry.trace
    assert trace is not None
    moved = {"palm_rad": trace["palm"].to_numpy()}
    if "pivot_height" in trace:
        moved["pivot_height_m"] = trace["pivot_height"].to_numpy()
    return {
        **moved,
        **{f"next_{name}": np.concatenate([one[1:], one[-1:]]) for name, one in moved.items()},
        "sign": trace["sign"].to_numpy(),
        "distance_m": distances(carry),
        "contact_m": trace["contact"].to_numpy(),
        "speed_m_s": trace["speed"].to_numpy(),
        "commanded_m_s": trace["commanded"].to_numpy(),
    }


def _vectors(carry: Carry) -> dict[str, list[str]]:
    """The parts of each feature that are known."""
    known = {name for name, values in _values(carry).items() if np.isfinite(values).all()}
    found = {name: [part for part in parts if part in known] for name, parts in _VECTORS.items()}
    return {name: parts for name, parts in found.items() if parts}


def _schema(arrow: Any, vectors: dict[str, list[str]]) -> Any:
    return arrow.schema(
        [*((name, arrow.list_(arrow.float32())) for name in vectors)]
        + [(name, arrow.type_for_alias(kind)) for name, kind in _NUMBERS.items()]
    )


def _columns(
    carry: Carry, vectors: dict[str, list[str]], number: int, begin: int, rate: int
) -> dict[str, NDArray[Any]]:
    """The features of an episode, with a row for each frame."""
    values = _values(carry)
    columns: dict[str, NDArray[Any]] = {
        name: np.stack([values[part][:, k] for k in range(len(SIDES)) for part in parts], axis=1)
        for name, parts in vectors.items()
    }
    frames = np.arange(len(values["sign"]))
    numbers = (frames / rate, frames, frames * 0 + number, frames + begin, frames * 0)
    return {name: rows.astype(np.float32) for name, rows in columns.items()} | {
        name: column.astype(kind)
        for (name, kind), column in zip(_NUMBERS.items(), numbers, strict=True)
    }


def _statistics(columns: dict[str, NDArray[Any]]) -> Statistics:
    """Of all features, over the frames of an episode."""
    return {
        name: {
            "min": rows.min(axis=0).tolist(),
            "max": rows.max(axis=0).tolist(),
            "mean": rows.mean(axis=0, dtype=float).tolist(),
            "std": rows.std(axis=0, dtype=float).tolist(),
            "count": [len(rows)],
        }
        for name, column in columns.items()
        for rows in [column.reshape(len(column), -1)]
    }


def _pooled(episodes: list[Statistics]) -> Statistics:
    """The same over the frames of all episodes."""
    found: Statistics = {}
    for name in episodes[0]:
        low, high, mean, std, count = (
            np.array([one[name][key] for one in episodes])
            for key in ("min", "max", "mean", "std", "count")
        )
        shares = count / count.sum()
        whole = (shares * mean).sum(axis=0)
        found[name] = {
            "min": low.min(axis=0).tolist(),
            "max": high.max(axis=0).tolist(),
            "mean": whole.tolist(),
            "std": np.sqrt((shares * (std**2 + (mean - whole) ** 2)).sum(axis=0)).tolist(),
            "count": [int(count.sum())],
        }
    return found


def _write_tasks(arrow: Any, parquet: Any, task: str, path: Path) -> None:
    """The table of tasks, whose index is the text, as pandas writes it."""
    import pandas as pd

    table = pd.DataFrame({"task_index": [0]}, index=pd.Index([task], name="task"))
    parquet.write_table(arrow.Table.from_pandas(table), path)


def _info(vectors: dict[str, list[str]], episodes: int, frames: int, rate: int) -> dict[str, Any]:
    shapes = {
        name: {
            "dtype": "float32",
            "shape": [len(SIDES) * len(parts)],
            "names": [f"{side}_{part}" for side in SIDES for part in parts],
        }
        for name, parts in vectors.items()
    }
    numbers = {
        name: {"dtype": kind, "shape": [1], "names": None} for name, kind in _NUMBERS.items()
    }
    return {
        "codebase_version": _VERSION,
        "robot_type": "palmbots",
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": 1,
        "chunks_size": _IN_A_CHUNK,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": rate,
        "splits": {"train": f"0:{episodes}"},
        "data_path": _DATA,
        "video_path": None,
        "features": shapes | numbers,
    }
