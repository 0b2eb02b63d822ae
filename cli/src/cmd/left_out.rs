//! Drives that lack what something needs, while the others go on without them.

use driver_model::{LeftOut, Trip};

use crate::flags::Context;
use crate::output;
use crate::words::{listed, plural};

/// One line for every reason, with the drives that it is about.
pub(crate) fn mention(left_out: &[LeftOut], context: &Context) {
    let mut reasons: Vec<&str> = Vec::new();
    for LeftOut { reason, .. } in left_out {
        if !reasons.contains(&reason.as_str()) {
            reasons.push(reason);
        }
    }
    for reason in reasons {
        let drives = left_out.iter().filter(|left_out| left_out.reason == reason);
        let names: Vec<&str> = drives.map(|left_out| left_out.log.as_str()).collect();
        output::note(context, &format!("left out, {reason}: {}", listed(&names)));
    }
}

/// The drives of which nothing counts, with the reason.
pub(crate) fn without(
    trips: &[Trip],
    counts: impl Fn(&Trip) -> bool,
    reason: &str,
) -> Vec<LeftOut> {
    let left_out = |trip: &Trip| LeftOut {
        log: trip.name.clone(),
        reason: reason.to_owned(),
    };
    trips
        .iter()
        .filter(|trip| !counts(trip))
        .map(left_out)
        .collect()
}

/// What every drive has, a line each, for the error that it is not enough.
pub(crate) fn contents_of(trips: &[Trip]) -> String {
    let line = |trip: &Trip| format!("\n  {}: {}", trip.name, contents(trip));
    trips.iter().map(line).collect()
}

/// What a drive has that models learn from.
pub(crate) fn contents(trip: &Trip) -> String {
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
