//! Simulated drives whose truth is known.
//!
//! A driver of given habits takes a road of stretches with speed limits, stops, turns and hills:
//!
//! - accelerates to the limit plus a bias, by one of the models of [`driver_model`],
//! - cruises with correlated deviations,
//! - brakes so that the lower speed is reached at the sign,
//! - follows vehicles ahead by the intelligent driver model.
//!
//! The log is what a car records of it, with volts and amps from the vehicle model. The same settings give the same log,
//! and drive `k` does not depend on how many there are.
//!
//! Without variation, noise and leaders every complete acceleration phase is the curve of the driver's model to the
//! last digit of the log, so that a fit must find the parameters.
//!
//! ```
//! use drive_sim::{Regime, SynthSettings, simulate};
//! use ev_energy::Vehicle;
//!
//! let settings = SynthSettings { seed: 7, drives: 2, duration_s: 120.0, ..SynthSettings::default() };
//! let drives = simulate(&settings, &Vehicle::builtin("b250e")?)?;
//!
//! assert_eq!(drives[1].log.name(), "drive-02");
//! assert_eq!(drives[0].log.len(), 1200);
//! assert!(drives[0].phases.iter().any(|phase| phase.regime == Regime::Acceleration));
//! # Ok::<(), drive_sim::Error>(())
//! ```
//!
//! # References
//!
//! - M. Treiber, A. Hennecke, D. Helbing: Congested traffic states in empirical observations and microscopic
//!   simulations, Physical Review E 62 (2000), 1805–1824 (intelligent driver model).
//! - G. E. P. Box, M. E. Muller: A note on the generation of random normal deviates, Annals of Mathematical Statistics
//!   29 (1958), 610–611.

mod braking;
mod drive;
mod driver;
mod error;
mod random;
mod route;
mod sensors;
mod traffic;

pub use driver::{Cruise, Pace, SimulatedDriver};
pub use error::Error;

use drive_log::DriveLog;
use driver_model::Phase;
use ev_energy::Vehicle;
use serde::Serialize;

use error::check;

use random::{Random, Stream};
use route::Route;
use traffic::Traffic;

/// What to simulate. The default is twelve drives of 10 min, each about 0.3 MB as CSV.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthSettings {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of drives, 1 to 999.
    pub drives: usize,
    /// Duration of each, 10 s to a day.
    pub duration_s: f64,
    /// Sampling interval, 0.01 to 1 s.
    pub step_s: f64,
    /// The driver.
    pub driver: SimulatedDriver,
    /// How much phases and stretches differ: 0 not at all, 1 as with a real driver, at most 2.
    pub variation: f64,
    /// Whether sensors are noisy and coarse. Standard deviation and resolution of the noisy channels, resolution without
    /// noise: speed 0.015, 0.01, 10⁻⁴ m/s; elevation 0.1, 0.1, 10⁻³ m; gap 0.2, 0.1, 10⁻³ m; lead speed 0.1, 0.05,
    /// 10⁻⁴ m/s; voltage 0.15, 0.1, 10⁻³ V; current 0.4, 0.1, 10⁻³ A. Only coarser: slope 10⁻⁴, 10⁻⁵ rad; state of
    /// charge 0.1, 10⁻³ %. A standing wheel has no noise.
    pub sensor_noise: bool,
    /// Whether there are vehicles ahead now and then, and a sensor for them in the car.
    pub leaders: bool,
}

impl Default for SynthSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            drives: 12,
            duration_s: 600.0,
            step_s: 0.1,
            driver: SimulatedDriver::default(),
            variation: 1.0,
            sensor_noise: true,
            leaders: true,
        }
    }
}

/// Which part of the driver decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Regime {
    /// Waiting at a stop line.
    Standstill,
    /// Speeding up on a free road.
    Acceleration,
    /// Holding limit plus bias on a free road.
    Cruise,
    /// Slowing down for a lower limit, a turn or a stop line.
    Braking,
    /// A vehicle ahead allows no more.
    Following,
}

/// A stretch of a simulated drive in one regime.
///
/// Neighbours share a sample: the last of one phase is the first of the next, so that every step between two samples
/// belongs to one phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TruePhase {
    /// The regime.
    pub regime: Regime,
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// Speed at the first sample.
    pub start_speed_mps: f64,
    /// Speed aimed at.
    pub target_speed_mps: f64,
    /// Whether an acceleration or braking phase ran to its end; where not, the next phase says what cut it short, such
    /// as following a vehicle that cut in. `true` in other regimes.
    pub complete: bool,
}

