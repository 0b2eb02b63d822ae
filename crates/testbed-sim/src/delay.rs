//! The simulated way from the tracker to the controller: noise, latency, lost poses and outages.

use unicycle_cbf::{Pose, StampedPose};

use crate::disturbances::{Disturbances, Random};

/// The poses of one robot that are still on their way.
#[derive(Debug, Clone)]
pub(crate) struct Delay {
    under_way: Vec<(f64, StampedPose)>,
    outages_s: Vec<[f64; 2]>,
}

impl Delay {
    pub(crate) fn new(outages_s: Vec<[f64; 2]>) -> Self {
        Self {
            under_way: Vec::with_capacity(32),
            outages_s,
        }
    }

    /// The tracker sees a robot. The same random numbers are drawn whether or not the pose is lost.
    pub(crate) fn see(
        &mut self,
        stamp_s: f64,
        pose: Pose,
        disturbances: &Disturbances,
        random: &mut Random,
    ) {
        let position = disturbances.position_noise_m;
        let (dx, dy, turn) = (random.normal(), random.normal(), random.normal());
        let early = disturbances.jitter_s * random.share();
        let lost = random.share() < disturbances.drop_share;
        let out = |[from_s, to_s]: &[f64; 2]| (*from_s..*to_s).contains(&stamp_s);
        if lost || self.outages_s.iter().any(out) {
            return;
        }
        let pose = Pose {
            x_m: pose.x_m + position * dx,
            y_m: pose.y_m + position * dy,
            heading_rad: pose.heading_rad + disturbances.heading_noise_rad * turn,
        };
        let arrival_s = stamp_s + disturbances.latency_s - early;
        self.under_way
            .push((arrival_s, StampedPose { stamp_s, pose }));
    }

    /// The newest of the poses that have arrived by `now_s`; older ones are dropped.
    pub(crate) fn newest(&mut self, now_s: f64) -> Option<StampedPose> {
        let mut newest: Option<StampedPose> = None;
        self.under_way.retain(|(arrival_s, pose)| {
            let arrived = *arrival_s <= now_s;
            if arrived && newest.is_none_or(|best| pose.stamp_s > best.stamp_s) {
                newest = Some(*pose);
            }
            !arrived
        });
        newest
    }
}

/// Spans without poses for each robot: each hits all robots, as when the camera fails, or one, as when it is hidden.
pub(crate) fn outages(
    robots: usize,
    duration_s: f64,
    disturbances: &Disturbances,
    random: &mut Random,
) -> Vec<Vec<[f64; 2]>> {
    let mut spans = vec![Vec::new(); robots];
    if disturbances.outages_per_minute <= 0.0 {
        return spans;
    }
    let mean_pause_s = 60.0 / disturbances.outages_per_minute;
    let mut time_s = 0.0;
    loop {
        time_s -= mean_pause_s * (1.0 - random.share()).ln();
        if time_s >= duration_s {
            return spans;
        }
        let span = [time_s, time_s + disturbances.outage_s * random.share()];
        let hit = (random.share() * 2.0 * robots as f64) as usize;
        for (robot, spans) in spans.iter_mut().enumerate() {
            if hit >= robots || hit == robot {
                spans.push(span);
            }
        }
        time_s = span[1];
    }
}
