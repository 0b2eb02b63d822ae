//! The server, asked over plain sockets.

mod crowd;
mod events;
mod requests;

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::View;

const PATIENCE: Duration = Duration::from_secs(5);

struct Served {
    view: View,
    stops: Arc<AtomicU32>,
    port: u16,
}

fn served(address: SocketAddr) -> Served {
    let stops = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&stops);
    let stop = Box::new(move || {
        counted.fetch_add(1, Ordering::SeqCst);
    });
    let lane = json!({ "half_width_m": 0.07 });
    let view = View::serve(address, lane, "A <title>".to_owned(), stop).unwrap();
    let (address, _) = view
        .control_url()
        .strip_prefix("http://")
        .unwrap()
        .split_once('/')
        .unwrap();
    let port = address.parse::<SocketAddr>().unwrap().port();
    Served { view, stops, port }
}

impl Served {
    fn local() -> Self {
        served((Ipv4Addr::LOCALHOST, 0).into())
    }

    fn everywhere() -> Self {
        let address = (Ipv4Addr::UNSPECIFIED, 0).into();
        served(address)
    }

    fn control(&self) -> String {
        token(self.view.control_url())
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Sends a request whose headers are given; `PORT` in them stands for the port.
    fn send(&self, line: &str, headers: &[&str]) -> TcpStream {
        let mut request = format!("{line} HTTP/1.1\r\n");
        for header in headers {
            request += &header.replace("PORT", &self.port.to_string());
            request += "\r\n";
        }
        let mut stream = self.connect();
        stream
            .write_all(format!("{request}\r\n").as_bytes())
            .unwrap();
        stream
    }

    /// Status and whole answer, to a request with these headers and a sound host.
    fn ask(&self, line: &str, headers: &[&str]) -> (u16, String) {
        self.ask_raw(line, &[&["Host: 127.0.0.1:PORT"], headers].concat())
    }

    fn ask_raw(&self, line: &str, headers: &[&str]) -> (u16, String) {
        let mut answer = String::new();
        let mut stream = self.send(line, headers);
        stream.read_to_string(&mut answer).unwrap();
        (status(&answer), answer)
    }

    fn events(&self, query: &str) -> Events {
        let stream = self.send(&format!("GET /events{query}"), &["Host: localhost:PORT"]);
        Events {
            stream,
            text: String::new(),
        }
    }
}

fn token(url: &str) -> String {
    url.split_once("?token=").unwrap().1.to_owned()
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).unwrap().parse().unwrap()
}

struct Events {
    stream: TcpStream,
    text: String,
}

impl Events {
    /// The data of the next event of this name; those of other names before it are skipped.
    fn next(&mut self, name: &str) -> Value {
        let start = Instant::now();
        loop {
            let head = format!("event: {name}\ndata: ");
            if let Some(at) = self.text.find(&head) {
                let rest = &self.text[at + head.len()..];
                if let Some((data, after)) = rest.split_once('\n') {
                    let value = serde_json::from_str(data).unwrap();
                    self.text = after.to_owned();
                    return value;
                }
            }
            assert!(start.elapsed() < PATIENCE, "no {name} in {}", self.text);
            let mut part = [0; 4096];
            let count = self.stream.read(&mut part).unwrap();
            assert!(count > 0, "no {name} in {}", self.text);
            self.text += std::str::from_utf8(&part[..count]).unwrap();
        }
    }

    fn status(&mut self) -> u16 {
        let mut part = [0; 64];
        let count = self.stream.read(&mut part).unwrap();
        status(std::str::from_utf8(&part[..count]).unwrap())
    }
}
