//! Robots and a tracker as they behave at the Robotarium, on a broker.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;
use std::time::Duration;

use rumqttc::{
    Client, Connection, Event, MqttOptions, NetworkOptions, Packet, QoS, RecvTimeoutError,
};
use testbed_io::live::Clock;
use testbed_io::live::robotarium::decode_command;
use unicycle_cbf::{Pose, Speeds};

/// How often a robot applies its newest command, in s.
const APPLY_S: f64 = 0.016;
const BATTERY_V: f64 = 3.9;
const POSE_TOPIC: &str = "overhead_tracker/all_robot_pose_data";

/// What to publish in place of a message.
pub type Tamper = Box<dyn FnMut(String) -> Vec<Vec<u8>> + Send>;

/// How the testbed is.
pub struct PeerSpec {
    /// Poses per second
    pub rate_hz: f64,
    pub wheel_base_m: f64,
    /// Fastest wheel, in m/s
    pub wheel_speed_mps: f64,
    /// Whether the tracker is an older one
    pub older: bool,
}

impl Default for PeerSpec {
    fn default() -> Self {
        Self {
            rate_hz: 30.0,
            wheel_base_m: 0.105,
            wheel_speed_mps: 0.2,
            older: false,
        }
    }
}

/// A command that a robot received.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Received {
    /// On the peer's clock, in s
    pub at_s: f64,
    pub speeds: Speeds,
}

struct Robot {
    pose: Pose,
    newest: Speeds,
    applied: Speeds,
    standing_since_s: Option<f64>,
    commands: Vec<Received>,
}

struct World {
    robots: BTreeMap<u32, Robot>,
    /// Least distance of each pair, in m
    nearest_m: BTreeMap<(u32, u32), f64>,
    malformed: usize,
    tamper: Option<Tamper>,
}

struct Shared {
    clock: Clock,
    spec: PeerSpec,
    connected: AtomicBool,
    ended: AtomicBool,
    world: Mutex<World>,
}

/// Simulated robots with their tracker. They go on with their last commands while the broker is away.
pub struct RobotariumPeer {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl RobotariumPeer {
    /// Robots by ids and poses. Returns when they listen.
    pub fn start(port: u16, starts: &[(u32, Pose)], spec: PeerSpec) -> Self {
        let robots = starts.iter().map(|&(id, pose)| (id, Robot::at(pose)));
        let shared = Arc::new(Shared {
            clock: Clock::start(),
            spec,
            connected: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            world: Mutex::new(World {
                robots: robots.collect(),
                nearest_m: BTreeMap::new(),
                malformed: 0,
                tamper: None,
            }),
        });
        let id = format!("peer{}x{port}", std::process::id());
        let mut options = MqttOptions::new(id, "127.0.0.1", port);
        options.set_keep_alive(Duration::from_secs(5));
        options.set_max_packet_size(1 << 20, 1 << 20);
        let (client, mut connection) = Client::new(options, 200);
        let mut network = NetworkOptions::new();
        network.set_tcp_nodelay(true);
        network.set_connection_timeout(1);
        connection.eventloop.set_network_options(network);
        let (listening, listener) = (shared.clone(), client.clone());
        let moving = shared.clone();
        let threads = vec![
            std::thread::spawn(move || listen(&listening, &listener, &mut connection)),
            std::thread::spawn(move || moving.run(&client)),
        ];
        let peer = Self { shared, threads };
        while !peer.connected() {
            std::thread::sleep(Duration::from_millis(2));
        }
        peer
    }

    pub fn clock(&self) -> Clock {
        self.shared.clock
    }

    /// Whether the robots hear the broker.
    pub fn connected(&self) -> bool {
        self.shared.connected.load(Ordering::SeqCst)
    }

    /// Changes what the tracker publishes.
    pub fn tamper(&self, with: impl FnMut(String) -> Vec<Vec<u8>> + Send + 'static) {
        self.world().tamper = Some(Box::new(with));
    }

    /// Everything that a robot was told, in order.
    pub fn commands(&self, id: u32) -> Vec<Received> {
        self.world().robots[&id].commands.clone()
    }

    pub fn pose(&self, id: u32) -> Pose {
        self.world().robots[&id].pose
    }

    /// Since when it stands, on the peer's clock in s.
    pub fn standing_since_s(&self, id: u32) -> Option<f64> {
        self.world().robots[&id].standing_since_s
    }

    /// How near two robots came to each other, in m; infinite before the first move.
    pub fn nearest_m(&self, a: u32, b: u32) -> f64 {
        let pair = (a.min(b), a.max(b));
        let nearest_m = self.world().nearest_m.get(&pair).copied();
        nearest_m.unwrap_or(f64::INFINITY)
    }

    /// Commands that were none.
    pub fn malformed(&self) -> usize {
        self.world().malformed
    }

    fn world(&self) -> MutexGuard<'_, World> {
        self.shared.world.lock().unwrap()
    }
}

