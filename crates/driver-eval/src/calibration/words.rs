//! What a calibration says of itself.

use std::fmt::Write as _;

use ev_energy::calibration::ParameterEstimate;

use super::CalibrationReport;
use crate::words::plural;

impl CalibrationReport {
    /// Which parameters keep their values, in one line; `None` where none does.
    #[must_use]
    pub fn kept(&self) -> Option<String> {
        let keys: Vec<&str> = self.untold().map(|parameter| parameter.key).collect();
        (!keys.is_empty()).then(|| {
            let of = plural(self.parameters.len(), "parameter");
            let (count, keys) = (keys.len(), keys.join(", "));
            format!("not told by these trips, keep their values: {count} of {of}, {keys}")
        })
    }

    /// The head of the vehicle file, of a vehicle that was fitted from `start`: what was not told, and why.
    #[must_use]
    pub fn comments(&self, start: &str) -> String {
        let trips = plural(self.trips.len(), "trip");
        let mut lines = format!("# Calibrated from {start} to {trips}.\n");
        for parameter in self.untold() {
            let ParameterEstimate {
                key,
                start,
                tried,
                remark,
                ..
            } = parameter;
            let tried =
                tried.map_or_else(String::new, |tried| format!(" (a fit made it {tried:.6})"));
            let _ = writeln!(lines, "# {key} is still {start}{tried}; {remark}.");
        }
        for left_out in &self.left_out_drives {
            let (log, reason) = (&left_out.log, &left_out.reason);
            let _ = writeln!(lines, "# {log} is left out: {reason}.");
        }
        lines + "\n"
    }
}
