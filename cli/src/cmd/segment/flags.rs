//! The flags that choose and tune a method, and what they mean.

use anyhow::bail;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, ValueEnum as _};
use driver_model::segmentation::{
    HeuristicRules, Method, Scaling, Segmenter, Segments, StatisticalRules,
};
use serde::Serialize;
use tseg::{Cost, Refill, Stop};

use crate::names::{name, named, optional_name};
use crate::numbers;

use super::names::{MergeName, MethodName, ScaleArg, SegmentsArg, pair};

#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "Segmentation")]
pub(crate) struct MethodArgs {
    /// Segmentation method
    #[arg(long, value_enum, default_value_t = MethodName::Swab)]
    pub(super) method: MethodName,
    /// Number of segments of dynamic programming, or auto for as many as pay [default: auto; 80 with --compare]
    #[arg(long, value_name = "K|auto")]
    pub(super) segments: Option<SegmentsArg>,
    /// Least length of a segment of dynamic programming, in samples
    #[arg(long, default_value_t = 5, value_parser = numbers::samples, value_name = "SAMPLES")]
    pub(super) min_length: usize,
    /// Dynamic programming may make fewer segments where that costs less
    #[arg(long)]
    at_most: bool,
    /// Cost of a segment [default: mean-deviation; z-scale for dynamic]
    #[arg(long, value_parser = named::<Cost>())]
    #[serde(serialize_with = "optional_name")]
    cost: Option<Cost>,
    /// Highest cost of a merged segment [default: 0.2 for mean-deviation; the others have no useful one]
    #[arg(long, value_parser = numbers::cost, value_name = "COST")]
    pub(super) threshold: Option<f64>,
    /// When bottom-up stops
    #[arg(long, value_parser = named::<Stop>(), default_value = "keogh")]
    #[serde(serialize_with = "name")]
    stop: Stop,
    /// Window of SWAB, in samples
    #[arg(long, default_value_t = 100, value_parser = numbers::samples, value_name = "SAMPLES")]
    pub(super) window: usize,
    /// How SWAB refills its window
    #[arg(long, value_parser = named::<Refill>(), default_value = "keogh")]
    #[serde(serialize_with = "name")]
    refill: Refill,
    /// Weights of speed and acceleration
    #[arg(long, value_delimiter = ',', num_args = 1, default_values_t = [1.8, 1.0], value_parser = numbers::weight, value_name = "V,A")]
    pub(super) weights: Vec<f64>,
    /// Scaling of speed and acceleration before segmentation: none; zscore, range or max of each log; or fixed
    /// divisors in m/s and m/s², such as 18,1.6 [default: range; 18,1.6 with --follow]
    #[arg(long, value_name = "SCALE|V,A")]
    pub(super) scale: Option<ScaleArg>,
    /// Merging of similar neighbours afterwards [default: percentile; none for dynamic]
    #[arg(long, value_enum)]
    merge: Option<MergeName>,
    /// Neighbours above this similarity are merged; for the means, magnitude and difference in m/s² [default: 0.64 for
    /// percentile, 0.005 for association, 0.4,0.55 for mean and mean-literal]
    #[arg(long, value_delimiter = ',', num_args = 1, value_parser = numbers::similarity, value_name = "J|M,D")]
    similarity: Option<Vec<f64>>,
    /// Acceleration under this magnitude counts as 0, in m/s²
    #[arg(long, default_value_t = 0.4, value_parser = numbers::deadband_mps2, value_name = "M/S2")]
    pub(super) accel_deadband: f64,
}

/// The thesis's, for the mean deviation.
pub(crate) const DEFAULT_THRESHOLD: f64 = 0.2;

impl MethodArgs {
    /// The same with the defaults that depend on other flags; `scaling` is the one of these.
    pub(super) fn resolved(&self, scaling: Scaling) -> anyhow::Result<Self> {
        let dynamic = self.method == MethodName::Dynamic;
        let cost = self.cost.unwrap_or(match self.method {
            MethodName::Dynamic => Cost::ZScale,
            _ => Cost::MeanDeviation,
        });
        let needs_threshold = !dynamic && self.method != MethodName::Heuristic;
        if needs_threshold && self.threshold.is_none() && cost != Cost::MeanDeviation {
            bail!(
                "--threshold is missing: its default, {DEFAULT_THRESHOLD}, belongs to --cost mean-deviation"
            );
        }
        let merge = self.merge.unwrap_or(match self.method {
            MethodName::Dynamic | MethodName::Heuristic => MergeName::None,
            _ => MergeName::Percentile,
        });
        Ok(Self {
            segments: self.segments.or(dynamic.then_some(SegmentsArg::Auto)),
            cost: Some(cost),
            threshold: self
                .threshold
                .or(needs_threshold.then_some(DEFAULT_THRESHOLD)),
            scale: self.scale.or(Some(ScaleArg(scaling))),
            merge: Some(merge),
            similarity: self.similarity.clone().or(merge.default_similarity()),
            ..self.clone()
        })
    }

