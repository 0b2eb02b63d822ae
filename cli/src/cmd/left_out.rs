//! Drives that lack what something needs, while the others go on without them.

use driver_model::LeftOut;

use crate::flags::Context;
use crate::output;
use crate::words::listed;

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
