"""The Robotarium's Python simulator as the robots of `drivekit ctrl run --live`.

Needs the package `rps` (https://github.com/robotarium/robotarium_python_simulator). In the link file:

    [poses]
    kind = "program"
    command = ["python3", "crates/testbed-io/examples/robotarium_simulator.py"]     # --no-figure without a window

    [commands]
    kind = "program"

Newer versions of the simulator first drive the robots to where the scenario starts, which takes about a minute. Poses are sent
from then on; until then the session is told that robots are getting ready, and waits.
"""
import json
import math
import os
import sys
import threading
import time

# The simulator prints; standard output belongs to the protocol.
to_drivekit = os.fdopen(os.dup(sys.stdout.fileno()), "w")
sys.stdout = sys.stderr

starts = json.loads(os.environ["DRIVEKIT_STARTS"])
column = {start["robot"]: index for index, start in enumerate(starts)}
velocities = [[0.0] * len(starts), [0.0] * len(starts)]
ready = threading.Event()
over = threading.Event()


def say(line):
    to_drivekit.write(json.dumps(line) + "\n")


def listen():
    for line in sys.stdin:
        command = json.loads(line)
        robot = column[command["robot"]]
        velocities[0][robot], velocities[1][robot] = command["v"], command["w"]
    stop()
    if not ready.is_set():
        os._exit(0)


def stop():
    velocities[:] = [[0.0] * len(starts), [0.0] * len(starts)]
    over.set()


def wait():
    while not ready.is_set():
        say({"getting_ready": "the simulator drives its robots to their starts"})
        to_drivekit.flush()
        ready.wait(1.0)


def approach(start, x, y, theta):
    """Speeds from a pose towards a start; None from within 5 mm and 1 degree."""
    away, ahead = math.hypot(start["x"] - x, start["y"] - y), 1.0
    turn = start["theta"] - theta
    if away > 0.005:
        turn = math.atan2(start["y"] - y, start["x"] - x) - theta
        if math.cos(turn) < 0.0:
            turn, ahead = turn + math.pi, -1.0
    turn = math.remainder(turn, math.tau)
    if away > 0.005:
        return ahead * min(away, 0.05) * math.cos(turn), turn
    return (0.0, turn) if abs(turn) > math.radians(1.0) else None


def settle():
    """The simulator is content with 5 cm, which is much in a narrow lane. For at most 20 s."""
    for _ in range(600):
        poses = testbed.get_poses()
        speeds = [approach(start, *(poses[axis][i] for axis in range(3))) for i, start in enumerate(starts)]
        towards = np.array([[speed[axis] if speed else 0.0 for speed in speeds] for axis in range(2)])
        testbed.set_velocities(np.arange(len(starts)), towards)
        testbed.step()
        if not any(speeds):
            return


threading.Thread(target=listen, daemon=True).start()
waiting = threading.Thread(target=wait, daemon=True)
waiting.start()

import numpy as np  # noqa: E402
from rps.robotarium import Robotarium  # noqa: E402

# The constructor returns when the robots are near.
testbed = Robotarium(
    number_of_robots=len(starts),
    show_figure="--no-figure" not in sys.argv,
    initial_conditions=np.array([[s["x"], s["y"], s["theta"]] for s in starts]).T,
    sim_in_real_time=True,
)
settle()
ready.set()
waiting.join()
while not over.is_set():
    poses = testbed.get_poses()
    try:
        for robot, index in column.items():
            x, y, theta = (float(poses[axis][index]) for axis in range(3))
            say({"robot": robot, "x": x, "y": y, "theta": theta, "t": time.monotonic()})
        to_drivekit.flush()
    except BrokenPipeError:
        stop()
    testbed.set_velocities(np.arange(len(starts)), np.array(velocities))
    testbed.step()
# The simulator's verdict, under its older and its newer name.
(testbed.debug if hasattr(testbed, "debug") else testbed.call_at_scripts_end)()
