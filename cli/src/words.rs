//! Numbers and lists in sentences.

pub(crate) use driver_eval::words::{listed, plural};
