# SPDX-License-Identifier: Apache-2.0
"""Carries in the formats of other programs, read with the packages of these programs."""

import json
import shutil
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from rosbags.highlevel import AnyReader

import palmbots as pb
from palmbots._types import SIDES
from palmbots.interchange import export, lerobot_sets
from palmbots.mujoco.carry_files import save_carry
from palmbots.views.run_replay import ReplayResult, replay_logs

NOISY = {"robot.noise_m_s": 0.05, "task.distance_m": 0.3}
SEEDS = 4


@pytest.fixture(scope="module")
def carries() -> list[Any]:
    found = [pb.carry("paper", overrides=NOISY, seed=seed) for seed in range(SEEDS)]
    assert {one.outcome for one in found} == {"delivered", "dropped"}
    return found


def export_seeds(**files: Any) -> None:
    pb.export("paper", overrides=NOISY, seeds=SEEDS, **files)


def test_a_table_has_every_value_of_every_carry(carries: list[Any], tmp_path: Path) -> None:
    export_seeds(parquet=tmp_path / "c.parquet")
    file = pq.ParquetFile(tmp_path / "c.parquet")
    assert file.num_row_groups == SEEDS
    facts = json.loads(file.metadata.metadata[b"palmbots"])
    rows = pd.read_parquet(tmp_path / "c.parquet")
    for seed, carry in enumerate(carries):
        own = rows[rows.episode == seed]
        assert set(own.seed) == {seed}
        assert facts["carries"][seed]["outcome"] == carry.outcome
        assert facts["carries"][seed]["trace_hash"] == carry.trace_hash
        assert (own.time_s.to_numpy() == carry.trace["time"].to_numpy()).all()
        assert (own.object_rad.to_numpy() == carry.trace["object"].to_numpy()).all()
        for name in ("contact", "palm", "sign", "case", "motion"):
            column = carry.trace[name]
            shown = column.attrs["log_field"]
            for k, side in enumerate(SIDES):
                assert (own[f"{side}_{shown}"].to_numpy() == column.to_numpy()[:, k]).all()
    assert pb.load_scene(_written(facts["scene"], tmp_path)) == carries[0].scene
    field = file.schema_arrow.field("right_speed_m_s")
    assert field.metadata[b"units"] == b"m/s"


def _written(scene: str, folder: Path) -> Path:
    path = folder / "scene.toml"
    path.write_text(scene)
    return path


def test_a_log_gives_what_its_carry_gives(carries: list[Any], tmp_path: Path) -> None:
    """The folder of `palmbots carry --out` stands for its log; one with several is refused."""
    save_carry(carries[0], tmp_path / "out")
    pb.export("paper", overrides=NOISY, parquet=tmp_path / "carry.parquet")
    carried = pd.read_parquet(tmp_path / "carry.parquet")
    for log in (tmp_path / "out" / "carry.mcap", tmp_path / "out"):
        pb.export(log=log, parquet=tmp_path / "log.parquet")
        pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "log.parquet"), carried)
    replayed = replay_logs([tmp_path / "out"])
    assert isinstance(replayed, ReplayResult) and replayed.identical
    shutil.copy(tmp_path / "out" / "carry.mcap", tmp_path / "out" / "other.mcap")
    with pytest.raises(pb.PalmbotsError, match="has 2 logs that are not of robots; expected"):
        pb.export(log=tmp_path / "out", parquet=tmp_path / "log.parquet")


