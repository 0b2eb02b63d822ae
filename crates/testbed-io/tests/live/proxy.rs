//! A network between a client and its broker that can fail.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Passing,
    Silent,
    Cut,
}

struct Network {
    mode: Mode,
    sockets: Vec<TcpStream>,
}

/// Passes connections on to another port of the loopback.
pub struct Proxy {
    port: u16,
    network: Arc<Mutex<Network>>,
}

impl Proxy {
    pub fn start(to: u16) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let network = Arc::new(Mutex::new(Network {
            mode: Mode::Passing,
            sockets: Vec::new(),
        }));
        let shared = network.clone();
        std::thread::spawn(move || {
            for client in listener.incoming() {
                accept(&client.unwrap(), to, &shared);
            }
        });
        Self { port, network }
    }

    pub fn port(&self) -> u16 {
        self.port
    }

    /// Ends every connection and accepts no other.
    pub fn cut(&self) {
        let mut network = self.lock();
        network.mode = Mode::Cut;
        for socket in network.sockets.drain(..) {
            let _ = socket.shutdown(Shutdown::Both);
        }
    }

    /// Keeps back what either side sends.
    pub fn silence(&self) {
        self.lock().mode = Mode::Silent;
    }

    /// Passes on what was kept back, and everything from now on.
    pub fn resume(&self) {
        self.lock().mode = Mode::Passing;
    }

    fn lock(&self) -> MutexGuard<'_, Network> {
        self.network.lock().unwrap()
    }
}

fn accept(client: &TcpStream, to: u16, network: &Arc<Mutex<Network>>) {
    let mut state = network.lock().unwrap();
    if state.mode == Mode::Cut {
        return;
    }
    let Ok(server) = TcpStream::connect(("127.0.0.1", to)) else {
        return;
    };
    for (from, to) in [(client, &server), (&server, client)] {
        from.set_nodelay(true).unwrap();
        state.sockets.push(from.try_clone().unwrap());
        let (from, to) = (from.try_clone().unwrap(), to.try_clone().unwrap());
        let network = network.clone();
        std::thread::spawn(move || pass(from, to, &network));
    }
}

fn pass(mut from: TcpStream, mut to: TcpStream, network: &Mutex<Network>) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        while network.lock().unwrap().mode == Mode::Silent {
            std::thread::sleep(Duration::from_millis(2));
        }
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    while network.lock().unwrap().mode == Mode::Silent {
        std::thread::sleep(Duration::from_millis(2));
    }
    let _ = to.shutdown(Shutdown::Both);
    let _ = from.shutdown(Shutdown::Both);
}
