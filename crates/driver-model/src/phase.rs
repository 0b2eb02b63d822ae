use std::borrow::Cow;

use serde::Serialize;

use crate::motion::samples_in;
use crate::{BEGUN_S, DriverInput, Motion, PhaseKind, Span, SpeedGroup};

/// What a model may be told of a phase before it predicts it. Each model takes only what it declares to know.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Phase {
    /// Speed at the first sample.
    pub start_speed_mps: f64,
    /// Speed at the last sample.
    pub end_speed_mps: f64,
    /// Sampling interval.
    pub step_s: f64,
    /// Number of samples, at least 2.
    pub samples: usize,
    /// How the phase is entered; `None` at the beginning of a log.
    pub onset: Option<Onset>,
    /// What the driver does as it begins.
    pub input: DriverInput,
}

/// The driver's motion as a phase begins: backward differences of the smoothed speed that end with its first sample, whose speed
/// every model is told.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Onset {
    /// Acceleration.
    pub accel_mps2: f64,
    /// Its change over one step.
    pub jerk_mps3: f64,
    /// The same, one step earlier.
    pub previous_jerk_mps3: f64,
}

impl Onset {
    /// Acceleration, jerk, and the jerk before, in SI units.
    pub(crate) fn values(self) -> [f64; 3] {
        [self.accel_mps2, self.jerk_mps3, self.previous_jerk_mps3]
    }

    pub(crate) fn of_values([accel_mps2, jerk_mps3, previous_jerk_mps3]: [f64; 3]) -> Self {
        Self {
            accel_mps2,
            jerk_mps3,
            previous_jerk_mps3,
        }
    }

    pub(crate) fn before(start: usize, speed_mps: &[f64], step_s: f64) -> Option<Self> {
        let speed = speed_mps.get(start.checked_sub(3)?..=start)?;
        let accel = |k: usize| (speed[k + 1] - speed[k]) / step_s;
        Some(Self {
            accel_mps2: accel(2),
            jerk_mps3: (accel(2) - accel(1)) / step_s,
            previous_jerk_mps3: (accel(1) - accel(0)) / step_s,
        })
    }
}

/// A phase between two speeds, which still lacks its duration.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct PhaseSpeeds {
    start_mps: f64,
    end_mps: f64,
}

impl PhaseSpeeds {
    /// So long, in steps of 0.1 s, at least one.
    #[must_use]
    pub fn lasting(self, duration_s: f64) -> Phase {
        Phase {
            start_speed_mps: self.start_mps,
            end_speed_mps: self.end_mps,
            step_s: STEP_S,
            samples: ((duration_s / STEP_S).round() as usize).max(1) + 1,
            onset: None,
            input: DriverInput::default(),
        }
    }
}

/// Sampling interval of a phase that was not recorded.
const STEP_S: f64 = 0.1;

impl Phase {
    /// Between two speeds.
    ///
    /// ```
    /// let phase = driver_model::Phase::from_to(0.0, 13.9).lasting(8.0);
    /// assert_eq!((phase.duration_s(), phase.samples), (8.0, 81));
    /// ```
    pub fn from_to(start_mps: f64, end_mps: f64) -> PhaseSpeeds {
        PhaseSpeeds { start_mps, end_mps }
    }

    /// `T`, from first to last sample.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        (self.samples - 1) as f64 * self.step_s
    }

    /// `v_end − v0`.
    #[must_use]
    pub fn gain_mps(&self) -> f64 {
        self.end_speed_mps - self.start_speed_mps
    }

    /// Whether speed falls.
    #[must_use]
    pub fn is_braking(&self) -> bool {
        self.gain_mps() < 0.0
    }

    /// The phase with rising speed: braking in reversed time (thesis 3.3.1). Onset and input have no counterpart there.
    #[must_use]
    pub fn rising(&self) -> Self {
        if !self.is_braking() {
            return *self;
        }
        Self {
            start_speed_mps: self.end_speed_mps,
            end_speed_mps: self.start_speed_mps,
            onset: None,
            input: DriverInput::default(),
            ..*self
        }
    }

    /// Group by start and end speed.
    #[must_use]
    pub fn group(&self) -> SpeedGroup {
        SpeedGroup::of(self.start_speed_mps, self.end_speed_mps)
    }
}

