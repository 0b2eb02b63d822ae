use drive_log::{Drive, DriveLog};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

use crate::energy::slope_rad;
use crate::{Error, HeuristicRules, PhaseCurve, PhaseKind, StatisticalRules};

/// How phases are found in a drive, and which of them count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseSettings {
    /// Route of system identification and of the measured curves.
    pub heuristic: HeuristicRules,
    /// Route of the function fits.
    pub statistical: StatisticalRules,
    /// Shorter phases do not count; 3 s.
    pub min_duration_s: f64,
    /// Phases that gain less do not count; 10 km/h.
    pub min_gain_mps: f64,
    /// Elevation is smoothed over this distance to either side before it gives a slope; 100 m.
    pub slope_bandwidth_m: f64,
}

impl Default for PhaseSettings {
    fn default() -> Self {
        Self {
            heuristic: HeuristicRules::default(),
            statistical: StatisticalRules::for_models(),
            min_duration_s: 3.0,
            min_gain_mps: 10.0 / 3.6,
            slope_bandwidth_m: DEFAULT_SLOPE_BANDWIDTH_M,
        }
    }
}

/// What models learn from one drive, and what they are judged on when it is held out.
#[derive(Debug, Clone, PartialEq)]
pub struct Trip {
    /// Name of the drive.
    pub name: String,
    /// Acceleration phases by the heuristic route that count.
    pub phases: Vec<PhaseCurve>,
    /// `(mean speed, mean acceleration)` of acceleration segments by the statistical route, without a leader.
    pub segment_means: Vec<(f64, f64)>,
    /// Acceleration phases that would count but for a leader.
    pub lead_influenced_phases: usize,
}

impl Trip {
    /// Finds the phases of a drive.
    ///
    /// # Errors
    /// [`Error::Option`] for settings out of range, and whatever segmentation refuses.
    pub fn from_drive(drive: &Drive, settings: &PhaseSettings) -> Result<Self, Error> {
        Error::unless_at_least(
            "min_duration_s",
            settings.min_duration_s,
            0.0,
            "at least 0 s",
        )?;
        Error::unless_at_least("min_gain_mps", settings.min_gain_mps, 0.0, "at least 0 m/s")?;
        let mut trip = Self {
            name: drive.name.clone(),
            phases: Vec::new(),
            segment_means: Vec::new(),
            lead_influenced_phases: 0,
        };
        for log in &drive.pieces {
            trip.add_curves(log, settings)?;
            trip.add_segment_means(log, settings)?;
        }
        Ok(trip)
    }

    fn add_curves(&mut self, log: &DriveLog, settings: &PhaseSettings) -> Result<(), Error> {
        let slope_rad = slope_rad(log, settings.slope_bandwidth_m)?;
        for phase in settings.heuristic.segment(log)?.phases {
            if phase.kind != PhaseKind::Acceleration {
                continue;
            }
            let Some(curve) = PhaseCurve::cut(log, slope_rad.as_deref(), &phase) else {
                continue;
            };
            let outline = curve.outline();
            if outline.duration_s() < settings.min_duration_s
                || outline.gain_mps() < settings.min_gain_mps
            {
                continue;
            }
            if phase.lead_influenced {
                self.lead_influenced_phases += 1;
            } else {
                self.phases.push(curve);
            }
        }
        Ok(())
    }

    fn add_segment_means(&mut self, log: &DriveLog, settings: &PhaseSettings) -> Result<(), Error> {
        let segmented = settings.statistical.segment(log)?;
        self.segment_means.extend(
            segmented
                .means(log)
                .filter(|(phase, ..)| {
                    phase.kind == PhaseKind::Acceleration && !phase.lead_influenced
                })
                .map(|(_, speed_mps, accel_mps2)| (speed_mps, accel_mps2)),
        );
        Ok(())
    }
}
