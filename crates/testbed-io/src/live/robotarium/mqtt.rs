//! The session with the broker, as its caller sees it.

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;
use tokio::task::JoinSet;
use unicycle_cbf::Speeds;

use super::super::inbox::Inbox;
use super::super::real_time::into_real_time_class;
use super::RobotariumSpec;
use super::commands::{Lane, Sender};
use super::poses;
use super::status::Status;
use crate::Error;

/// For the first connection.
const FIRST: Duration = Duration::from_millis(2500);
/// How often a robot is told to stop, and how far apart.
const STOPS: u32 = 5;
const BETWEEN_STOPS: Duration = Duration::from_millis(20);
/// For stopping robots when nobody did before the end.
const AT_LAST: Duration = Duration::from_millis(500);

/// Robots behind a broker. They are stopped when this is dropped; where that fails, the broker stops them.
#[derive(Debug)]
pub struct Robotarium {
    lanes: Vec<Arc<Lane>>,
    status: Arc<Status>,
    stopped: bool,
    end: Option<watch::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Connects to the broker: poses go into the inbox, commands to the robots with these ids.
///
/// # Errors
///
/// No broker answers within 3 s, it refuses us, or the settings cannot be.
pub fn connect(spec: &RobotariumSpec, ids: &[u32], inbox: Inbox) -> Result<Robotarium, Error> {
    check(spec)?;
    let spec = &spec.with_password()?;
    let runtime = Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| Error::no_thread("robotarium", &error))?;
    let lanes: Vec<Arc<Lane>> = ids.iter().map(|_| Arc::default()).collect();
    let status = Arc::new(Status::new(inbox, ids.len() + 1));
    let (end, ended) = watch::channel(());
    let prefix = client_prefix();
    let senders = ids.iter().zip(&lanes).enumerate();
    let senders = senders.map(|(index, (id, lane))| Sender {
        lane: lane.clone(),
        status: status.clone(),
        index,
        client_id: format!("{prefix}r{index}"),
        topic: format!("{}/{id}", spec.command_topic),
    });
    let connections = Connections {
        spec: spec.clone(),
        senders: senders.collect(),
        status: status.clone(),
        poses_id: format!("{prefix}p"),
    };
    let thread = std::thread::Builder::new()
        .name("robotarium".to_owned())
        .spawn(move || {
            into_real_time_class();
            connections.run(runtime, &ended);
        })
        .map_err(|error| Error::no_thread("robotarium", &error))?;
    let mut robotarium = Robotarium {
        lanes,
        status,
        stopped: false,
        end: Some(end),
        thread: Some(thread),
    };
    robotarium.await_first(spec)?;
    Ok(robotarium)
}

impl Robotarium {
    /// Gives the robot at this place of the ids a command. It replaces one that has not left yet, and it is forgotten if it
    /// cannot leave within 0.2 s. A robot that was stopped stays so.
    pub fn send(&mut self, robot: usize, speeds: Speeds) {
        if let Some(lane) = self.lanes.get(robot)
            && !self.stopped
        {
            lane.give(self.now_s(), speeds);
        }
    }

    /// Whether robots and poses can be reached, as far as is known: silence is noticed after 0.8 s.
    #[must_use]
    pub fn connected(&self) -> bool {
        self.status.lost_since_s().is_none()
    }

    /// For how long a robot or the poses could not be reached, in s.
    #[must_use]
    pub fn disconnected_for_s(&self) -> Option<f64> {
        let since_s = self.status.lost_since_s()?;
        Some((self.now_s() - since_s).max(0.0))
    }

    /// Stops every robot for good: tells it five times and until the broker has it, at most for this time. When a connection was
    /// lost in the last 12 s, robots are told for all of this time: they may not be back at the broker yet. Returns the places of
    /// the robots for which the broker did not confirm it.
    pub fn stop(&mut self, patience: Duration) -> Vec<usize> {
        self.stopped = true;
        let until = Instant::now() + patience;
        let first: Vec<u64> = self.stop_once();
        for told in 1.. {
            std::thread::sleep(BETWEEN_STOPS);
            let late = Instant::now() >= until;
            let enough = told >= STOPS && self.untold(&first).is_empty();
            if late || (enough && !self.status.robots_may_be_away()) {
                break;
            }
            self.stop_once();
        }
        let untold = self.untold(&first);
        for (robot, lane) in self.lanes.iter().enumerate() {
            if !untold.contains(&robot) {
                lane.stopped();
            }
        }
        untold
    }

    fn stop_once(&self) -> Vec<u64> {
        let now_s = self.now_s();
        let lanes = self.lanes.iter();
        lanes.map(|lane| lane.give(now_s, Speeds::ZERO)).collect()
    }

    fn untold(&self, first: &[u64]) -> Vec<usize> {
        let lanes = self.lanes.iter().zip(first).enumerate();
        let untold = lanes.filter(|(_, (lane, number))| !lane.has_confirmed(**number));
        untold.map(|(robot, _)| robot).collect()
    }

    fn await_first(&mut self, spec: &RobotariumSpec) -> Result<(), Error> {
        let until = Instant::now() + FIRST;
        while !self.connected() {
            let problem = self.status.problem();
            if Instant::now() >= until || problem.is_final() {
                // No robot got a command, so none needs to be stopped.
                self.stopped = true;
                self.lanes.iter().for_each(|lane| lane.stopped());
                return Err(problem.error(spec));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Ok(())
    }

    fn now_s(&self) -> f64 {
        self.status.inbox().clock().now_s()
    }
}

impl Drop for Robotarium {
    fn drop(&mut self) {
        if !self.stopped {
            self.stop(AT_LAST);
        }
        self.status.end();
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has closed its connections: the broker stops the robots.
            let _ = thread.join();
        }
    }
}

/// What the thread runs.
struct Connections {
    spec: RobotariumSpec,
    senders: Vec<Sender>,
    status: Arc<Status>,
    poses_id: String,
}

impl Connections {
    fn run(self, runtime: Runtime, ended: &watch::Receiver<()>) {
        runtime.block_on(async {
            let mut tasks = JoinSet::new();
            let last = self.senders.len();
            let poses = poses::receive(
                self.spec.clone(),
                self.poses_id,
                self.status,
                last,
                ended.clone(),
            );
            tasks.spawn(poses);
            for sender in self.senders {
                tasks.spawn(sender.run(self.spec.clone(), ended.clone()));
            }
            while tasks.join_next().await.is_some() {}
        });
        // Not to wait for a name that is still being looked up.
        runtime.shutdown_background();
    }
}

fn check(spec: &RobotariumSpec) -> Result<(), Error> {
    let topics = [&spec.pose_topic, &spec.command_topic];
    let is_topic = |topic: &&String| {
        !topic.is_empty() && topic.len() <= 256 && !topic.contains(['+', '#', '\0'])
    };
    if !topics.iter().all(is_topic) {
        let help = "give topics without wildcards";
        return Err(spec.error("no topic".to_owned(), help));
    }
    if !(spec.latency_s.is_finite() && spec.latency_s >= 0.0) {
        let problem = format!("a latency of {} s", spec.latency_s);
        return Err(spec.error(problem, "give a number from 0"));
    }
    Ok(())
}

/// Another in every session: a broker ends the older of two connections with the same. At most 23 letters and digits, which every
/// broker takes.
fn client_prefix() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanos = since.map_or(0, |since| since.as_nanos());
    let pid = std::process::id() & 0xf_ffff;
    format!("d{pid:x}x{:x}", nanos & 0xff_ffff_ffff)
}
