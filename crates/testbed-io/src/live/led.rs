//! Where commands can have led a robot that was out of sight, or of which poses said something else meanwhile.

use unicycle_cbf::{Pose, StampedPose};

use super::commanded::Commanded;
use super::gate::{Bounds, STOPPED_AFTER_S, TOLERANCE_M, UNDER_WAY_S, distance_m};

/// Delays of commands and poses together that are tried, in s.
const DELAY_STEP_S: f64 = 0.1;
/// How far beside its heading a robot may move, as a share of its way: bodies are put on trackers by hand.
const ASIDE: f64 = 0.2;
/// A shorter way has no direction, in m.
const LEAST_WAY_M: f64 = 1e-3;

impl Bounds {
    /// Whether commands can have led a robot from one pose to the other. One that was not seen at all may not have heard that it shall
    /// stop, and have gone on as it did. One of which poses `contradicted` that is where its commands led it: what cannot be is not
    /// believed however long it lasts.
    pub(super) fn is_led(
        &self,
        last: &StampedPose,
        seen: &StampedPose,
        told: &Commanded,
        contradicted: bool,
    ) -> bool {
        if told.is_empty() {
            return true;
        }
        let delays = (UNDER_WAY_S / DELAY_STEP_S).round() as u32;
        let mut delays_s = (0..=delays).map(|step| DELAY_STEP_S * f64::from(step));
        if delays_s.any(|delay_s| self.is_near(&led(last, seen.stamp_s, told, delay_s), last, seen))
        {
            return true;
        }
        let gone_s = (seen.stamp_s - last.stamp_s).min(STOPPED_AFTER_S);
        !contradicted && self.has_gone_on(last, seen, told, gone_s)
    }

    /// Wheels that are off make a way longer or shorter, and turn it aside with a heading that is off: then it is shorter, too.
    fn is_near(&self, led: &Led, last: &StampedPose, seen: &StampedPose) -> bool {
        let aside = ASIDE + self.wheel_error * led.way_m / self.wheel_base_m;
        let off = |to: &Pose| [to.x_m - last.pose.x_m, to.y_m - last.pose.y_m];
        let ([x, y], [led_x, led_y]) = (off(&seen.pose), off(&led.pose));
        let led_m = led_x.hypot(led_y);
        if led_m <= LEAST_WAY_M {
            return distance_m(&led.pose, &seen.pose) <= TOLERANCE_M;
        }
        let (ahead_m, beside_m) = (
            (x * led_x + y * led_y) / led_m - led_m,
            (y * led_x - x * led_y) / led_m,
        );
        let longer_m = TOLERANCE_M + self.wheel_error * led.way_m;
        let shorter_m = longer_m + 0.5 * aside.min(1.0).powi(2) * led.way_m;
        (-shorter_m..=longer_m).contains(&ahead_m)
            && beside_m.abs() <= TOLERANCE_M + aside * led.way_m
    }

    /// Whether it is where it would be if it heard nothing any more.
    fn has_gone_on(
        &self,
        last: &StampedPose,
        seen: &StampedPose,
        told: &Commanded,
        most_s: f64,
    ) -> bool {
        let speeds = told.at(last.stamp_s);
        let steps = (most_s / DELAY_STEP_S).ceil() as u32;
        let mut led = (0..=steps).map(|step| {
            let gone_s = (DELAY_STEP_S * f64::from(step)).min(most_s);
            Led {
                pose: last.pose.advanced(speeds, gone_s),
                way_m: speeds.speed_mps.abs() * gone_s,
            }
        });
        led.any(|led| self.is_near(&led, last, seen))
    }
}

struct Led {
    pose: Pose,
    way_m: f64,
}

/// With commands and poses that are late by some time.
fn led(last: &StampedPose, to_s: f64, told: &Commanded, delay_s: f64) -> Led {
    let from = StampedPose {
        stamp_s: last.stamp_s - delay_s,
        ..*last
    };
    Led {
        pose: told.carried(&from, to_s - delay_s),
        way_m: told.between(from.stamp_s, to_s - delay_s).path_m,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use unicycle_cbf::Speeds;

    use super::*;
    use crate::live::gate::Gate;

    const BOUNDS: Bounds = Bounds::ORDINARY;

    const FORWARD: Speeds = Speeds {
        speed_mps: 0.2,
        turn_rate_rad_s: 0.0,
    };

    fn seen(stamp_s: f64, x_m: f64) -> StampedPose {
        let pose = Pose {
            x_m,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        StampedPose { stamp_s, pose }
    }

    /// 0.2 m/s along x until 2 s, then it stands.
    fn driven() -> Gate {
        let mut gate = Gate::new(BOUNDS, 1);
        gate.pass(0, seen(0.0, 0.0)).unwrap();
        gate.start();
        for step in 1..=100 {
            let time_s = 0.02 * f64::from(step);
            gate.told(0, time_s - 0.02, FORWARD);
            gate.pass(0, seen(time_s, 0.2 * time_s)).unwrap();
        }
        gate
    }

    #[test]
    fn a_place_where_commands_cannot_have_led_is_not_believed_however_long_it_lasts() {
        for [dx_m, dy_m] in [
            [-0.6, 0.0],
            [-0.2, 0.0],
            [0.4, 0.0],
            [0.0, 0.1],
            [0.0, -0.11],
        ] {
            let mut gate = driven();
            let mut x_m: f64 = 0.4;
            let mut believed = 0;
            for step in 1..2000 {
                let time_s = 2.0 + 0.02 * f64::from(step);
                let speeds = if step < 15 { FORWARD } else { Speeds::ZERO };
                gate.told(0, time_s - 0.02, speeds);
                x_m += 0.02 * speeds.speed_mps;
                let mut pose = seen(time_s, x_m + dx_m);
                pose.pose.y_m = dy_m;
                believed += u32::from(gate.pass(0, pose).is_ok());
            }
            assert_eq!(believed, 0, "{dx_m} {dy_m}");
            // Where its commands led it, it is found again.
            gate.pass(0, seen(50.0, x_m)).unwrap();
        }
    }

    #[test]
    fn a_robot_out_of_sight_is_found_where_it_stopped_or_where_it_went_on() {
        for (x_m, found) in [
            (0.46, true),
            (0.8, true),
            (0.9, true),
            (1.1, false),
            (0.3, false),
        ] {
            let mut gate = driven();
            gate.told(0, 2.3, Speeds::ZERO);
            assert_eq!(gate.pass(0, seen(6.0, x_m)).is_ok(), found, "{x_m}");
        }
    }
}
