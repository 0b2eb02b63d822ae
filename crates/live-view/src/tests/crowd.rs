//! The stop, whatever connections without a token do.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use super::{Events, Served};

/// Between the bytes of an attacker.
const DRIP: Duration = Duration::from_millis(5);
/// What a press of the button may take: half a second, and one more on a computer that is busy with other tests.
const ANSWERED: Duration = Duration::from_millis(1500);
/// A system without room for another connection lets one wait for minutes.
const CONNECTED: Duration = Duration::from_millis(200);

impl Served {
    /// Status of a press of the button, and how long the answer took.
    fn press(&self, headers: &[&str]) -> (u16, Duration) {
        let start = Instant::now();
        (self.ask("POST /stop", headers).0, start.elapsed())
    }

    fn assert_stops(&self, about: &str) {
        let right = format!("Authorization: Bearer {}", self.control());
        for (headers, expected) in [(vec![], 403), (vec![right.as_str()], 200)] {
            let (status, took) = self.press(&headers);
            assert_eq!(status, expected, "{about}");
            assert!(took < ANSWERED, "{about}: {took:?}");
        }
    }

    fn silent(&self, count: usize) -> Vec<TcpStream> {
        (0..count).map(|_| self.connect()).collect()
    }

    /// Opens connections as fast as they are closed, and sends a byte over each every few milliseconds.
    fn crowd_in(&self, most: usize, first: &[u8], until: Instant) {
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, self.port));
        let mut held: Vec<TcpStream> = Vec::new();
        while Instant::now() < until {
            while held.len() < most && Instant::now() < until {
                let Ok(mut stream) = TcpStream::connect_timeout(&address, CONNECTED) else {
                    break;
                };
                let _ = stream.write_all(first);
                let _ = stream.set_nonblocking(true);
                held.push(stream);
            }
            held.retain_mut(|stream| is_open(stream) && stream.write_all(b"a").is_ok());
            sleep(DRIP);
        }
    }
}

fn is_open(stream: &mut TcpStream) -> bool {
    let read = stream.read(&mut [0; 16]);
    read.is_err_and(|error| error.kind() == ErrorKind::WouldBlock)
}

#[test]
fn silent_connections_do_not_hold_up_the_stop() {
    let served = Served::local();
    for count in [100, 200] {
        let silent = served.silent(count);
        for _ in 0..3 {
            served.assert_stops(&format!("{count} silent"));
        }
        drop(silent);
    }
}

#[test]
fn heads_that_drip_and_attackers_that_reopen_do_not_hold_up_the_stop() {
    let served = Served::local();
    for first in [
        &b""[..],
        b"GET / HTTP/1.1\r\nX-",
        b"POST /stop HTTP/1.1\r\nX-",
    ] {
        let until = Instant::now() + Duration::from_millis(800);
        scope(|threads| {
            for _ in 0..3 {
                threads.spawn(|| served.crowd_in(70, first, until));
            }
            while Instant::now() < until {
                served.assert_stops(&format!("{:?}", String::from_utf8_lossy(first)));
                sleep(Duration::from_millis(50));
            }
        });
    }
}

#[test]
fn a_head_that_is_not_complete_within_a_second_is_not_waited_for() {
    let served = Served::local();
    let mut idle = served.connect();
    let mut dripping = served.connect();
    dripping.write_all(b"GET / HTTP/1.1\r\nX-").unwrap();
    let start = Instant::now();
    while dripping.write_all(b"a").is_ok() {
        assert!(start.elapsed() < Duration::from_secs(4));
        sleep(Duration::from_millis(20));
    }
    assert!(start.elapsed() > Duration::from_millis(800));
    assert_eq!(idle.read(&mut [0; 16]).unwrap(), 0);
}

#[test]
fn readers_that_take_every_stream_leave_those_of_the_token_free() {
    let served = Served::local();
    let mut readers: Vec<Events> = (0..16).map(|_| served.events("")).collect();
    for events in &mut readers {
        events.next("hello");
    }
    assert_eq!(served.events("").status(), 503);
    let query = format!("?token={}", served.control());
    let mut pages: Vec<Events> = (0..20).map(|_| served.events(&query)).collect();
    for page in &mut pages {
        assert_eq!(page.next("hello")["may_stop"], true);
    }
    served.assert_stops("streams");
}

/// Pages that nobody reads fill the places of readers, not those of others.
#[test]
fn the_page_with_the_token_outlives_a_crowd() {
    let served = Served::local();
    let mut page = served.events(&format!("?token={}", served.control()));
    page.next("hello");
    let unread = (0..100).map(|_| served.send("GET /", &["Host: localhost"]));
    let unread: Vec<TcpStream> = unread.collect();
    let silent = served.silent(300);
    served.view.note("still here");
    assert_eq!(page.next("note")["text"], "still here");
    served.assert_stops("unread pages");
    drop((unread, silent));
}
