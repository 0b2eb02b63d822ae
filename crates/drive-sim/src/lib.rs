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
mod settings;
mod traffic;
mod true_phase;

pub use driver::{Cruise, Pace, SimulatedDriver};
pub use error::Error;
pub use settings::SynthSettings;
pub use true_phase::{Regime, TruePhase};

use drive_log::DriveLog;
use ev_energy::Vehicle;
use serde::Serialize;

use random::{Random, Stream};
use route::Route;
use traffic::Traffic;

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
