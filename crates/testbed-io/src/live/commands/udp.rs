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
    robots: Vec<Robot>,
    counts: CommandCounts,
}

/// What went out to a robot, and what it answered.
#[derive(Debug, Clone, Copy)]
struct Robot {
    sent: u64,
    answers: u64,
    answered: Instant,
}

/// Between two rounds of a message that has to arrive, and the least number of rounds.
const ROUND: Duration = Duration::from_millis(20);
const ROUNDS: u64 = 5;

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
        let robot = Robot {
            sent: 0,
            answers: 0,
            answered: Instant::now(),
        };
        Ok(Self {
            socket,
            addresses: addresses.to_vec(),
            robots: vec![robot; addresses.len()],
            counts: CommandCounts::default(),
        })
    }

    pub(super) fn send(&mut self, robot: usize, message: &[u8]) {
        let sent = self
            .addresses
            .get(robot)
            .is_some_and(|address| self.socket.send_to(message, address).is_ok());
        if sent {
            self.counts.sent += 1;
            self.robots[robot].sent += 1;
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
                    self.robots[robot].answers += 1;
                    self.robots[robot].answered = Instant::now();
                }
                (Some(_), _) => self.counts.malformed += 1,
                (None, _) => self.counts.stranger += 1,
            }
        }
    }

    /// Sends a message to every robot each 20 ms, at least five times, until each has answered as often as asked after these, or
    /// patience ends. Gives the robots that have not, and those to which it could not be sent as often.
    pub(super) fn insist(
        &mut self,
        message: &[u8],
        is_answer: impl Fn(&[u8]) -> bool + Copy,
        answers: u64,
        patience: Duration,
    ) -> Vec<usize> {
        let start = Instant::now();
        let first = self.robots.clone();
        let mut confirmed = first.clone();
        for round in 1.. {
            self.send_to_all(message);
            std::thread::sleep(ROUND);
            self.take_answers(is_answer);
            if round == ROUNDS {
                // Answers until now may be to what was sent before.
                confirmed.clone_from(&self.robots);
            }
            if round < ROUNDS {
                continue;
            }
            let certain = |robot: &usize| {
                let now = self.robots[*robot];
                now.sent >= first[*robot].sent + ROUNDS
                    && now.answers >= confirmed[*robot].answers + answers
            };
            let robots = 0..self.robots.len();
            let missing: Vec<usize> = robots.filter(|robot| !certain(robot)).collect();
            if missing.is_empty() || start.elapsed() >= patience {
                return missing;
            }
        }
        Vec::new()
    }

    /// Sends a message that nobody answers to every robot each 20 ms for half a second. Gives the robots to which it could not be
    /// sent often enough.
    pub(super) fn repeat(&mut self, message: &[u8]) -> Vec<usize> {
        let first = self.robots.clone();
        for _ in 0..5 * ROUNDS {
            self.send_to_all(message);
            std::thread::sleep(ROUND);
        }
        let reached = |robot: &usize| self.robots[*robot].sent >= first[*robot].sent + ROUNDS;
        let robots = 0..self.robots.len();
        robots.filter(|robot| !reached(robot)).collect()
    }

    fn send_to_all(&mut self, message: &[u8]) {
        for robot in 0..self.robots.len() {
            self.send(robot, message);
        }
    }

    pub(super) fn silence(&self) -> Option<Silence> {
        let robots = self.addresses.iter().zip(&self.robots);
        let (address, robot) = robots.min_by_key(|(_, robot)| robot.answered)?;
        Some(Silence {
            peer: format!("the robot at {address}"),
            for_s: robot.answered.elapsed().as_secs_f64(),
        })
    }

    pub(super) fn counts(&self) -> CommandCounts {
        self.counts
    }
}
