//! Where phases of one kind begin and end in a drive that goes on, by the rules of the heuristic route.

use std::collections::VecDeque;

use super::begun::{Beginning, BegunPhases, BegunSettings, Forecast};
use super::buffer::Buffer;
use super::{Event, LiveSettings};
use crate::grid::{at_least, below};
use crate::motion::samples_in;
use crate::segmentation::lead;
use crate::{
    BEGUN_S, Error, Onset, PhaseExtent, PhaseKind, PhaseMemory, PhaseModel, PhaseSettings,
};

/// Samples of an onset, the one at which a phase begins included.
const ONSET_SAMPLES: usize = 4;

#[derive(Debug)]
pub(super) struct Watch {
    kind: PhaseKind,
    settings: PhaseSettings,
    begun: BegunPhases,
    step_s: f64,
    /// Smoothed samples of the piece so far, and the last of them.
    samples: usize,
    latest_mps: VecDeque<f64>,
    run: Option<Run>,
}

/// Samples that may be a phase.
#[derive(Debug)]
struct Run {
    /// Of the piece.
    start: usize,
    speed_mps: Vec<f64>,
    onset: Option<Onset>,
    near_leader: usize,
    /// Where in it the acceleration has reached the threshold, and still does.
    cut: Option<usize>,
    /// Whether it has ever reached the threshold, and for so long that it counts.
    is_phase: bool,
    cut_counts: bool,
    told: Option<Forecast>,
}

impl Watch {
    pub(super) fn new(
        model: PhaseModel,
        memory: &PhaseMemory,
        settings: &LiveSettings,
    ) -> Result<Self, Error> {
        let step_s = settings.step_s;
        let other = memory.step_s().filter(|of| (of - step_s).abs() > 1e-9);
        if let Some(expected_s) = other {
            return Err(Error::Steps {
                log: "the stream".to_owned(),
                found_s: step_s,
                expected_s,
            });
        }
        Ok(Self {
            kind: memory.kind(),
            settings: memory.settings(),
            begun: BegunPhases::new(model, memory, &BegunSettings::default())?,
            step_s,
            samples: 0,
            latest_mps: VecDeque::new(),
            run: None,
        })
    }

    /// Takes the next smoothed speed, by which the step before it is known.
    pub(super) fn push(&mut self, speed_mps: f64, buffer: &Buffer) -> Vec<Event> {
        let mut events = Vec::new();
        if let Some(&before_mps) = self.latest_mps.back() {
            let accel_mps2 = (speed_mps - before_mps) / self.step_s;
            events.extend(self.step(before_mps, accel_mps2, buffer));
        }
        self.samples += 1;
        self.latest_mps.push_back(speed_mps);
        if self.latest_mps.len() > ONSET_SAMPLES {
            self.latest_mps.pop_front();
        }
        events.extend(self.tell(buffer));
        events
    }

    /// The step from the last sample on, and whether the phase goes on with it.
    fn step(&mut self, speed_mps: f64, accel_mps2: f64, buffer: &Buffer) -> Option<Event> {
        let rules = &self.settings.heuristic;
        let reaches = rules.label(speed_mps, accel_mps2) == self.kind;
        let sign = self.sign();
        let goes_on = match self.settings.extent {
            PhaseExtent::Threshold => reaches,
            PhaseExtent::Whole => at_least(sign * accel_mps2, rules.end_accel_mps2),
        };
        let last = self.samples - 1;
        if goes_on && self.run.is_none() {
            let latest: Vec<f64> = self.latest_mps.iter().copied().collect();
            self.run = Some(Run {
                start: last,
                speed_mps: Vec::new(),
                onset: Onset::before(latest.len() - 1, &latest, self.step_s),
                near_leader: 0,
                cut: None,
                is_phase: false,
                cut_counts: false,
                told: None,
            });
        }
        let whole = self.settings.extent == PhaseExtent::Whole;
        if let Some(run) = &mut self.run
            && (goes_on || whole)
        {
            // A whole phase has the sample at the end of its last step, too.
            run.take(speed_mps, buffer.lead_gap_m(last));
        }
        self.reach(reaches);
        if goes_on {
            return None;
        }
        self.ended(buffer)
    }

