//! Loops about the origin whose radius varies with the angle.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

use super::arc_length::ArcLength;
use super::search::{Nearest, minimum, peak};
use super::{PathError, PathPoint, frenet, wrapped};

const MAX_PERIODS: u32 = 1000;

/// Samples per period that the search far from the path starts from, and the least number on the whole path.
const SAMPLES_PER_PERIOD: u32 = 32;
const MIN_SAMPLES: u32 = 64;

/// `R_path(φ) = R + b sin nφ`, `R > |b|`, counter-clockwise (thesis 2.23); `s` counts from `φ = 0`.
#[derive(Clone, PartialEq)]
pub struct PolarPath {
    wave: Wave,
    /// Over one period, which is its parameter from 0 to 1
    arc: ArcLength,
    /// Points at equal steps of the angle
    samples: Vec<[f64; 2]>,
    max_curvature_1pm: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    radius_m: f64,
    amplitude_m: f64,
    periods: u32,
}

impl Wave {
    fn radius(self, phi: f64) -> [f64; 4] {
        let n = f64::from(self.periods);
        let (sin, cos) = (n * phi).sin_cos();
        let r1 = n * self.amplitude_m * cos;
        let bend = n * self.amplitude_m * sin;
        [
            self.radius_m + self.amplitude_m * sin,
            r1,
            -n * bend,
            -n * n * r1,
        ]
    }

    /// The unit tangent by its outward and its counter-clockwise component, `κ` and `dκ/ds`.
    fn frenet([radius, r1, r2, r3]: [f64; 4]) -> ([f64; 2], f64, f64) {
        frenet(
            [r1, radius],
            [r2 - radius, 2.0 * r1],
            [r3 - 3.0 * r1, 3.0 * r2 - radius],
        )
    }
}

impl PolarPath {
    /// A path with mean radius `R`, amplitude `b` and `n` periods; with `b = 0` or `n = 0` a circle.
    ///
    /// # Errors
    ///
    /// A number that is not finite, `R ≤ |b|`, more than 1000 periods.
    pub fn new(radius_m: f64, amplitude_m: f64, periods: u32) -> Result<Self, PathError> {
        PathError::check("radius_m", radius_m)?;
        PathError::check("amplitude_m", amplitude_m)?;
        if radius_m <= amplitude_m.abs() {
            return Err(PathError::Radius {
                radius_m,
                amplitude_m,
            });
        }
        if periods > MAX_PERIODS {
            return Err(PathError::Periods {
                periods,
                most: MAX_PERIODS,
            });
        }
        let wave = Wave {
            radius_m,
            amplitude_m,
            periods,
        };
        let period_rad = TAU / f64::from(periods.max(1));
        let arc = ArcLength::new(1, |_, place| {
            let [radius, r1, r2, _] = wave.radius(place * period_rad);
            let speed = radius.hypot(r1) * period_rad;
            let change = r1 * (radius + r2) / speed * period_rad.powi(3);
            [speed, change]
        });
        let count = (SAMPLES_PER_PERIOD * periods).max(MIN_SAMPLES);
        let samples = (0..count)
            .map(|sample| {
                let phi = f64::from(sample) * TAU / f64::from(count);
                let radius = wave.radius(phi)[0];
                [radius * phi.cos(), radius * phi.sin()]
            })
            .collect();
        let curvature = |phi| Wave::frenet(wave.radius(phi)).1.abs();
        Ok(Self {
            wave,
            arc,
            samples,
            max_curvature_1pm: peak(period_rad, 1024, curvature),
        })
    }

