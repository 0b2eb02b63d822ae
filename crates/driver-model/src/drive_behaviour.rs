use crate::cruise::{CruiseSettings, CruiseStretch, cruise_stretches};
use crate::following::{FollowingSettings, FollowingStretch, following_stretches};
use crate::grid::below;
use crate::segmentation::{HeuristicRules, StatisticalRules};
use crate::{AccelPoint, Error, Motion, PhaseCurve, PhaseKind, error, motion};

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
    /// Stretches behind a leader.
    pub following: FollowingSettings,
    /// Stretches of cruising.
    pub cruise: CruiseSettings,
}

impl Default for PhaseSettings {
    fn default() -> Self {
        Self {
            heuristic: HeuristicRules::default(),
            statistical: StatisticalRules::for_models(),
            min_duration_s: 3.0,
            min_gain_mps: 10.0 / 3.6,
            following: FollowingSettings::default(),
            cruise: CruiseSettings::default(),
        }
    }
}

/// What models learn from one drive, and what they are judged on when it is held out.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveBehaviour {
    /// Name of the drive.
    pub name: String,
    /// Acceleration and braking phases by the heuristic route that count.
    pub phases: Vec<PhaseCurve>,
    /// Acceleration and braking segments by the statistical route, without a leader.
    pub segments: Vec<Segment>,
    /// Phases that would count but for a leader.
    pub lead_influenced: LeadInfluenced,
    /// Stretches behind one leader.
    pub following: Vec<FollowingStretch>,
    /// Stretches of cruising without a leader.
    pub cruise: Vec<CruiseStretch>,
}

/// Phases left out because of a leader.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LeadInfluenced {
    /// Accelerations.
    pub acceleration: usize,
    /// Brakings.
    pub braking: usize,
}

/// A segment of one kind as the function fits see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Acceleration or braking.
    pub kind: PhaseKind,
    /// Mean speed and mean acceleration.
    pub mean: AccelPoint,
    /// Speed and acceleration of every sample.
    pub samples: Vec<AccelPoint>,
}

impl DriveBehaviour {
    /// Finds the phases of a drive, given by its pieces.
    ///
    /// # Errors
    /// [`Error::Option`] for settings out of range, and whatever segmentation refuses.
    pub fn of_drive(motions: &[Motion], settings: &PhaseSettings) -> Result<Self, Error> {
        error::at_least(
            "min_duration_s",
            settings.min_duration_s,
            0.0,
            "at least 0 s",
        )?;
        error::at_least("min_gain_mps", settings.min_gain_mps, 0.0, "at least 0 m/s")?;
        let mut trip = Self {
            name: motion::name(motions).to_owned(),
            phases: Vec::new(),
            segments: Vec::new(),
            lead_influenced: LeadInfluenced::default(),
            following: Vec::new(),
            cruise: Vec::new(),
        };
        for motion in motions {
            trip.cruise
                .extend(cruise_stretches(motion, &settings.cruise));
            trip.following
                .extend(following_stretches(motion, &settings.following));
            trip.add_curves(motion, settings)
                .and_then(|()| trip.add_segments(motion, settings))
                .map_err(|error| error.in_log(motion.name()))?;
        }
        Ok(trip)
    }

    /// The phases of one kind.
    pub fn phases_of(&self, kind: PhaseKind) -> impl Iterator<Item = &PhaseCurve> {
        self.phases.iter().filter(move |curve| curve.kind() == kind)
    }

    /// The segments of one kind.
    pub fn segments_of(&self, kind: PhaseKind) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(move |s| s.kind == kind)
    }

    fn add_curves(&mut self, motion: &Motion, settings: &PhaseSettings) -> Result<(), Error> {
        for phase in settings.heuristic.segment(motion.log())?.phases {
            let Some(curve) = PhaseCurve::cut(motion, &phase) else {
                continue;
            };
            let outline = curve.outline();
            if phase.kind != curve.kind()
                || below(outline.duration_s(), settings.min_duration_s)
                || below(outline.gain_mps().abs(), settings.min_gain_mps)
            {
                continue;
            }
            match (phase.lead_influenced, phase.kind) {
                (false, _) => self.phases.push(curve),
                (true, PhaseKind::Braking) => self.lead_influenced.braking += 1,
                (true, _) => self.lead_influenced.acceleration += 1,
            }
        }
        Ok(())
    }

    fn add_segments(&mut self, motion: &Motion, settings: &PhaseSettings) -> Result<(), Error> {
        let log = motion.log();
        let segmented = settings.statistical.segment(log)?;
        let (speed_mps, accel_mps2) = (log.speed_mps(), log.accel_mps2());
        for (phase, mean_speed_mps, mean_accel_mps2) in segmented.means(log) {
            let sign = match phase.kind {
                PhaseKind::Acceleration => 1.0,
                PhaseKind::Braking => -1.0,
                PhaseKind::Cruise | PhaseKind::Other => continue,
            };
            if phase.lead_influenced {
                continue;
            }
            let range = phase.start..phase.end;
            let samples = speed_mps[range.clone()].iter().zip(&accel_mps2[range]);
            self.segments.push(Segment {
                kind: phase.kind,
                mean: AccelPoint::new(mean_speed_mps, sign * mean_accel_mps2),
                samples: samples
                    .map(|(&v, &a)| AccelPoint::new(v, sign * a))
                    .collect(),
            });
        }
        Ok(())
    }
}
