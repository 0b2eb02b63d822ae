//! A NatNet server on the loopback: robots on a floor, in any version, with faults on demand.

use std::collections::BTreeSet;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, Socket, Type};
use testbed_io::live::natnet::{
    Body, Channel, Frame, ServerInfo, Stamps, Version, encode_server_info,
};

use super::natnet_filler::{Filler, frame_with};
use super::natnet_synthetic::synthetic;

/// Id, x and y in m, heading in rad, whether the cameras see it.
pub(crate) type Robot = (i32, f64, f64, f64, bool);
/// Robots at a time of the server in s.
type Poses = dyn FnMut(f64) -> Vec<Robot> + Send;
/// What is sent in place of a frame.
type Tamper = dyn FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send;

/// Ticks per second of its clock, and its time at the start in s.
pub(crate) const CLOCK_HZ: u64 = 10_000_000;
const STARTED_S: f64 = 500.0;
/// From exposure to transmission, in s.
pub(crate) const AGE_S: f64 = 0.004;

/// Ends when it is dropped.
pub(crate) struct NatNetServer {
    control: Arc<Mutex<Control>>,
    address: SocketAddr,
    thread: Option<JoinHandle<()>>,
}

struct Control {
    version: Version,
    clock_offset_s: f64,
    silent: bool,
    ended: bool,
    tamper: Box<Tamper>,
    connects: u32,
    keep_alives: u32,
}

/// To whom frames go.
#[derive(Clone, Copy)]
pub(crate) enum To {
    /// Whoever connects
    Clients,
    /// A group on the loopback
    Group(SocketAddrV4),
}

impl NatNetServer {
    /// In unicast at a free port.
    pub(crate) fn start(
        version: Version,
        rate_hz: f64,
        poses: impl FnMut(f64) -> Vec<Robot> + Send + 'static,
    ) -> Self {
        let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 0);
        Self::start_at(address, To::Clients, version, rate_hz, poses)
    }

    /// At a command port of choice, such as that of a server before.
    pub(crate) fn start_at(
        address: SocketAddrV4,
        to: To,
        version: Version,
        rate_hz: f64,
        poses: impl FnMut(f64) -> Vec<Robot> + Send + 'static,
    ) -> Self {
        let socket = loopback(address).unwrap();
        let control = Control {
            version,
            clock_offset_s: 0.0,
            silent: false,
            ended: false,
            tamper: Box::new(|datagram| vec![datagram]),
            connects: 0,
            keep_alives: 0,
        };
        let control = Arc::new(Mutex::new(control));
        let mut server = Running {
            address: socket.local_addr().unwrap(),
            socket,
            to,
            control: Arc::clone(&control),
            clients: BTreeSet::new(),
            poses: Box::new(poses),
            period: Duration::from_secs_f64(1.0 / rate_hz),
            start: Instant::now(),
        };
        Self {
            control,
            address: server.address,
            thread: Some(thread::spawn(move || server.run())),
        }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn command_port(&self) -> u16 {
        self.address.port()
    }

    /// From now on frames are of another version; the next connect is answered with it.
    pub(crate) fn set_version(&self, version: Version) {
        self.control().version = version;
    }

    /// The clock of the server jumps to this offset, in s.
    pub(crate) fn set_clock_offset_s(&self, offset_s: f64) {
        self.control().clock_offset_s = offset_s;
    }

    /// Sends nothing and answers nothing while silent.
    pub(crate) fn silence(&self, silent: bool) {
        self.control().silent = silent;
    }

    /// What happens to each frame on its way: lost, repeated, cut.
    pub(crate) fn tamper(&self, tamper: impl FnMut(Vec<u8>) -> Vec<Vec<u8>> + Send + 'static) {
        self.control().tamper = Box::new(tamper);
    }

    /// Connects and keep-alives that came.
    pub(crate) fn heard(&self) -> (u32, u32) {
        let control = self.control();
        (control.connects, control.keep_alives)
    }

    fn control(&self) -> MutexGuard<'_, Control> {
        lock(&self.control)
    }
}

