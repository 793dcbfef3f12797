"""The objects that come with the package: complete, carried, mirrored, found by name."""

import tomllib
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.errors import SceneError
from palmbots.log import read_log, write_log
from palmbots.outline import crossing_edges
from palmbots.scene import Scene, load_scene
from palmbots.sections import Object

FOLDER = Path(pb.__file__).parent / "objects"
NAMES = ["box", "box-strips", "l-shape", "plank", "trapezoid", "tray"]
KNOWN = "allowed: box, box-strips, l-shape, plank, trapezoid, tray, or a table"


def area_and_centre(vertices) -> tuple[float, float, float]:
    area = x = y = 0.0
    for (ax, ay), (bx, by) in zip(vertices, (*vertices[1:], vertices[0]), strict=True):
        cross = ax * by - ay * bx
        area += cross / 2
        x += (ax + bx) * cross / 6
        y += (ay + by) * cross / 6
    return area, x / area, y / area


def test_names() -> None:
    assert pb.objects() == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_the_files_are_complete_and_explain_themselves(name: str) -> None:
    """All keys are given: put over another object, nothing of that one is left."""
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    table = tomllib.loads(text)
    assert list(table) == ["object"]
    assert set(table["object"]) == set(Object.model_fields)
    assert text.startswith("# ")
    assert name == "box" or "assumed" in text.split("[object]")[0]
    other = load_scene({"object": {"mass_kg": 9.0, "depth_m": 0.9, "com_m": [0.1, 0.1]}})
    assert load_scene(other, {"object": name}) == load_scene("paper", {"object": name})


def test_the_box_is_the_papers_and_the_strips_lift_it() -> None:
    assert load_scene("paper", {"object": "box"}) == Scene()
    plain, lifted = (load_scene({"object": name}).object for name in ("box", "box-strips"))
    assert lifted.com_m[1] == pytest.approx(plain.com_m[1] + 0.005)
    top = [max(y for _, y in o.vertices_m) for o in (plain, lifted)]
    assert top[1] == pytest.approx(top[0] + 0.005)


@pytest.mark.parametrize("name", ["l-shape", "plank", "tray", "trapezoid"])
def test_centres_of_homogeneous_bodies(name: str) -> None:
    thing = load_scene({"object": name}).object
    area, x, y = area_and_centre(thing.vertices_m)
    assert area > 0 and crossing_edges(thing.vertices_m) is None
    assert thing.com_m == pytest.approx((x, y), abs=1e-4)


@pytest.mark.parametrize("name", NAMES)
def test_is_delivered(name: str) -> None:
    for seed in range(20):
        assert pb.carry("paper", seed=seed, overrides={"object": name}).outcome == "delivered"


@pytest.mark.parametrize("name", NAMES)
def test_mirrors(name: str) -> None:
    scene = load_scene("paper", {"object": name})
    mirror = scene.mirrored()
    assert mirror.mirrored() == scene
    there, back = pb.carry(scene, seed=3), pb.carry(mirror, seed=3)
    assert (there.outcome, there.time_s) == (back.outcome, back.time_s)
    assert there.contact_rms_m["left"] == back.contact_rms_m["right"]


@pytest.mark.parametrize("name", NAMES)
def test_every_way_to_name_one(name: str, tmp_path: Path) -> None:
    wanted = load_scene("paper", {"object": name})
    path = tmp_path / "mine.toml"
    path.write_text(f'object = "{name}"\n\n[radio]\nloss = 0.25\n', encoding="utf-8")
    assert load_scene(path) == load_scene(wanted, {"radio.loss": 0.25})
    assert load_scene({"object": name}) == wanted
    assert Scene.model_validate({"object": name}) == wanted
    assert load_scene(wanted, {"object": "box"}) == Scene()


def test_keys_beside_a_name_are_set_in_it_in_any_order() -> None:
    tray = load_scene({"object": "tray"})
    wanted = load_scene(tray, {"object.mass_kg": 2.0})
    assert wanted.object.mass_kg == 2 and wanted.object.vertices_m == tray.object.vertices_m
    assert load_scene("paper", {"object": "tray", "object.mass_kg": 2.0}) == wanted
    assert load_scene("paper", {"object.mass_kg": 2.0, "object": "tray"}) == wanted
    assert load_scene({"object": "tray"}, {"object": {"mass_kg": 2.0}}) == wanted


def test_dumps_and_logs_hold_the_table(tmp_path: Path) -> None:
    done = pb.carry("paper", seed=0, overrides={"object": "tray", "task.distance_m": 0.1})
    table = done.scene.model_dump()["object"]
    assert table["vertices_m"] == load_scene({"object": "tray"}).object.vertices_m
    assert 'object = "' not in done.scene.to_toml()
    write_log(done, tmp_path / "carry.mcap")
    assert load_scene(read_log(tmp_path / "carry.mcap").scene) == done.scene


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        ({"object": "try"}, f'object: "try" is no object (did you mean tray?); {KNOWN}'),
        ({"object": "xyz"}, f'object: "xyz" is no object; {KNOWN}'),
        ({"object": "xyz", "object.mass_kg": 2}, f'object: "xyz" is no object; {KNOWN}'),
        ({"object": "tray\n"}, f'object: "tray\\n" is no object (did you mean tray?); {KNOWN}'),
        (
            {"object": 3},
            "object: 3 is not a table; allowed: a table with the keys vertices_m, contacts, "
            "com_m, mass_kg, depth_m",
        ),
    ],
)
def test_refused_in_one_line(overrides: dict, line: str) -> None:
    with pytest.raises(SceneError) as error:
        load_scene("paper", overrides)
    assert str(error.value) == f"overrides: {line}"
