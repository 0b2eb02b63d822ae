/// One sample, a step after the one before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Time on the recording's own clock, s.
    pub time_s: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Distance to a vehicle ahead, m; NaN where there is none.
    pub lead_gap_m: f64,
    /// What else the reader was asked for, in the order of [`RowReader::told`](crate::RowReader::told); NaN where missing.
    pub told: Vec<f64>,
    /// The first sample of a piece: of the stream, after a gap, or after the clock was set back.
    pub starts_piece: bool,
}
