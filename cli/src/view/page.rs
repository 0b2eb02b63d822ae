//! The page, which needs nothing but itself and its events.

const SCRIPT: &str = concat!(
    include_str!("../render/report/base.js"),
    include_str!("../render/report/page.js"),
    include_str!("../render/report/tables.js"),
    include_str!("../render/report/canvas.js"),
    include_str!("../render/report/chart.js"),
    include_str!("../render/report/ctrl-data.js"),
    include_str!("../render/report/ctrl-scene.js"),
    include_str!("../render/report/ctrl-charts.js"),
    include_str!("../render/report/live-cards.js"),
    include_str!("../render/report/live-scene.js"),
    include_str!("../render/report/live.js"),
);
const STYLE: &str = concat!(
    include_str!("../render/report/report.css"),
    include_str!("../render/report/live.css"),
);

/// The page with the nonce by which its own style and script are known.
pub(super) fn html(nonce: &str) -> String {
    format!(
        include_str!("../render/report/live.html"),
        nonce = nonce,
        style = STYLE,
        script = SCRIPT,
    )
}
