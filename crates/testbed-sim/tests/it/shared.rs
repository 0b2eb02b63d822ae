//! Data beside the project, which not every machine has.

use std::path::{Path, PathBuf};

/// A file or folder beside the project; none where it is not there, which is then said and, with `DRIVEKIT_REQUIRE_SHARED` set, fails.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared")
        .join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: {} is not there", path.display());
    let is_required = std::env::var_os("DRIVEKIT_REQUIRE_SHARED").is_some();
    assert!(!is_required, "DRIVEKIT_REQUIRE_SHARED is set");
    None
}
