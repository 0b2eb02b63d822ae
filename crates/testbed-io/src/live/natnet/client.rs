//! Sockets of the client.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use socket2::{Domain, Protocol, Socket, Type};

use super::super::inbox::Inbox;
use super::super::poses::receiver;
use super::conversation::Conversation;
use super::spec::{NatNetSpec, Transport};
use crate::Error;

/// So often a thread that hears nothing looks whether it shall end.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

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
    let session = Conversation::new(spec.clone(), inbox.clone());
    receiver("natnet", inbox, move |_| run(&session, &sockets))
}

fn run(session: &Conversation, sockets: &Sockets) {
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
