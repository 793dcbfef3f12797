# SPDX-License-Identifier: Apache-2.0
"""The objects that come with the package: complete, carried, mirrored, found by name."""

import tomllib
from pathlib import Path

import pytest

import palmbots as pb
from palmbots import read_log, write_log
from palmbots._core import crossing_edges
from palmbots.scene.object_section import Object
from palmbots.scene.scene import Scene, load_scene

FOLDER = Path(pb.__file__).parent / "scene" / "data" / "objects"
NAMES = ["bottle", "box", "box-strips", "carton", "l-shape", "plank", "trapezoid", "tray"]


def area_and_centre(vertices) -> tuple[float, float, float]:
    area = x = y = 0.0
    for (ax, ay), (bx, by) in zip(vertices, (*vertices[1:], vertices[0]), strict=True):
        cross = ax * by - ay * bx
        area += cross / 2
        x += (ax + bx) * cross / 6
        y += (ay + by) * cross / 6
    return area, x / area, y / area


def test_object_names_are_listed_in_order() -> None:
    assert pb.object_names() == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_object_files_give_every_key_and_state_their_source(name: str) -> None:
    """All keys are given: put over another object, nothing of that one is left."""
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    table = tomllib.loads(text)
    assert list(table) == ["object"]
    # box_m is short for vertices_m, and an outline that says nothing else has sharp corners.
    given = set(table["object"]) | {"edge_radius_m"}
    assert given == set(Object.model_fields) - {"box_m"}
    assert text.startswith("# ")
    assert name == "box" or "assumed" in text.split("[object]")[0]
    other = load_scene({"object": {"mass_kg": 9.0, "edge_radius_m": 0.01, "com_m": [0.1, 0.1]}})
    assert load_scene(other, {"object": name}) == load_scene("paper", {"object": name})


def test_box_is_that_of_the_paper_and_strips_raise_it() -> None:
    assert load_scene("paper", {"object": "box"}) == Scene()
    plain, lifted = (load_scene({"object": name}).object for name in ("box", "box-strips"))
    assert lifted.com_m[1] == pytest.approx(plain.com_m[1] + 0.005)
    top = [max(y for _, y in o.vertices_m) for o in (plain, lifted)]
    assert top[1] == pytest.approx(top[0] + 0.005)


@pytest.mark.parametrize("name", ["l-shape", "plank", "tray", "trapezoid"])
def test_com_of_uniform_objects_is_the_centroid(name: str) -> None:
    item = load_scene({"object": name}).object
    area, x, y = area_and_centre(item.vertices_m)
    assert area > 0 and crossing_edges(item.vertices_m) is None
    assert item.com_m == pytest.approx((x, y), abs=1e-4)


@pytest.mark.parametrize("name", NAMES)
def test_object_is_delivered_with_every_seed(name: str) -> None:
    for seed in range(20):
        assert pb.carry("paper", seed=seed, overrides={"object": name}).outcome == "delivered"


@pytest.mark.parametrize("name", NAMES)
def test_name_in_file_table_and_override_gives_one_scene(name: str, tmp_path: Path) -> None:
    wanted = load_scene("paper", {"object": name})
    path = tmp_path / "mine.toml"
    path.write_text(f'object = "{name}"\n\n[radio]\nloss = 0.25\n', encoding="utf-8")
    assert load_scene(path) == load_scene(wanted, {"radio.loss": 0.25})
    assert load_scene({"object": name}) == wanted
    assert Scene.model_validate({"object": name}) == wanted
    assert load_scene(wanted, {"object": "box"}) == Scene()


def test_keys_beside_a_name_override_it_in_any_order() -> None:
    tray = load_scene({"object": "tray"})
    wanted = load_scene(tray, {"object.mass_kg": 2.0})
    assert wanted.object.mass_kg == 2 and wanted.object.vertices_m == tray.object.vertices_m
    assert load_scene("paper", {"object": "tray", "object.mass_kg": 2.0}) == wanted
    assert load_scene("paper", {"object.mass_kg": 2.0, "object": "tray"}) == wanted
    assert load_scene({"object": "tray"}, {"object": {"mass_kg": 2.0}}) == wanted


def test_dumps_and_logs_contain_the_table(tmp_path: Path) -> None:
    result = pb.carry("paper", seed=0, overrides={"object": "tray", "task.distance_m": 0.1})
    table = result.scene.model_dump()["object"]
    assert table["vertices_m"] == load_scene({"object": "tray"}).object.vertices_m
    assert 'object = "' not in result.scene.to_toml()
    write_log(result, tmp_path / "carry.mcap")
    assert load_scene(read_log(tmp_path / "carry.mcap").scene) == result.scene


CRATE = "[object]\nvertices_m = [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]]\ndepth_m = 0.3\n"


def test_object_file_is_found_beside_the_scene_file(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "crate-object.toml").write_text(CRATE)
    (tmp_path / "scenes" / "mine.toml").write_text('object = "crate-object.toml"\n')
    wanted = load_scene({"object": tomllib.loads(CRATE)["object"]})
    assert load_scene("scenes/mine.toml") == load_scene(tmp_path / "scenes" / "mine.toml") == wanted
    assert wanted.object.com_m == (0.2, 0.06)
    assert load_scene("scenes/mine.toml", {"object.mass_kg": 2}).object.mass_kg == 2
    # A table and an override name a file in the working directory.
    name = "scenes/crate-object.toml"
    assert load_scene({"object": name}) == wanted == load_scene("paper", {"object": name})
    changed = load_scene("paper", {"object": name, "object.mass_kg": 2})
    assert changed == load_scene(wanted, {"object.mass_kg": 2})


def test_name_of_the_package_goes_before_a_file(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tray").write_text(CRATE)
    assert load_scene({"object": "tray"}).object.depth_m == 0.1
    assert load_scene({"object": "./tray"}).object.depth_m == 0.3
