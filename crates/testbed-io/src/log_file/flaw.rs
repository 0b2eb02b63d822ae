//! What can be wrong with a file.

use super::limits::MAX_BYTES;

pub(super) const DAMAGED: &str = "copy the file again, or log the run again";

/// What is wrong with a file.
pub(super) struct Flaw {
    pub(super) place: String,
    pub(super) found: String,
    pub(super) help: &'static str,
}

impl Flaw {
    /// Of the file as a whole.
    pub(super) fn new(found: impl Into<String>, help: &'static str) -> Flaw {
        Flaw {
            place: String::new(),
            found: found.into(),
            help,
        }
    }

    pub(super) fn at(place: String, found: impl Into<String>, help: &'static str) -> Flaw {
        Flaw {
            place,
            ..Flaw::new(found, help)
        }
    }

    pub(super) fn too_large() -> Flaw {
        Flaw::new(
            format!("more than {MAX_BYTES} bytes of values"),
            "split the run log",
        )
    }
}

/// The beginning of a text from a file, for messages.
pub(super) fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}
