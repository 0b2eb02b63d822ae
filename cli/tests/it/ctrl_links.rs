//! Links of live sessions that are not as they should be, and the Robotarium's simulator as robots.

use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{drivekit, drivekit_in, run};
use crate::python::has_python;

const BRIDGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../crates/testbed-io/examples/robotarium_simulator.py"
);

#[test]
fn two_senders_of_one_robot_are_noted_once() {
    let folder = tempfile::tempdir().unwrap();
    let listen = UdpSocket::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let link = drivekit(&["ctrl", "run", "--show-link", "json-udp"])
        .ok()
        .stdout;
    let link = link.replace("127.0.0.1:5005", &listen.to_string());
    std::fs::write(folder.path().join("lab.toml"), link).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivekit"));
    command
        .current_dir(folder.path())
        .args(["ctrl", "run", "--live", "lab.toml"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let senders = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(2) {
        for (sender, x) in senders.iter().zip([0.9, 0.91]) {
            let line = format!(r#"{{"robot": 1, "x": {x}, "y": 0.0, "theta": 1.5}}"#);
            let _ = sender.send_to(line.as_bytes(), listen);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    let stopped = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(stopped.unwrap().success());
    let out = run(child.wait_with_output());
    let notes: Vec<&str> = out
        .stderr
        .lines()
        .filter(|line| line.contains("by turns"))
        .collect();
    assert_eq!(notes.len(), 1, "{}", out.stderr);
    assert!(
        notes[0].contains("poses of robot 1 come from 127.0.0.1:"),
        "{}",
        notes[0]
    );
}

#[test]
fn scenarios_that_cannot_start_name_robots_of_a_session_by_their_ids() {
    let folder = tempfile::tempdir().unwrap();
    let link = drivekit(&["ctrl", "run", "--show-link", "program"])
        .ok()
        .stdout;
    let link = link.replace("[1, 2]", "[7, 12]");
    std::fs::write(folder.path().join("lab.toml"), link).unwrap();
    let shown = drivekit(&["ctrl", "run", "--show-config", "--scenario", "straight"])
        .ok()
        .stdout;
    let swapped = shown.replace("start = 0.6", "start = -0.6");
    assert_ne!(shown, swapped);
    std::fs::write(folder.path().join("mine.toml"), swapped).unwrap();
    let simulated = ["ctrl", "run", "--scenario", "mine.toml"];
    let out = drivekit_in(folder.path(), &simulated);
    out.refused(&["robot 1 starts 0.600 m ahead of the one before it"]);
    let live = [&simulated[..], &["--live", "lab.toml"]].concat();
    let out = drivekit_in(folder.path(), &live);
    assert!(
        out.stderr.contains("robot 12 starts 0.600 m ahead"),
        "{}",
        out.stderr
    );
}

/// What the bridge needs of the simulator and of numpy. The robots come from a place of their own and stop 3 cm beside their starts,
/// as the simulator's do.
fn stand_in(folder: &Path) {
    std::fs::create_dir(folder.join("rps")).unwrap();
    let files = [
        ("rps/__init__.py", ""),
        (
            "numpy.py",
            "arange = range\nclass array(list):\n    @property\n    def T(self):\n        return array(map(list, zip(*self)))\n",
        ),
        (
            "rps/robotarium.py",
            r#"
import math, time
class Robotarium:
    def __init__(self, number_of_robots, show_figure, initial_conditions, sim_in_real_time):
        print("Initializing")
        time.sleep(2.5)
        self.poses = [list(row) for row in initial_conditions]
        self.poses[1] = [y + 0.03 for y in self.poses[1]]
    def get_poses(self):
        return self.poses
    def set_velocities(self, ids, speeds):
        self.speeds = speeds
    def step(self):
        for i, (v, w) in enumerate(zip(*self.speeds)):
            self.poses[0][i] += 0.033 * v * math.cos(self.poses[2][i])
            self.poses[1][i] += 0.033 * v * math.sin(self.poses[2][i])
            self.poses[2][i] += 0.033 * w
        time.sleep(0.033)
    def debug(self):
        print("no errors")
"#,
        ),
    ];
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn the_simulator_drives_to_its_starts_before_the_session_begins() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    stand_in(folder.path());
    let link = drivekit(&["ctrl", "run", "--show-link", "program"])
        .ok()
        .stdout;
    let link = link.replace("robots.py", BRIDGE);
    std::fs::write(folder.path().join("lab.toml"), link).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivekit"));
    command
        .current_dir(folder.path())
        .env("PYTHONPATH", folder.path())
        .args([
            "ctrl",
            "run",
            "--live",
            "lab.toml",
            "--testbed",
            "robotarium",
        ])
        .args([
            "--scenario",
            "on-off",
            "--duration",
            "3",
            "--format",
            "json",
        ])
        .stdin(Stdio::null());
    let out = run(command.output()).ok();
    assert_eq!(
        out.stderr
            .matches("drives its robots to their starts")
            .count(),
        1,
        "{}",
        out.stderr
    );
    assert!(out.stderr.contains("no errors"), "{}", out.stderr);
    let document = out.json();
    assert_eq!(document["safe"], true);
    // Of 40 mm; the simulator left them 30 mm beside their starts.
    assert!(
        document["max_abs_lateral_m"].as_f64().unwrap() < 0.02,
        "{}",
        out.stdout
    );
}

#[test]
fn a_session_that_is_stopped_while_the_simulator_gets_ready_ends() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    stand_in(folder.path());
    let out = Command::new("python3")
        .arg(BRIDGE)
        .env("PYTHONPATH", folder.path())
        .env(
            "DRIVEKIT_STARTS",
            r#"[{"robot": 1, "x": 0, "y": 0, "theta": 0}]"#,
        )
        .stdin(Stdio::null())
        .output();
    let out = run(out).ok();
    assert!(
        out.stdout
            .lines()
            .all(|line| line.contains("getting_ready")),
        "{}",
        out.stdout
    );
    // It does not wait for the simulator, which would say this in the end.
    assert!(!out.stderr.contains("no errors"), "{}", out.stderr);
}
