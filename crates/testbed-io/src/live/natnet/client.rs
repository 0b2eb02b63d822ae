//! Settings and sockets of the client.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use socket2::{Domain, Protocol, Socket, Type};

use super::super::inbox::Inbox;
use super::super::poses::receiver;
use super::axes::Up;
use super::session::Session;
use crate::Error;

/// So often a thread that hears nothing looks whether it shall end.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Which server, and how it streams.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NatNetSpec {
    /// Address of the server
    pub server: IpAddr,
    /// UDP port of the server for commands
    #[serde(default = "command_port")]
    pub command_port: u16,
    /// UDP port for frames: of the group, or in unicast of this machine
    #[serde(default = "data_port")]
    pub data_port: u16,
    /// How the server sends frames
    #[serde(default)]
    pub transport: Transport,
    /// The group of multicast frames
    #[serde(default = "group")]
    pub group: Ipv4Addr,
    /// Address of this machine in the server's network; any if it has only one network
    #[serde(default = "any")]
    pub local: IpAddr,
    /// Which axis of the server points up
    #[serde(default)]
    pub up: Up,
    /// How old a pose is when its frame is sent, beyond what the server says of it, in s
    #[serde(default)]
    pub latency_s: f64,
}

/// How a server sends frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transport {
    /// To a group, as servers are delivered
    #[default]
    Multicast,
    /// To each client that connects
    Unicast,
}

fn command_port() -> u16 {
    1510
}

fn data_port() -> u16 {
    1511
}

fn group() -> Ipv4Addr {
    Ipv4Addr::new(239, 255, 42, 99)
}

fn any() -> IpAddr {
    Ipv4Addr::UNSPECIFIED.into()
}

impl NatNetSpec {
    /// A server with everything else as it is delivered.
    #[must_use]
    pub fn new(server: IpAddr) -> Self {
        Self {
            server,
            command_port: command_port(),
            data_port: data_port(),
            transport: Transport::default(),
            group: group(),
            local: any(),
            up: Up::default(),
            latency_s: 0.0,
        }
    }

    /// Where commands go.
    pub(super) fn command_address(&self) -> SocketAddr {
        SocketAddr::new(self.server, self.command_port)
    }

    pub(super) fn error(&self, problem: impl Into<String>, help: impl Into<String>) -> Error {
        Error::Link {
            peer: format!("NatNet server {}", self.server),
            problem: problem.into(),
            help: help.into(),
        }
    }
}

/// Connects to the server and puts what it sends into the inbox, until the inbox ends.
///
/// A server that does not answer is no error: it is asked again and again.
///
/// # Errors
/// If a socket cannot be opened or the group not be joined.
pub fn start(spec: &NatNetSpec, inbox: Inbox) -> Result<JoinHandle<()>, Error> {
    let sockets = Sockets::open(spec)?;
    if let Some(port) = sockets.instead {
        let wanted = spec.data_port;
        inbox.note(format!(
            "port {wanted} is taken; NatNet frames are awaited at port {port}"
        ));
    }
    let session = Session::new(spec.clone(), inbox.clone());
    receiver("natnet", inbox, move |_| run(&session, &sockets))
}

fn run(session: &Session, sockets: &Sockets) {
    thread::scope(|scope| {
        if let Some(data) = &sockets.data {
            let builder = thread::Builder::new().name("natnet-data".to_owned());
            if let Err(source) = builder.spawn_scoped(scope, || session.listen(data)) {
                // The session ends when this thread does.
                return session.note(format!("no thread for NatNet frames: {source}"));
            }
        }
        session.converse(&sockets.command);
    });
}

struct Sockets {
    /// In unicast, frames come here as well
    command: UdpSocket,
    data: Option<UdpSocket>,
    /// Port in place of the taken data port
    instead: Option<u16>,
}

impl Sockets {
    fn open(spec: &NatNetSpec) -> Result<Self, Error> {
        if spec.server.is_ipv4() != spec.local.is_ipv4() {
            let problem = format!("`local` is {}, of the other version of IP", spec.local);
            return Err(spec.error(problem, "use IPv4 for both"));
        }
        match spec.transport {
            Transport::Unicast => Self::unicast(spec),
            Transport::Multicast => Self::multicast(spec),
        }
    }

    /// One socket for all: some servers send frames to where the connect came from, some to the data port of that address.
    fn unicast(spec: &NatNetSpec) -> Result<Self, Error> {
        let wanted = UdpSocket::bind((spec.local, spec.data_port));
        let taken = matches!(&wanted, Err(source) if source.kind() == io::ErrorKind::AddrInUse);
        let bound = match taken {
            true => UdpSocket::bind((spec.local, 0)),
            false => wanted,
        };
        let command = bound
            .and_then(with_timeout)
            .map_err(|source| spec.no_socket(&source))?;
        let port = command.local_addr().map(|address| address.port()).ok();
        Ok(Self {
            command,
            data: None,
            instead: port.filter(|_| taken),
        })
    }

    fn multicast(spec: &NatNetSpec) -> Result<Self, Error> {
        let (IpAddr::V4(local), true) = (spec.local, spec.group.is_multicast()) else {
            let problem = format!("{} at {} is no multicast group", spec.group, spec.local);
            let help =
                "use IPv4 and the group in the server's streaming settings, often 239.255.42.99";
            return Err(spec.error(problem, help));
        };
        let command = UdpSocket::bind((local, 0))
            .and_then(with_timeout)
            .map_err(|source| spec.no_socket(&source))?;
        let data = join(spec.group, local, spec.data_port)
            .and_then(with_timeout)
            .map_err(|source| spec.no_group(&source))?;
        Ok(Self {
            command,
            data: Some(data),
            instead: None,
        })
    }
}

impl NatNetSpec {
    fn no_socket(&self, source: &io::Error) -> Error {
        let problem = format!("no socket at {}: {source}", self.local);
        let help = "set `local` to an address of this machine in the server's network";
        self.error(problem, help)
    }

    fn no_group(&self, source: &io::Error) -> Error {
        let (group, port) = (self.group, self.data_port);
        let problem = format!("group {group} at port {port} cannot be joined: {source}");
        let help = "set `local` to the address of this machine in the server's network, and `group` and \
            `data_port` as in the server's streaming settings, or use unicast";
        self.error(problem, help)
    }
}

/// The port is shared with other clients and a server on this machine.
fn join(group: Ipv4Addr, local: Ipv4Addr, port: u16) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.set_reuse_address(true)?;
    socket.bind(&SocketAddr::from((Ipv4Addr::UNSPECIFIED, port)).into())?;
    socket.join_multicast_v4(&group, &local)?;
    Ok(socket.into())
}

fn with_timeout(socket: UdpSocket) -> io::Result<UdpSocket> {
    socket.set_read_timeout(Some(READ_TIMEOUT))?;
    Ok(socket)
}
