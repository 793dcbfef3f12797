# SPDX-License-Identifier: Apache-2.0
"""The view Proofs: every pinned counterexample of the model checker, step by step."""

import json
import re
import tomllib
from typing import Any

from playwright.sync_api import expect

import model_check
import palmbots as pb
from site_pages import ROOT, Open, pictures

COUNTEREXAMPLES = ROOT / "verify" / "counterexamples"
RUNS = ROOT / "verify" / "runs.toml"
SCENES = sorted(path.stem for path in COUNTEREXAMPLES.glob("*.toml"))


def stated_claims() -> dict[str, set[str]]:
    """The claims and formulas of all models by name, in the words of their comments."""
    found: dict[str, set[str]] = {}
    for path in (ROOT / "verify" / "models").glob("*.pml"):
        lines = path.read_text().splitlines()
        for line, after in zip(lines, [*lines[1:], ""], strict=True):
            words = re.search(r"/\* (?:S\d: )?(.+) \*/$", line)
            name = re.match(r"#define (\w+) \d+ ", line) or re.match(r"ltl (\w+) ", after)
            if words and name:
                found.setdefault(name[1], set()).add(words[1].removesuffix("."))
    return found


def with_numbers(words: str, run: dict[str, Any]) -> str:
    """Words of a claim with the numbers of a run in place of the model's parameters."""
    says = re.sub(r"\b[A-Z]{3,}\b", lambda name: str(run.get(name[0], name[0])), words)
    return says[0].lower() + says[1:]


SHOWN = sorted(name for name, run in model_check.runs().items() if run.fails)


def test_every_counterexample_plays_to_its_end(open_page: Open) -> None:
    page = open_page("#proofs")
    expect(page.locator("#run")).to_be_visible()
    claims = stated_claims()
    runs = {run["name"]: run for run in tomllib.loads(RUNS.read_text())["run"]}
    names = page.locator("#run option").all_inner_texts()
    assert names == SHOWN
    for name in names:
        page.locator("#run").select_option(name)
        title = (COUNTEREXAMPLES / f"{name}.txt").read_text().splitlines()[0]
        says = title.rsplit(": ", 1)[0]
        expect(page.locator(".claim strong")).to_have_text(f"{says[0].upper()}{says[1:]}.")
        claim = title.rsplit(": ", 1)[1].removesuffix(" is violated")
        stated = [with_numbers(words, runs[name]) for words in claims[claim]]
        shown = page.locator(".claim").inner_text()
        assert any(f"“{words}” ({claim}) fails" in shown for words in stated), shown
        # A breadth-first search finds a shortest run; it needs a claim, and memory for its depth.
        is_shortest = "formula" not in runs[name] and "depth" not in runs[name]
        how = "breadth-first" if is_shortest else "depth-first"
        expect(page.locator("#search")).to_contain_text(f"A {how} search found this run")
        page.locator("#scrub").fill("100000")
        expect(page.locator(".time")).to_have_text(re.compile(r"^(\d+) of \1$"))


# Goes to every step of every counterexample and returns what the page shows there.
EVERY_STEP = """async () => {
  const wait = () => new Promise(done => setTimeout(done));
  const by = id => document.getElementById(id);
  const change = async (id, value, kind) => {
    by(id).value = value;
    by(id).dispatchEvent(new Event(kind, { bubbles: true }));
    await wait();
  };
  const shown = {};
  for (const name of [...by("run").options].map(option => option.value)) {
    await change("run", name, "change");
    shown[name] = [];
    for (let k = 0; k <= Number(by("scrub").max); ++k) {
      await change("scrub", k, "input");
      const rows = [...document.querySelectorAll(".robots tbody tr")].map(row => [
        row.querySelector("th").textContent,
        [...row.querySelectorAll("td")].map(cell => cell.textContent),
      ]);
      shown[name].push({
        place: document.querySelector(".time").textContent,
        rows: Object.fromEntries(rows),
        events: document.querySelector(".events").textContent,
      });
    }
  }
  return shown;
}"""


def transcript_of(name: str) -> tuple[list[list[str]], list[tuple[str, str]]]:
    """The lines before each step of a transcript, and those after the last; what it says of the
    left and the right robot in each step."""
    events: list[list[str]] = [[]]
    steps: list[tuple[str, str]] = []
    for line in (COUNTEREXAMPLES / f"{name}.txt").read_text().splitlines()[2:]:
        if " left " in f"{line} " and " right " in line and re.match(r" {0,3}\d", line):
            left, right = line.split(" right ", 1)
            steps.append((left.split(" left ", 1)[1].strip(), right.strip()))
            events.append([])
        elif not line.endswith(":"):
            events[-1].append(line.strip())
    return events, steps


