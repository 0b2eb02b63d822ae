//! What a stretch of the road rises, by all that knows.

use std::ops::RangeInclusive;

use super::checked::Checked;
use super::motion::{GRAVITY_MPS2, Span, moving_spans, spans};
use super::power::{Load, felt_climb, loads};
use crate::statistics::mean;
use crate::{Channel, RawLog};

/// The steepest streets rise by 0.34 of the way.
pub(super) const STEEPEST: f64 = 0.35;

/// Stretches over which heights are compared, m, and how many of them tell.
const STRETCH_M: f64 = 150.0;
pub(super) const STRETCHES: usize = 20;

/// The way to either side over which a gradient is taken from elevations, and the least of both together, m.
const REACH_M: f64 = 100.0;
const LEAST_M: f64 = 50.0;

/// The battery tells where the car is an ordinary one, within so many usual factors, on roads whose gradients deviate by so much,
/// where it feels so many standard errors of a climb, or does not by so small an error, and so many of them.
const ORDINARY: f64 = 1.5;
const HILLY: f64 = 0.01;
const CERTAIN: f64 = 10.0;
const ERROR: f64 = 0.07;
const ERRORS: f64 = 5.0;

/// A stretch of the road, m.
#[derive(Clone, Copy, Default)]
pub(super) struct Stretch {
    pub(super) way_m: f64,
    /// What the elevation rises, the slope climbs and the accelerometer feels; NaN where one is not there.
    pub(super) rise_m: f64,
    pub(super) climb_m: f64,
    pub(super) felt_m: f64,
}

/// The stretches of a drive over which `elevation`, and whatever else of the road is recorded, is known.
pub(super) fn stretches(log: &RawLog) -> Vec<Stretch> {
    let Some(elevation_m) = log.channel(Channel::Elevation) else {
        return Vec::new();
    };
    let slope_rad = log.channel(Channel::Slope);
    let felt_mps2 = log.channel(Channel::Accelerometer);
    let mut stretches = Vec::new();
    let mut open = Stretch::default();
    for span in spans(log) {
        let way_m = span.distance_m();
        let rise_m = elevation_m[*span.samples.end()] - elevation_m[*span.samples.start()];
        if !rise_m.is_finite() {
            open = Stretch::default();
            continue;
        }
        let mean = |values: Option<&[f64]>| values.and_then(|v| span.mean(v)).unwrap_or(f64::NAN);
        open.way_m += way_m;
        open.rise_m += rise_m;
        open.climb_m += mean(slope_rad).sin() * way_m;
        open.felt_m += (mean(felt_mps2) - span.accel_mps2) / GRAVITY_MPS2 * way_m;
        if open.way_m >= STRETCH_M {
            stretches.push(std::mem::take(&mut open));
        }
    }
    stretches
}

/// Pairs of two heights of the stretches where both are known.
pub(super) fn pairs(stretches: &[Stretch], of: impl Fn(&Stretch) -> (f64, f64)) -> Vec<(f64, f64)> {
    let known = |(a, b): &(f64, f64)| a.is_finite() && b.is_finite();
    stretches.iter().map(of).filter(known).collect()
}

/// What the battery feels of the climb of a true road.
pub(super) const TRUE: RangeInclusive<f64> = 0.6..=1.6;

/// How many times a climb something feels, and the standard error of that.
pub(super) struct Share {
    pub(super) times: f64,
    pub(super) error: f64,
}

impl Share {
    pub(super) fn is_certain(&self) -> bool {
        self.times > CERTAIN * self.error
    }

    /// Whether it is that of no road, and be it that nothing of the climb is felt.
    pub(super) fn is_of_no_road(&self) -> bool {
        let margin = ERRORS * self.error;
        self.error <= ERROR
            && (self.times + margin < *TRUE.start() || self.times - margin > *TRUE.end())
    }
}

/// How many times what an elevation or a slope climbs the battery feels; `None` where it does not tell.
pub(super) fn felt_by_battery(checked: &Checked, channel: Channel) -> Option<Share> {
    let log = &checked.log;
    let values = log.channel(channel)?;
    let spans = moving_spans(log);
    let gradients: Vec<f64> = if channel == Channel::Elevation {
        let distance_m = checked.distance_m();
        let gradient = |span: &Span| gradient(&distance_m, values, *span.samples.start());
        spans.iter().map(gradient).collect()
    } else {
        let slope = |span: &Span| span.mean(values).unwrap_or(f64::NAN);
        spans.iter().map(slope).collect()
    };
    let middle = mean(gradients.iter().copied())?;
    let variance = mean(gradients.iter().map(|gradient| (gradient - middle).powi(2)))?;
    let (times, error) = felt_climb(log, &spans, &gradients)?;
    let car = Load::fit(&loads(log, &spans), 1.0)?;
    (car.oddity() <= ORDINARY && variance >= HILLY * HILLY).then_some(Share { times, error })
}

/// The rise of the elevation over the way around a sample.
fn gradient(distance_m: &[f64], elevation_m: &[f64], at: usize) -> f64 {
    let here_m = distance_m[at];
    let from = distance_m.partition_point(|m| *m < here_m - REACH_M);
    let to = distance_m.partition_point(|m| *m <= here_m + REACH_M) - 1;
    let way_m = distance_m[to] - distance_m[from];
    if way_m < LEAST_M {
        return f64::NAN;
    }
    (elevation_m[to] - elevation_m[from]) / way_m
}
