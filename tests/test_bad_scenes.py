"""Every kind of wrong input has one clear line: file, key, value, and what is allowed."""

import datetime
import tomllib

import numpy as np
import pytest

from palmbots.complaints import dotted_keys
from palmbots.errors import SceneError
from palmbots.scene import Scene, load_scene

KEYS = sorted(dotted_keys(Scene))


def refusal(source, overrides=None) -> str:
    with pytest.raises(SceneError) as error:
        load_scene(source, overrides)
    line = str(error.value)
    assert line.isprintable(), "a message is one line"
    return line


M = "a number in m"
SIMPLE = "allowed: a simple polygon, whose edges share nothing but the vertices between them"
LOWER = "allowed: [left, right], two lower corners of the outline's convex hull"
PALM_KEYS = (
    "length_m, width_m, lip_height_m, lip_clearance_m, pivot_offset_m, friction, slip_deg, "
    "shallow_deg, steep_deg, rate_deg_s, "
    "left, right"
)
BAD = [
    # Unknown and misspelt keys.
    (
        "[palm]\nlenght_m = 0.15",
        "palm.lenght_m: 0.15 is given to an unknown key; did you mean palm.length_m? "
        f"allowed in palm: {PALM_KEYS}",
    ),
    (
        "[task]\nloss = 0.15",
        "task.loss: 0.15 is given to an unknown key; did you mean radio.loss? "
        "allowed in task: distance_m, slope_deg, timeout_s, direction, inertia, inertia_lag_s, "
        "path",
    ),
    (
        "[rodio]\nloss = 0.15",
        "rodio: { loss = 0.15 } is given to an unknown key; did you mean radio? allowed at the "
        "top: object, palm, robot, tactile, control, radio, faults, bumps, start, task, dynamic",
    ),
    (
        "[control]\nxyz = 1",
        "control.xyz: 1 is given to an unknown key; allowed in control: period_s, watchdog_s",
    ),
    # Wrong units: by name and by size.
    (
        "[palm]\nlength_mm = 150",
        "palm.length_mm: 150 is given to an unknown key; did you mean palm.length_m? "
        f"allowed in palm: {PALM_KEYS}",
    ),
    (
        "[palm]\nlength_m = 150",
        f"palm.length_m: 150 is too large; allowed: {M}, from 0.001 to 10",
    ),
    (
        '[palm]\nlength_m = "15 cm"',
        'palm.length_m: "15 cm" is a string, not a number; allowed: a number in m, from 0.001 '
        "to 10",
    ),
    # Wrong types.
    (
        "[palm]\nfriction = true",
        "palm.friction: true is a boolean, not a number; allowed: a number, from 0.001 to 100",
    ),
    (
        '[palm]\nfriction = "0.3"',
        'palm.friction: "0.3" is a string, not a number; allowed: a number, from 0.001 to 100',
    ),
    (
        "palm = 3",
        f"palm: 3 is not a table; allowed: a table with the keys {PALM_KEYS}",
    ),
    (
        "[object]\ncontacts = [0.0, 1]",
        "object.contacts[0]: 0.0 is a number, not a whole number; allowed: a whole number, at "
        "least 0",
    ),
    (
        "[object]\ncom_m = 0.1",
        "object.com_m: 0.1 is a number, not a list; allowed: [x, y], two numbers in m",
    ),
    (
        "[object]\ncom_m = [0.1]",
        "object.com_m: [0.1] has 1 item; allowed: [x, y], two numbers in m",
    ),
    (
        '[object]\nvertices_m = [[0, 0], [1, "0"], [1, 1]]',
        f'object.vertices_m[1][1]: "0" is a string, not a number; allowed: {M}, from -10 to 10',
    ),
    (
        '[task]\ndirection = "left"',
        "task.direction: \"left\" is not known; allowed: 'forward' or 'backward'",
    ),
    (
        "[task]\ninertia = 1",
        "task.inertia: 1 is a whole number, not a boolean; allowed: true or false",
    ),
    # Numbers that are none, and out of range.
    (
        "[radio]\nloss = nan",
        "radio.loss: nan is not finite; allowed: a number, from 0 to 1",
    ),
    (
        "[robot]\nspeed_m_s = inf",
        "robot.speed_m_s: inf is not finite; allowed: a number in m/s, from 0 to 10",
    ),
    (
        "[robot.left]\nspeed_m_s = -inf",
        "robot.left.speed_m_s: -inf is not finite; allowed: a number in m/s, from 0 to 10",
    ),
    (
        "[palm]\nwidth_m = -0.07",
        "palm.width_m: -0.07 is too small; allowed: a number in m, from 0.001 to 10",
    ),
    (
        "[palm.right]\nlength_m = -0.15",
        "palm.right.length_m: -0.15 is too small; allowed: a number in m, from 0.001 to 10",
    ),
    (
        "[palm]\nfriction = 0",
        "palm.friction: 0 is too small; allowed: a number, from 0.001 to 100",
    ),
    (
        "[palm]\nsteep_deg = 80",
        "palm.steep_deg: 80 is too large; allowed: a number in degrees, more than -80 and less "
        "than 80",
    ),
    (
        "[radio]\nloss = 1.5",
        "radio.loss: 1.5 is too large; allowed: a number, from 0 to 1",
    ),
    # Palms.
    (
        "[palm]\nsteep_deg = 5",
        "palm.steep_deg: 5.0 is not more than shallow_deg, which is 5; allowed: a number in "
        "degrees, more than 5 and less than 80",
    ),
    (
        "[palm.left]\nsteep_deg = 4",
        "palm.left.steep_deg: 4.0 is not more than shallow_deg, which is 5; allowed: a number in "
        "degrees, more than 5 and less than 80",
    ),
    (
        "[palm.right]\nfriction = 4",
        "palm.right.friction: 4.0 is too large for a palm at 15 degrees; allowed: less than "
        "3.73205 (friction angle + palm angle below 90 degrees)",
    ),
    # Outlines.
    (
        "[object]\nvertices_m = [[0, 0], [0.25, 0.16], [0.25, 0], [0, 0.16]]",
        "object.vertices_m: [[0.0, 0.0], [0.25, 0.16], [0.25, 0.0], [0.0, 0.16]] crosses itself: "
        f"the edge from vertex 0 to 1 meets the edge from vertex 2 to 3; {SIMPLE}",
    ),
    (
        "[object]\nvertices_m = [[0, 0], [0.25, 0], [0.1, 0]]",
        "object.vertices_m: [[0.0, 0.0], [0.25, 0.0], [0.1, 0.0]] crosses itself: the edge from "
        f"vertex 0 to 1 meets the edge from vertex 1 to 2; {SIMPLE}",
    ),
    (
        "[object]\nvertices_m = [[0, 0], [0, 0], [0.1, 0]]",
        "object.vertices_m: [[0.0, 0.0], [0.0, 0.0], [0.1, 0.0]] repeats vertex 0 as the next one; "
        f"{SIMPLE}",
    ),
    (
        "[object]\nvertices_m = [[0, 0], [0.25, 0]]",
        "object.vertices_m: [[0, 0], [0.25, 0]] has 2 items; allowed: a list of 3 to 32 points "
        "[x, y]",
    ),
    # Contact vertices.
    (
        "[object]\ncontacts = [0, 4]",
        "object.contacts: [0, 4] names vertex 4, but there are 4; allowed: two different whole "
        "numbers from 0 to 3",
    ),
    (
        "[object]\ncontacts = [1, 1]",
        "object.contacts: [1, 1] names contacts that are not apart; allowed: two vertices at "
        "least 0.001 m from each other",
    ),
    (
        "[object]\ncontacts = [1, 0]",
        "object.contacts: [1, 0] cannot carry the object: with the left one on the left and both "
        f"level, vertex 1 (left) is no corner of its lower side; {LOWER}",
    ),
    (
        "[object]\nvertices_m = [[0, 0], [0.25, 0], [0.125, 0.05], [0.2, 0.16], [0, 0.16]]\n"
        "contacts = [0, 2]",
        "object.contacts: [0, 2] cannot carry the object: with the left one on the left and both "
        f"level, vertex 2 (right) is no corner of its lower side; {LOWER}",
    ),
    # Centre of mass.
    (
        "[object]\ncom_m = [0.3, 0.04]",
        "object.com_m: [0.3, 0.04] is outside the outline; allowed: a point of the object",
    ),
    (
        "[object]\ncom_m = [0.1, 0]",
        "object.com_m: [0.1, 0.0] is not above the line between the contact vertices; allowed: a "
        "point above that line and between its ends",
    ),
    # Sensors and bumps.
    (
        '[tactile]\nzones = [{sign = "+", from_m = 0, to_m = 1},'
        '{sign = "-", from_m = -1, to_m = 0.1}]',
        'tactile.zones[0]: { sign = "+", from_m = 0.0, to_m = 1.0 } overlaps the zone - from -1 '
        "to 0.1; allowed: zones + and - that do not overlap each other",
    ),
    (
        '[tactile]\nzones = [{sign = "0", from_m = 0.1, to_m = 0}]',
        "tactile.zones[0].to_m: 0.0 is not more than from_m, which is 0.1; allowed: a number in "
        "m, more than 0.1 and at most 10",
    ),
    (
        '[tactile]\nzones = [{sign = "0", to_m = 0}]',
        "tactile.zones[0].from_m: is missing; needed there: sign, from_m, to_m",
    ),
    (
        '[bumps]\nscript = [{robot = "left", shift_m = 0.01}]',
        'bumps.script[0]: { robot = "left", shift_m = 0.01 } does not say when; allowed: exactly '
        "one of at_m and at_s",
    ),
    (
        '[bumps]\nscript = [{robot = "left", shift_m = 0, at_m = 1, at_s = 1}]',
        'bumps.script[0]: { robot = "left", shift_m = 0.0, at_m = 1.0, at_s = 1.0 } says twice '
        "when; allowed: exactly one of at_m and at_s",
    ),
    (
        '[[bumps.script]]\nrobot = "left"\nshift_mm = 1\nat_m = 1',
        "bumps.script[0].shift_mm: 1 is given to an unknown key; did you mean "
        "bumps.script[0].shift_m? allowed in bumps.script[0]: robot, shift_m, at_m, at_s",
    ),
    # Time.
    (
        "[radio]\nlatency_s = 2\njitter_s = 0.5",
        "radio.latency_s: 2.0 and a jitter_s of 0.5 are too long for control periods of 0.01 s; "
        "allowed: latency_s + jitter_s at most 2 (200 periods)",
    ),
    (
        "[task]\ntimeout_s = 500000",
        "task.timeout_s: 500000.0 is too long for control periods of 0.01 s; allowed: at most "
        "100000 (ten million periods)",
    ),
    (
        "[robot]\nspeed_m_s = 0",
        "robot.speed_m_s: 0.0 sets no time limit; allowed: a speed above 0, or a task.timeout_s",
    ),
    (
        "[robot.right]\nspeed_m_s = 0.3",
        "robot.right.speed_m_s: 0.3 is more than max_speed_m_s; allowed: a number in m/s, from 0 "
        "to 0.2",
    ),
    # Start.
    (
        "[start]\nleft_m = 0.08",
        "start.left_m: 0.08 is not on the palm; allowed: a number in m, from -0.075 to 0.075",
    ),
    (
        "[object]\nvertices_m = [[0, 0], [0.02, 0], [0.01, 0.02]]\ncom_m = [0.01, 0.01]\n"
        "[start]\nleft_m = -0.07\nright_m = 0.07",
        "start: [-0.07, 0.07] puts the contacts at heights -0.0181173 and 0.0181173 m, too far "
        "apart for an object that is 0.02 m wide between them; allowed: left_m and right_m at "
        "more equal heights",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line"), BAD, ids=[line.split(": ")[0] for _, line in BAD])
def test_bad_scenes(tmp_path, text, line):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    assert refusal(path) == f"{path}: {line}"
    assert refusal(tomllib.loads(text)) == f"scene: {line}"
    assert refusal("paper", tomllib.loads(text)) == f"overrides: {line}"


def test_of_several_faults_the_misspelt_key_is_told():
    line = refusal({"object": {"mass_kg": -1}, "task": {"distanc_m": 1}})
    assert line.startswith("scene: task.distanc_m: 1 is given to an unknown key; did you mean ")


@pytest.mark.parametrize("key", KEYS)
def test_a_misspelt_key_suggests_the_right_one(key):
    table, _, name = key.rpartition(".")
    for wrong in (name[1:], name[:1] + name[2:], name[1] + name[0] + name[2:], name + "s"):
        line = refusal("paper", {f"{table}.{wrong}": 1})
        assert line.startswith(f"overrides: {table}.{wrong}: 1 is given to an unknown key; ")
        assert f"did you mean {key}? allowed in {table}: " in line


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (10**400, f"1{'0' * 58}…"),
        (1 << 20_000, "<int>"),  # longer than Python is willing to print
        (None, "null"),
        (b"x", "b'x'"),
        (datetime.date(2001, 2, 3), "datetime.date(2001, 2, 3)"),
        ("a\nb\ud800" * 20, '"' + ("a\\nb\\ud800" * 20)[:58] + "…"),
    ],
    ids=["long", "very long", "none", "bytes", "date", "text"],
)
def test_values_are_shown_short_and_on_one_line(value, shown):
    line = refusal({"radio": {"loss": value}})
    assert line.startswith(f"scene: radio.loss: {shown} is ")


def test_numpy_numbers_are_numbers():
    for number in (np.float64(0.5), np.float32(0.5)):
        assert load_scene("paper", {"radio.loss": number}).radio.loss == 0.5
    one = load_scene("paper", {"radio.loss": np.int64(1), "object.contacts": [np.int8(0), 1]})
    assert type(one.radio.loss) is float
    assert type(one.object.contacts[0]) is int
    assert "is of type bool" in refusal("paper", {"radio.loss": np.True_})
