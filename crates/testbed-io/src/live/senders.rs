//! Whether the poses of a robot come from two senders at once, which no single pose shows.

use std::fmt;
use std::net::SocketAddr;

use unicycle_cbf::Pose;

use super::gate::{Bounds, distance_m, turned_rad};
use super::seen::Seen;

/// Two clocks differ by more than what is late, in s.
const CLOCKS_APART_S: f64 = 0.5;
/// One sender's next pose is not farther from its last one than the robot can move and this, in m and rad.
const NEAR_M: f64 = 0.1;
const NEAR_RAD: f64 = 1.0;
/// How often both have to come back before they are two: a single wrong pose, a clock that jumps or a program that was started anew
/// comes once.
const RETURNS: u32 = 3;
/// A sender that was silent for longer is forgotten, in s.
const FORGOTTEN_S: f64 = 5.0;

/// The senders of one robot's poses, as far as they differ.
#[derive(Debug, Clone)]
pub(super) struct Senders {
    bounds: Bounds,
    /// The one whose pose came last, and the one before
    streams: [Option<Stream>; 2],
    told: bool,
}

/// Poses that one sender can have sent.
#[derive(Debug, Clone, Copy)]
struct Stream {
    from: Option<SocketAddr>,
    arrival_s: f64,
    /// Time of arrival less the stamp, in s
    clock_s: Option<f64>,
    pose: Pose,
    /// Times that it came back after the other
    returns: u32,
}

/// What shows that there are two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Two {
    /// Where from
    Addresses(SocketAddr, SocketAddr),
    /// By how much their clocks differ, in s
    Clocks(f64),
    /// How far their poses are from each other, in m and rad
    Places(f64, f64),
}

impl Senders {
    pub(super) fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            streams: [None; 2],
            told: false,
        }
    }

    /// Adds a pose; gives what shows two senders, once.
    pub(super) fn add(
        &mut self,
        arrival_s: f64,
        seen: &Seen,
        from: Option<SocketAddr>,
    ) -> Option<Two> {
        let new = Stream {
            from,
            arrival_s,
            clock_s: seen.stamp_s.map(|stamp_s| arrival_s - stamp_s),
            pose: seen.pose,
            returns: 0,
        };
        let [last, other] = self.streams;
        let goes_on = |stream: Option<Stream>| stream.filter(|s| new.goes_on(s, &self.bounds));
        if let Some(last) = goes_on(last) {
            let returns = last.returns;
            self.streams[0] = Some(Stream { returns, ..new });
            return None;
        }
        let back = goes_on(other).map(|other| other.returns + 1);
        let returns = back.unwrap_or(0);
        self.streams = [Some(Stream { returns, ..new }), last];
        let last = last?;
        let two = returns >= RETURNS && last.returns >= RETURNS && !self.told;
        self.told |= two;
        two.then(|| Two::of(&last, &new))
    }
}

impl Stream {
    /// Whether this can be the next pose of the same sender.
    fn goes_on(&self, before: &Self, bounds: &Bounds) -> bool {
        let passed_s = self.arrival_s - before.arrival_s;
        let near_m = NEAR_M + bounds.speed_mps * passed_s;
        let near_rad = NEAR_RAD + bounds.turn_rate_rad_s * passed_s;
        passed_s <= FORGOTTEN_S
            && self.from == before.from
            && self.clocks_apart_s(before) <= CLOCKS_APART_S
            && distance_m(&before.pose, &self.pose) <= near_m
            && turned_rad(&before.pose, &self.pose) <= near_rad
    }

