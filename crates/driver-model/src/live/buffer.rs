//! The latest samples of a drive.

use std::collections::{BTreeMap, VecDeque};

use drive_log::{Channel, DriveLog, Row, Smoothing, SmoothingStream, hann};
use ev_energy::DEFAULT_SLOPE_BANDWIDTH_M;

use super::LiveSettings;
use crate::motion::samples_in;
use crate::{DriverInput, Error, Motion, error};

/// Kept at least, for phases, s.
const LEAST_KEPT_S: f64 = 10.0;

/// Kept beyond what models look back on, so that samples are not thrown away one by one, s.
const SPARE_S: f64 = 20.0;

/// Rows of a piece as far back as somebody looks.
#[derive(Debug)]
pub(super) struct Buffer {
    settings: LiveSettings,
    kept: usize,
    /// Time of the first sample of the piece.
    start_s: f64,
    /// Samples of the piece that are gone.
    gone: usize,
    speed_mps: VecDeque<f64>,
    lead_gap_m: VecDeque<f64>,
    told: Vec<VecDeque<f64>>,
    smoothing: SmoothingStream,
}

impl Buffer {
    pub(super) fn new(settings: &LiveSettings) -> Result<Self, Error> {
        error::at_least("step_s", settings.step_s, 1e-3, "at least 0.001 s")?;
        error::at_least("max_gap_s", settings.max_gap_s, 0.0, "at least 0 s")?;
        let mut buffer = Self {
            kept: 0,
            start_s: 0.0,
            gone: 0,
            speed_mps: VecDeque::new(),
            lead_gap_m: VecDeque::new(),
            told: vec![VecDeque::new(); settings.told.len()],
            smoothing: SmoothingStream::new(settings.smoothing),
            settings: settings.clone(),
        };
        buffer.keep(LEAST_KEPT_S);
        Ok(buffer)
    }

    /// At least so much of the past, and what smoothing needs beside it.
    pub(super) fn keep(&mut self, past_s: f64) {
        let smoothed = match self.settings.smoothing {
            Smoothing::None => 0,
            Smoothing::Hann(length) => length,
        };
        let kept = samples_in(past_s, self.settings.step_s) + 2 * smoothed + 2;
        self.kept = self.kept.max(kept);
    }

    /// Speeds whose smoothing is known now, in order.
    pub(super) fn push(&mut self, row: &Row) -> Result<Option<f64>, Error> {
        if row.told.len() != self.told.len() {
            return Err(Error::Option {
                name: "the number of channels of a row",
                value: row.told.len() as f64,
                expected: "as many as were announced",
            });
        }
        if self.speed_mps.is_empty() {
            self.start_s = row.time_s;
        }
        self.speed_mps.push_back(row.speed_mps);
        self.lead_gap_m.push_back(row.lead_gap_m);
        for (values, value) in self.told.iter_mut().zip(&row.told) {
            values.push_back(*value);
        }
        let spare = samples_in(SPARE_S, self.settings.step_s);
        if self.speed_mps.len() > self.kept + spare {
            self.gone += spare;
            let columns = self.told.iter_mut();
            for values in columns.chain([&mut self.speed_mps, &mut self.lead_gap_m]) {
                values.drain(..spare);
            }
        }
        Ok(self.smoothing.push(row.speed_mps))
    }

    /// Smoothed speeds still due, when no sample of the piece follows.
    pub(super) fn rest(&mut self) -> Vec<f64> {
        let fresh = SmoothingStream::new(self.settings.smoothing);
        std::mem::replace(&mut self.smoothing, fresh).finish()
    }

    pub(super) fn clear(&mut self) {
        self.gone = 0;
        let columns = self.told.iter_mut();
        for values in columns.chain([&mut self.speed_mps, &mut self.lead_gap_m]) {
            values.clear();
        }
    }

    pub(super) fn step_s(&self) -> f64 {
        self.settings.step_s
    }

