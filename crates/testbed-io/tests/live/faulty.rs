//! Robots that speak JSON lines over UDP, and are not as they should be.

use std::collections::VecDeque;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use testbed_io::live::json_lines::{CommandLine, PoseLine};
use testbed_io::live::poses::JsonUdpSpec;
use testbed_io::live::{CommandsSpec, JsonCommandsSpec, LinkSpec, PosesSpec};
use unicycle_cbf::{Body, Pose, Scenario, ScenarioSpec, Speeds};

use super::world::World;

/// What is wrong with them.
#[derive(Debug, Clone, Copy)]
pub struct Faults {
    /// What the left and the right wheel do of what they are told
    pub gains: [f64; 2],
    /// What a wheel really does at most, in m/s
    pub most_mps: f64,
    /// By how much headings are off, in rad
    pub yaw_rad: f64,
    /// From when on headings are off by π
    pub flipped_after_s: f64,
    pub degrees: bool,
    /// The first and the second have each other's id: on the tracker, and for commands
    pub exchanged: [bool; 2],
    /// How late poses are, which their stamps do not say
    pub late_s: f64,
    /// From when to when poses and commands are held up; then all poses come, with true stamps
    pub held_up_s: [f64; 2],
    /// From when on robots hear no command
    pub deaf_after_s: f64,
    /// From when on the tracker says that the last robot is on the first
    pub on_first_after_s: f64,
    /// From when on the last robot is measured elsewhere, and by how much in x and y, in m
    pub elsewhere_after_s: f64,
    pub elsewhere_m: [f64; 2],
    /// From when on the first robot is measured ahead of where it is, and by how much, in s and m
    pub ahead: [f64; 2],
    /// From when to when no pose of the first robot comes, in s
    pub hidden_s: [f64; 2],
    /// From when on headings are off by how much, in s and rad
    pub turned: [f64; 2],
    /// All robots are measured farther to the left by the second, in m, each time after the first, in s
    pub steps: [f64; 2],
    /// Time between two poses of a robot, where they do not come at every step
    pub every_s: f64,
}

impl Faults {
    pub const NONE: Self = Self {
        gains: [1.0; 2],
        most_mps: f64::INFINITY,
        yaw_rad: 0.0,
        flipped_after_s: f64::INFINITY,
        degrees: false,
        exchanged: [false; 2],
        late_s: 0.0,
        held_up_s: [f64::INFINITY; 2],
        deaf_after_s: f64::INFINITY,
        on_first_after_s: f64::INFINITY,
        elsewhere_after_s: f64::INFINITY,
        elsewhere_m: [0.0; 2],
        ahead: [f64::INFINITY, 0.0],
        hidden_s: [f64::INFINITY; 2],
        turned: [f64::INFINITY, 0.0],
        steps: [f64::INFINITY, 0.0],
        every_s: 0.0,
    };

    fn speeds(&self, body: &Body, command: &CommandLine) -> Speeds {
        let [left, right] = self.gains;
        let wheel = |gain: f64, mps: f64| gain * mps.clamp(-self.most_mps, self.most_mps);
        let (left, right) = (wheel(left, command.left), wheel(right, command.right));
        Speeds {
            speed_mps: 0.5 * (left + right),
            turn_rate_rad_s: (right - left) / body.wheel_base_m,
        }
    }

    fn line(&self, robot: usize, pose: &Pose, now_s: f64) -> PoseLine {
        let flipped = now_s >= self.flipped_after_s;
        let flip_rad = if flipped { std::f64::consts::PI } else { 0.0 };
        let [from_s, off_rad] = self.turned;
        let turned_rad = if now_s >= from_s { off_rad } else { 0.0 };
        let theta = pose.heading_rad + self.yaw_rad + flip_rad + turned_rad;
        PoseLine {
            robot: id(robot, self.exchanged[0]),
            x: pose.x_m,
            y: pose.y_m,
            theta: if self.degrees {
                theta.to_degrees()
            } else {
                theta
            },
            t: Some(now_s),
        }
    }
}

fn id(robot: usize, exchanged: bool) -> u32 {
    let place = if exchanged && robot < 2 {
        1 - robot
    } else {
        robot
    };
    place as u32 + 1
}

struct Robots {
    world: World,
    body: Body,
    faults: Faults,
    socket: UdpSocket,
    listen: SocketAddr,
    start: Instant,
    /// Poses on their way
    held: VecDeque<(f64, Vec<u8>)>,
    /// When the next are due
    due_s: f64,
}

