use crate::cruise::{CruiseSettings, CruiseStretch, cruise_stretches};
use crate::following::{FollowingSettings, FollowingStretch, following_stretches};
use crate::grid::below;
use crate::segmentation::{HeuristicRules, PhaseExtent, StatisticalRules};
use crate::{
    AccelPoint, Error, Motion, Phase, PhaseCurve, PhaseKind, PointsOf, Span, error, motion,
};

/// How phases are found in a drive, and which of them count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseSettings {
    /// Route of system identification and of the measured curves.
    pub heuristic: HeuristicRules,
    /// Route of the function fits.
    pub statistical: StatisticalRules,
    /// How far the phases of [`DriveBehaviour::phases`] reach; to the threshold.
    pub extent: PhaseExtent,
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
            extent: PhaseExtent::default(),
            min_duration_s: 3.0,
            min_gain_mps: 10.0 / 3.6,
            following: FollowingSettings::default(),
            cruise: CruiseSettings::default(),
        }
    }
}

impl PhaseSettings {
    /// The same with phases that reach so far.
    #[must_use]
    pub fn reaching(self, extent: PhaseExtent) -> Self {
        Self { extent, ..self }
    }

    /// Whether a phase is long enough and gains enough.
    pub(crate) fn counts(&self, phase: &Phase) -> bool {
        !below(phase.duration_s(), self.min_duration_s)
            && !below(phase.gain_mps().abs(), self.min_gain_mps)
    }
}

/// What lasts so long has begun; most that ends sooner is noise about the threshold.
pub const BEGUN_S: f64 = 1.0;

/// A whole phase that ends at less would hold standstill and noise.
pub(crate) const LEAST_END_ACCEL_MPS2: f64 = 1e-3;

/// What models learn from one drive, and what they are judged on when it is held out.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveBehaviour {
    /// Name of the drive.
    pub name: String,
    /// Acceleration and braking phases by the heuristic route that count, as far as [`PhaseSettings::extent`] says.
    pub phases: Vec<PhaseCurve>,
    /// Those phases from where they begin to where they end, whatever the extent; two that meet there are one.
    pub whole_phases: Vec<PhaseCurve>,
    /// Phases that last [`BEGUN_S`] but do not count, since they end too soon or change the speed too little; as far as the extent says.
    pub short_phases: Vec<PhaseCurve>,
    /// Those that are whole, whatever the extent.
    pub whole_short_phases: Vec<PhaseCurve>,
    /// Acceleration and braking segments by the statistical route, without a leader.
    pub segments: Vec<Segment>,
    /// Phases that would count but for a leader.
    pub lead_influenced: LeadInfluenced,
    /// The same of whole phases.
    pub whole_lead_influenced: LeadInfluenced,
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

impl LeadInfluenced {
    /// Counts the phases under a leader's influence and keeps the others.
    fn split(&mut self, spans: &[Span], curves: Vec<PhaseCurve>, kept: &mut Vec<PhaseCurve>) {
        for (span, curve) in spans.iter().zip(curves) {
            match (span.lead_influenced, span.kind) {
                (false, _) => kept.push(curve),
                (true, PhaseKind::Braking) => self.braking += 1,
                (true, _) => self.acceleration += 1,
            }
        }
    }
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
        error::at_least(
            "end_accel_mps2",
            settings.heuristic.end_accel_mps2,
            LEAST_END_ACCEL_MPS2,
            "at least 0.001 m/s²",
        )?;
        let mut trip = Self {
            name: motion::name(motions).to_owned(),
            phases: Vec::new(),
            whole_phases: Vec::new(),
            short_phases: Vec::new(),
            whole_short_phases: Vec::new(),
            segments: Vec::new(),
            lead_influenced: LeadInfluenced::default(),
            whole_lead_influenced: LeadInfluenced::default(),
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
        Ok(match settings.extent {
            PhaseExtent::Threshold => trip,
            PhaseExtent::Whole => trip.with_whole_phases(),
        })
    }

    /// The same drive with its whole phases as the phases that models learn from and are judged on.
    #[must_use]
    pub fn with_whole_phases(&self) -> Self {
        let mut whole = self.clone();
        whole.phases.clone_from(&self.whole_phases);
        whole.short_phases.clone_from(&self.whole_short_phases);
        whole.lead_influenced = self.whole_lead_influenced;
        whole
    }

    /// The phases of one kind.
    pub fn phases_of(&self, kind: PhaseKind) -> impl Iterator<Item = &PhaseCurve> {
        self.phases.iter().filter(move |curve| curve.kind() == kind)
    }

    /// The phases of one kind that do not count.
    pub fn short_phases_of(&self, kind: PhaseKind) -> impl Iterator<Item = &PhaseCurve> {
        let of_kind = move |curve: &&PhaseCurve| curve.kind() == kind;
        self.short_phases.iter().filter(of_kind)
    }

    /// Points of acceleration of the segments of one kind.
    pub fn points_of(
        &self,
        kind: PhaseKind,
        points_of: PointsOf,
    ) -> impl Iterator<Item = &AccelPoint> {
        self.segments_of(kind)
            .flat_map(move |segment| match points_of {
                PointsOf::Means => std::slice::from_ref(&segment.mean),
                PointsOf::Samples => &segment.samples,
            })
    }

    /// The segments of one kind.
    pub fn segments_of(&self, kind: PhaseKind) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(move |s| s.kind == kind)
    }

    fn add_curves(&mut self, motion: &Motion, settings: &PhaseSettings) -> Result<(), Error> {
        let log = motion.log();
        let cut = settings.heuristic.segment(log)?.phases;
        let (spans, curves): (Vec<Span>, Vec<PhaseCurve>) =
            counting(motion, &cut, settings).unzip();
        let whole = settings.heuristic.whole_phases(log, &spans);
        self.short_phases.extend(short(motion, &cut, &spans));
        self.lead_influenced.split(&spans, curves, &mut self.phases);
        let (spans, curves): (Vec<Span>, Vec<PhaseCurve>) =
            counting(motion, &whole, settings).unzip();
        let all_whole = settings.heuristic.whole_phases(log, &cut);
        self.whole_short_phases
            .extend(short(motion, &all_whole, &spans));
        self.whole_lead_influenced
            .split(&spans, curves, &mut self.whole_phases);
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

/// Accelerations and brakings without a leader that have begun but are none of those that count.
fn short<'a>(
    motion: &'a Motion,
    phases: &'a [Span],
    counting: &'a [Span],
) -> impl Iterator<Item = PhaseCurve> + 'a {
    let begun = motion.samples_in(BEGUN_S);
    phases.iter().filter_map(move |phase| {
        let counts = counting
            .binary_search_by_key(&phase.start, |counting| counting.start)
            .is_ok();
        let has_begun = phase.end - phase.start > begun;
        let curve = PhaseCurve::cut(motion, phase).filter(|curve| curve.kind() == phase.kind);
        curve.filter(|_| has_begun && !counts && !phase.lead_influenced)
    })
}

/// The phases that are long enough and gain enough, a leader or not.
fn counting<'a>(
    motion: &'a Motion,
    phases: &'a [Span],
    settings: &'a PhaseSettings,
) -> impl Iterator<Item = (Span, PhaseCurve)> + 'a {
    phases.iter().filter_map(|phase| {
        let curve = PhaseCurve::cut(motion, phase)?;
        let counts = phase.kind == curve.kind() && settings.counts(&curve.outline());
        counts.then_some((*phase, curve))
    })
}