    /// Notes whether the last sample of the run reaches the threshold.
    fn reach(&mut self, reaches: bool) {
        let Some(run) = &mut self.run else {
            return;
        };
        let last = run.speed_mps.len().saturating_sub(1);
        if reaches {
            run.is_phase = true;
            run.cut.get_or_insert(last);
        } else if let Some(cut) = run.cut.take() {
            // The sample after the last that reaches it is in the run where the run goes on.
            let end = match self.settings.extent {
                PhaseExtent::Threshold => last,
                PhaseExtent::Whole => last.saturating_sub(1),
            };
            run.cut_counts |= counts(&run.speed_mps, cut, end, self.step_s, &self.settings);
        }
    }

    /// The phase is over: no sample follows in this piece.
    pub(super) fn end(&mut self, buffer: &Buffer) -> Option<Event> {
        if let (Some(run), Some(&last_mps)) = (&mut self.run, self.latest_mps.back()) {
            run.take(last_mps, buffer.lead_gap_m(self.samples - 1));
            if let Some(cut) = run.cut.take() {
                let end = run.speed_mps.len() - 1;
                run.cut_counts |= counts(&run.speed_mps, cut, end, self.step_s, &self.settings);
            }
        }
        let event = self.ended(buffer);
        self.samples = 0;
        self.latest_mps.clear();
        event
    }

    fn ended(&mut self, buffer: &Buffer) -> Option<Event> {
        let run = self.run.take()?;
        let forecast = run.told?;
        let end = run.speed_mps.len().checked_sub(1)?;
        let influenced = lead::is_influenced(run.near_leader, run.speed_mps.len());
        let begun = samples_in(BEGUN_S, self.step_s);
        let seconds = forecast.seconds.iter().filter_map(|second| {
            let steps = samples_in(second.after_s, self.step_s);
            let measured_mps = *run.speed_mps.get(begun + steps)?;
            let error_mps = second.speed_mps - measured_mps;
            let inside = (second.low_mps..=second.high_mps).contains(&measured_mps);
            Some((error_mps * error_mps, f64::from(u8::from(inside))))
        });
        let (squares, inside): (Vec<f64>, Vec<f64>) = seconds.unzip();
        let mean = |values: Vec<f64>| crate::statistics::mean(values);
        Some(Event::PhaseEnds {
            phase: self.kind,
            begin_s: buffer.time_s(run.start),
            end_s: buffer.time_s(run.start + end),
            end_speed_mps: run.speed_mps[end],
            counts: run.cut_counts
                && !influenced
                && counts(&run.speed_mps, 0, end, self.step_s, &self.settings),
            rmse_mps: mean(squares).map(f64::sqrt),
            in_band_pct: mean(inside).map(|share| 100.0 * share),
        })
    }

    /// What becomes of the phase, once, when it has lasted long enough.
    fn tell(&mut self, buffer: &Buffer) -> Option<Event> {
        let begun = samples_in(BEGUN_S, self.step_s);
        let run = self.run.as_mut()?;
        if run.told.is_some() || !run.is_phase || run.speed_mps.len() <= begun {
            return None;
        }
        let (start_speed_mps, speed_mps) = (run.speed_mps[0], run.speed_mps[begun]);
        let forecast = self.begun.forecast(&Beginning {
            start_speed_mps,
            early_gain_mps: speed_mps - start_speed_mps,
            onset: run.onset,
            input: buffer.input(run.start),
        });
        run.told = Some(forecast.clone());
        Some(Event::PhaseBegins {
            phase: self.kind,
            begin_s: buffer.time_s(run.start),
            from_s: buffer.time_s(run.start + begun),
            known_s: buffer.now_s(),
            start_speed_mps,
            speed_mps,
            lead_influenced: lead::is_influenced(run.near_leader, run.speed_mps.len()),
            forecast,
        })
    }

    fn sign(&self) -> f64 {
        if self.kind == PhaseKind::Braking {
            -1.0
        } else {
            1.0
        }
    }
}

impl Run {
    fn take(&mut self, speed_mps: f64, lead_gap_m: f64) {
        self.speed_mps.push(speed_mps);
        self.near_leader += usize::from(lead::is_near(lead_gap_m, speed_mps));
    }
}

/// Whether samples are long and gain enough for a phase that counts.
fn counts(
    speed_mps: &[f64],
    first: usize,
    last: usize,
    step_s: f64,
    settings: &PhaseSettings,
) -> bool {
    let (Some(from), Some(to)) = (speed_mps.get(first), speed_mps.get(last)) else {
        return false;
    };
    let duration_s = last.saturating_sub(first) as f64 * step_s;
    !below(duration_s, settings.min_duration_s) && !below((to - from).abs(), settings.min_gain_mps)
}
