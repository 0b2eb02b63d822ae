use std::collections::VecDeque;

use drive_log::{Smoothing, SmoothingStream};
use tseg::{Merging, Swab, SwabStream};

use super::lead;
use super::statistical::{Method, StatisticalRules, banded, check_deadband};
use crate::tally::Tally;
use crate::{Error, PhaseKind, error};

/// A sample as it comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Time, s. Handed through to the phases; samples count as one step apart.
    pub time_s: f64,
    /// Recorded speed, m/s.
    pub speed_mps: f64,
    /// Distance to a vehicle ahead, m; NaN where there is none.
    pub lead_gap_m: f64,
}

/// A phase that no later sample can change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamedPhase {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Time of the sample after the last, s.
    pub end_s: f64,
    /// What the driver does.
    pub kind: PhaseKind,
    /// Mean speed, m/s.
    pub mean_speed_mps: f64,
    /// Mean acceleration without a dead band, m/s².
    pub mean_accel_mps2: f64,
    /// A vehicle ahead is near enough to matter, see [`crate::segmentation::lead_influenced`].
    pub lead_influenced: bool,
}

/// Segments a drive while it is driven: smoothing, acceleration, SWAB, merging and phases sample by sample, with the phases
/// that [`StatisticalRules::segment`] would find in the whole.
///
/// Holds the samples of SWAB's window, and of the phase that still grows the distinct dead-banded accelerations.
#[derive(Debug, Clone)]
pub struct PhaseStream {
    rules: StatisticalRules,
    divisors: [f64; 2],
    step_s: f64,
    smoothing: SmoothingStream,
    /// Readings whose smoothed speed is not known yet.
    unsmoothed: VecDeque<Reading>,
    /// The last smoothed reading, whose acceleration is not known yet, and the acceleration before it.
    last: Option<Reading>,
    last_accel_mps2: f64,
    swab: SwabStream,
    merging: Option<Merging>,
    /// Samples that are in no segment yet.
    pending: VecDeque<Sample>,
    /// Samples that are in a segment.
    segmented: usize,
    growing: Option<Growing>,
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    reading: Reading,
    accel_mps2: f64,
}

/// The phase that the next segment may still join.
#[derive(Debug, Clone, Copy)]
struct Growing {
    start: usize,
    start_s: f64,
    end_s: f64,
    tally: Tally,
    near_leader: usize,
}

impl PhaseStream {
    /// A stream by these rules of samples `step_s` apart, its speed smoothed first.
    ///
    /// # Errors
    /// [`Error::MethodOfStream`] for a method other than SWAB, [`Error::ScaleOfStream`] for a scaling that needs the whole
    /// log, [`Error::Option`] and [`Error::Segmentation`] for parameters out of range.
    pub fn new(rules: &StatisticalRules, step_s: f64, smoothing: Smoothing) -> Result<Self, Error> {
        let Method::Swab {
            threshold,
            window,
            refill,
        } = rules.method
        else {
            return Err(Error::MethodOfStream);
        };
        error::at_least("step_s", step_s, f64::MIN_POSITIVE, "above 0 s")?;
        check_deadband(rules.accel_deadband_mps2)?;
        Ok(Self {
            rules: *rules,
            divisors: rules.scaling.divisors()?,
            step_s,
            smoothing: SmoothingStream::new(smoothing),
            unsmoothed: VecDeque::new(),
            last: None,
            last_accel_mps2: 0.0,
            swab: Swab::new(rules.cost, threshold, window)?
                .with_refill(refill)
                .stream(&rules.weights)?,
            merging: rules.similarity.map(Merging::new).transpose()?,
            pending: VecDeque::new(),
            segmented: 0,
            growing: None,
        })
    }

    /// Takes the next sample; a phase, if one has ended for certain.
    ///
    /// # Errors
    /// [`Error::Segmentation`] for a speed that is not finite or absurdly large.
    pub fn push(&mut self, reading: Reading) -> Result<Option<StreamedPhase>, Error> {
        self.unsmoothed.push_back(reading);
        match self.smoothing.push(reading.speed_mps) {
            Some(speed_mps) => self.smoothed(speed_mps),
            None => Ok(None),
        }
    }

