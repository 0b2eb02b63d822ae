//! Robots at UDP addresses, one each.

use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use super::{CommandCounts, Silence};
use crate::Error;

/// A socket that sends without waiting and takes answers from its robots alone.
#[derive(Debug)]
pub(super) struct UdpRobots {
    socket: UdpSocket,
    addresses: Vec<SocketAddr>,
    answers: Vec<Answers>,
    counts: CommandCounts,
}

/// What a robot answered.
#[derive(Debug, Clone, Copy)]
struct Answers {
    count: u64,
    last: Instant,
}

impl UdpRobots {
    /// `local_port` is where answers come; 0 for any.
    pub(super) fn bind(addresses: &[SocketAddr], local_port: u16) -> Result<Self, Error> {
        let any = match addresses.first() {
            Some(SocketAddr::V6(_)) => IpAddr::from([0_u16; 8]),
            _ => IpAddr::from([0_u8; 4]),
        };
        let failed = |source: std::io::Error| Error::Link {
            peer: format!("UDP port {local_port} of this computer"),
            problem: source.to_string(),
            help: "is another program using it?".to_owned(),
        };
        let socket = UdpSocket::bind((any, local_port)).map_err(failed)?;
        socket.set_nonblocking(true).map_err(failed)?;
        let answers = Answers {
            count: 0,
            last: Instant::now(),
        };
        Ok(Self {
            socket,
            addresses: addresses.to_vec(),
            answers: vec![answers; addresses.len()],
            counts: CommandCounts::default(),
        })
    }

    pub(super) fn robots(&self) -> usize {
        self.addresses.len()
    }

    pub(super) fn send(&mut self, robot: usize, message: &[u8]) {
        let sent = self
            .addresses
            .get(robot)
            .is_some_and(|address| self.socket.send_to(message, address).is_ok());
        if sent {
            self.counts.sent += 1;
        } else {
            self.counts.failed += 1;
        }
    }

    /// Takes in what has come; `is_answer` says whether a packet of a robot is an answer to what was sent.
    pub(super) fn take_answers(&mut self, is_answer: impl Fn(&[u8]) -> bool) {
        let mut buffer = [0; 2048];
        // Bounded, so that a flood of packets does not keep the loop here.
        for _ in 0..64 * self.addresses.len().max(1) {
            let (bytes, from) = match self.socket.recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => return,
                // An ICMP message of an earlier packet: the robot is not there now.
                Err(_) => continue,
            };
            let robot = self.addresses.iter().position(|address| *address == from);
            match (robot, buffer.get(..bytes)) {
                (Some(robot), Some(packet)) if is_answer(packet) => {
                    self.counts.acknowledged += 1;
                    self.answers[robot] = Answers {
                        count: self.answers[robot].count + 1,
                        last: Instant::now(),
                    };
                }
                (Some(_), _) => self.counts.malformed += 1,
                (None, _) => self.counts.stranger += 1,
            }
        }
    }

    /// Sends `message` to every robot each 20 ms, at least five times, until each has answered `answers` times or patience ends.
    /// Gives the robots that have not.
    pub(super) fn insist(
        &mut self,
        message: &[u8],
        is_answer: impl Fn(&[u8]) -> bool + Copy,
        answers: u64,
        patience: Duration,
    ) -> Vec<usize> {
        let start = Instant::now();
        self.take_answers(is_answer);
        let before: Vec<u64> = self.answers.iter().map(|a| a.count).collect();
        let mut round = 0;
        loop {
            for robot in 0..self.robots() {
                self.send(robot, message);
            }
            std::thread::sleep(Duration::from_millis(20));
            round += 1;
            self.take_answers(is_answer);
            let missing = |robot: &usize| self.answers[*robot].count < before[*robot] + answers;
            let missing: Vec<usize> = (0..self.robots()).filter(missing).collect();
            if round >= 5 && (missing.is_empty() || start.elapsed() >= patience) {
                return missing;
            }
        }
    }

    pub(super) fn silence(&self) -> Option<Silence> {
        let robots = self.addresses.iter().zip(&self.answers);
        let (address, answers) = robots.min_by_key(|(_, answers)| answers.last)?;
        Some(Silence {
            peer: format!("the robot at {address}"),
            for_s: answers.last.elapsed().as_secs_f64(),
        })
    }

    pub(super) fn counts(&self) -> CommandCounts {
        self.counts
    }
}