def test_the_dynamic_world_has_its_own_variables(tmp_path: Path) -> None:
    carry = pb.carry("paper", overrides={"task.distance_m": 0.02}, world="mujoco")
    save_carry(carry, tmp_path / "out")
    pb.export(log=tmp_path / "out" / "carry.mcap", parquet=tmp_path / "c")
    columns = set(pd.read_parquet(tmp_path / "c").columns)
    assert {"left_dynamics_force_n", "right_dynamics_yaw_rad"} <= columns


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_a_bag_says_what_the_robots_read_and_said(direction: str, tmp_path: Path) -> None:
    keys = {**NOISY, "task.direction": direction}
    carry = pb.carry("paper", overrides=keys)
    pb.export("paper", overrides=keys, rosbag=tmp_path / "bag")
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([tmp_path / "bag"]) as reader:
        for connection, now_ns, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append((now_ns, message))
    trace = carry.trace
    assert trace is not None
    times = np.round(trace["time"].to_numpy() * 1e9).astype(int)
    away = {"left": -1, "right": 1}  # from the partner, along x
    for k, side in enumerate(SIDES):
        contact = found[f"/{side}/contact"]
        assert [now for now, _ in contact] == times.tolist()
        assert [one.data for _, one in contact] == trace["sign"].to_numpy()[:, k].tolist()
        assert all(one.data for _, one in found[f"/{side}/contact_present"])
        joints = [one.position[0] for _, one in found[f"/{side}/joint_states"]]
        assert joints == trace["palm"].to_numpy()[:, k].tolist()
        # The pivots' places along x; base_link looks at the partner.
        middle = trace["midpoint"].to_numpy() * (1 if direction == "forward" else -1)
        places = middle + away[side] * trace["separation"].to_numpy() / 2
        poses = [one.pose.pose.position.x for _, one in found[f"/{side}/odom"]]
        assert np.allclose(poses, -away[side] * (places - places[0]), atol=1e-12)
        stamps = [one.header.stamp for _, one in found[f"/{side}/cmd_vel"]]
        assert [one.sec * 10**9 + one.nanosec for one in stamps] == times.tolist()
        said = [one.data for _, one in found.get(f"/{side}/said", [])]
        assert said == [one.kind for one in carry.message_log if one.sender == side]
        assert said
    assert len(found["/tf"]) == 2 * len(times)


