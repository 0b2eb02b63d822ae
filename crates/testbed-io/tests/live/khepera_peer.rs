//! Khepera robots on loopback.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use unicycle_cbf::{Body, WheelSpeeds};

use super::world::World;

pub const COUNT_MPS: f64 = 6.2953e-6;

/// What the robots of a testbed share.
#[derive(Default)]
pub struct Wireless {
    /// Per cent of packets that are lost on their way, each way
    pub lost_percent: AtomicU32,
    /// Requests received
    pub requests: AtomicU64,
    ended: AtomicBool,
}

/// Robots that answer until they are dropped.
pub struct Kheperas {
    pub addresses: Vec<SocketAddr>,
    pub wireless: Arc<Wireless>,
    threads: Vec<JoinHandle<()>>,
}

impl Kheperas {
    pub fn start(world: &World, body: Body) -> Self {
        let wireless = Arc::new(Wireless::default());
        let mut addresses = Vec::new();
        let mut threads = Vec::new();
        for robot in 0..world.poses().len() {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            let patience = Some(Duration::from_millis(20));
            socket.set_read_timeout(patience).unwrap();
            addresses.push(socket.local_addr().unwrap());
            let (world, wireless) = (world.clone(), Arc::clone(&wireless));
            threads.push(std::thread::spawn(move || {
                serve(robot, &socket, &world, body, &wireless);
            }));
        }
        Self {
            addresses,
            wireless,
            threads,
        }
    }
}

fn serve(robot: usize, socket: &UdpSocket, world: &World, body: Body, wireless: &Wireless) {
    let mut random = 1_u32 + robot as u32;
    let mut lost = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 16) % 100 < wireless.lost_percent.load(Ordering::Relaxed)
    };
    let mut buffer = [0; 256];
    while !wireless.ended.load(Ordering::Relaxed) {
        let Ok((bytes, from)) = socket.recv_from(&mut buffer) else {
            continue;
        };
        wireless.requests.fetch_add(1, Ordering::Relaxed);
        if lost() {
            continue;
        }
        let request = str::from_utf8(&buffer[..bytes]).unwrap();
        let answer = match request.split(',').collect::<Vec<_>>()[..] {
            ["$K3DRV", "REQ", "INIT"] => "$K3DRV,RES,INIT",
            ["$K3DRV", "REQ", "CTRL", right, left] => {
                let speed = |counts: &str| f64::from(counts.parse::<i32>().unwrap()) * COUNT_MPS;
                world.command(
                    robot,
                    body.speeds_of(WheelSpeeds {
                        left_mps: speed(left),
                        right_mps: speed(right),
                    }),
                );
                // Robots answer in either spelling.
                ["$K3DRV,RES,CTRL", "$K3DRV,CTRL,RES"][robot % 2]
            }
            _ => panic!("{request}"),
        };
        if !lost() {
            socket.send_to(answer.as_bytes(), from).unwrap();
        }
    }
}

impl Drop for Kheperas {
    fn drop(&mut self) {
        self.wireless.ended.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.join().unwrap();
        }
    }
}
