#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page in a browser: from a cold load to the first motion, and frames per second.

    .venv/bin/python benchmarks/bench_page.py [SECONDS]        5 for each rate by default

Needs `make site`. Chromium has no window and draws with the processor; a new profile for each load
makes it cold. A rate depends on what else the machine does; the processor time of a frame, over all
processes of the browser, hardly does. So the load of the machine before the measurement is part of
the results, benchmarks/results/page.csv.
"""

import csv
import statistics
import sys
import threading
from pathlib import Path

from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from _machine import load, processor

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from serve_site import server  # noqa: E402

RESULTS = Path(__file__).parent / "results" / "page.csv"
LOADS = 9
SIZE = ViewportSize(width=1280, height=900)
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
SECONDS = "() => parseFloat(document.querySelector('.time')?.innerText ?? 0)"
RATE = """async seconds => {
  const start = performance.now();
  let frames = 0;
  while (performance.now() - start < 1000 * seconds) {
    await new Promise(requestAnimationFrame);
    BEFORE
    frames += 1;
  }
  return 1000 * frames / (performance.now() - start);
}"""
# Drags the centre of mass to and fro, a step in every frame.
DRAG = """
    const handle = document.getElementById('handle-com');
    const key = frames % 40 < 20 ? 'ArrowRight' : 'ArrowLeft';
    handle.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
"""


def first_motion_ms(page: Page, address: str) -> float:
    """From the start of the navigation until the carry has moved."""
    page.goto(address, wait_until="commit")
    page.wait_for_function(f"() => ({SECONDS})() > 0", polling="raf")
    return float(page.evaluate("performance.now()"))


def rate(browser: Browser, page: Page, seconds: float, before: str = "") -> tuple[float, float]:
    """Frames per second, and the processor time of a frame in ms."""
    session = browser.new_browser_cdp_session()

    def used_s() -> float:
        return sum(p["cpuTime"] for p in session.send("SystemInfo.getProcessInfo")["processInfo"])

    start = used_s()
    per_second = float(page.evaluate(RATE.replace("BEFORE", before), seconds))
    return per_second, 1000 * (used_s() - start) / (per_second * seconds)


def main() -> None:
    """Measure, print and write the results."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    rows: list[tuple[str, float, str]] = []
    before_it = load()
    with server() as serving, sync_playwright() as playwright:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{serving.server_port}/"
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=ARGUMENTS)
        loads = []
        for _ in range(LOADS):
            context = browser.new_context(viewport=SIZE)
            loads.append(first_motion_ms(context.new_page(), address))
            context.close()
        rows.append(("cold load to first motion, median", statistics.median(loads), "ms"))
        page = browser.new_context(viewport=SIZE).new_page()
        page.goto(address)
        page.wait_for_function(f"() => ({SECONDS})() > 0")
        for what, place, before in (
            ("Carry while it plays", "", ""),
            ("Mechanics while the COM is dragged", "#mechanics", DRAG),
        ):
            if place:
                page.goto(address + place)
                page.wait_for_selector("#handle-com")
            per_second, each_ms = rate(browser, page, seconds, before)
            rows += [(what, per_second, "frames/s"), (f"{what}: processor time", each_ms, "ms")]
        version = browser.version
        browser.close()
        serving.shutdown()
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["what", "value", "unit", "load before", "browser", "processor"])
        for what, value, unit in rows:
            print(f"{what}: {value:.3g} {unit}")
            writer.writerow(
                [what, f"{value:.3g}", unit, f"{before_it:.1f}", f"Chromium {version}", processor()]
            )
    print(f"load of the machine before: {before_it:.1f}")
    print(f"wrote {RESULTS.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
