"""The Robotarium's Python simulator as the robots of `drivekit ctrl run --live`.

Needs the package `rps` (https://github.com/robotarium/robotarium_python_simulator). In the link file:

    [poses]
    kind = "program"
    command = ["python3", "bridges/robotarium_simulator.py"]     # --no-figure without a window

    [commands]
    kind = "program"

Newer versions of the simulator first drive the robots to where the scenario starts, which takes half a minute.
"""
import json
import os
import sys
import threading
import time

import numpy as np

# The simulator prints; standard output belongs to the protocol.
to_drivekit = os.fdopen(os.dup(sys.stdout.fileno()), "w")
sys.stdout = sys.stderr

from rps.robotarium import Robotarium  # noqa: E402

starts = json.loads(os.environ["DRIVEKIT_STARTS"])
column = {start["robot"]: index for index, start in enumerate(starts)}
testbed = Robotarium(
    number_of_robots=len(starts),
    show_figure="--no-figure" not in sys.argv,
    initial_conditions=np.array([[s["x"], s["y"], s["theta"]] for s in starts]).T,
    sim_in_real_time=True,
)

commands = np.zeros((2, len(starts)))
over = threading.Event()


def listen():
    for line in sys.stdin:
        command = json.loads(line)
        commands[:, column[command["robot"]]] = command["v"], command["w"]
    commands[:] = 0.0
    over.set()


threading.Thread(target=listen, daemon=True).start()
while not over.is_set():
    poses = testbed.get_poses()
    try:
        for robot, index in column.items():
            x, y, theta = poses[:, index]
            line = {"robot": robot, "x": x, "y": y, "theta": theta, "t": time.monotonic()}
            to_drivekit.write(json.dumps(line) + "\n")
        to_drivekit.flush()
    except BrokenPipeError:
        commands[:] = 0.0
        over.set()
    testbed.set_velocities(np.arange(len(starts)), commands.copy())
    testbed.step()
# The simulator's verdict, under its older and its newer name.
(testbed.debug if hasattr(testbed, "debug") else testbed.call_at_scripts_end)()
