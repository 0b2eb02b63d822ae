//! How large a run log may be.

/// The most that is read into memory, in bytes, as a file and after decompression.
pub(super) const MAX_BYTES: u64 = 1 << 30;

pub(super) const MAX_COLUMNS: usize = 10_000;
