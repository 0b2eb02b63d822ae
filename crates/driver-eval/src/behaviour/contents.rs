//! What drives have that models learn from.

use driver_model::{DriveBehaviour, LeftOut};

use crate::words::plural;

/// Drives without a phase or stretch that counts.
pub(super) fn without_anything(trips: &[DriveBehaviour]) -> Vec<LeftOut> {
    let empty = |trip: &&DriveBehaviour| {
        trip.phases.is_empty() && trip.cruise.is_empty() && trip.following.is_empty()
    };
    let left_out = |trip: &DriveBehaviour| LeftOut::new(&trip.name, contents(trip));
    trips.iter().filter(empty).map(left_out).collect()
}

/// What every drive has, a line each, for the error that it is not enough.
#[must_use]
pub fn contents_of(trips: &[DriveBehaviour]) -> String {
    let line = |trip: &DriveBehaviour| format!("\n  {}: {}", trip.name, contents(trip));
    trips.iter().map(line).collect()
}

/// What a drive has, in words.
#[must_use]
pub fn contents(trip: &DriveBehaviour) -> String {
    let behind = trip.lead_influenced;
    let mut has: Vec<String> = [
        (trip.phases.len(), "phase"),
        (
            behind.acceleration + behind.braking,
            "phase under a leader's influence",
        ),
        (trip.cruise.len(), "stretch of cruising"),
        (trip.following.len(), "stretch behind a vehicle"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| plural(count, what))
    .collect();
    if has.is_empty() {
        has.push("no phase or stretch that counts".to_owned());
    }
    has.join(", ")
}
