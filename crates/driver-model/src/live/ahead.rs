//! The speed of the next seconds, every second.

use drive_log::Channel;

use super::buffer::Buffer;
use super::{Event, Horizon, LiveSettings};
use crate::Error;
use crate::motion::samples_in;
use crate::speed_ahead::{DirectModel, LEAST_PAST_S};

/// Distance of two predictions.
const EVERY_S: f64 = 1.0;

/// A model that looks back further would need more memory than a stream is worth, s.
const MOST_PAST_S: f64 = 3600.0;

#[derive(Debug)]
pub(super) struct Ahead {
    model: DirectModel,
    /// Which horizons are asked for.
    wanted: Vec<bool>,
    told: Vec<Channel>,
    said_fallback: bool,
    said_limits: bool,
}

impl Ahead {
    pub(super) fn new(model: DirectModel, settings: &LiveSettings) -> Result<Self, Error> {
        if (model.step_s() - settings.step_s).abs() > 1e-9 {
            return Err(Error::Steps {
                log: "the stream".to_owned(),
                found_s: settings.step_s,
                expected_s: model.step_s(),
            });
        }
        if model.needs_limits() && !settings.told.contains(&Channel::SpeedLimit) {
            return Err(Error::NoLimits {
                log: "the stream".to_owned(),
            });
        }
        if model.past_s() > MOST_PAST_S {
            return Err(Error::Option {
                name: "the time that the model looks back",
                value: model.past_s(),
                expected: "at most an hour on a stream",
            });
        }
        let asked = &settings.horizons_s;
        let is_wanted = |h: f64| asked.is_empty() || asked.iter().any(|a| (a - h).abs() < 1e-9);
        Ok(Self {
            wanted: model.horizons_s().map(is_wanted).collect(),
            told: settings.told.clone(),
            model,
            said_fallback: false,
            said_limits: false,
        })
    }

    pub(super) fn past_s(&self) -> f64 {
        self.model.past_s()
    }

    pub(super) fn remarks(&self) -> Option<String> {
        self.model.needs_limits().then(|| {
            "the road ahead is not known: the speed limit of now counts as that of the way ahead".to_owned()
        })
    }

    pub(super) fn now(&mut self, buffer: &Buffer) -> Result<Vec<Event>, Error> {
        let step_s = buffer.step_s();
        // The latest sample whose smoothed speed no later one changes, as those that the model has learnt from.
        let unsmoothed = buffer.unsmoothed();
        let since = (buffer.len() - 1).checked_sub(samples_in(LEAST_PAST_S, step_s) + unsmoothed);
        if !since.is_some_and(|since| since.is_multiple_of(samples_in(EVERY_S, step_s))) {
            return Ok(Vec::new());
        }
        let motion = buffer.motion()?;
        let mut events = Vec::new();
        let mut say_once = |said: &mut bool, text: String| {
            if !std::mem::replace(said, true) {
                events.push(Event::Remark { text });
            }
        };
        if self.model.falls_back(&motion) {
            let has = |c: &crate::DriverChannel| self.told.contains(&c.channel());
            let lacking = self.model.channels().iter().filter(|c| !has(c));
            let lacking: Vec<&str> = lacking.map(|c| c.channel().name()).collect();
            let text = match lacking.is_empty() {
                true => {
                    "predicted without what the driver does, of which the stream has too little now"
                        .to_owned()
                }
                false => format!(
                    "predicted without what the driver does: the model knows {}, and the stream does not say it",
                    lacking.join(", ")
                ),
            };
            say_once(&mut self.said_fallback, text);
        }
        let last = motion.len() - 1 - unsmoothed;
        let ahead = match self.model.predict(&motion, &[last]) {
            Err(Error::NoLimits { .. }) => {
                let text = "the model knows speed limits, which the stream has for less than half of the time; nothing is predicted meanwhile";
                say_once(&mut self.said_limits, text.to_owned());
                return Ok(events);
            }
            ahead => ahead?,
        };
        let horizons = |ahead: &crate::speed_ahead::SpeedAhead| {
            let each = self.model.horizons_s().zip(&ahead.speed_mps);
            let each = each.zip(&ahead.interval_mps).zip(&self.wanted);
            each.filter(|(_, wanted)| **wanted)
                .map(|(((horizon_s, &speed_mps), interval_mps), _)| Horizon {
                    horizon_s,
                    speed_mps,
                    low_mps: interval_mps.map(|(low, _)| low),
                    high_mps: interval_mps.map(|(_, high)| high),
                })
                .collect()
        };
        events.extend(ahead.first().map(|ahead| Event::Ahead {
            time_s: buffer.time_s(buffer.len() - 1 - unsmoothed),
            known_s: buffer.now_s(),
            speed_mps: motion.speed_mps()[last],
            horizons: horizons(ahead),
        }));
        Ok(events)
    }
}
