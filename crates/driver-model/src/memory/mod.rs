//! What a model of phases has learnt from, kept so that it can go on learning without the logs.

mod config;
mod file;

use serde::{Deserialize, Serialize};

use crate::drive_behaviour::LEAST_END_ACCEL_MPS2;
use crate::{
    AccelPoint, DriveBehaviour, FitSettings, Manoeuvre, Phase, PhaseCurve, PhaseExtent, PhaseKind,
    PhaseSettings, PointsOf, TrainingSet,
};

/// Beyond every time, speed and acceleration of a rule.
const MOST_RULE: f64 = 1e6;

/// The phases and points of every drive that a model of phases was fitted to, with the rules by which they were found.
///
/// Fitting to it is fitting to the drives: [`PhaseMemory::training`] gives the same [`TrainingSet`], to the last bit, also after a model file.
/// The slope under a phase is not kept, since no model of phases learns from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "file::OnDisk", into = "file::OnDisk")]
pub struct PhaseMemory {
    rules: PhaseRules,
    manoeuvre: Manoeuvre,
    points_of: PointsOf,
    prior_weight: f64,
    own: Vec<RememberedDrive>,
    others: Vec<RememberedDrive>,
}

/// What a drive has taught; nothing is possible, and counts as a drive.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct RememberedDrive {
    pub(crate) phases: Vec<PhaseCurve>,
    pub(crate) short: Vec<ShortPhase>,
    pub(crate) points: Vec<AccelPoint>,
}

/// A phase that began and ended before it counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShortPhase {
    pub(crate) outline: Phase,
    /// What it gained while it began, see [`PhaseCurve::early_gain_mps`].
    pub(crate) early_gain_mps: f64,
}

/// As much of [`PhaseSettings`] as a file holds; all else is as by default.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PhaseRules {
    extent: PhaseExtent,
    min_duration_s: f64,
    min_gain_mps: f64,
    accel_threshold_mps2: f64,
    end_accel_mps2: f64,
    cruise_speed_mps: f64,
    accel_deadband_mps2: f64,
}

impl PhaseRules {
    /// `None` for what differs from the defaults in anything else that phases depend on.
    fn of(settings: &PhaseSettings) -> Option<Self> {
        let rules = Self {
            extent: settings.extent,
            min_duration_s: settings.min_duration_s,
            min_gain_mps: settings.min_gain_mps,
            accel_threshold_mps2: settings.heuristic.accel_threshold_mps2,
            end_accel_mps2: settings.heuristic.end_accel_mps2,
            cruise_speed_mps: settings.heuristic.cruise_speed_mps,
            accel_deadband_mps2: settings.statistical.accel_deadband_mps2,
        };
        let PhaseSettings {
            heuristic,
            statistical,
            ..
        } = rules.settings();
        let same_heuristic = crate::segmentation::HeuristicRules {
            accel_deadband_mps2: heuristic.accel_deadband_mps2,
            ..settings.heuristic
        } == heuristic;
        let is_whole = same_heuristic && statistical == settings.statistical;
        Some(rules).filter(|rules| is_whole && rules.are_usable())
    }

    /// Whether standstill is no phase, and every number is one.
    fn are_usable(&self) -> bool {
        let lowest = [
            (self.min_duration_s, 0.0),
            (self.min_gain_mps, 0.0),
            (self.accel_threshold_mps2, LEAST_END_ACCEL_MPS2),
            (self.end_accel_mps2, LEAST_END_ACCEL_MPS2),
            (self.cruise_speed_mps, 0.0),
            (self.accel_deadband_mps2, 0.0),
        ];
        let in_range = |&(value, lowest): &(f64, f64)| (lowest..=MOST_RULE).contains(&value);
        lowest.iter().all(in_range)
    }

    fn settings(&self) -> PhaseSettings {
        let mut settings = PhaseSettings {
            extent: self.extent,
            min_duration_s: self.min_duration_s,
            min_gain_mps: self.min_gain_mps,
            ..PhaseSettings::default()
        };
        settings.heuristic.accel_threshold_mps2 = self.accel_threshold_mps2;
        settings.heuristic.end_accel_mps2 = self.end_accel_mps2;
        settings.heuristic.cruise_speed_mps = self.cruise_speed_mps;
        settings.statistical.accel_deadband_mps2 = self.accel_deadband_mps2;
        settings
    }
}

