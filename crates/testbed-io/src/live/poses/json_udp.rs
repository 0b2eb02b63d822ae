//! Poses as JSON lines in datagrams.

use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{Receiver, receiver};
use crate::Error;
use crate::live::counts::Dropped;
use crate::live::inbox::Inbox;
use crate::live::json_lines::{GettingReadyLine, PoseLine, lines_of};

/// Where poses come to, and from whom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JsonUdpSpec {
    /// Address and port of this computer to listen on
    pub listen: SocketAddr,
    /// Packets from other addresses are dropped
    pub sender: IpAddr,
    /// How old a pose is when it is sent, in s
    #[serde(default)]
    pub latency_s: f64,
}

/// An error that stays must not make the thread spin.
const AFTER_ERROR: Duration = Duration::from_millis(10);

pub(in crate::live) fn listen(spec: &JsonUdpSpec, inbox: Inbox) -> Result<Receiver, Error> {
    let failed = |source: std::io::Error| Error::Link {
        peer: format!("UDP port {}", spec.listen),
        problem: source.to_string(),
        help: "is it an address of this computer, and is another program using the port?"
            .to_owned(),
    };
    let socket = UdpSocket::bind(spec.listen).map_err(failed)?;
    let patience = Some(Duration::from_millis(50));
    socket.set_read_timeout(patience).map_err(failed)?;
    let (sender, latency_s) = (spec.sender.to_canonical(), spec.latency_s);
    receiver("json poses", inbox, move |inbox| {
        let mut buffer = vec![0; 65_536];
        while !inbox.has_ended() {
            let (bytes, from) = match socket.recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) => {
                    if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) {
                        std::thread::sleep(AFTER_ERROR);
                    }
                    continue;
                }
            };
            let arrival_s = inbox.clock().now_s();
            inbox.packet();
            if from.ip().to_canonical() != sender {
                inbox.dropped(Dropped::Stranger);
                continue;
            }
            // From the back: without stamps the last line of a robot is its newest.
            for line in lines_of(buffer.get(..bytes).unwrap_or_default()).rev() {
                take(inbox, arrival_s, line, latency_s, Some(from));
            }
        }
    })
}

/// `from` whom, where that can be known.
pub(super) fn take(
    inbox: &Inbox,
    arrival_s: f64,
    line: &[u8],
    latency_s: f64,
    from: Option<SocketAddr>,
) {
    if let Some(pose) = PoseLine::parse(line) {
        inbox.pose_from(arrival_s, pose.seen(latency_s), from);
    } else if let Some(line) = GettingReadyLine::parse(line) {
        inbox.getting_ready(arrival_s, line.getting_ready);
    } else {
        inbox.dropped(Dropped::Malformed);
    }
}
