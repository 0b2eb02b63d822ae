//! From a recording to drives.

use std::collections::BTreeMap;

use crate::log::positive;
use crate::resample::{drives, uniform};
use crate::statistics::median_step_s;
use crate::{Action, DriveLog, Error, Finding, Preparation, RawLog, check};

/// What a recording became.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Drive {
    /// Name of the recording.
    pub name: String,
    /// What the file says of the whole recording, see [`RawLog::origin`].
    pub origin: BTreeMap<String, String>,
    /// The drives, at least one; several where the recording was cut.
    pub pieces: Vec<DriveLog>,
    /// What is wrong with the recording and what was done about it, in the order of time.
    pub findings: Vec<Finding>,
    /// Samples of the recording.
    pub samples: usize,
    /// Median step of the recording, s.
    pub step_s: f64,
}

/// Checks a recording, cuts it where it has no valid speed for longer than
/// [`Preparation::max_gap_s`], resamples each piece to the grid `t_i = t0 + i·step` and smooths its
/// speed.
///
/// The grid of a piece starts at its first valid sample. Values between samples are interpolated
/// linearly, except the speed limit, which holds. A sample within 10⁻⁶ steps of a grid point is
/// taken over exactly, so a log that is on the grid already passes unchanged.
///
/// # Errors
/// [`Error::Option`] for options without meaning, [`Error::Refused`] for a recording that cannot be
/// true and does not say what it means, [`Error::NoPiece`] if no two valid samples are
/// close enough, [`Error::TooManySamples`] for a grid that does not fit into memory; with `raw`,
/// [`Error::NotUniform`].
pub fn prepare(log: RawLog, options: &Preparation) -> Result<Drive, Error> {
    positive("step_s", options.step_s)?;
    positive("max_gap_s", options.max_gap_s)?;
    let (name, origin, samples) = (log.name().to_owned(), log.origin().clone(), log.len());
    if options.raw {
        let (findings, step_s) = (log.findings.clone(), median_step_s(log.time_s()));
        return Ok(Drive {
            name,
            origin,
            pieces: vec![uniform(log, options.step_s)?],
            findings,
            samples,
            step_s,
        });
    }
    let checked = check(log);
    if let Some(finding) = checked
        .findings
        .iter()
        .find(|f| f.action == Action::Refused)
    {
        return Err(Error::Refused {
            log: name,
            channel: finding.channel.clone(),
            found: finding.detail.clone(),
        });
    }
    let step_s = median_step_s(checked.log.time_s());
    let (pieces, findings) = drives(checked, options)?;
    Ok(Drive {
        name,
        origin,
        pieces,
        findings,
        samples,
        step_s,
    })
}
