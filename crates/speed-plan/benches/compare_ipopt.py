#!/usr/bin/env python3
"""A plan beside IPOPT's of the same problem: energy, time and whether it stays above the bound.

    cargo bench --workspace --bench plan -- --export FOLDER
    cargo build --workspace --release --bin drivekit
    python3 crates/speed-plan/benches/compare_ipopt.py --case FOLDER/10-km.json

Any problem that `drivekit plan --case` takes will do, without signals, leader and accelerations that change with the speed. Needs
CasADi with its IPOPT (`pip install casadi`) and drivekit; without them it says so and ends with 0. IPOPT gets the squared speeds at
the nodes and the torque of every step, which is at least what every piece of its law asks for, so that there are no kinks but those of
the fade of regeneration, rounded over a thousandth of it. Derivatives are CasADi's; it starts from three quarters of the limits. The
energy of the speeds that it finds is evaluated without rounding. Times are processor time of one thread, the least of several runs; that of drivekit is
its own `solve_ms`, the time that passed while it planned.
"""

import argparse
import json
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path

try:
    import casadi as ca
except ImportError as missing:
    print(f"skipped: {missing}; `pip install casadi` brings it")
    sys.exit(0)

GRAVITY_MPS2 = 9.81
FADE_WIDTH = 1e-3
REPETITIONS = 3


class Car:
    """Torques and powers; `positive(x)` is max(x, 0), exact or rounded."""

    def __init__(self, spec):
        motor, regeneration, battery, road = (spec[key] for key in ("motor", "regeneration", "battery", "road_load"))
        radius, ratio, efficiency = spec["wheel_radius_m"], spec["gear_ratio"], spec["gear_efficiency"]
        self.mass_kg = spec["mass_kg"]
        self.inertia_kg = self.mass_kg + spec["rotating_inertia_kg_m2"] / radius**2
        self.road = (road["constant_n"], road["linear_n_per_mps"], road["quadratic_n_per_mps2"])
        self.c = ratio / radius
        self.propelling, self.braking = radius / (ratio * efficiency), radius * efficiency / ratio
        spin = 1.0 - motor.get("spin_share_in_road_load", 0.0)
        self.copper, self.iron = motor["copper_w_per_nm2"], spin * motor["iron_w_per_rad_s"] * self.c
        self.windage = spin * motor["windage_w_per_rad3_s3"] * self.c**3
        self.motor_w, self.auxiliary_w = motor["constant_w"], spec["auxiliary_power_w"]
        self.voltage, self.resistance = battery["open_circuit_voltage_v"], battery["resistance_ohm"]
        self.max_nm, self.max_w = motor["max_torque_nm"], motor["max_power_w"]
        share = regeneration["torque_fraction"]
        self.regeneration_n = min(
            share * self.max_nm / self.braking, regeneration["max_decel_mps2"] * self.inertia_kg
        )
        self.regeneration_w = min(share * self.max_w, regeneration["max_power_w"]) / (self.braking * self.c)
        self.fade = (regeneration["fade_start_mps"], regeneration["fade_end_mps"])

    def torques(self, w, accel, slope, positive):
        """The motor's torque is the largest of these."""
        a, b, c = self.road
        force = self.inertia_kg * accel + a * math.cos(slope) + (b + c * w) * w
        force += self.mass_kg * GRAVITY_MPS2 * math.sin(slope)
        start, end = self.fade
        fade = positive((w - start) / (end - start))
        fade = fade - positive(fade - 1.0)
        limited = [-self.braking * fade * limit_n for limit_n in (self.regeneration_n, self.regeneration_w / w)]
        return [self.propelling * force, self.braking * force, *limited]

    def electric_w(self, w, torque):
        loss_w = self.copper * torque**2 + (self.iron + self.windage * w * w) * w + self.motor_w
        return torque * self.c * w + loss_w + self.auxiliary_w

    def cells_w(self, electric_w, root):
        u = self.voltage
        return 2.0 * electric_w * u / (u + root(u * u - 4.0 * self.resistance * electric_w))

    def standing_w(self, slope):
        """Held by the motor uphill, by the brakes downhill."""
        torque = max(self.mass_kg * GRAVITY_MPS2 * math.sin(slope), 0.0) * self.propelling
        loss_w = self.copper * torque**2 + self.motor_w if torque > 0.0 else 0.0
        return self.cells_w(loss_w + self.auxiliary_w, math.sqrt)


class Case:
    def __init__(self, path):
        case = json.loads(Path(path).read_text())
        self.car = Car(case["vehicle"])
        self.length = [b - a for a, b in zip(case["position_m"], case["position_m"][1:])]
        self.slope = case["slope_rad"]
        self.low, self.high = case["speed_min_mps"], case["speed_max_mps"]
        self.accel = (case.get("accel_min_mps2", -2.0), case.get("accel_max_mps2", 1.5))
        self.latest_s = case.get("latest_arrival_s")
        self.dwell = {stop["node"]: stop["dwell_s"] for stop in case.get("stops", []) if stop["node"] < len(self.slope)}
        self.stranger = next(
            (key for key in ("signals", "earliest_passage_s", "accel_envelope") if case.get(key)), None
        )

    def steps(self, speed):
        """Mean speed, acceleration, length and slope of every step."""
        for k, (length, slope) in enumerate(zip(self.length, self.slope)):
            accel = (speed[k + 1] ** 2 - speed[k] ** 2) / (2.0 * length)
            yield 0.5 * (speed[k] + speed[k + 1]), accel, length, slope

    def totals(self, speed, torques, root):
        """Energy and time."""
        energy_j, time_s = 0.0, 0.0
        for (w, _, length, _), torque in zip(self.steps(speed), torques):
            energy_j += self.car.cells_w(self.car.electric_w(w, torque), root) * length / w
            time_s += length / w
        for node, dwell_s in self.dwell.items():
            slope = 0.5 * (self.slope[max(node - 1, 0)] + self.slope[node])
            energy_j += self.car.standing_w(slope) * dwell_s
            time_s += dwell_s
        return energy_j, time_s

    def torques(self, speed):
        pieces = [self.car.torques(w, accel, slope, lambda x: max(x, 0.0)) for w, accel, _, slope in self.steps(speed)]
        return [max(asked) for asked in pieces]

    def start(self):
        """Squared speeds of three quarters of the limits, under gentle accelerations."""
        z = [max(low, 0.75 * high) ** 2 for low, high in zip(self.low, self.high)]
        for k, length in enumerate(self.length):
            z[k + 1] = max(min(z[k + 1], z[k] + length), self.low[k + 1] ** 2)
        for k in reversed(range(len(self.length))):
            z[k] = max(min(z[k], z[k + 1] + self.length[k]), self.low[k] ** 2)
        return z