/// The measured speed of one phase, with the slope under it.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseCurve {
    start_s: f64,
    step_s: f64,
    speed_mps: Vec<f64>,
    slope_rad: Option<Vec<f64>>,
    onset: Option<Onset>,
    input: DriverInput,
}

impl PhaseCurve {
    /// Cuts `phase` out of a log. `None` where it has fewer than two samples or ends with the speed that it began with.
    #[must_use]
    pub fn cut(motion: &Motion, phase: &Span) -> Option<Self> {
        let log = motion.log();
        let range = phase.start..phase.end;
        let slope_rad = motion.slope_rad().and_then(|s| s.get(range.clone()));
        let curve = Self::of_parts(
            log.time_s(phase.start),
            log.step_s(),
            log.speed_mps().get(range)?.to_vec(),
            Onset::before(phase.start, log.speed_mps(), log.step_s()),
            DriverInput::at(motion, phase.start),
        )?;
        Some(Self {
            slope_rad: slope_rad.map(<[f64]>::to_vec),
            ..curve
        })
    }

    /// On an unknown slope; `None` as in [`cut`](Self::cut).
    pub(crate) fn of_parts(
        start_s: f64,
        step_s: f64,
        speed_mps: Vec<f64>,
        onset: Option<Onset>,
        input: DriverInput,
    ) -> Option<Self> {
        let gain = speed_mps.last()? - speed_mps.first()?;
        let is_phase = speed_mps.len() >= 2 && gain.abs() >= f64::EPSILON;
        is_phase.then_some(Self {
            start_s,
            step_s,
            speed_mps,
            slope_rad: None,
            onset,
            input,
        })
    }

    pub(crate) fn without_slope(&self) -> Self {
        Self {
            slope_rad: None,
            ..self.clone()
        }
    }

    /// Change of speed over [`BEGUN_S`] from the first sample on; `None` for a shorter phase.
    #[must_use]
    pub fn early_gain_mps(&self) -> Option<f64> {
        let begun = samples_in(BEGUN_S, self.step_s);
        Some(self.speed_mps.get(begun)? - self.speed_mps[0])
    }

    /// Sampling interval.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Time of the first sample in the drive.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Acceleration or braking, whichever the speed does from first to last sample.
    #[must_use]
    pub fn kind(&self) -> PhaseKind {
        if self.outline().is_braking() {
            PhaseKind::Braking
        } else {
            PhaseKind::Acceleration
        }
    }

    /// Measured speed, at least two samples.
    #[must_use]
    pub fn speed_mps(&self) -> &[f64] {
        &self.speed_mps
    }

    /// Slope at the same samples, where the log tells it.
    #[must_use]
    pub fn slope_rad(&self) -> Option<&[f64]> {
        self.slope_rad.as_deref()
    }

    /// What a model may know.
    #[must_use]
    pub fn outline(&self) -> Phase {
        Phase {
            start_speed_mps: self.speed_mps[0],
            end_speed_mps: self.speed_mps[self.speed_mps.len() - 1],
            step_s: self.step_s,
            samples: self.speed_mps.len(),
            onset: self.onset,
            input: self.input,
        }
    }

    /// The speed as it rises: that of braking in reversed time.
    #[must_use]
    pub fn rising_speed_mps(&self) -> Cow<'_, [f64]> {
        if self.outline().is_braking() {
            Cow::Owned(self.speed_mps.iter().rev().copied().collect())
        } else {
            Cow::Borrowed(&self.speed_mps)
        }
    }
}