    /// The same with this number of segments where none is given.
    pub(super) fn with_segments(&self, segments: SegmentsArg) -> Self {
        Self {
            segments: self.segments.or(Some(segments)),
            ..self.clone()
        }
    }

    /// What resolved flags ask for.
    pub(super) fn segmenter(&self) -> anyhow::Result<Segmenter> {
        if self.method == MethodName::Heuristic {
            return Ok(Segmenter::Heuristic(self.heuristic()));
        }
        Ok(Segmenter::Statistical(self.rules()?))
    }

    pub(super) fn heuristic(&self) -> HeuristicRules {
        HeuristicRules {
            accel_deadband_mps2: self.accel_deadband,
            ..HeuristicRules::default()
        }
    }

    /// The rules of a statistical method, SWAB's in place of the heuristic.
    pub(super) fn rules(&self) -> anyhow::Result<StatisticalRules> {
        let threshold = self.threshold.unwrap_or(DEFAULT_THRESHOLD);
        let method = match self.method {
            MethodName::Dynamic => Method::Dynamic {
                segments: self.number_of_segments()?,
                min_length: self.min_length,
            },
            MethodName::BottomUp => Method::BottomUp {
                threshold,
                stop: self.stop,
            },
            MethodName::SlidingWindow => Method::SlidingWindow { threshold },
            MethodName::Heuristic | MethodName::Swab => Method::Swab {
                threshold,
                window: self.window,
                refill: self.refill,
            },
        };
        if self.weights.iter().all(|weight| *weight <= 0.0) {
            bail!("--weights: one of the two has to be above 0, such as 1.8,1");
        }
        let defaults = StatisticalRules::default();
        Ok(StatisticalRules {
            accel_deadband_mps2: self.accel_deadband,
            method,
            cost: self.cost.unwrap_or(defaults.cost),
            weights: pair(
                "--weights",
                "for speed and acceleration, such as 1.8,1",
                &self.weights,
            )?,
            scaling: self.scale.map_or(defaults.scaling, |scale| scale.0),
            similarity: match self.merge {
                Some(merge) => merge.similarity(self.similarity.as_deref())?,
                None => defaults.similarity,
            },
            ..defaults
        })
    }

    /// The same without merging.
    pub(super) fn unmerged_rules(&self) -> anyhow::Result<StatisticalRules> {
        Ok(StatisticalRules {
            similarity: None,
            ..self.rules()?
        })
    }

    pub(super) fn number_of_segments(&self) -> anyhow::Result<Segments> {
        Ok(match (self.segments, self.at_most) {
            (Some(SegmentsArg::Number(number)), true) => Segments::AtMost(number),
            (Some(SegmentsArg::Number(number)), false) => Segments::Exactly(number),
            (Some(SegmentsArg::Auto) | None, false) => Segments::AtKnee,
            (Some(SegmentsArg::Auto) | None, true) => {
                bail!("--at-most needs a number of segments, such as --segments 80")
            }
        })
    }
}

/// Refuses flags on the command line that the chosen method would not look at; a configuration file may hold them for
/// other methods.
pub(crate) fn refuse_idle(matches: &ArgMatches) -> anyhow::Result<()> {
    let Some(&method) = matches.get_one::<MethodName>("method") else {
        return Ok(());
    };
    let merge = matches.get_one::<MergeName>("merge").copied();
    let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    let is = |names: &[MethodName]| names.contains(&method);
    use MethodName::{BottomUp, Dynamic, Heuristic, SlidingWindow, Swab};
    // With --compare the methods are given.
    let compare = matches.get_flag("compare");
    for (id, used) in [
        ("cost", !is(&[Heuristic])),
        ("weights", !is(&[Heuristic])),
        ("scale", !is(&[Heuristic])),
        ("merge", !is(&[Heuristic])),
        ("similarity", !is(&[Heuristic])),
        ("threshold", is(&[BottomUp, SlidingWindow, Swab])),
        ("segments", is(&[Dynamic])),
        ("min_length", is(&[Dynamic])),
        ("at_most", is(&[Dynamic])),
        ("stop", is(&[BottomUp])),
        ("window", is(&[Swab])),
        ("refill", is(&[Swab])),
    ] {
        if given(id) && !used && !compare {
            let method = method.to_possible_value();
            let method = method.as_ref().map_or("", |value| value.get_name());
            let flag = id.replace('_', "-");
            bail!("--{flag} has no meaning with --method {method}; leave it out");
        }
    }
    if given("similarity") && merge == Some(MergeName::None) {
        bail!("--similarity has no meaning with --merge none; leave it out");
    }
    Ok(())
}
