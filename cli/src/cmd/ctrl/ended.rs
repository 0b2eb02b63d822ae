use testbed_io::LoggedRun;
use testbed_io::live::LiveReport;
use testbed_sim::{Summary, Timing};

/// A run that is over, in simulation or on real robots.
pub(super) struct Ended {
    pub(super) run: LoggedRun,
    pub(super) summary: Summary,
    pub(super) timing: Timing,
    pub(super) live: Option<LiveReport>,
}

impl Ended {
    pub(super) fn doubts(&self) -> &[String] {
        self.live.as_ref().map_or(&[], |live| &live.doubts)
    }
}