    fn clocks_apart_s(&self, other: &Self) -> f64 {
        match (self.clock_s, other.clock_s) {
            (Some(own_s), Some(other_s)) => (own_s - other_s).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    }
}

impl Two {
    fn of(a: &Stream, b: &Stream) -> Self {
        if let (Some(from_a), Some(from_b)) = (a.from, b.from)
            && from_a != from_b
        {
            return Self::Addresses(from_a, from_b);
        }
        let clocks_s = a.clocks_apart_s(b);
        if clocks_s > CLOCKS_APART_S {
            return Self::Clocks(clocks_s);
        }
        Self::Places(distance_m(&a.pose, &b.pose), turned_rad(&a.pose, &b.pose))
    }
}

impl fmt::Display for Two {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Addresses(a, b) => write!(f, "come from {a} and from {b} by turns"),
            Self::Clocks(apart_s) if apart_s.is_finite() => {
                write!(
                    f,
                    "come by turns with two clocks that are {apart_s:.1} s apart"
                )
            }
            Self::Clocks(_) => write!(f, "come by turns with a stamp and without"),
            Self::Places(apart_m, turned_rad) => write!(
                f,
                "contradict each other by turns: they are {apart_m:.2} m and {:.0}° apart",
                turned_rad.to_degrees()
            ),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::gate::Arena;
    use super::*;

    const BOUNDS: Bounds = Bounds {
        arena: Arena {
            x_m: [-2.0, 2.0],
            y_m: [-2.0, 2.0],
        },
        ..Bounds::ORDINARY
    };

    fn seen(x_m: f64, stamp_s: Option<f64>) -> Seen {
        let pose = Pose {
            x_m,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        Seen {
            id: 1,
            pose,
            stamp_s,
            age_s: 0.0,
        }
    }

    fn address(port: u16) -> Option<SocketAddr> {
        Some(([127, 0, 0, 1], port).into())
    }

    /// What is told of poses that arrive every 20 ms.
    fn told(count: u32, pose: impl Fn(u32, f64) -> (Seen, Option<SocketAddr>)) -> Vec<String> {
        let mut senders = Senders::new(BOUNDS);
        let told = (0..count).filter_map(|number| {
            let arrival_s = 0.02 * f64::from(number);
            let (seen, from) = pose(number, arrival_s);
            senders.add(arrival_s, &seen, from)
        });
        told.map(|two| two.to_string()).collect()
    }

    #[test]
    fn two_addresses_are_told_once() {
        let told = told(1000, |number, _| {
            (seen(0.0, None), address(5000 + (number % 2) as u16))
        });
        assert_eq!(told.len(), 1);
        assert!(told[0].contains("127.0.0.1:5000") && told[0].contains("127.0.0.1:5001"));
    }

    #[test]
    fn two_clocks_and_two_places_are_told_with_their_difference() {
        let clocks = told(100, |number, now_s| {
            let ahead_s = if number.is_multiple_of(3) { 100.0 } else { 0.0 };
            (seen(0.0, Some(now_s + ahead_s)), None)
        });
        assert_eq!(
            clocks,
            ["come by turns with two clocks that are 100.0 s apart"]
        );
        let places = told(100, |number, _| {
            (seen(0.5 * f64::from(number % 2), None), None)
        });
        assert_eq!(places.len(), 1);
        assert!(places[0].contains("0.50 m and 0° apart"), "{places:?}");
    }

    #[test]
    fn one_sender_is_one_whatever_it_does() {
        // Bursts after silence, while it drives
        let bursts = |number: u32, now_s: f64| {
            let sent_s = now_s - 0.02 * f64::from(49 - number % 50);
            (seen(0.3 * sent_s, Some(sent_s)), address(5000))
        };
        assert!(told(1000, bursts).is_empty());
        // Wrong poses at different places now and then
        let wild = |number: u32, now_s: f64| {
            let wrong = if number.is_multiple_of(10) {
                0.5 * f64::from(number / 10 % 4 + 1)
            } else {
                0.0
            };
            (seen(wrong, Some(now_s)), address(5000))
        };
        assert!(told(200, wild).is_empty());
        // A port of its own for every packet
        let ports = |number: u32, _| (seen(0.0, None), address(5000 + number as u16));
        assert!(told(1000, ports).is_empty());
        // A clock that jumps, a program that is started anew, and nothing that is compared with a long time ago
        let anew = |number: u32, now_s: f64| {
            let ahead_s = 100.0 * f64::from(number / 250);
            (
                seen(0.0, Some(now_s + ahead_s)),
                address(5000 + (number / 300) as u16),
            )
        };
        assert!(told(1000, anew).is_empty());
    }
}
