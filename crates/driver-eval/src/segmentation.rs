//! What Table 3.5 and figures 3.3 to 3.10 of the thesis compare.

use std::ops::ControlFlow;

use drive_log::DriveLog;
use driver_model::segmentation::{
    HeuristicRules, Method, Segmented, Segmenter, Segments, StatisticalRules, dead_banded,
    most_divided,
};
use serde_json::{Value, json};
use tseg::{Cost, Similarity, Stop};

use crate::Error;
use crate::words::rounded;

/// Thresholds of the figures and of Table 3.5; the thesis has both.
const FIGURE_THRESHOLD: f64 = 0.4;

/// The figure whose first panel is SWAB before merging.
const UNMERGED: &str = "3.10";

/// Settings of the methods that are compared.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Of the heuristic, and of acceleration that counts as none
    pub heuristic: HeuristicRules,
    /// SWAB without merging
    pub swab: StatisticalRules,
    /// Of bottom-up and the sliding window in the table
    pub threshold: f64,
    /// Of dynamic programming in the table
    pub segments: Segments,
    /// Least length of a segment of dynamic programming, in samples
    pub min_length: usize,
}

/// One panel: figure, title, and how its segments come about.
type Panel = (&'static str, String, Segmenter);

impl Comparison {
    /// The methods of the table by name, and two more.
    #[must_use]
    pub fn methods(&self) -> [(&'static str, Segmenter); 5] {
        let (threshold, stop) = (self.threshold, Stop::Keogh);
        [
            ("dynamic", self.dynamic(self.segments)),
            ("bottom-up", self.with(Method::BottomUp { threshold, stop })),
            ("swab", Segmenter::Statistical(self.swab)),
            (
                "sliding-window",
                self.with(Method::SlidingWindow { threshold }),
            ),
            ("heuristic", Segmenter::Heuristic(self.heuristic)),
        ]
    }

    /// The figures for one log, as data that a page draws. What a log is too short for is left out.
    ///
    /// # Errors
    ///
    /// Where the log cannot be segmented.
    pub fn figures(&self, log: &DriveLog) -> Result<Value, Error> {
        let accel_mps2 = log.accel_mps2();
        let deadband_mps2 = self.heuristic.accel_deadband_mps2;
        let banded_mps2 = dead_banded(&accel_mps2, deadband_mps2)?;
        let mut panels = Vec::new();
        for (figure, title, segmenter) in self.panels() {
            match segmenter.segment(log, &|_| ControlFlow::Continue(())) {
                Err(driver_model::Error::Segmentation(tseg::Error::TooManySegments { .. })) => {}
                segmented => panels.push((figure, title, segmented?)),
            }
        }
        let first = |figure| panels.iter().find(|panel| panel.0 == figure);
        // Figure 3.9: the acceleration of the heuristic that unmerged SWAB cuts most.
        let acceleration = first("3.3")
            .zip(first(UNMERGED))
            .and_then(|(heuristic, swab)| most_divided(&heuristic.2.phases, &swab.2.segmentation))
            .map(|phase| [phase.start, phase.end]);
        let panel = |(figure, title, segmented): &(&str, String, Segmented)| {
            json!({
                "figure": figure,
                "title": title,
                "boundaries": segmented.segmentation.boundaries(),
                "phases": segmented.phases.iter().map(|phase| phase.kind).collect::<Vec<_>>(),
            })
        };
        Ok(json!({
            "log": log.name(),
            "t0_s": log.t0_s(),
            "step_s": log.step_s(),
            "speed_mps": drawn(log.speed_mps()),
            "accel_mps2": drawn(&accel_mps2),
            "banded_mps2": drawn(&banded_mps2),
            "accel_deadband_mps2": deadband_mps2,
            "acceleration": acceleration,
            "panels": panels.iter().map(panel).collect::<Vec<_>>(),
        }))
    }

    fn with(&self, method: Method) -> Segmenter {
        let rules = self.swab;
        Segmenter::Statistical(StatisticalRules { method, ..rules })
    }

    fn dynamic(&self, segments: Segments) -> Segmenter {
        let min_length = self.min_length;
        Segmenter::Statistical(StatisticalRules {
            method: Method::Dynamic {
                segments,
                min_length,
            },
            cost: Cost::ZScale,
            ..self.swab
        })
    }

    fn merged(&self, similarity: Option<Similarity>) -> Segmenter {
        let rules = self.swab;
        Segmenter::Statistical(StatisticalRules {
            similarity,
            ..rules
        })
    }

    fn panels(&self) -> Vec<Panel> {
        let dynamic = |segments| self.dynamic(Segments::Exactly(segments));
        let (swab, window) = match self.swab.method {
            Method::Swab { window, refill, .. } => (
                Method::Swab {
                    threshold: FIGURE_THRESHOLD,
                    window,
                    refill,
                },
                window,
            ),
            other => (other, 0),
        };
        let bottom_up = Method::BottomUp {
            threshold: FIGURE_THRESHOLD,
            stop: Stop::Keogh,
        };
        let titled = |figure, title: &str, segmenter| (figure, title.to_owned(), segmenter);
        let swab_title = format!("SWAB, threshold {FIGURE_THRESHOLD}, window {window}");
        let bottom_up_title = format!("Bottom-up, threshold {FIGURE_THRESHOLD}");
        let heuristic = Segmenter::Heuristic(self.heuristic);
        let [mean, association, percentile] = [
            Similarity::mean(),
            Similarity::association(),
            Similarity::percentile(),
        ]
        .map(|similarity| self.merged(Some(similarity)));
        vec![
            titled("3.3", "Heuristic classes", heuristic),
            titled("3.5", "Dynamic programming, k = 20", dynamic(20)),
            titled("3.6", "Dynamic programming, k = 40", dynamic(40)),
            titled("3.7", &bottom_up_title, self.with(bottom_up)),
            titled("3.8", &swab_title, self.with(swab)),
            titled(UNMERGED, "Not merged", self.merged(None)),
            titled(UNMERGED, "Mean comparison", mean),
            titled(UNMERGED, "l-association interval", association),
            titled(UNMERGED, "Percentile", percentile),
        ]
    }
}

/// Four decimals: more than any picture shows.
fn drawn(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| rounded(*value, 4)).collect()
}
