use super::habit::WantedSpeed;
use super::law_fit::laws;
use super::recording::RecordedTrip;
use super::{Slowdowns, TripDriver};
use crate::{Error, LeftOut, Motion};

impl TripDriver {
    /// Learns from logs that know the speed limit. Vehicles ahead are part of it: who predicts from the road
    /// alone does not know them either.
    ///
    /// What the logs do not show has fallbacks: without steady driving the limit is driven, for laws see [`super::AccelerationLaw`]
    /// and [`super::BrakingLaw`]. A dozen trips of 10 min are enough.
    ///
    /// # Errors
    /// [`Error::NoLimits`] for a log without limits, or with limits for less than half of the time; [`Error::Fit`] without logs.
    pub fn fit(motions: &[&Motion]) -> Result<Self, Error> {
        let recordings = motions
            .iter()
            .map(|motion| RecordedTrip::of(motion))
            .collect::<Result<Vec<_>, _>>()?;
        Self::fit_recorded(&recordings.iter().collect::<Vec<_>>())
    }

    /// Learns from the logs of which it can, with the driver's [`Style`](super::Style) of trips kept back, and says which it cannot use and
    /// why.
    ///
    /// # Errors
    /// [`Error::NothingUsable`] where there is no such log.
    pub fn fit_usable(motions: &[&Motion]) -> Result<(Self, Vec<LeftOut>), Error> {
        let (mut recordings, mut left_out) = (Vec::new(), Vec::new());
        for motion in motions {
            match RecordedTrip::of(motion) {
                Ok(recording) => recordings.push(recording),
                Err(reason) => left_out.push(LeftOut::new(motion.name(), reason.to_string())),
            }
        }
        if recordings.is_empty() {
            let task = "whole trips from the road";
            return Err(Error::NothingUsable { task, left_out });
        }
        let recordings: Vec<&RecordedTrip> = recordings.iter().collect();
        let driver = Self::fit_recorded(&recordings)?.with_style_of(&recordings)?;
        Ok((driver, left_out))
    }

    /// Learns from trips as [`fit`](Self::fit) does from logs.
    ///
    /// # Errors
    /// [`Error::Fit`] without a trip.
    pub fn fit_recorded(recordings: &[&RecordedTrip]) -> Result<Self, Error> {
        Self::fit_without_unrest(recordings)?.with_unrest_of(recordings)
    }

    pub(super) fn fit_without_unrest(recordings: &[&RecordedTrip]) -> Result<Self, Error> {
        if recordings.is_empty() {
            return Err(Error::Fit {
                model: "trip driver",
                reason: "no log to learn from; add logs with speed limits".to_owned(),
            });
        }
        let wanted = WantedSpeed::fit(recordings);
        let (acceleration, braking) = laws(recordings, &wanted);
        Self::new(wanted, acceleration, braking, Slowdowns::fit(recordings))
    }
}