impl Drop for NatNetServer {
    fn drop(&mut self) {
        self.control().ended = true;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(control: &Mutex<Control>) -> MutexGuard<'_, Control> {
    control.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Multicast from it stays on the loopback.
fn loopback(address: SocketAddrV4) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.bind(&SocketAddr::V4(address).into())?;
    socket.set_multicast_if_v4(&Ipv4Addr::LOCALHOST)?;
    socket.set_multicast_loop_v4(true)?;
    Ok(socket.into())
}

struct Running {
    socket: UdpSocket,
    address: SocketAddr,
    to: To,
    control: Arc<Mutex<Control>>,
    clients: BTreeSet<SocketAddr>,
    poses: Box<Poses>,
    period: Duration,
    start: Instant,
}

impl Running {
    fn run(&mut self) {
        let mut number = 0;
        let mut next = Instant::now();
        while !lock(&self.control).ended {
            let wait = next.saturating_duration_since(Instant::now());
            if wait.is_zero() {
                self.send_frame(number);
                number += 1;
                next += self.period;
                continue;
            }
            let wait = wait.clamp(Duration::from_micros(500), Duration::from_millis(20));
            self.socket.set_read_timeout(Some(wait)).unwrap();
            let mut buffer = [0; 2048];
            if let Ok((bytes, from)) = self.socket.recv_from(&mut buffer) {
                self.answer(&buffer[..bytes], from);
            }
        }
    }

    fn answer(&mut self, datagram: &[u8], from: SocketAddr) {
        let mut control = lock(&self.control);
        match datagram {
            _ if control.silent => return,
            [10, 0, 0, 0] => control.keep_alives += 1,
            [0, 0, ..] => control.connects += 1,
            _ => return,
        }
        let info = self.info(control.version);
        drop(control);
        if datagram[0] == 0 {
            self.clients.insert(from);
            let _ = self.socket.send_to(&encode_server_info(&info), from);
        }
    }

    fn info(&self, version: Version) -> ServerInfo {
        let (port, multicast, group) = match self.to {
            To::Clients => (self.address.port(), false, Ipv4Addr::UNSPECIFIED),
            To::Group(group) => (group.port(), true, *group.ip()),
        };
        let channel = Channel {
            clock_hz: CLOCK_HZ,
            port,
            multicast,
            group,
        };
        ServerInfo {
            name: "loopback".to_owned(),
            program: [1, 0, 0, 0],
            version,
            channel: (version >= Version::new(3, 0)).then_some(channel),
        }
    }

    fn send_frame(&mut self, number: u32) {
        let run_s = self.start.elapsed().as_secs_f64();
        let mut control = lock(&self.control);
        if control.silent {
            return;
        }
        let robots = (self.poses)(run_s);
        let server_s = STARTED_S + run_s + control.clock_offset_s;
        let datagram = if control.version == Version::new(4, 1) {
            synthetic(number, server_s, &robots)
        } else {
            let frame = frame_of(number, server_s, &robots);
            frame_with(&frame, control.version, &Filler::SOME)
        };
        for datagram in (control.tamper)(datagram) {
            let group = match self.to {
                To::Clients => None,
                To::Group(group) => Some(SocketAddr::V4(group)),
            };
            let unicast = self.clients.iter().filter(|_| group.is_none());
            for client in unicast.copied().chain(group) {
                let _ = self.socket.send_to(&datagram, client);
            }
        }
    }
}

/// In the default axes, with Y up.
pub(crate) fn placed(robot: &Robot) -> ([f32; 3], [f32; 4]) {
    let (_, x_m, y_m, heading_rad, _) = *robot;
    let half_rad = heading_rad / 2.0;
    let quaternion = [0.0, half_rad.sin() as f32, 0.0, half_rad.cos() as f32];
    ([x_m as f32, 0.05, -y_m as f32], quaternion)
}

fn frame_of(number: u32, server_s: f64, robots: &[Robot]) -> Frame {
    let body = |robot: &Robot| {
        let (position_m, quaternion) = placed(robot);
        Body {
            id: robot.0.cast_unsigned(),
            position_m,
            quaternion,
            mean_error_m: 0.0003,
            tracked: robot.4,
        }
    };
    let ticks = |time_s: f64| (time_s * CLOCK_HZ as f64) as u64;
    Frame {
        number,
        bodies: robots.iter().map(body).collect(),
        timestamp_s: Some(server_s),
        stamps: Some(Stamps {
            mid_exposure: ticks(server_s - AGE_S),
            received: ticks(server_s - AGE_S / 2.0),
            transmit: ticks(server_s),
        }),
    }
}
