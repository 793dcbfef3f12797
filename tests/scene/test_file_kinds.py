# SPDX-License-Identifier: Apache-2.0
"""A reader that is given a file of another kind names both kinds, in one line."""

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.boards.flashing import flash
from palmbots.derivation.policy_file import read_policy
from palmbots.fitting.recorded_packets import read_packets
from palmbots.logs.mcap_reader import read_log
from palmbots.logs.mcap_writer import write_log
from palmbots.logs.run_log_reader import read_run_log
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.scene.file_kinds import KINDS, all_kinds, other_kind
from palmbots.scene.files import read_scene, read_table
from palmbots.scene.key_reference import init_scene
from palmbots.scene.scene import Scene
from palmbots.simulation.imperfections import load_imperfections
from palmbots.stability.certificates.checker.certificate_file import read_certificate
from palmbots.stability.probed_object import read_probed
from palmbots.studies.study_file import load_plan
from palmbots.views.log_player import read_playable
from palmbots.views.run_replay import replay_logs

REPOSITORY = Path(__file__).parents[2]
READERS: list[tuple[str, Callable[[Any], Any]]] = [
    ("scene", read_scene),
    ("scene", pb.load_scene),
    ("object", lambda file: read_table(str(file), KINDS.get("object"))),
    ("pair", load_pair),
    ("study", load_plan),
    ("policy", read_policy),
    ("imperfections", lambda file: load_imperfections([str(file)])),
    ("certificate", read_certificate),
    ("log", read_log),
    ("log", read_run_log),
    ("log", read_playable),
    ("log", lambda file: replay_logs([file])),
    ("image", flash),
    ("recording", read_packets),
    ("probed object", partial(read_probed, scene=Scene())),
]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One file of each kind that has files, most of them as palmbots itself writes them."""
    folder = tmp_path_factory.mktemp("kinds")
    pair, key, *counters = init_pair(folder / "pair.toml")
    write_log(pb.carry("paper"), folder / "carry.mcap")
    certificate = pb.certify("paper", claims=("property 2",))
    certificate.save(folder / "certificate.json")
    made = {
        "scene": init_scene(folder / "scene.toml"),
        "object": folder / "object.toml",
        "pair": pair,
        "study": folder / "study.toml",
        "policy": folder / "policy.toml",
        "imperfections": folder / "imperfections.toml",
        "certificate": folder / "certificate.json",
        "log": folder / "carry.mcap",
        "image": REPOSITORY / "src/palmbots/boards/data/robot.hex",
        "key": key,
        "counter": counters[0],
        "recording": folder / "packets.csv",
        "probed object": folder / "probe.toml",
        "drawing": folder / "bottle.svg",
        "program": folder / "swing.py",
    }
    made["object"].write_text("[object]\nvertices_m = [[0, 0], [1, 0], [0, 1]]\n")
    shutil.copy(REPOSITORY / "src/palmbots/studies/data/silent-map.toml", made["study"])
    shutil.copy(REPOSITORY / "examples/policies/table-1.toml", made["policy"])
    made["imperfections"].write_text("trim = 0.02\n[left]\nservo_zero_deg = 92\n")
    made["recording"].write_text("index,time_s,sent_s\n0,0.0,0.0\n")
    made["drawing"].write_text("<svg xmlns='http://www.w3.org/2000/svg'/>\n")
    intervals = ["com_x_m = [0.1, 0.12]", "com_y_m = [0.03, 0.05]"]
    intervals += [f"friction_{side} = [0.3, 0.4]" for side in ("left", "right")]
    made["probed object"].write_text("\n".join(["[probed]", *intervals, ""]))
    made["program"].write_text("class Swing:\n    pass\n")
    return made


def test_each_kind_of_file_is_recognized(files: dict[str, Path]) -> None:
    assert set(files) == set(KINDS.names()) - {"controller"}
    for kind, file in files.items():
        content = file.read_bytes()
        assert not other_kind(str(file), content, KINDS.get(kind))
        for wanted in set(KINDS.names()) - {kind, "scene"}:  # an object file is a part of a scene
            problem = other_kind(str(file), content, KINDS.get(wanted))
            meant = KINDS.get("scene" if kind == "object" else kind).called
            assert problem.startswith(f"is {meant}, for "), (kind, wanted)
            assert problem.endswith(f"; allowed: {KINDS.get(wanted).in_words}")


@pytest.mark.parametrize("number", range(len(READERS)))
def test_readers_name_the_kind_of_a_wrong_file(number: int, files: dict[str, Path]) -> None:
    wanted, read = READERS[number]
    for kind, file in files.items():
        if kind == wanted or (kind, wanted) == ("object", "scene"):
            continue
        if wanted == "imperfections" and file.suffix != ".toml":  # such a text is KEY=VALUE
            continue
        with pytest.raises(pb.PalmbotsError) as refusal:
            read(file)
        called = KINDS.get("scene" if kind == "object" else kind).called
        assert str(refusal.value).startswith(f"{file}: is {called}, for "), (wanted, kind)


@pytest.mark.parametrize("number", range(len(READERS)))
def test_readers_know_the_built_in_names_of_other_kinds(
    number: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    wanted, read = READERS[number]
    names = {"scene": "figure8", "study": "silent-map", "controller": "resilient", "object": "tray"}
    for kind, name in names.items():
        if kind == wanted or wanted == "imperfections":  # a name without a suffix is KEY=VALUE
            continue
        with pytest.raises(pb.PalmbotsError) as refusal:
            read(Path(name) if read in (read_playable, flash) else name)
        assert str(refusal.value).startswith(f"{name}: is a built-in {kind}, for "), wanted


def test_each_kind_has_something_that_identifies_it() -> None:
    for kind in all_kinds():
        assert kind.keys or kind.mark or kind.suffixes or kind.names(), kind.called


def test_a_file_with_as_many_keys_of_its_own_kind_is_not_of_another(tmp_path: Path) -> None:
    file = tmp_path / "mixed.toml"
    file.write_text("controllers = ['none']\n[robot]\nnoise_m_s = 0.01\n")
    with pytest.raises(pb.PalmbotsError, match=r"robot: .* is the value of an unknown key"):
        load_plan(file)
    file.write_text("[par]\nnumber = 3\n")
    with pytest.raises(pb.PalmbotsError, match=r"par: .* is the value of an unknown key"):
        load_pair(file)
    file.write_text("")
    assert read_table(str(file), KINDS.get("pair")) == {}
