#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Packet loss with the resilient algorithm and with Table 2: many carries at each loss rate.

    .venv/bin/python benchmarks/bench_loss.py [CARRIES]        10 000 each by default

Half of the losses are single, half come in bursts of 0.1 s; 5 % of the packets come twice, 30 ms of
jitter lets them overtake, and one robot reboots in every carry of the resilient algorithm. Writes
benchmarks/results/loss.csv, and loss_by_time.csv: how many carries of Table 2 have lost a
message by some time at 1 % loss. Seeds are 0, 1, …; the counts depend on nothing but the version.
"""

import csv
import sys
from pathlib import Path
from typing import Any

import numpy as np

import palmbots as pb
from palmbots._util.confidence_intervals import wilson
from palmbots.simulation.unavoidable_drops import is_unavoidable

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from lossy_radio import lossy, many

RESULT = Path(__file__).parent / "results" / "loss.csv"
BY_TIME = RESULT.with_name("loss_by_time.csv")
LOSSES = (0.0, 0.01, 0.05, 0.1, 0.2, 0.4)
DELIVERED, DROPPED, STALLED = 1, 2, 3


def rms_mm(cell: dict[str, np.ndarray]) -> float:
    """Of both contacts, over all carries."""
    return 1e3 * float(np.sqrt(np.mean(cell["contact_rms_m"] ** 2)))


def row(loss: float, n: int, lossless_mm: float) -> dict[str, Any]:
    """One cell: the resilient algorithm, and beside it what becomes of Table 2 on a lossy radio."""
    cell = many(lossy(loss), "resilient", n)
    outcome = cell["outcome"]
    dropped = np.nonzero(outcome == DROPPED)[0]
    again = [pb.carry("paper", "resilient", seed=int(s), overrides=lossy(loss)) for s in dropped]
    unavoidable = sum(is_unavoidable(carry) for carry in again)
    table2 = many({"radio.loss": loss}, "distributed", n)
    messages = many({}, "distributed", n)["messages"].astype(float)
    hit = int(np.count_nonzero(table2["messages_lost"]))
    low, high = wilson(hit, n)
    return {
        "loss": loss,
        "carries": n,
        "delivered": int(np.count_nonzero(outcome == DELIVERED)),
        "dropped_unavoidable": unavoidable,
        "dropped_avoidable": len(dropped) - unavoidable,
        "stalled": int(np.count_nonzero(outcome == STALLED)),
        "rms_mm": round(rms_mm(cell), 3),
        "rms_ratio": round(rms_mm(cell) / lossless_mm, 3),
        "mean_time_s": round(float(np.mean(cell["time_s"])), 2),
        "messages_per_s": round(float(cell["messages"].sum() / cell["time_s"].sum()), 2),
        "table2_dropped": int(np.count_nonzero(table2["outcome"] == DROPPED)),
        "table2_affected": round(hit / n, 4),
        "table2_affected_low": round(low, 4),
        "table2_affected_high": round(high, 4),
        "table2_expected": round(float(np.mean(1 - (1 - loss) ** messages)), 4),
    }


def by_time(n: int, loss: float = 0.01) -> list[dict[str, Any]]:
    """Table 2: the carries that have lost a message by some time, and the number expected if
    each message is lost independently. Until then a carry sends what it sends on a perfect
    radio."""
    rows = []
    for by_s in (2.0, 5.0, 10.0, 15.0, 20.0, 25.0):
        until = {"task.timeout_s": by_s}
        messages = many(until, "distributed", n)["messages"].astype(float)
        hit = np.count_nonzero(
            many(until | {"radio.loss": loss}, "distributed", n)["messages_lost"]
        )
        low, high = wilson(int(hit), n)
        rows.append({
            "by_s": by_s, "loss": loss, "carries": n, "messages": round(float(messages.mean()), 2),
            "affected": round(hit / n, 4), "low": round(low, 4), "high": round(high, 4),
            "expected": round(float(np.mean(1 - (1 - loss) ** messages)), 4),
        })  # fmt: skip
    return rows


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    """As CSV."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    """All cells, printed and written as they come."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    plain = many({}, "distributed", n)
    perfect = many({}, "resilient", n)
    each = [np.sqrt(np.mean(c["contact_rms_m"] ** 2, axis=1)) for c in (perfect, plain)]
    ratio = np.log(each[0] / each[1])
    spread = 1.96 * float(ratio.std()) / np.sqrt(n)
    mean = float(ratio.mean())
    print(f"perfect radio: rms ratio to Table 2 {np.exp(mean):.4f}, 95 % interval "
          f"{np.exp(mean - spread):.4f} to {np.exp(mean + spread):.4f}")  # fmt: skip
    per_metre = {
        name: float(c["messages"].mean()) / 1.5
        for name, c in (("distributed", plain), ("resilient", perfect))
    }
    print(f"messages per metre: {per_metre}")
    rows = by_time(n)
    for line in rows:
        print(line)
    write(BY_TIME, rows)
    rows = []
    for loss in LOSSES:
        rows.append(row(loss, n, rms_mm(plain)))
        print(rows[-1], flush=True)
    write(RESULT, rows)


if __name__ == "__main__":
    main()