    /// Latest samples whose smoothed speed the next ones will change.
    pub(super) fn unsmoothed(&self) -> usize {
        match self.settings.smoothing {
            Smoothing::None => 0,
            Smoothing::Hann(length) => length / 2,
        }
    }

    /// Samples of the piece so far.
    pub(super) fn len(&self) -> usize {
        self.gone + self.speed_mps.len()
    }

    /// Of a sample of the piece.
    pub(super) fn time_s(&self, sample: usize) -> f64 {
        self.start_s + sample as f64 * self.settings.step_s
    }

    pub(super) fn now_s(&self) -> f64 {
        self.time_s(self.len().saturating_sub(1))
    }

    /// NaN where there is no vehicle ahead, and for a sample that is gone.
    pub(super) fn lead_gap_m(&self, sample: usize) -> f64 {
        let kept = sample.checked_sub(self.gone);
        let gap_m = kept.and_then(|kept| self.lead_gap_m.get(kept));
        gap_m.copied().unwrap_or(f64::NAN)
    }

    /// What the driver did at a sample of the piece.
    pub(super) fn input(&self, sample: usize) -> DriverInput {
        let value = |channel: Channel, sample: usize| {
            let column = self.settings.told.iter().position(|c| *c == channel)?;
            let value = *self.told[column].get(sample.checked_sub(self.gone)?)?;
            value.is_finite().then_some(value)
        };
        DriverInput::of(sample, self.settings.step_s, value)
    }

    /// The samples that are kept as a drive that ends now, prepared as [`drive_log::prepare`] prepares one.
    pub(super) fn motion(&self) -> Result<Motion, Error> {
        let raw: Vec<f64> = self.speed_mps.iter().copied().collect();
        let speed_mps = match self.settings.smoothing {
            Smoothing::None => raw,
            Smoothing::Hann(length) => hann(&raw, length),
        };
        let longest = samples_in(self.settings.max_gap_s, self.settings.step_s);
        let mut channels = BTreeMap::from([(Channel::Speed, speed_mps)]);
        for (channel, values) in self.settings.told.iter().zip(&self.told) {
            let mut values: Vec<f64> = values.iter().copied().collect();
            fill(&mut values, longest, *channel == Channel::SpeedLimit);
            channels.insert(*channel, values);
        }
        let (t0_s, step_s) = (self.time_s(self.gone), self.settings.step_s);
        let log = DriveLog::new("the stream", t0_s, step_s, channels)?;
        Motion::of_log(&log, DEFAULT_SLOPE_BANDWIDTH_M)
    }
}

/// Straight lines over gaps of at most so many steps between two values, or the value before them.
fn fill(values: &mut [f64], longest: usize, holds: bool) {
    let mut last: Option<usize> = None;
    for k in 0..values.len() {
        if values[k].is_finite() {
            if let Some(last) = last.filter(|last| !holds && k - last > 1 && k - last <= longest) {
                let (from, rise) = (values[last], values[k] - values[last]);
                for (step, value) in values[last..k].iter_mut().enumerate() {
                    *value = from + rise * (step as f64 / (k - last) as f64);
                }
            }
            last = Some(k);
        } else if let Some(last) = last.filter(|last| holds && k - last <= longest) {
            values[k] = values[last];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gaps_are_filled_and_long_ones_and_ends_stay() {
        let nan = f64::NAN;
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let gaps = [nan, 1.0, nan, 3.0, nan, nan, nan, 7.0, nan];
        let mut line = gaps;
        fill(&mut line, 2, false);
        assert_eq!(
            bits(&line),
            bits(&[nan, 1.0, 2.0, 3.0, nan, nan, nan, 7.0, nan])
        );
        let mut held = gaps;
        fill(&mut held, 2, true);
        assert_eq!(
            bits(&held),
            bits(&[nan, 1.0, 1.0, 3.0, 3.0, 3.0, nan, 7.0, 7.0])
        );
    }
}
