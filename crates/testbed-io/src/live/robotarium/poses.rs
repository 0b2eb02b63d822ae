//! The connection that brings the poses.

use std::sync::Arc;
use std::time::Duration;

use rumqttc::{AsyncClient, Event, EventLoop, Packet, Publish, QoS, SubscribeReasonCode};
use tokio::sync::watch;

use super::super::counts::Dropped;
use super::super::inbox::Inbox;
use super::super::seen::Seen;
use super::RobotariumSpec;
use super::messages::{LARGEST_MESSAGE, decode_poses};
use super::problem::Problem;
use super::status::{self, Status};

/// Between signs of life when there are no poses.
const KEEP_ALIVE: Duration = Duration::from_secs(2);

/// Receives until the session ends.
pub(super) async fn receive(
    spec: RobotariumSpec,
    client_id: String,
    status: Arc<Status>,
    index: usize,
    mut end: watch::Receiver<()>,
) {
    let mut options = status::options(&spec, &client_id);
    let (client, mut connection) = status::client(&mut options, KEEP_ALIVE, 2 * LARGEST_MESSAGE);
    while status::connect(&mut connection, &status, &mut end).await {
        let received = receive_connected(&spec, &client, &mut connection, &status, index);
        tokio::select! {
            () = received => {}
            _ = end.changed() => {
                status::leave(&client, &mut connection).await;
                return;
            }
        }
    }
}

/// Receives until the connection is lost.
async fn receive_connected(
    spec: &RobotariumSpec,
    client: &AsyncClient,
    connection: &mut EventLoop,
    status: &Status,
    index: usize,
) {
    let topic = &spec.pose_topic;
    let asked = client.try_subscribe(topic, QoS::AtMostOnce);
    let subscribed = asked.is_ok() && subscribed(connection, status).await;
    if !subscribed {
        // Not to ask a broker that refuses all the time.
        return tokio::time::sleep(status::RETRY).await;
    }
    let _up = status.up(index);
    loop {
        match connection.poll().await {
            Ok(Event::Incoming(Packet::Publish(publish))) => {
                take(&publish, spec.latency_s, status.inbox());
            }
            Ok(_) => {}
            Err(error) => return status.failed(error),
        }
    }
}

/// Whether the broker will send poses.
async fn subscribed(connection: &mut EventLoop, status: &Status) -> bool {
    loop {
        match connection.poll().await {
            Ok(Event::Incoming(Packet::SubAck(answer))) => {
                let refused = answer.return_codes.contains(&SubscribeReasonCode::Failure);
                if refused {
                    status.failed(Problem::Topic);
                }
                return !refused;
            }
            Ok(_) => {}
            Err(error) => {
                status.failed(error);
                return false;
            }
        }
    }
}

fn take(publish: &Publish, latency_s: f64, inbox: &Inbox) {
    let arrival_s = inbox.clock().now_s();
    inbox.packet();
    if publish.retain {
        inbox.dropped(Dropped::Old);
        return;
    }
    let Ok(poses) = decode_poses(&publish.payload) else {
        inbox.dropped(Dropped::Malformed);
        return;
    };
    for tracked in poses {
        let seen = Seen {
            id: tracked.id,
            pose: tracked.pose,
            stamp_s: None,
            age_s: latency_s,
        };
        inbox.pose(arrival_s, seen);
    }
}
