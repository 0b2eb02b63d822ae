//! Predictions while a drive goes on: the speed of the next seconds, and how a phase that has just begun will go.
//!
//! A [`LivePredictor`] takes samples as they come and answers with [`Event`]s. It keeps as much of the past as its models look back on.

mod ahead;
mod begun;
mod buffer;
mod watch;

use drive_log::{Channel, Row, Smoothing};
use serde::Serialize;

use crate::{DriverModel, Error, ModelFile, PhaseKind};
use ahead::Ahead;
pub use begun::{Beginning, BegunPhases, BegunSettings, Forecast, Second};
use buffer::Buffer;
use watch::Watch;

/// How samples come, and what is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveSettings {
    /// Distance of samples.
    pub step_s: f64,
    /// Of the speed.
    pub smoothing: Smoothing,
    /// Longest time without a value that is filled.
    pub max_gap_s: f64,
    /// What rows tell beside speed and gap, in this order.
    pub told: Vec<Channel>,
    /// Which of the horizons of a model of the next seconds; none for all.
    pub horizons_s: Vec<f64>,
}

/// What is told of a drive under way.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The speed of the next seconds, once a second.
    Ahead {
        /// The moment from which it is predicted.
        time_s: f64,
        /// When that was known: as many samples later as smoothing looks ahead.
        known_s: f64,
        /// Speed at that moment.
        speed_mps: f64,
        /// By rising horizon.
        horizons: Vec<Horizon>,
    },
    /// A phase has begun.
    PhaseBegins {
        /// Acceleration or braking.
        phase: PhaseKind,
        /// When it began.
        begin_s: f64,
        /// The time from which it is predicted, [`BEGUN_S`](crate::BEGUN_S) later.
        from_s: f64,
        /// When that was known: as many samples later as smoothing looks ahead.
        known_s: f64,
        /// Speed at `begin_s`.
        start_speed_mps: f64,
        /// Speed at `from_s`.
        speed_mps: f64,
        /// Whether a vehicle ahead is near, under whose influence the model has learnt nothing.
        lead_influenced: bool,
        /// What becomes of it.
        #[serde(flatten)]
        forecast: Forecast,
    },
    /// A phase of which it was told that it began has ended.
    PhaseEnds {
        /// Acceleration or braking.
        phase: PhaseKind,
        /// When it began.
        begin_s: f64,
        /// When it ended.
        end_s: f64,
        /// Speed at its end.
        end_speed_mps: f64,
        /// Whether it is one that models learn from: long and large enough, and without a leader.
        counts: bool,
        /// Of the predicted seconds that it lasted; `None` where it lasted none.
        rmse_mps: Option<f64>,
        /// Share of them in the band.
        in_band_pct: Option<f64>,
    },
    /// What is to be said once.
    Remark {
        /// In words.
        text: String,
    },
}

/// The speed at one horizon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Horizon {
    /// Seconds ahead.
    pub horizon_s: f64,
    /// Predicted.
    pub speed_mps: f64,
    /// Lower end of the interval, where the model has one.
    pub low_mps: Option<f64>,
    /// Upper end.
    pub high_mps: Option<f64>,
}

/// Predicts a drive that is still going on.
///
/// Memory is bounded: the samples of as many seconds as the models look back, and those of a phase under way.
#[derive(Debug)]
pub struct LivePredictor {
    buffer: Buffer,
    ahead: Option<Ahead>,
    watches: Vec<Watch>,
    remarks: Vec<String>,
}

impl LivePredictor {
    /// Channels that models may ask for.
    pub const CHANNELS: [Channel; 7] = [
        Channel::SpeedLimit,
        Channel::Slope,
        Channel::Elevation,
        Channel::AcceleratorPedal,
        Channel::Brake,
        Channel::MotorTorque,
        Channel::Accelerometer,
    ];

    /// Of a model of the next seconds, one of acceleration and one of braking phases, or some of these.
    ///
    /// # Errors
    /// [`Error::NotLive`] for another model, [`Error::TwoOf`] for two of a kind, [`Error::NoMemory`] for a model of phases whose file does not
    /// hold them, [`Error::TooFewPhases`] where it holds too few, [`Error::Steps`] where the model is of another sampling interval,
    /// [`Error::Option`] for one that looks back for too long or a step that is none.
    pub fn new(files: Vec<ModelFile>, settings: &LiveSettings) -> Result<Self, Error> {
        let mut predictor = Self {
            buffer: Buffer::new(settings)?,
            ahead: None,
            watches: Vec::new(),
            remarks: Vec::new(),
        };
        for (number, file) in files.iter().enumerate() {
            let behaviour = file.model.behaviour();
            let same = |other: &ModelFile| other.model.behaviour() == behaviour;
            if files[..number].iter().any(same) {
                return Err(Error::TwoOf {
                    behaviour: behaviour.name(),
                });
            }
        }
        for file in files {
            predictor.add(file, settings)?;
        }
        Ok(predictor)
    }

    fn add(&mut self, file: ModelFile, settings: &LiveSettings) -> Result<(), Error> {
        match file.model {
            DriverModel::SpeedAhead(model) => {
                let ahead = Ahead::new(model, settings)?;
                self.buffer.keep(ahead.past_s());
                self.remarks.extend(ahead.remarks());
                self.ahead = Some(ahead);
            }
            DriverModel::Acceleration(model) | DriverModel::Braking(model) => {
                let kind = model.kind();
                let memory = file.memory.ok_or(Error::NoMemory { model: kind })?;
                self.watches.push(Watch::new(model, &memory, settings)?);
            }
            other => {
                return Err(Error::NotLive {
                    model: other.kind(),
                });
            }
        }
        Ok(())
    }

    /// Takes the next sample, and says what there is to say now.
    ///
    /// # Errors
    /// [`Error::Option`] for a row that is not of the channels announced, and what prediction refuses.
    pub fn push(&mut self, row: &Row) -> Result<Vec<Event>, Error> {
        let mut events = Vec::new();
        for text in self.remarks.drain(..) {
            events.push(Event::Remark { text });
        }
        if row.starts_piece {
            events.extend(self.end_piece());
        }
        let smoothed = self.buffer.push(row)?;
        if let Some(speed_mps) = smoothed {
            for watch in &mut self.watches {
                events.extend(watch.push(speed_mps, &self.buffer));
            }
        }
        if let Some(ahead) = &mut self.ahead {
            events.extend(ahead.now(&self.buffer)?);
        }
        Ok(events)
    }

    /// When no sample follows: the phases under way have ended.
    pub fn finish(mut self) -> Vec<Event> {
        self.end_piece()
    }

    fn end_piece(&mut self) -> Vec<Event> {
        let mut events = Vec::new();
        for speed_mps in self.buffer.rest() {
            for watch in &mut self.watches {
                events.extend(watch.push(speed_mps, &self.buffer));
            }
        }
        let ended = self.watches.iter_mut();
        events.extend(ended.filter_map(|watch| watch.end(&self.buffer)));
        self.buffer.clear();
        events
    }
}