def solve(case):
    nodes = range(len(case.low))
    free = [k for k in nodes if case.high[k] > case.low[k]]
    z, torque = ca.SX.sym("z", len(free)), ca.SX.sym("torque", len(case.length))
    squared = {k: z[i] for i, k in enumerate(free)}
    speed = [ca.sqrt(squared[k]) if k in squared else case.high[k] for k in nodes]
    rounded = lambda x: 0.5 * (x + ca.sqrt(x * x + FADE_WIDTH**2))
    car, steps = case.car, list(case.steps(speed))
    rows, low, high = [], [], []
    for k, (w, accel, _, slope) in enumerate(steps):
        above = [(torque[k] - least) / car.max_nm for least in car.torques(w, accel, slope, rounded)]
        rows += [accel, torque[k] * car.c * w / car.max_w, *above]
        low += [case.accel[0], -ca.inf, *(0.0 for _ in above)]
        high += [case.accel[1], 1.0, *(ca.inf for _ in above)]
    energy_j, time_s = case.totals(speed, ca.vertsplit(torque), ca.sqrt)
    if case.latest_s is not None:
        rows.append(time_s)
        low.append(-ca.inf)
        high.append(case.latest_s)
    options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.tol": 1e-9}
    program = {"x": ca.vertcat(z, torque), "f": energy_j / 1e3, "g": ca.vertcat(*rows)}
    solver = ca.nlpsol("plan", "ipopt", program, options)
    start = case.start()
    torques = case.torques([math.sqrt(square) for square in start])
    settings = {
        "x0": [start[k] for k in free] + torques,
        "lbx": [case.low[k] ** 2 for k in free] + [-ca.inf for _ in steps],
        "ubx": [case.high[k] ** 2 for k in free] + [car.max_nm for _ in steps],
        "lbg": low,
        "ubg": high,
    }
    least_s = math.inf
    for _ in range(REPETITIONS):
        before = time.process_time()
        solution = solver(**settings)
        least_s = min(least_s, time.process_time() - before)
    found = dict(zip(free, solution["x"].full().ravel()))
    speed = [math.sqrt(found[k]) if k in found else case.high[k] for k in nodes]
    energy_j, time_s = case.totals(speed, case.torques(speed), math.sqrt)
    stats = solver.stats()
    return energy_j, time_s, 1e3 * least_s, stats["iter_count"], stats["return_status"]


def main():
    parser = argparse.ArgumentParser(description="Compares plans with those of IPOPT.")
    parser.add_argument("--case", required=True, type=Path, nargs="+", help="problems as `drivekit plan --case` takes them")
    parser.add_argument("--drivekit", default="target/release/drivekit", help="the program; target/release/drivekit")
    arguments = parser.parse_args()
    if shutil.which(arguments.drivekit) is None:
        print(f"skipped: there is no {arguments.drivekit}; `cargo build --workspace --release --bin drivekit` makes it")
        return
    print(f"CasADi {ca.__version__}")
    for path in arguments.case:
        case = Case(path)
        if case.stranger:
            print(f"{path}: skipped: it has `{case.stranger}`")
            continue
        command = [arguments.drivekit, "plan", "--case", path, "--format", "json"]
        runs = [subprocess.run(command, capture_output=True, text=True) for _ in range(REPETITIONS)]
        documents = [json.loads(run.stdout) for run in runs if run.stdout]
        if not documents or not documents[0]["plans"]:
            print(f"{path}: skipped: there is no plan: {(runs[0].stderr or runs[0].stdout).strip()[:200]}")
            continue
        plan = documents[0]["plans"][0]
        own_ms = min(document["plans"][0]["solve_ms"] for document in documents)
        energy_j, time_s, ms, iterations, status = solve(case)
        above_pct = 100.0 * (energy_j - plan["energy_j"]) / abs(plan["energy_j"])
        verdict = "not below the bound" if energy_j >= plan["lower_bound_j"] * (1.0 - 1e-9) else "BELOW THE BOUND"
        print(
            f"{path}: {len(case.low)} nodes; drivekit {own_ms:.2f} ms, gap {plan['gap_pct']:.4f} %; "
            f"IPOPT {ms:.0f} ms, {ms / own_ms:.1f} times, {iterations} iterations, {status}; "
            f"its energy is {above_pct:+.5f} % from the plan's, {verdict}; arrives {time_s - plan['time_s']:+.1e} s after it"
        )


if __name__ == "__main__":
    main()
