#!/usr/bin/env python3
"""Optimal segmentation by drivekit and by the Python package ruptures: the same series, the same cost, times and ratios.

    cargo build --release -p drivekit
    python3 crates/tseg/benches/compare_ruptures.py

Needs numpy and ruptures (`pip install ruptures`); without them it says so and ends with 0. The input is the WLTC at 10 Hz,
speed and acceleration with a dead band of 0.4 m/s2, both standardised, weights 1.8 and 1. drivekit is timed as a whole
process, reading included, on one thread; ruptures without its import.
"""

import csv
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy as np
    import ruptures as rpt
except ImportError as missing:
    print(f"skipped: {missing}; `pip install ruptures` brings it")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[3]
DRIVEKIT = ROOT / "target/release/drivekit"
WEIGHTS = (1.8, 1.0)
STEP_S = 0.1


def wltc(samples):
    """Speed in m/s at 10 Hz, linear between the seconds of the cycle."""
    with open(ROOT / "fixtures/cycles/wltc-3b.csv", newline="") as file:
        seconds = [float(row["speed_kmh"]) / 3.6 for row in csv.DictReader(file)]
    return np.interp(np.arange(samples) * STEP_S, np.arange(len(seconds)), seconds)


def series(speed):
    """What drivekit makes of the speed, also in that it rounds to multiples of 2^-32: without that, the rounding noise of a
    constant acceleration is a signal to z-scale."""
    accel = np.diff(speed) / STEP_S
    accel = np.append(accel, accel[-1])
    accel[np.abs(accel) < 0.4] = 0.0
    columns = [(x - x.mean()) / x.std(ddof=1) for x in (speed, accel)]
    return np.round(np.column_stack(columns) * 2.0**32) / 2.0**32


class ZScale(rpt.base.BaseCost):
    """Thesis (3.19) as a cost of ruptures."""

    model = "z-scale"
    min_size = 1

    def fit(self, signal):
        self.signal = signal
        return self

    def error(self, start, end):
        x = self.signal[start:end]
        if len(x) < 2:
            return 0.0
        deviation = np.abs(x - x.mean(axis=0)).sum(axis=0)
        spread = x.std(axis=0, ddof=1)
        varies = x.min(axis=0) < x.max(axis=0)
        terms = np.divide(deviation, spread, out=np.zeros_like(spread), where=varies)
        return float(terms @ np.array(WEIGHTS))


def drivekit(path, cost, segments, min_length):
    """Boundaries, cost and seconds of the whole process."""
    command = [DRIVEKIT, "segment", path, "--raw", "--method", "dynamic", "--cost", cost]
    command += ["--segments", str(segments), "--min-length", str(min_length)]
    command += ["--weights", ",".join(map(str, WEIGHTS)), "--scale", "zscore", "--merge", "none"]
    command += ["--threads", "1", "--format", "json", "--quiet"]
    start = time.perf_counter()
    run = subprocess.run([str(word) for word in command], check=True, capture_output=True)
    seconds = time.perf_counter() - start
    log = json.loads(run.stdout)["logs"][0]
    return log["boundaries"], log["cost"], seconds


def compare(name, samples, segments, min_length, cost, search, signal, total):
    speed = wltc(samples)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "wltc.csv"
        with open(path, "w") as file:
            file.write("time_s,speed_mps\n")
            file.writelines(f"{i * STEP_S:.1f},{v!r}\n" for i, v in enumerate(speed.tolist()))
        ours, our_cost, our_seconds = drivekit(path, cost, segments, min_length)
    x = signal(series(speed))
    start = time.perf_counter()
    theirs = [0, *search().fit(x).predict(n_bkps=segments - 1)]
    seconds = time.perf_counter() - start
    their_cost = total(series(speed), theirs)
    same = "the same boundaries" if theirs == ours else "other boundaries"
    excess = (their_cost - our_cost) / our_cost if our_cost else 0.0
    print(
        f"{name:34} n = {samples:6} k = {segments:4}  drivekit {our_seconds:8.3f} s  ruptures {seconds:9.3f} s  "
        f"ratio {seconds / our_seconds:8.1f}  cost of ruptures / drivekit - 1 = {excess:9.1e}, {same}"
    )


def squared_total(x, boundaries):
    parts = [x[a:b] for a, b in zip(boundaries, boundaries[1:])]
    return math.fsum(float((((p - p.mean(axis=0)) ** 2).sum(axis=0) * WEIGHTS).sum()) for p in parts)


def z_scale_total(x, boundaries):
    cost = ZScale().fit(x)
    return math.fsum(cost.error(a, b) for a, b in zip(boundaries, boundaries[1:]))


def main():
    if not DRIVEKIT.exists():
        print("skipped: no target/release/drivekit; run `cargo build --release -p drivekit`")
        return
    weighted = lambda x: x * np.sqrt(WEIGHTS)
    for samples, segments in [(1500, 40), (3000, 80), (6000, 160)]:
        compare("squared error, KernelCPD (C)", samples, segments, 5, "squared-error",
                lambda: rpt.KernelCPD(kernel="linear", min_size=5), weighted, squared_total)
    compare("squared error, Dynp (Python)", 400, 10, 5, "squared-error",
            lambda: rpt.Dynp(model="l2", min_size=5, jump=1), weighted, squared_total)
    compare("z-scale (3.19), Dynp (Python)", 300, 10, 5, "z-scale",
            lambda: rpt.Dynp(custom_cost=ZScale(), min_size=5, jump=1), lambda x: x, z_scale_total)


if __name__ == "__main__":
    main()
