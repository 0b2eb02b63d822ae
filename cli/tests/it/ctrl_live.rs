//! `drivekit ctrl run --live` with robots that speak JSON lines over UDP, and every way to end it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use testbed_io::live::json_lines::{CommandLine, PoseLine};
use unicycle_cbf::{Preset, Scenario, Speeds, Testbed};

use crate::program::{drivekit, drivekit_in};

/// Two robots of the Robotarium's track, for as long as this lives.
struct Robots {
    link: String,
    told: Arc<Mutex<Vec<CommandLine>>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Robots {
    fn start() -> Self {
        let spec = Testbed::Robotarium.scenario("track", Preset::Hardened);
        let scenario = Scenario::new(spec.unwrap()).unwrap();
        let poses_to = UdpSocket::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let link = format!(
            "robots = [1, 2]\n[poses]\nkind = \"json-udp\"\nlisten = \"{poses_to}\"\nsender = \"127.0.0.1\"\n\
             [commands]\nkind = \"json-udp\"\naddress = \"{}\"\n",
            socket.local_addr().unwrap()
        );
        let told: Arc<Mutex<Vec<CommandLine>>> = Arc::default();
        let ended = Arc::new(AtomicBool::new(false));
        let (log, until) = (Arc::clone(&told), Arc::clone(&ended));
        let thread = std::thread::spawn(move || {
            move_robots(&scenario, &socket, poses_to, &log, &until);
        });
        Self {
            link,
            told,
            ended,
            thread: Some(thread),
        }
    }

    fn told(&self) -> usize {
        self.told.lock().unwrap().len()
    }

    /// Whether the last command of each robot was to stand.
    fn stand(&self) -> bool {
        let told = self.told.lock().unwrap();
        [1, 2].into_iter().all(|robot| {
            let last = told.iter().rev().find(|told| told.robot == robot);
            last.is_some_and(|last| last.v == 0.0 && last.w == 0.0)
        })
    }
}

impl Drop for Robots {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn move_robots(
    scenario: &Scenario,
    socket: &UdpSocket,
    poses_to: SocketAddr,
    log: &Mutex<Vec<CommandLine>>,
    ended: &AtomicBool,
) {
    let mut robots: Vec<_> = scenario
        .starts()
        .iter()
        .map(|pose| (*pose, Speeds::ZERO))
        .collect();
    let wait = Some(Duration::from_millis(2));
    socket.set_read_timeout(wait).unwrap();
    let start = Instant::now();
    let mut before = start;
    let mut buffer = [0; 4096];
    while !ended.load(Ordering::Relaxed) {
        if let Ok((bytes, _)) = socket.recv_from(&mut buffer) {
            for line in buffer[..bytes].split(|byte| *byte == b'\n') {
                let Some(command) = CommandLine::parse(line) else {
                    continue;
                };
                robots[command.robot as usize - 1].1 = Speeds {
                    speed_mps: command.v,
                    turn_rate_rad_s: command.w,
                };
                log.lock().unwrap().push(command);
            }
        }
        let passed_s = before.elapsed().as_secs_f64();
        if passed_s < 0.02 {
            continue;
        }
        before = Instant::now();
        for (robot, (pose, speeds)) in (1..).zip(&mut robots) {
            *pose = pose.advanced(*speeds, passed_s);
            let line = PoseLine {
                robot,
                x: pose.x_m,
                y: pose.y_m,
                theta: pose.heading_rad,
                t: Some(start.elapsed().as_secs_f64()),
            };
            let text = serde_json::to_vec(&line).unwrap();
            let _ = socket.send_to(&text, poses_to);
        }
    }
}

/// `ctrl run` on a link, in a folder.
fn live(folder: &Path, link: &str) -> Command {
    std::fs::write(folder.join("lab.toml"), link).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivekit"));
    command
        .current_dir(folder)
        .args(["ctrl", "run", "--live", "lab.toml"])
        .args(["--testbed", "robotarium", "--scenario", "track"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// A session that has told its robots something, and what it says on stderr.
fn session(
    folder: &Path,
    robots: &Robots,
    flags: &[&str],
) -> (Child, BufReader<impl Read + use<>>) {
    let mut command = live(folder, &robots.link);
    let mut child = command
        .args(["-o", "run.mcap"])
        .args(flags)
        .spawn()
        .unwrap();
    let stderr = BufReader::new(child.stderr.take().unwrap());
    let start = Instant::now();
    while robots.told() < 100 {
        assert!(start.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(10));
    }
    (child, stderr)
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn signals_stop_the_robots_and_leave_a_whole_log() {
    for name in ["-INT", "-TERM", "-HUP"] {
        let folder = tempfile::tempdir().unwrap();
        let robots = Robots::start();
        let (mut child, _stderr) = session(folder.path(), &robots, &[]);
        assert!(!robots.stand());
        let asked = Instant::now();
        signal(&child, name);
        while !robots.stand() {
            assert!(asked.elapsed() < Duration::from_secs(10));
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(child.wait().unwrap().code(), Some(0), "{name}");
        assert!(robots.stand());
        let out = drivekit_in(folder.path(), &["ctrl", "replay", "run.mcap"]).ok();
        assert!(out.stdout.contains("every one the same"), "{}", out.stdout);
        assert!(!folder.path().join("run.partial.csv").exists());
    }
}

#[test]
fn a_killed_session_leaves_a_log_up_to_its_last_step() {
    let folder = tempfile::tempdir().unwrap();
    let robots = Robots::start();
    let (mut child, _stderr) = session(folder.path(), &robots, &[]);
    signal(&child, "-KILL");
    child.wait().unwrap();
    std::thread::sleep(Duration::from_millis(50));
    let told = robots.told();
    let log = ["ctrl", "replay", "run.partial.csv", "--format", "json"];
    let out = drivekit_in(folder.path(), &log);
    // Its end is not known.
    assert_eq!(out.code, 2, "{}", out.stderr);
    let document: serde_json::Value = serde_json::from_str(&out.stdout).unwrap();
    assert_eq!(document["different"], 0);
    assert_eq!(document["verdict"], "not_known");
    // A step is two decisions; the last one may have been sent and not written, or the other way round.
    let decisions = document["decisions"].as_u64().unwrap() as usize;
    assert!(decisions.abs_diff(told) <= 2, "{decisions} of {told}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_at_a_terminal_leaves_the_robots_program_time_to_hear_zeros() {
    use std::os::unix::process::CommandExt as _;
    if !crate::python::has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let robots = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../crates/testbed-io/examples/robots.py"
    );
    let link = format!(
        "robots = [1, 2]\n[poses]\nkind = \"program\"\ncommand = [\"sh\", \"-c\", \"tee told.txt | python3 {robots}\"]\n\
         [commands]\nkind = \"program\"\n"
    );
    let mut command = live(folder.path(), &link);
    let mut child = command.process_group(0).spawn().unwrap();
    let told = || std::fs::read_to_string(folder.path().join("told.txt")).unwrap_or_default();
    let start = Instant::now();
    while told().lines().count() < 200 {
        assert!(start.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(20));
    }
    let group = format!("-{}", child.id());
    let sent = Command::new("kill").args(["-INT", "--", &group]).status();
    assert!(sent.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let last: Vec<CommandLine> = told()
        .lines()
        .rev()
        .take(2)
        .map(|line| CommandLine::parse(line.as_bytes()).unwrap())
        .collect();
    assert!(
        last.iter().all(|told| told.v == 0.0 && told.w == 0.0),
        "{last:?}"
    );
}

#[test]
fn the_view_stops_the_robots_for_those_who_may() {
    let folder = tempfile::tempdir().unwrap();
    let robots = Robots::start();
    let (mut child, stderr) = session(folder.path(), &robots, &["--view", "--duration", "600"]);
    let line = stderr
        .lines()
        .map_while(Result::ok)
        .find(|line| line.contains("view: "))
        .unwrap();
    let url = line.split("http://").nth(1).unwrap();
    let (address, token) = url.split_once("/?token=").unwrap();
    let ask = |request: String| {
        let mut stream = TcpStream::connect(address).unwrap();
        let text = format!("{request}Host: {address}\r\nConnection: close\r\n\r\n");
        stream.write_all(text.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    assert!(ask("GET / HTTP/1.1\r\n".to_owned()).starts_with("HTTP/1.1 200"));
    assert!(ask("POST /stop HTTP/1.1\r\n".to_owned()).starts_with("HTTP/1.1 403"));
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none());
    let token = token.trim();
    let stop = format!("POST /stop HTTP/1.1\r\nAuthorization: Bearer {token}\r\n");
    assert!(ask(stop).starts_with("HTTP/1.1 2"));
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(robots.stand());
}

#[test]
fn every_link_that_is_shown_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let kinds = [
        ("khepera", "no answer to the first request"),
        ("robotarium", "1883"),
        ("robotarium-udp", "1883"),
        ("program", "has ended before every robot was seen"),
        ("recording", "run.mcap"),
    ];
    let runs = kinds.map(|(kind, problem)| {
        let text = drivekit(&["ctrl", "run", "--show-link", kind]).ok().stdout;
        // Addresses of this computer, on which nobody answers.
        let text = text
            .replace("192.168.0.1", "127.0.0.1")
            .replace("192.168.1.1", "127.0.0.1");
        let text = text.replace("python3", "true");
        let file = format!("{kind}.toml");
        std::fs::write(folder.path().join(&file), text).unwrap();
        let folder = folder.path().to_owned();
        std::thread::spawn(move || {
            let out = drivekit_in(&folder, &["ctrl", "run", "--live", &file]);
            assert_eq!(out.code, 2, "{}", out.stderr);
            assert!(out.stderr.contains(problem), "{kind}: {}", out.stderr);
        })
    });
    for run in runs {
        run.join().unwrap();
    }
}

#[test]
fn whom_a_session_waits_for_is_said_and_it_can_be_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let show = ["ctrl", "run", "--show-link", "json-udp"];
    let link = drivekit(&show).ok().stdout.replace(":5005", ":0");
    let mut command = live(folder.path(), &link);
    let mut child = command.args(["-o", "run.csv"]).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let waits = |line: &String| line.contains("waiting for poses of robot 1, robot 2");
    let mut lines = stderr.by_ref().lines().map(Result::unwrap);
    let said = lines.find(waits);
    assert!(said.is_some());
    signal(&child, "-INT");
    // Nothing was seen, so that nothing is known.
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[test]
fn links_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let good = drivekit(&["ctrl", "run", "--show-link", "json-udp"])
        .ok()
        .stdout;
    for (text, problem) in [
        (
            good.replace("[1, 2]", "[1]"),
            "names 1 and the scenario has 2",
        ),
        (good.replace("[1, 2]", "[1, 1]"), "robot 1 is named twice"),
        (
            good.replace("after_s = 5.0", "after_s = -1.0"),
            "`lost_after_s` is -1",
        ),
        (good.replace("latency_s", "latencie_s"), "latencie_s"),
        (
            good.replace("127.0.0.1:5006", "nowhere"),
            "invalid socket address",
        ),
        (
            good.replace(
                "kind = \"json-udp\"\naddress",
                "kind = \"program\"\naddress",
            ),
            "same kind",
        ),
    ] {
        std::fs::write(folder.path().join("lab.toml"), text).unwrap();
        let out = drivekit_in(folder.path(), &["ctrl", "run", "--live", "lab.toml"]);
        assert_eq!(out.code, 2, "{}", out.stderr);
        assert!(out.stderr.contains(problem), "{}", out.stderr);
    }
    let out = drivekit(&["ctrl", "run", "--live", "x.toml", "--disturb", "all"]);
    assert_eq!(out.code, 2);
}