impl Drop for RobotariumPeer {
    fn drop(&mut self) {
        self.shared.ended.store(true, Ordering::SeqCst);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

impl Robot {
    fn at(pose: Pose) -> Self {
        Self {
            pose,
            newest: Speeds::ZERO,
            applied: Speeds::ZERO,
            standing_since_s: Some(0.0),
            commands: Vec::new(),
        }
    }
}

/// Receives commands until the end.
fn listen(shared: &Shared, client: &Client, connection: &mut Connection) {
    while !shared.ended.load(Ordering::SeqCst) {
        match connection.recv_timeout(Duration::from_millis(500)) {
            Ok(Ok(Event::Incoming(Packet::ConnAck(_)))) => {
                client.subscribe("matlab_api/+", QoS::AtMostOnce).unwrap();
            }
            Ok(Ok(Event::Incoming(Packet::SubAck(_)))) => {
                shared.connected.store(true, Ordering::SeqCst);
            }
            Ok(Ok(Event::Incoming(Packet::Publish(publish)))) => {
                shared.told(&publish.topic, &publish.payload);
            }
            Ok(Ok(_)) | Err(RecvTimeoutError::Timeout) => {}
            Ok(Err(_)) => {
                shared.connected.store(false, Ordering::SeqCst);
                connection.eventloop.pending.clear();
                std::thread::sleep(Duration::from_millis(50));
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

impl Shared {
    fn told(&self, topic: &str, payload: &[u8]) {
        let at_s = self.clock.now_s();
        let id = topic.rsplit('/').next().and_then(|id| id.parse().ok());
        let mut world = self.world.lock().unwrap();
        let Ok(speeds) = decode_command(payload) else {
            world.malformed += 1;
            return;
        };
        if let Some(robot) = id.and_then(|id: u32| world.robots.get_mut(&id)) {
            robot.newest = speeds;
            robot.commands.push(Received { at_s, speeds });
        }
    }

    /// Moves the robots and publishes their poses until the end.
    fn run(&self, client: &Client) {
        let mut before_s = self.clock.now_s();
        let mut publish_s = before_s;
        while !self.ended.load(Ordering::SeqCst) {
            let now_s = self.clock.now_s();
            let mut world = self.world.lock().unwrap();
            world.advance(now_s - before_s, now_s, &self.spec);
            before_s = now_s;
            let mut messages = Vec::new();
            if now_s >= publish_s {
                publish_s += 1.0 / self.spec.rate_hz;
                messages = world.messages(&self.spec);
            }
            drop(world);
            for message in messages {
                if self.connected.load(Ordering::SeqCst) {
                    let _ = client.try_publish(POSE_TOPIC, QoS::AtMostOnce, false, message);
                }
            }
            self.clock.sleep_until(publish_s.min(now_s + APPLY_S));
        }
    }
}

impl World {
    fn advance(&mut self, span_s: f64, now_s: f64, spec: &PeerSpec) {
        for robot in self.robots.values_mut() {
            robot.pose = robot.pose.advanced(robot.applied, span_s);
            robot.applied = clipped(robot.newest, spec);
            if robot.applied != Speeds::ZERO {
                robot.standing_since_s = None;
            } else if robot.standing_since_s.is_none() {
                robot.standing_since_s = Some(now_s);
            }
        }
        for (a, first) in &self.robots {
            for (b, second) in self.robots.range(a + 1..) {
                let [dx_m, dy_m] = [
                    first.pose.x_m - second.pose.x_m,
                    first.pose.y_m - second.pose.y_m,
                ];
                let nearest_m = self.nearest_m.entry((*a, *b)).or_insert(f64::INFINITY);
                *nearest_m = nearest_m.min(dx_m.hypot(dy_m));
            }
        }
    }

    fn messages(&mut self, spec: &PeerSpec) -> Vec<Vec<u8>> {
        let [battery, charging] = if spec.older {
            ["powerData", r#""charging": false"#]
        } else {
            ["batt_volt", r#""charge_status": false"#]
        };
        let entries = self.robots.iter().map(|(id, robot)| {
            let Pose { x_m, y_m, heading_rad } = robot.pose;
            format!(
                r#""{id}": {{"x": {x_m}, "y": {y_m}, "theta": {heading_rad}, "{battery}": {BATTERY_V}, {charging}}}"#
            )
        });
        let message = format!("{{{}}}", entries.collect::<Vec<_>>().join(", "));
        match &mut self.tamper {
            Some(tamper) => tamper(message),
            None => vec![message.into_bytes()],
        }
    }
}

/// As the wheels can turn: each is clipped by itself.
fn clipped(speeds: Speeds, spec: &PeerSpec) -> Speeds {
    let half_m = 0.5 * spec.wheel_base_m;
    let most = spec.wheel_speed_mps;
    let wheel =
        |side: f64| (speeds.speed_mps + side * half_m * speeds.turn_rate_rad_s).clamp(-most, most);
    let (left, right) = (wheel(-1.0), wheel(1.0));
    Speeds {
        speed_mps: 0.5 * (left + right),
        turn_rate_rad_s: (right - left) / spec.wheel_base_m,
    }
}