def test_every_step_shows_what_the_transcript_says(open_page: Open) -> None:
    """Contact, palm, drive, what a robot waits for, and what happens before the step."""
    page = open_page("#proofs")
    expect(page.locator("#run")).to_be_visible()
    shown = page.evaluate(EVERY_STEP)
    assert list(shown) == SHOWN
    drives = set()
    for name, views in shown.items():
        events, steps = transcript_of(name)
        assert [view["place"] for view in views] == [
            f"{k + 1} of {len(steps)}" for k in range(len(steps))
        ]
        for k, (view, said) in enumerate(zip(views, steps, strict=True)):
            for words in events[k]:
                assert words in view["events"], (name, k)
            for side, words in enumerate(said):
                row = {key: cells[side] for key, cells in view["rows"].items()}
                assert row["state"]
                if lifts := re.fullmatch(r"arm +(\d) (\w+)", words):
                    assert row["arm"] == ("on the floor" if lifts[1] == "0" else f"{lifts[1]} up")
                    assert row["state"].endswith(f" {lifts[2]}")
                    continue
                if "hears" in words:
                    assert row == {"state": words}
                    continue
                palm = "steep" if "steep" in words else "shallow"
                assert row["palm"] == palm + (", turning" if "…" in words else "")
                if "contact p" in row:
                    assert int(row["contact p"].replace("−", "-")) == int(words.split()[0])
                drive = "away" if "away" in words else "closer" if "closer" in words else "hold"
                assert row["drive"].split(", ")[0] == drive
                assert ("stands" in row["drive"]) == (" rests " in words)
                assert ("misses" in row["drive"]) == ("naps" in words)
                if "waits for" in words:
                    assert row["state"].endswith(words[words.index("waits for") :])
                case = re.search(r"\(([a-d])\)", words)
                assert case is None or row["state"].startswith(f"({case[1]}) ")
                drives.add(drive)
    assert drives == {"hold", "away", "closer"}


def test_a_counterexample_is_stepped_along_its_chart(open_page: Open) -> None:
    page = open_page("#proofs?v.run=late-ack")
    place = page.locator(".player .time")
    expect(place).to_have_text("1 of 6")
    page.locator("#step-on").click()
    expect(place).to_have_text("2 of 6")
    page.locator("#step-back").click()
    expect(place).to_have_text("1 of 6")
    chart = page.locator("#proof-chart")
    box = chart.bounding_box()
    assert box is not None
    before = pictures(page, "proof-chart")
    # The columns of the six steps follow each other behind 44 pixels with the names of the robots.
    column = (box["width"] - 50) / 6
    chart.click(position={"x": 44 + 3.5 * column, "y": 40})
    expect(place).to_have_text("4 of 6")
    assert pictures(page, "proof-chart") != before
    chart.focus()
    page.keyboard.press("ArrowRight")
    expect(place).to_have_text("5 of 6")
    page.keyboard.press("Home")
    expect(place).to_have_text("1 of 6")
    page.keyboard.press("End")
    expect(place).to_have_text("6 of 6")
    assert "step=5" in page.evaluate(
        "() => new Promise(done => setTimeout(() => done(location.hash), 300))"
    )


def test_a_carry_goes_along_with_the_steps(open_page: Open) -> None:
    """Where there is a scene: at each message of the transcript, the carry has just sent it."""
    page = open_page("#proofs")
    expect(page.locator("#run")).to_be_visible()
    with_carry = [
        name for name in page.locator("#run option").all_inner_texts()
        if page.locator("#run").select_option(name) and page.locator("#proof-carry").count()
    ]  # fmt: skip
    assert with_carry == SCENES
    for name in ("lost-b-tilt-down", "late-ack", "zone-narrow"):
        page.locator("#run").select_option(name)
        carried = pb.carry(COUNTEREXAMPLES / f"{name}.toml", "distributed")
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)
        events, steps = transcript_of(name)
        sent = {side: [m.sent_s for m in carried.message_log if m.sender == side]
                for side in ("left", "right")}  # fmt: skip
        times = []
        picture = ""
        for k in range(len(steps)):
            page.locator("#scrub").fill(str(k))
            times.append(float(page.locator("#carry-time").inner_text().split()[0]))
            now = [sent[words.split()[0]].pop(0) for words in events[k] if " sends " in words]
            if now and name != "zone-narrow":
                assert max(now) <= times[-1] <= max(now) + 0.021
            before, picture = picture, pictures(page, "proof-carry")
            assert k == 0 or picture != before or times[-1] == times[-2]
        assert times == sorted(times)
        assert times[-1] > times[0]
        assert times[-1] <= carried.time_s + 0.005  # it is shown with two digits


def test_a_counterexample_is_carried(open_page: Open) -> None:
    page = open_page("#proofs?v.run=reboot-fight")
    page.locator("#carry-it").click()
    carried = pb.carry(COUNTEREXAMPLES / "reboot-fight.toml")
    expect(page.locator("#hash")).to_have_text(carried.trace_hash)


def test_a_counterexample_moves_by_itself(open_page: Open) -> None:
    page = open_page("#proofs", moves=True)
    expect(page.locator(".time")).to_contain_text("4 of 4")
    assert json.loads(page.evaluate("JSON.stringify(document.title)"))
