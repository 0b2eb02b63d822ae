//! Samples on a grid, while they come.

use super::row::Row;
use crate::quality::time::MAX_LATE;
use crate::resample::ON_GRID;

/// A row as it came.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) time_s: f64,
    pub(super) speed_mps: f64,
    pub(super) lead_gap_m: f64,
    pub(super) told: Vec<f64>,
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
    /// Whether a value stays until the next row, of each that is told.
    holds: Vec<bool>,
}

impl Regular {
    pub(super) fn new(step_s: f64, max_gap_s: f64) -> Self {
        Self {
            step_s,
            max_gap_s,
            piece: None,
            coming: None,
            late: 0,
            holds: Vec::new(),
        }
    }

    pub(super) fn holding(self, holds: Vec<bool>) -> Self {
        Self { holds, ..self }
    }

    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// The newest sample that was taken.
    pub(super) fn newest(&self) -> Option<&Sample> {
        let newest = self.piece.as_ref().map(|piece| &piece.newest);
        self.coming.as_ref().or(newest)
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
        let piece = self.piece.as_mut()?;
        let coming_s = self.coming.as_ref()?.time_s;
        let near_s = ON_GRID * self.step_s;
        let time_s = piece.start_s + piece.out as f64 * self.step_s;
        if time_s > coming_s + near_s {
            piece.newest = self.coming.take()?;
            return None;
        }
        let (newest, coming) = (&piece.newest, self.coming.as_ref()?);
        let share = if time_s <= newest.time_s + near_s {
            0.0
        } else if time_s >= coming.time_s - near_s {
            1.0
        } else {
            (time_s - newest.time_s) / (coming.time_s - newest.time_s)
        };
        let between = |from: f64, to: f64| match share {
            0.0 => from,
            1.0 => to,
            share => from + (to - from) * share,
        };
        let pairs = newest.told.iter().zip(&coming.told).zip(&self.holds);
        let told = pairs.map(|((from, to), holds)| match holds {
            true if share < 1.0 => *from,
            _ => between(*from, *to),
        });
        piece.out += 1;
        Some(Row {
            time_s,
            speed_mps: between(newest.speed_mps, coming.speed_mps),
            lead_gap_m: between(newest.lead_gap_m, coming.lead_gap_m),
            told: told.collect(),
            starts_piece: piece.out == 1,
        })
    }
}