impl Robots {
    fn is_held_up(&self) -> bool {
        let [from_s, to_s] = self.faults.held_up_s;
        (from_s..to_s).contains(&self.start.elapsed().as_secs_f64())
    }

    fn send(&mut self) {
        let now_s = self.start.elapsed().as_secs_f64();
        if now_s < self.due_s {
            return;
        }
        self.due_s = now_s + self.faults.every_s;
        let mut text = Vec::new();
        let mut poses = self.world.poses();
        if now_s >= self.faults.on_first_after_s {
            let first = poses[0];
            let last = poses.last_mut().unwrap();
            (last.x_m, last.y_m) = (first.x_m + 0.07, first.y_m + 0.03);
        }
        if let Some(last) = poses.last_mut()
            && now_s >= self.faults.elsewhere_after_s
        {
            let [x_m, y_m] = self.faults.elsewhere_m;
            (last.x_m, last.y_m) = (last.x_m + x_m, last.y_m + y_m);
        }
        let [from_s, ahead_m] = self.faults.ahead;
        if now_s >= from_s {
            let (sin, cos) = poses[0].heading_rad.sin_cos();
            poses[0].x_m += ahead_m * cos;
            poses[0].y_m += ahead_m * sin;
        }
        let [hidden_s, until_s] = self.faults.hidden_s;
        let [every_s, step_m] = self.faults.steps;
        for pose in &mut poses {
            pose.y_m += step_m * (now_s / every_s).floor();
        }
        for (robot, pose) in poses.iter().enumerate() {
            if robot == 0 && (hidden_s..until_s).contains(&now_s) {
                continue;
            }
            serde_json::to_writer(&mut text, &self.faults.line(robot, pose, now_s)).unwrap();
            text.push(b'\n');
        }
        self.held.push_back((now_s + self.faults.late_s, text));
        while !self.is_held_up()
            && let Some((_, text)) = self.held.pop_front_if(|(due_s, _)| *due_s <= now_s)
        {
            let _ = self.socket.send_to(&text, self.listen);
        }
    }

    fn hear(&self, packet: &[u8]) {
        let is_deaf = self.start.elapsed().as_secs_f64() >= self.faults.deaf_after_s;
        if is_deaf || self.is_held_up() {
            return;
        }
        for command in packet
            .split(|byte| *byte == b'\n')
            .filter_map(CommandLine::parse)
        {
            let robot = command.robot as usize - 1;
            let robot = id(robot, self.faults.exchanged[1]) as usize - 1;
            self.world
                .command(robot, self.faults.speeds(&self.body, &command));
        }
    }
}

/// Until the session tells nothing for a second.
pub fn start(spec: &ScenarioSpec, faults: Faults) -> (LinkSpec, World, JoinHandle<World>) {
    let scenario = Scenario::new(spec.clone()).unwrap();
    let free = UdpSocket::bind("127.0.0.1:0").unwrap();
    let listen = free.local_addr().unwrap();
    drop(free);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let soon = Duration::from_millis(5);
    socket.set_read_timeout(Some(soon)).unwrap();
    let poses = PosesSpec::JsonUdp(JsonUdpSpec {
        listen,
        sender: IpAddr::from([127, 0, 0, 1]),
        latency_s: 0.0,
    });
    let link = LinkSpec {
        robots: (1..=scenario.starts().len() as u32).collect(),
        lost_after_s: 5.0,
        arena: None,
        poses,
        commands: CommandsSpec::JsonUdp(JsonCommandsSpec {
            address: socket.local_addr().unwrap(),
        }),
    };
    let (world, moving) = World::new(&scenario, None);
    let mut robots = Robots {
        world: world.clone(),
        body: *scenario.controller().body(),
        faults,
        socket,
        listen,
        start: Instant::now(),
        held: VecDeque::new(),
        due_s: 0.0,
    };
    let thread = std::thread::spawn(move || {
        let _moving = moving;
        let mut heard = None::<Instant>;
        let mut send_at = robots.start;
        let mut buffer = [0; 65_536];
        while heard.is_none_or(|heard| heard.elapsed() < Duration::from_secs(1)) {
            assert!(robots.start.elapsed() < Duration::from_secs(120));
            if Instant::now() >= send_at {
                send_at += Duration::from_millis(20);
                robots.send();
            }
            if let Ok((bytes, _)) = robots.socket.recv_from(&mut buffer) {
                heard = Some(Instant::now());
                robots.hear(&buffer[..bytes]);
            }
        }
        robots.world
    });
    (link, world, thread)
}
