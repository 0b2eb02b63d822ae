//! The page of a running session.

const LIVE_SCRIPT: &str = concat!(
    include_str!("../web/base.js"),
    include_str!("../web/page.js"),
    include_str!("../web/tables.js"),
    include_str!("../web/canvas.js"),
    include_str!("../web/chart.js"),
    include_str!("../web/ctrl-data.js"),
    include_str!("../web/ctrl-scene.js"),
    include_str!("../web/ctrl-charts.js"),
    include_str!("../web/live-cards.js"),
    include_str!("../web/live-scene.js"),
    include_str!("../web/live.js"),
);
const LIVE_STYLE: &str = concat!(
    include_str!("../web/report.css"),
    include_str!("../web/live.css"),
);

/// The page of a running session, which needs nothing but itself and its events; `nonce` is that by which its own style and
/// script are known.
#[must_use]
pub fn live(nonce: &str) -> String {
    format!(
        include_str!("../web/live.html"),
        nonce = nonce,
        style = LIVE_STYLE,
        script = LIVE_SCRIPT,
    )
}
