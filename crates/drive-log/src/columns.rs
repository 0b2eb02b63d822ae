//! Columns of numbers: which are wanted, and their values.

use crate::Channel;
use crate::note::Note;
use crate::unit::Unit;

/// A column of numbers to read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) column: usize,
    pub(crate) unit: Unit,
    /// The channel; `None` for time. Without time and speed there is no sample: a word is an error
    /// there, and no value elsewhere.
    pub(crate) channel: Option<Channel>,
}

impl Wanted {
    pub(crate) fn is_needed(self) -> bool {
        matches!(self.channel, None | Some(Channel::Speed))
    }
}

/// Values of columns, one vector per column, and what there is to say of them.
pub(crate) type Columns = (Vec<Vec<f64>>, Vec<Note>);