impl PhaseMemory {
    /// Of no drive yet; `None` for rules that a model file cannot hold: a segmentation by [`crate::segmentation::StatisticalRules`] that differs from
    /// the default in more than its dead band, and thresholds by which standstill were a phase.
    #[must_use]
    pub fn new(settings: &FitSettings) -> Option<Self> {
        Some(Self {
            rules: PhaseRules::of(&settings.phases)?,
            manoeuvre: settings.manoeuvre,
            points_of: settings.points_of,
            prior_weight: 0.0,
            own: Vec::new(),
            others: Vec::new(),
        })
    }

    /// Adds drives of the driver, after those that there are.
    #[must_use]
    pub fn with_own<'a>(mut self, trips: impl IntoIterator<Item = &'a DriveBehaviour>) -> Self {
        let drives = trips.into_iter().map(|trip| self.remembered(trip));
        let drives: Vec<RememberedDrive> = drives.collect();
        self.own.extend(drives);
        self
    }

    /// With these drives of other drivers, each phase with this weight beside 1 for an own one.
    #[must_use]
    pub fn with_prior<'a>(
        mut self,
        trips: impl IntoIterator<Item = &'a DriveBehaviour>,
        weight: f64,
    ) -> Self {
        let drives = trips.into_iter().map(|trip| self.remembered(trip));
        self.others = drives.collect();
        self.prior_weight = weight;
        self
    }

    fn remembered(&self, trip: &DriveBehaviour) -> RememberedDrive {
        let kind = self.kind();
        let short = trip.short_phases_of(kind).filter_map(ShortPhase::of);
        RememberedDrive {
            phases: trip
                .phases_of(kind)
                .map(PhaseCurve::without_slope)
                .collect(),
            short: short.collect(),
            points: trip.points_of(kind, self.points_of).copied().collect(),
        }
    }

    /// What models are fitted to: the same as of the drives themselves.
    #[must_use]
    pub fn training(&self) -> TrainingSet<'_> {
        fn parts(
            drives: &[RememberedDrive],
        ) -> impl Iterator<
            Item = (
                std::slice::Iter<'_, PhaseCurve>,
                std::slice::Iter<'_, AccelPoint>,
            ),
        > {
            drives.iter().map(|d| (d.phases.iter(), d.points.iter()))
        }
        let mut training = TrainingSet::default();
        training.add(parts(&self.own), 1.0);
        if self.prior_weight > 0.0 {
            training.add(parts(&self.others), self.prior_weight);
        }
        training
    }

    /// Acceleration or braking.
    #[must_use]
    pub fn manoeuvre(&self) -> Manoeuvre {
        self.manoeuvre
    }

    /// The same as a kind of phase.
    #[must_use]
    pub fn kind(&self) -> PhaseKind {
        self.manoeuvre.into()
    }

    /// What a function of speed is fitted to.
    #[must_use]
    pub fn points_of(&self) -> PointsOf {
        self.points_of
    }

    /// The rules by which phases were found.
    #[must_use]
    pub fn settings(&self) -> PhaseSettings {
        self.rules.settings()
    }

    /// Sampling interval of the phases; `None` without any.
    #[must_use]
    pub fn step_s(&self) -> Option<f64> {
        let mut phases = self.drives().flat_map(|drive| &drive.phases);
        phases.next().map(PhaseCurve::step_s)
    }

    /// Phases and points learnt from, those of other drivers included.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let training = self.training();
        (training.phases.len(), training.points.len())
    }

    /// Own drives, and drives of other drivers.
    #[must_use]
    pub fn drive_counts(&self) -> (usize, usize) {
        (self.own.len(), self.others.len())
    }

    /// Weight of a phase of other drivers beside 1 for an own one.
    #[must_use]
    pub fn prior_weight(&self) -> f64 {
        self.prior_weight
    }

    /// Own drives first.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &RememberedDrive> {
        self.own.iter().chain(&self.others)
    }
}

impl ShortPhase {
    fn of(curve: &PhaseCurve) -> Option<Self> {
        Some(Self {
            early_gain_mps: curve.early_gain_mps()?,
            outline: curve.outline(),
        })
    }
}
