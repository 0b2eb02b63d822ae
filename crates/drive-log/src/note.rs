//! What reading found, before it is known which log it belongs to.

use crate::{Action, Channel, Finding, FindingKind};

/// Something about rows of a file; each log gets the finding about its own rows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Note {
    pub(crate) kind: FindingKind,
    /// `None` for time.
    pub(crate) channel: Option<Channel>,
    pub(crate) action: Action,
    pub(crate) about: About,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum About {
    /// The whole file, in these words.
    All(String),
    /// Some of its rows, in order: what one and several of them are called, and what follows.
    Rows {
        rows: Vec<usize>,
        names: (&'static str, &'static str),
        rest: String,
    },
}

impl Note {
    pub(crate) fn of_file(kind: FindingKind, action: Action, detail: String) -> Note {
        Note {
            kind,
            channel: None,
            action,
            about: About::All(detail),
        }
    }

    /// The finding about a log, whose rows of the file are `rows` (all if `None`) at the times
    /// `time_s`; `None` if it does not concern them.
    pub(crate) fn finding(&self, rows: Option<&[usize]>, time_s: &[f64]) -> Option<Finding> {
        let last = time_s.len().checked_sub(1)?;
        let (from, to, detail) = match &self.about {
            About::All(detail) => (0, last, detail.clone()),
            About::Rows {
                rows: concerned,
                names: (one, many),
                rest,
            } => {
                let places: Vec<usize> = concerned
                    .iter()
                    .filter_map(|row| match rows {
                        None => (*row <= last).then_some(*row),
                        Some(rows) => rows.binary_search(row).ok().filter(|at| *at <= last),
                    })
                    .collect();
                let count = places.len();
                let name = if count == 1 { one } else { many };
                let detail = format!("{count} {name}{rest}");
                (*places.first()?, *places.last()?, detail)
            }
        };
        let span_s = (time_s[from], time_s[to]);
        Some(match self.channel {
            None => Finding::of_time(self.kind, span_s, self.action, detail),
            Some(channel) => Finding::of_channel(self.kind, channel, span_s, self.action, detail),
        })
    }
}

/// A piece of text for a message: sixty characters at most.
pub(crate) fn excerpt(text: &str) -> String {
    text.chars().take(60).collect()
}