impl TruePhase {
    fn open(regime: Regime, start: usize, start_speed_mps: f64, target_speed_mps: f64) -> Self {
        Self {
            regime,
            start,
            end: start + 1,
            start_speed_mps,
            target_speed_mps,
            complete: false,
        }
    }

    /// What the true model knows of an acceleration phase. The end speed is the one aimed at: the rise-time model stops
    /// at 95.96 % of it, the others at the last sample that does not exceed it.
    #[must_use]
    pub fn outline(&self, step_s: f64) -> Phase {
        Phase {
            start_speed_mps: self.start_speed_mps,
            end_speed_mps: self.target_speed_mps,
            step_s,
            samples: self.end - self.start,
            onset: None,
        }
    }
}

/// One simulated drive.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedDrive {
    /// What the car recorded; the name is `drive-01` and so on.
    pub log: DriveLog,
    /// What really happened, from the first to the last sample.
    pub phases: Vec<TruePhase>,
}

/// Schema name and version of the truth document.
pub const TRUTH_SCHEMA: &str = "drivekit/truth/1";

/// Everything that made the drives, for a file beside the logs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth<'a> {
    /// [`TRUTH_SCHEMA`].
    pub schema: &'static str,
    /// Settings with the driver; `driver.acceleration` has the form of the model in a [`driver_model::ModelFile`].
    pub settings: &'a SynthSettings,
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// The drives in order.
    pub drives: Vec<TrueDrive<'a>>,
}

/// Phases of one drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrueDrive<'a> {
    /// Name of the drive.
    pub name: &'a str,
    /// Its phases.
    pub phases: &'a [TruePhase],
}

impl<'a> Truth<'a> {
    /// Collects the truth of drives that [`simulate`] made of these settings.
    #[must_use]
    pub fn new(
        settings: &'a SynthSettings,
        vehicle: &'a Vehicle,
        drives: &'a [SimulatedDrive],
    ) -> Self {
        Self {
            schema: TRUTH_SCHEMA,
            settings,
            vehicle: &vehicle.spec().name,
            drives: drives
                .iter()
                .map(|drive| TrueDrive {
                    name: drive.log.name(),
                    phases: &drive.phases,
                })
                .collect(),
        }
    }
}

/// Simulates drives.
///
/// # Errors
/// [`Error::Setting`] for settings out of range, [`Error::Model`] for a parameter of the acceleration model that no
/// fit can produce.
pub fn simulate(settings: &SynthSettings, vehicle: &Vehicle) -> Result<Vec<SimulatedDrive>, Error> {
    settings.check()?;
    (0..settings.drives)
        .map(|drive| simulate_one(settings, vehicle, drive))
        .collect()
}

/// The road is long enough for this speed throughout: the highest limit with the largest bias.
const FASTEST_MPS: f64 = 50.0;

fn simulate_one(
    settings: &SynthSettings,
    vehicle: &Vehicle,
    drive: usize,
) -> Result<SimulatedDrive, Error> {
    let random = |stream| Random::new(settings.seed, drive, stream);
    let route = Route::draw(
        &mut random(Stream::Route),
        FASTEST_MPS * settings.duration_s,
    );
    let traffic = Traffic::new(random(Stream::Traffic), settings.leaders);
    let mut motion = drive::drive(settings, &route, random(Stream::Driver), traffic);
    let phases = std::mem::take(&mut motion.phases);
    let name = format!("drive-{:02}", drive + 1);
    let log = sensors::record(
        &name,
        settings,
        vehicle,
        &route,
        motion,
        random(Stream::Sensors),
    )?;
    Ok(SimulatedDrive { log, phases })
}

impl SynthSettings {
    /// Samples of one drive.
    fn samples(&self) -> usize {
        (self.duration_s / self.step_s).round() as usize
    }

    fn check(&self) -> Result<(), Error> {
        check("drives", self.drives as f64, 1.0..=999.0, "1 to 999")?;
        check("step_s", self.step_s, 0.01..=1.0, "0.01 to 1")?;
        check(
            "duration_s",
            self.duration_s,
            10.0..=86_400.0,
            "10 to 86400",
        )?;
        check("variation", self.variation, 0.0..=2.0, "0 to 2")?;
        let samples = self.drives as f64 * self.duration_s / self.step_s;
        check(
            "drives · duration_s / step_s",
            samples,
            1.0..=2e7,
            "at most 20 million samples",
        )?;
        self.driver.check()
    }
}
