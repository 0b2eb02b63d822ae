//! The simulated drives that ship inside the binary.

use std::path::Path;

/// A drive as canonical CSV.
pub(crate) struct EmbeddedDrive {
    pub(crate) name: &'static str,
    bytes: &'static [u8],
}

macro_rules! drives {
    ($($name:literal),*) => {
        [$(EmbeddedDrive {
            name: concat!($name, ".csv"),
            bytes: include_bytes!(concat!("../../fixtures/drives/", $name, ".csv")),
        }),*]
    };
}

/// Twelve drives of one simulated driver, `fixtures/drives` in the repository.
pub(crate) const EMBEDDED: [EmbeddedDrive; 12] = drives![
    "drive-01", "drive-02", "drive-03", "drive-04", "drive-05", "drive-06", "drive-07", "drive-08",
    "drive-09", "drive-10", "drive-11", "drive-12"
];

impl EmbeddedDrive {
    pub(crate) fn path(&self) -> &Path {
        Path::new(self.name)
    }

    pub(crate) fn bytes(&self) -> &'static [u8] {
        self.bytes
    }
}