    /// `R`, in m
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.wave.radius_m
    }

    /// `b`, in m
    #[must_use]
    pub fn amplitude_m(&self) -> f64 {
        self.wave.amplitude_m
    }

    /// `n`
    #[must_use]
    pub fn periods(&self) -> u32 {
        self.wave.periods
    }

    /// `R_path` and its first three derivatives by the angle, in m.
    #[must_use]
    pub fn radius(&self, phi_rad: f64) -> [f64; 4] {
        self.wave.radius(phi_rad)
    }

    /// The point at an angle, in rad, any number of turns.
    #[must_use]
    pub fn at_angle(&self, phi_rad: f64) -> PathPoint {
        let radius = self.wave.radius(phi_rad);
        let ([outward, forward], curvature_1pm, curvature_rate_1pm2) = Wave::frenet(radius);
        let (sin, cos) = phi_rad.sin_cos();
        let periods = f64::from(self.wave.periods.max(1));
        let place = wrapped(phi_rad, TAU) / TAU * periods;
        let whole = place.floor();
        let s_m = self.arc.at(place - whole) + whole * self.arc.length_m();
        PathPoint {
            s_m: wrapped(s_m, self.length_m()),
            x_m: radius[0] * cos,
            y_m: radius[0] * sin,
            tangent: [outward * cos - forward * sin, outward * sin + forward * cos],
            curvature_1pm,
            curvature_rate_1pm2,
        }
    }

    /// The point at an arc length, in m.
    #[must_use]
    pub fn at(&self, s_m: f64) -> PathPoint {
        let periods = wrapped(s_m, self.length_m()) / self.arc.length_m();
        let whole = periods.floor();
        let place = self.arc.parameter((periods - whole) * self.arc.length_m());
        self.at_angle((whole + place) * TAU / f64::from(self.wave.periods.max(1)))
    }

    /// Circumference, in m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.arc.length_m() * f64::from(self.wave.periods.max(1))
    }

    /// The largest `|κ|`, in 1/m.
    #[must_use]
    pub fn max_curvature_1pm(&self) -> f64 {
        self.max_curvature_1pm
    }

    /// The nearest point of the path.
    ///
    /// No point of the path farther than `α` in angle is nearer than the one in the direction of `p = (r, θ)`, at the distance
    /// `d = |r − R_path(θ)|`, with `sin α = d/r`. Where the squared distance is convex up to there, as it is near the path,
    /// the iteration starts at `θ`; elsewhere at all local minima of a scan.
    #[must_use]
    pub fn nearest(&self, x_m: f64, y_m: f64) -> PathPoint {
        let r = (x_m * x_m + y_m * y_m).sqrt();
        let theta = y_m.atan2(x_m);
        let derivatives = |phi: f64| {
            let [radius, r1, r2, r3] = self.wave.radius(phi);
            let (sin, cos) = (phi - theta).sin_cos();
            let (ahead, across, along) = (radius - r * cos, r * sin, r * cos);
            [
                r1 * ahead + radius * across,
                r1 * r1 + r2 * ahead + 2.0 * r1 * across + radius * along,
                3.0 * (r1 * (r2 + along) + r2 * across) + r3 * ahead - radius * across,
            ]
        };
        let [radius, r1, r2, _] = self.wave.radius(theta);
        let beside = radius - r;
        let sine = beside.abs() / r;
        if sine < 1.0 {
            let reach = sine + (FRAC_PI_2 - 1.0) * sine.powi(3);
            if self.least_bend(beside.abs(), r, reach) > 0.0 {
                let first = r1 * beside / (r1 * r1 + r2 * beside + r * radius);
                let start = theta - first.clamp(-reach, reach);
                return self.at_angle(minimum([theta - reach, theta + reach], start, derivatives));
            }
            self.scanned(theta, reach, [x_m, y_m], derivatives)
        } else {
            self.scanned(theta, PI, [x_m, y_m], derivatives)
        }
    }

    /// A lower bound of the second derivative of half the squared distance from a point, up to an angle `reach` from it.
    fn least_bend(&self, beside_m: f64, r: f64, reach: f64) -> f64 {
        let Wave {
            radius_m,
            amplitude_m,
            periods,
        } = self.wave;
        let (n, b) = (f64::from(periods), amplitude_m.abs());
        let cos = 1.0 - 0.5 * reach * reach;
        let across = r * reach;
        let ahead = beside_m + (n * b * reach).min(2.0 * b) + r * (1.0 - cos);
        let least_r1 = across.min(n * b);
        least_r1 * (least_r1 - 2.0 * across) + r * (radius_m - b) * cos - n * n * b * ahead
    }

    #[cold]
    fn scanned(
        &self,
        theta: f64,
        reach: f64,
        [x_m, y_m]: [f64; 2],
        derivatives: impl Fn(f64) -> [f64; 3],
    ) -> PathPoint {
        let count = self.samples.len() as i64;
        let step = TAU / count as f64;
        let distance_m = |sample: i64| {
            let [x, y] = self.samples[sample.rem_euclid(count) as usize];
            ((x - x_m).powi(2) + (y - y_m).powi(2)).sqrt()
        };
        let Wave {
            radius_m,
            amplitude_m,
            periods,
        } = self.wave;
        let spacing_m = step * (radius_m + amplitude_m.abs() * f64::from(periods + 1));
        let mut nearest = Nearest::none();
        let first = ((theta - reach) / step).floor() as i64;
        let last = (((theta + reach) / step).ceil() as i64).min(first + count);
        let mut before = distance_m(first - 1);
        let mut here = distance_m(first);
        for sample in first..=last {
            let after = distance_m(sample + 1);
            if here <= before && here <= after && here - spacing_m <= nearest.distance_m {
                let at = sample as f64 * step;
                let phi = minimum([at - step, at + step], at, &derivatives);
                let (sin, cos) = phi.sin_cos();
                let radius = self.wave.radius(phi)[0];
                nearest.offer(phi, (radius * cos - x_m).hypot(radius * sin - y_m));
            }
            (before, here) = (here, after);
        }
        self.at_angle(nearest.parameter)
    }
}

impl fmt::Debug for PolarPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PolarPath")
            .field("radius_m", &self.wave.radius_m)
            .field("amplitude_m", &self.wave.amplitude_m)
            .field("periods", &self.wave.periods)
            .finish_non_exhaustive()
    }
}
