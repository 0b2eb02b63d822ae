//! Samples on a grid, while they come.

use super::row::Row;
use crate::quality::time::MAX_LATE;
use crate::resample::ON_GRID;

/// A row as it came.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) time_s: f64,
    pub(super) speed_mps: f64,
    pub(super) lead_gap_m: f64,
}

/// What a sample is to those before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    /// The first, or the next of its piece.
    Follows,
    /// Not after the newest one; not taken.
    Late,
    /// The first after a gap, `alone` where the piece before was a single sample.
    Gap { alone: bool },
    /// The first after the clock was set back.
    SetBack { alone: bool },
}

#[derive(Debug, Clone)]
struct Piece {
    start_s: f64,
    /// Grid points that are out.
    out: usize,
    newest: Sample,
}

/// Puts samples on a grid that starts anew with every piece. Nothing is out before the second sample.
#[derive(Debug, Clone)]
pub(super) struct Regular {
    step_s: f64,
    max_gap_s: f64,
    piece: Option<Piece>,
    /// After the newest one of the piece; grid points up to it are not out yet.
    coming: Option<Sample>,
    late: usize,
}

impl Regular {
    pub(super) fn new(step_s: f64, max_gap_s: f64) -> Self {
        Self {
            step_s,
            max_gap_s,
            piece: None,
            coming: None,
            late: 0,
        }
    }

    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// The newest sample that was taken.
    pub(super) fn newest(&self) -> Option<Sample> {
        self.coming
            .or(self.piece.as_ref().map(|piece| piece.newest))
    }

    pub(super) fn newest_s(&self) -> Option<f64> {
        self.piece.as_ref().map(|piece| piece.newest.time_s)
    }

    /// Whether the piece has a single sample, which is not out.
    pub(super) fn is_alone(&self) -> bool {
        self.piece.as_ref().is_some_and(|piece| piece.out == 0)
    }

    /// Takes a sample once [`Regular::next`] has nothing left.
    pub(super) fn arrive(&mut self, sample: Sample) -> Arrival {
        let Some(newest_s) = self.newest_s() else {
            self.start(sample);
            return Arrival::Follows;
        };
        let alone = self.is_alone();
        let after_s = sample.time_s - newest_s;
        if after_s > self.max_gap_s {
            self.start(sample);
            return Arrival::Gap { alone };
        }
        if after_s > 0.0 {
            self.coming = Some(sample);
            self.late = 0;
            return Arrival::Follows;
        }
        let is_set_back = after_s < 0.0 && (-after_s > self.max_gap_s || self.late == MAX_LATE);
        if is_set_back {
            self.start(sample);
            return Arrival::SetBack { alone };
        }
        self.late += usize::from(after_s < 0.0);
        Arrival::Late
    }

    fn start(&mut self, sample: Sample) {
        self.late = 0;
        self.piece = Some(Piece {
            start_s: sample.time_s,
            out: 0,
            newest: sample,
        });
    }

    /// The next sample on the grid that what has come decides.
    pub(super) fn next(&mut self) -> Option<Row> {
        let (piece, coming) = (self.piece.as_mut()?, self.coming?);
        let near_s = ON_GRID * self.step_s;
        let time_s = piece.start_s + piece.out as f64 * self.step_s;
        if time_s > coming.time_s + near_s {
            piece.newest = coming;
            self.coming = None;
            return None;
        }
        let newest = piece.newest;
        let [speed_mps, lead_gap_m] = if time_s <= newest.time_s + near_s {
            [newest.speed_mps, newest.lead_gap_m]
        } else if time_s >= coming.time_s - near_s {
            [coming.speed_mps, coming.lead_gap_m]
        } else {
            let share = (time_s - newest.time_s) / (coming.time_s - newest.time_s);
            let line = |from: f64, to: f64| from + (to - from) * share;
            [
                line(newest.speed_mps, coming.speed_mps),
                line(newest.lead_gap_m, coming.lead_gap_m),
            ]
        };
        piece.out += 1;
        Some(Row {
            time_s,
            speed_mps,
            lead_gap_m,
            starts_piece: piece.out == 1,
        })
    }
}
