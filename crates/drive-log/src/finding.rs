//! What is wrong with a recording.

use std::fmt;

use serde::Serialize;

use crate::Channel;

/// Something wrong with a recording, where, and what was done about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What it is.
    pub kind: FindingKind,
    /// Canonical name of the channel, or `time`.
    pub channel: String,
    /// Time of the first sample concerned, s.
    pub from_s: f64,
    /// Time of the last sample concerned, s.
    pub to_s: f64,
    /// The figures that led to it.
    pub detail: String,
    /// What was done.
    pub action: Action,
}

impl Finding {
    pub(crate) fn of_time(
        kind: FindingKind,
        span_s: (f64, f64),
        action: Action,
        detail: String,
    ) -> Finding {
        Finding {
            kind,
            channel: "time".to_owned(),
            from_s: span_s.0,
            to_s: span_s.1,
            detail,
            action,
        }
    }

    pub(crate) fn of_channel(
        kind: FindingKind,
        channel: Channel,
        span_s: (f64, f64),
        action: Action,
        detail: String,
    ) -> Finding {
        Finding {
            kind,
            channel: channel.name().to_owned(),
            from_s: span_s.0,
            to_s: span_s.1,
            detail,
            action,
        }
    }
}

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FindingKind {
    /// A date that the calendar does not have.
    InvalidDate,
    /// No time.
    MissingTime,
    /// The same time twice.
    RepeatedTime,
    /// Time runs backward.
    BackwardTime,
    /// Rows stamped together that were measured one after the other.
    Batched,
    /// Time without a valid speed, longer than the recording's step.
    TimeGap,
    /// Values that are not there.
    Missing,
    /// Values that the quantity cannot have.
    OutOfRange,
    /// A value that does not change while it must.
    Frozen,
    /// Two recordings joined: a jump that no vehicle makes.
    Splice,
    /// A short excursion that no vehicle makes.
    Spike,
    /// One exact value in isolated pulses: a code, not a measurement.
    Sentinel,
    /// A block of elevation that the road cannot have.
    AltitudeOutlier,
    /// A value that is constant for most of the drive where it cannot be.
    Pinned,
    /// More power than the battery delivers.
    Contradicted,
    /// Values repeated in rows until the sensor gives the next one.
    Held,
    /// Values in coarse steps.
    Quantised,
    /// Values that scatter from one sample to the next.
    Noise,
    /// Discharge recorded as negative current.
    CurrentSign,
    /// A current that is too large, or too small, by the same all along.
    CurrentOffset,
    /// Values at the end of the range of their sensor.
    Clipped,
    /// A straight line where nothing was measured.
    Filled,
    /// Too short to be a drive.
    TooShort,
    /// The file ends in the middle of a row.
    CutOff,
    /// Values in another unit than their header says.
    Unit,
    /// A unit that changes within the recording.
    UnitChange,
    /// A sensor that is late, or early, against the speed.
    Delay,
    /// A sensor that is not mounted along the car, or not level.
    Mounting,
    /// Rows of the file that are none of the log: comments, a header again, a footer.
    NoSample,
    /// Words where numbers are expected.
    NoNumber,
    /// Times in a form that the header does not say, but their values do.
    TimeFormat,
    /// Rows of several vehicles or sensors between each other.
    Interleaved,
    /// A column that is named as one of trips or vehicles, and holds measured values.
    NoDivision,
}

/// What was done about a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Action {
    /// Nothing.
    Kept,
    /// The values were set to missing.
    Removed,
    /// The values were interpolated from their neighbours.
    Interpolated,
    /// The values were smoothed.
    Smoothed,
    /// The drive was cut there.
    Split,
    /// The samples were put in order.
    Sorted,
    /// The samples, or the whole channel, were left out.
    Dropped,
    /// The sign was flipped.
    SignFlipped,
    /// Another channel was taken in its place.
    Replaced,
    /// The values were multiplied by a factor.
    Scaled,
    /// A constant was taken off the values or their times.
    Shifted,
    /// The recording is not used.
    Refused,
    /// The values were read in another form or unit.
    Converted,
}

impl fmt::Display for FindingKind {
    /// In words, such as `altitude outlier`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FindingKind::InvalidDate => "invalid date",
            FindingKind::MissingTime => "missing time",
            FindingKind::RepeatedTime => "repeated time",
            FindingKind::BackwardTime => "backward time",
            FindingKind::Batched => "batched",
            FindingKind::TimeGap => "time gap",
            FindingKind::Missing => "missing",
            FindingKind::OutOfRange => "out of range",
            FindingKind::Frozen => "frozen",
            FindingKind::Splice => "splice",
            FindingKind::Spike => "spike",
            FindingKind::Sentinel => "sentinel",
            FindingKind::AltitudeOutlier => "altitude outlier",
            FindingKind::Pinned => "pinned",
            FindingKind::Contradicted => "contradicted",
            FindingKind::Held => "held",
            FindingKind::Quantised => "quantised",
            FindingKind::Noise => "noise",
            FindingKind::CurrentSign => "current sign",
            FindingKind::CurrentOffset => "current offset",
            FindingKind::Clipped => "clipped",
            FindingKind::Filled => "filled",
            FindingKind::TooShort => "too short",
            FindingKind::CutOff => "cut off",
            FindingKind::Unit => "unit",
            FindingKind::UnitChange => "unit change",
            FindingKind::Delay => "delay",
            FindingKind::Mounting => "mounting",
            FindingKind::NoSample => "no sample",
            FindingKind::NoNumber => "no number",
            FindingKind::TimeFormat => "time format",
            FindingKind::Interleaved => "interleaved",
            FindingKind::NoDivision => "no division",
        })
    }
}

impl fmt::Display for Action {
    /// In words, such as `sign flipped`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Action::Kept => "kept",
            Action::Removed => "removed",
            Action::Interpolated => "interpolated",
            Action::Smoothed => "smoothed",
            Action::Split => "split",
            Action::Sorted => "sorted",
            Action::Dropped => "dropped",
            Action::SignFlipped => "sign flipped",
            Action::Replaced => "replaced",
            Action::Scaled => "scaled",
            Action::Shifted => "shifted",
            Action::Refused => "refused",
            Action::Converted => "converted",
        })
    }
}
