//! Whole testbeds: simulated Khepera under a NatNet server, and a session on them.

use std::net::UdpSocket;
use std::time::Duration;

use testbed_io::live::commands::KheperaSpec;
use testbed_io::live::natnet::{NatNetSpec, Transport, Version};
use testbed_io::live::{
    CommandsSpec, LinkSpec, LiveReport, PosesSpec, Session, StopSwitch, Update,
};
use testbed_sim::{Summary, Tick};
use unicycle_cbf::{Preset, Scenario, Testbed};

use super::khepera_peer::{COUNT_MPS, Kheperas};
use super::natnet_server::NatNetServer;
use super::world::{Moving, World};

/// Ids at the tracker, from the front.
pub const IDS: [u32; 2] = [7, 3];

/// Two Khepera under OptiTrack at 50 Hz.
pub struct KheperaTestbed {
    pub scenario: Scenario,
    pub link: LinkSpec,
    pub world: World,
    pub server: NatNetServer,
    pub robots: Kheperas,
    /// Where the session listens for frames
    pub data_port: u16,
    _moving: Moving,
}

impl KheperaTestbed {
    pub fn start(version: Version, duration_s: f64) -> Self {
        let mut spec = Testbed::Khepera
            .scenario("on-off", Preset::Hardened)
            .unwrap();
        spec.duration_s = duration_s;
        let scenario = Scenario::new(spec).unwrap();
        let (world, moving) = World::new(&scenario, Some(Duration::from_secs(2)));
        let body = *scenario.controller().body();
        let robots = Kheperas::start(&world, body);
        let seen = world.clone();
        let server = NatNetServer::start(version, 100.0, move |_| {
            let poses = seen.poses();
            let body = |(id, pose): (&u32, &unicycle_cbf::Pose)| {
                (*id as i32, pose.x_m, pose.y_m, pose.heading_rad, true)
            };
            let mut bodies: Vec<_> = IDS.iter().zip(&poses).map(body).collect();
            // A body that takes no part.
            bodies.push((99, 0.0, 0.0, 0.0, true));
            bodies
        });
        let mut natnet = NatNetSpec::new(server.address().ip());
        natnet.command_port = server.command_port();
        natnet.transport = Transport::Unicast;
        natnet.data_port = free_udp_port();
        let data_port = natnet.data_port;
        let link = LinkSpec {
            robots: IDS.to_vec(),
            lost_after_s: 5.0,
            arena: None,
            poses: PosesSpec::Natnet(natnet),
            commands: CommandsSpec::Khepera(KheperaSpec {
                addresses: robots.addresses.clone(),
                count_mps: COUNT_MPS,
            }),
        };
        Self {
            scenario,
            link,
            world,
            server,
            robots,
            data_port,
            _moving: moving,
        }
    }

    /// Runs a session to its end; `each` sees the time of every step.
    pub fn run(&self, each: impl FnMut(f64) + Send) -> (Vec<Tick>, Summary, LiveReport) {
        run(&self.scenario, &self.link, &StopSwitch::default(), each)
    }
}

pub fn free_udp_port() -> u16 {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.local_addr().unwrap().port()
}

pub fn run(
    scenario: &Scenario,
    link: &LinkSpec,
    stop: &StopSwitch,
    mut each: impl FnMut(f64) + Send,
) -> (Vec<Tick>, Summary, LiveReport) {
    let session = Session { scenario, link };
    let mut all = Vec::new();
    let ended = session.run(stop, |update| match update {
        Update::Note(text) => println!("note: {text}"),
        Update::Step { ticks, .. } => {
            all.extend_from_slice(ticks);
            each(ticks[0].time_s);
        }
    });
    let (summary, report) = ended.unwrap();
    println!("{report:#?}");
    (all, summary, report)
}
