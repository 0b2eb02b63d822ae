//! A minute with two Khepera under OptiTrack.

use std::sync::atomic::Ordering;

use testbed_io::live::Ending;
use testbed_io::live::natnet::Version;

use super::testbed::KheperaTestbed;

fn a_minute(version: Version) {
    let testbed = KheperaTestbed::start(version, 60.0);
    let (ticks, summary, report) = testbed.run(|_| {});
    assert_eq!(report.ending, Ending::Finished);
    assert!(report.untold.is_empty());
    assert!(testbed.world.stands());
    let least = testbed.world.least();
    println!("{version}: {least:?}");
    assert!(least.headway_m >= 0.0 && least.lane_clearance_m >= 0.0);
    assert_eq!(summary.safe, Some(true));
    // Slow from the start of the tracker-off time on, it would not be a test.
    assert!(summary.mean_speed_mps > 0.1, "{}", summary.mean_speed_mps);
    let steps = ticks.len() / 2;
    println!("missed {} of {steps}", report.deadlines.missed);
    assert!(report.deadlines.missed as f64 <= 0.005 * steps as f64);
    let requests = testbed.robots.wireless.requests.load(Ordering::Relaxed);
    assert_eq!(report.commands.sent, requests);
    assert!(report.commands.sent >= 2 * steps as u64);
    assert_eq!(report.commands.failed, 0);
}

#[test]
fn a_minute_with_natnet_4_1() {
    a_minute(Version::new(4, 1));
}

#[test]
fn a_minute_with_natnet_2_9() {
    a_minute(Version::new(2, 9));
}