def test_a_dataset_has_frames_episodes_and_statistics(
    carries: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Read as LeRobot reads it: all data files in the order of their names, then by index."""
    monkeypatch.setattr(lerobot_sets, "_IN_A_FILE", 3)
    export_seeds(lerobot=tmp_path / "set")
    info, stats = (
        json.loads((tmp_path / "set" / "meta" / f"{name}.json").read_text())
        for name in ("info", "stats")
    )
    files = sorted((tmp_path / "set" / "data").glob("*/*.parquet"))
    assert len(files) == 2
    rows = pd.concat(map(pd.read_parquet, files), ignore_index=True)
    episodes = pd.read_parquet(tmp_path / "set" / "meta" / "episodes")
    tasks = pd.read_parquet(tmp_path / "set" / "meta" / "tasks.parquet")
    assert info["codebase_version"] == "v3.0"
    assert set(rows.columns) == set(info["features"])
    assert (info["total_episodes"], info["total_frames"]) == (SEEDS, len(rows))
    assert (rows["index"] == np.arange(len(rows))).all()
    assert tasks.index.tolist() == [episodes.tasks[0][0]]
    for number, carry in enumerate(carries):
        row = episodes.iloc[number]
        own = rows[row.dataset_from_index : row.dataset_to_index]
        path = info["data_path"].format(
            chunk_index=row["data/chunk_index"], file_index=row["data/file_index"]
        )
        assert number in set(pd.read_parquet(tmp_path / "set" / path).episode_index)
        assert set(own.episode_index) == {number}
        assert (own.frame_index == np.arange(row.length)).all()
        assert np.allclose(own.timestamp, np.arange(row.length) / info["fps"], atol=1e-5)
        assert row.outcome == carry.outcome
        names = info["features"]["observation.state"]["names"]
        signs = np.stack(own["observation.state"])[:, names.index("right_sign")]
        assert (signs == carry.trace["sign"].to_numpy()[:, 1]).all()
        names = info["features"]["action"]["names"]
        palms = np.stack(own["action"])[:-1, names.index("left_next_palm_rad")]
        assert (palms == carry.trace["palm"].to_numpy()[1:, 0].astype(np.float32)).all()
    for name, feature in info["features"].items():
        values = np.stack(rows[name].to_list()).astype(float).reshape(len(rows), -1)
        assert values.shape[1:] == tuple(feature["shape"])
        for key, by in (("min", np.min), ("max", np.max), ("mean", np.mean), ("std", np.std)):
            assert np.allclose(stats[name][key], by(values, axis=0), rtol=1e-5, atol=1e-7), name
        assert stats[name]["count"] == [len(rows)]


def test_a_job_has_its_arms_its_task_and_empty_palms(tmp_path: Path) -> None:
    """From the floor to the floor: nothing is on the palms at first and in the end."""
    carry = pb.carry("lift", "shared-sign")
    trace = carry.trace
    assert trace is not None
    pb.export("lift", controller="shared-sign", lerobot=tmp_path / "set", rosbag=tmp_path / "bag")
    info = json.loads((tmp_path / "set" / "meta" / "info.json").read_text())
    frames = pd.read_parquet(tmp_path / "set" / "data")
    heights = trace["pivot_height"].to_numpy()[:, 1].astype(np.float32)
    for feature, name, expected in (
        ("observation.state", "right_pivot_height_m", heights),
        ("action", "right_next_pivot_height_m", [*heights[1:], heights[-1]]),
    ):
        column = info["features"][feature]["names"].index(name)
        assert (np.stack(frames[feature])[:, column] == expected).all()
    assert pd.read_parquet(tmp_path / "set" / "meta" / "tasks.parquet").index.tolist() == [
        "pick the object up from the floor, then carry the object 1.5 m on two tilting palms, then "
        "put the object down on the floor"
    ]
    with AnyReader([tmp_path / "bag"]) as reader:
        topics = [one for one in reader.connections if one.topic == "/left/contact_present"]
        messages: list[Any] = [
            reader.deserialize(data, one.msgtype)
            for one, _, data in reader.messages(connections=topics)
        ]
    present = [one.data for one in messages]
    assert not present[0] and not present[-1]
    assert present[len(present) // 2]


def test_what_robots_do_not_know_is_left_out(carries: list[Any], tmp_path: Path) -> None:
    """As in logs of robots, where the contact coordinate is NaN."""
    blind = carries[0]
    trace = blind.trace.copy(deep=True)
    trace["contact"][:] = np.nan
    object.__setattr__(blind, "trace", trace)
    lerobot_sets.write_dataset(iter([blind]), tmp_path / "set")
    info = json.loads((tmp_path / "set" / "meta" / "info.json").read_text())
    names = info["features"]["observation.environment_state"]["names"]
    assert names == ["left_speed_m_s", "right_speed_m_s"]
    assert "NaN" not in (tmp_path / "set" / "meta" / "stats.json").read_text()


@pytest.mark.parametrize("kind", ["parquet", "lerobot", "rosbag"])
def test_an_interrupted_export_leaves_nothing(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = count()

    def carry(*args: Any, **kwargs: Any) -> Any:
        if next(calls) == (0 if kind == "rosbag" else 1):
            raise KeyboardInterrupt
        return pb.carry(*args, **kwargs)

    monkeypatch.setattr(export, "carry", carry)
    files: Any = {kind: tmp_path / "x"}
    with pytest.raises(KeyboardInterrupt):
        pb.export("paper", overrides=NOISY, seeds=1 if kind == "rosbag" else 2, **files)
    assert not [*tmp_path.iterdir()]


def test_progress_counts_all_carries_of_all_tables(tmp_path: Path) -> None:
    seen: list[float] = []
    pb.export(
        "paper", overrides=NOISY, seeds=2, on_progress=seen.append,
        parquet=tmp_path / "c.parquet", lerobot=tmp_path / "set",
    )  # fmt: skip
    assert seen == [0.25, 0.5, 0.75, 1.0]


def test_ticks_that_are_no_whole_part_of_a_second_are_refused_for_lerobot(tmp_path: Path) -> None:
    with pytest.raises(pb.PalmbotsError, match=r"^control\.period_s: value is 0\.003; allowed"):
        pb.export(lerobot=tmp_path / "set", overrides={"control.period_s": 0.003})
    assert not [*tmp_path.iterdir()]