    /// The remaining phases, when no sample follows.
    ///
    /// # Errors
    /// As [`PhaseStream::push`].
    pub fn finish(mut self) -> Result<Vec<StreamedPhase>, Error> {
        let mut phases = Vec::new();
        let smoothing =
            std::mem::replace(&mut self.smoothing, SmoothingStream::new(Smoothing::None));
        for speed_mps in smoothing.finish() {
            phases.extend(self.smoothed(speed_mps)?);
        }
        if let Some(reading) = self.last {
            phases.extend(self.sample(reading, self.last_accel_mps2)?);
        }
        for segment in self.swab.clone().finish() {
            phases.extend(self.segment(segment.len())?);
        }
        phases.extend(self.growing.map(|growing| self.phase(&growing)));
        Ok(phases)
    }

    fn smoothed(&mut self, speed_mps: f64) -> Result<Option<StreamedPhase>, Error> {
        let Some(reading) = self.unsmoothed.pop_front() else {
            return Ok(None);
        };
        let Some(before) = self.last.replace(Reading {
            speed_mps,
            ..reading
        }) else {
            return Ok(None);
        };
        self.last_accel_mps2 = (speed_mps - before.speed_mps) / self.step_s;
        self.sample(before, self.last_accel_mps2)
    }

    fn sample(
        &mut self,
        reading: Reading,
        accel_mps2: f64,
    ) -> Result<Option<StreamedPhase>, Error> {
        let [speed_divisor, accel_divisor] = self.divisors;
        let banded_mps2 = banded(accel_mps2, self.rules.accel_deadband_mps2);
        self.pending.push_back(Sample {
            reading,
            accel_mps2,
        });
        match self.swab.push(&[
            reading.speed_mps / speed_divisor,
            banded_mps2 / accel_divisor,
        ])? {
            Some(segment) => self.segment(segment.len()),
            None => Ok(None),
        }
    }

    /// Takes the next segment out of the pending samples; the phase before it, where it starts a new one.
    fn segment(&mut self, len: usize) -> Result<Option<StreamedPhase>, Error> {
        let segment: Vec<Sample> = self.pending.drain(..len).collect();
        let Some(last) = segment.last() else {
            return Ok(None);
        };
        let end_s = match self.pending.front() {
            Some(next) => next.reading.time_s,
            None => last.reading.time_s + self.step_s,
        };
        let threshold_mps2 = self.rules.accel_deadband_mps2;
        let joins = match &mut self.merging {
            Some(merging) => {
                let accels = segment.iter().map(|s| banded(s.accel_mps2, threshold_mps2));
                merging.joins(&accels.collect::<Vec<_>>())?
            }
            None => false,
        };
        let ended = if joins { None } else { self.growing.take() };
        let mut growing = self.growing.take().unwrap_or(Growing {
            start: self.segmented,
            start_s: segment[0].reading.time_s,
            end_s,
            tally: Tally::default(),
            near_leader: 0,
        });
        growing.end_s = end_s;
        for Sample {
            reading,
            accel_mps2,
        } in &segment
        {
            growing
                .tally
                .add(reading.speed_mps, *accel_mps2, threshold_mps2);
            let near = lead::is_near(reading.lead_gap_m, reading.speed_mps);
            growing.near_leader += usize::from(near);
        }
        self.segmented += len;
        if self.merging.is_none() {
            return Ok(Some(self.phase(&growing)));
        }
        self.growing = Some(growing);
        Ok(ended.map(|ended| self.phase(&ended)))
    }

    fn phase(&self, ended: &Growing) -> StreamedPhase {
        let tally = &ended.tally;
        StreamedPhase {
            start: ended.start,
            end: ended.start + tally.samples,
            start_s: ended.start_s,
            end_s: ended.end_s,
            kind: self.rules.classify(tally, self.step_s),
            mean_speed_mps: tally.mean_speed_mps(),
            mean_accel_mps2: tally.mean_accel_mps2(),
            lead_influenced: lead::is_influenced(ended.near_leader, tally.samples),
        }
    }
}
