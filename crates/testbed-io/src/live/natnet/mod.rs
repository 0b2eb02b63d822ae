//! OptiTrack NatNet 2.0 to 4.1 over UDP: rigid bodies of a motion capture system.

mod axes;
mod client;
mod conversation;
mod cursor;
mod decode;
mod encode;
mod frame;
mod server_state;
mod spec;

pub use axes::{Up, floor_pose};
pub use client::start;
pub use decode::decode;
pub use encode::{encode_connect, encode_frame, encode_keep_alive, encode_server_info};
pub use frame::{Body, Channel, Frame, Malformed, Message, ServerInfo, Stamps, Version};
pub use spec::{NatNetSpec, Transport};
