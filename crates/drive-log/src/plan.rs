//! What to read from a file, and what it becomes.

use crate::Channel;
use crate::stamp::DateOrder;
use crate::unit::Unit;

/// The columns of a file, and what they become.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    pub(crate) time: TimeColumns,
    pub(crate) logs: Vec<LogPlan>,
    /// The columns whose values divide the file into drives; `None` for those that are named so.
    pub(crate) split_by: Option<Vec<usize>>,
    /// Words for missing values, besides those that always are.
    pub(crate) missing: Vec<String>,
    /// The order of dates such as `03/04/2026`.
    pub(crate) date_order: Option<DateOrder>,
}

impl Plan {
    pub(crate) fn new(time: TimeColumns, logs: Vec<LogPlan>) -> Plan {
        Plan {
            time,
            logs,
            split_by: None,
            missing: Vec::new(),
            date_order: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TimeColumns {
    Number {
        column: usize,
        unit: Unit,
    },
    /// Dates or clocks as text, or numbers that tell their unit.
    Open {
        column: usize,
    },
    DateAndClock {
        date: usize,
        clock: usize,
    },
}

/// One log of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LogPlan {
    /// What follows `#` in the log's name, where a file holds several logs.
    pub(crate) part: Option<String>,
    pub(crate) columns: Vec<ChannelColumn>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChannelColumn {
    pub(crate) channel: Channel,
    pub(crate) column: usize,
    pub(crate) unit: Unit,
    pub(crate) sign: f64,
}

impl ChannelColumn {
    pub(crate) fn new(channel: Channel, column: usize, unit: Unit) -> ChannelColumn {
        ChannelColumn {
            channel,
            column,
            unit,
            sign: 1.0,
        }
    }
}
