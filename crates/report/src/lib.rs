//! Documents as HTML pages that need nothing but themselves.
//!
//! A page is plain HTML, CSS and JavaScript from `web/`, with the JSON document of a command inside; its own script draws tables and
//! charts from that. It reaches for nothing outside, works from a file, and says which keys a document lacks. [`picture`] draws speeds
//! as SVG without a document, [`terminal`] tables and speeds as text, and [`require`] holds figures of a document against thresholds.
//!
//! ```
//! let document = serde_json::json!({ "schema": "drivekit/energy/1", "trips": [] });
//! let page = report::ENERGY.filled(&document);
//! assert!(page.starts_with("<!DOCTYPE html>"));
//! ```

mod live;
mod pages;
pub mod picture;
pub mod require;
pub mod terminal;

use serde_json::Value;

pub use live::live;
pub use pages::{
    CALIBRATION, CAMPAIGN, CONTROL, ENERGY, EVALUATION, PLAN, PORTRAIT, SEGMENTATION, TRAJECTORY,
};

/// What one kind of page adds to the frame that all share.
#[derive(Debug)]
pub struct Page {
    pub(crate) command: &'static str,
    pub(crate) title: &'static str,
    /// Sections by id and name, those of the frame left out.
    pub(crate) contents: &'static [(&'static str, &'static str)],
    pub(crate) sections: &'static str,
    pub(crate) script: &'static str,
}

impl Page {
    /// The page for a document, drawn by its own script from the document inside it. Keys that the document lacks are named
    /// on the page.
    #[must_use]
    pub fn filled(&self, document: &Value) -> String {
        let link = |(id, label): &(&str, &str)| format!("    <a href=\"#{id}\">{label}</a>\n");
        format!(
            include_str!("../web/page.html"),
            command = self.command,
            title = self.title,
            contents = self.contents.iter().map(link).collect::<String>(),
            sections = self.sections,
            style = include_str!("../web/report.css"),
            script = self.script,
            document = script_safe_json(document),
        )
    }
}

/// JSON that cannot end the `<script>` element it stands in, nor open a comment. The characters replaced occur in JSON inside
/// strings only, so the parsed document stays the same.
fn script_safe_json(document: &Value) -> String {
    let json = document.to_string();
    let mut safe = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '<' => safe.push_str("\\u003c"),
            '>' => safe.push_str("\\u003e"),
            '&' => safe.push_str("\\u0026"),
            '\u{2028}' => safe.push_str("\\u2028"),
            '\u{2029}' => safe.push_str("\\u2029"),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use serde_json::json;

    use super::*;

    const DATA_START: &str = r#"<script id="document" type="application/json">"#;

    const PAGES: [Page; 9] = [
        EVALUATION,
        SEGMENTATION,
        ENERGY,
        CALIBRATION,
        PORTRAIT,
        TRAJECTORY,
        CONTROL,
        CAMPAIGN,
        PLAN,
    ];

    /// What a browser takes for the content of the data element.
    fn embedded(page: &str) -> &str {
        let (_, rest) = page.split_once(DATA_START).unwrap();
        rest.split_once("</script").unwrap().0
    }

    #[test]
    fn hostile_text_stays_data() {
        let trip = "</script><img src=x onerror=alert(1)><!--<script>&amp;\u{2028}\u{2029}\"\\";
        let document = json!({ "phases": [{ "trip": trip }], trip: { "{style}": "{script}" } });
        for page in PAGES.map(|page| page.filled(&document)) {
            assert!(!page.contains("<img"));
            let data = embedded(&page);
            assert!(!data.contains(['<', '>', '&', '\u{2028}', '\u{2029}']));
            assert_eq!(serde_json::from_str::<Value>(data).unwrap(), document);
        }
    }

    #[test]
    fn the_document_survives_unchanged() {
        let document = json!({ "schema": "drivekit/evaluate/1", "models": { "profile": { "rmse_mps": 0.1 + 0.2, "in_band_pct": null } },
            "phases": [{ "group": "0–50 → 50–100", "measured_mps": [0.0, 1e-300, -3] }] });
        assert_eq!(
            serde_json::from_str::<Value>(embedded(&EVALUATION.filled(&document))).unwrap(),
            document
        );
    }

    #[test]
    fn any_value_gives_a_whole_page() {
        for document in [
            json!({}),
            json!(null),
            json!([1, 2]),
            json!("text"),
            json!({ "models": 3, "phases": { "0": null } }),
            json!({ "totals": [null, { "budget": 1 }], "logs": { "curve": [] } }),
            json!({ "parameters": [[], { "ci95": "all" }], "correlation": { "keys": 2 } }),
            json!({ "figures": { "time_s": "all", "robots": [null] }, "events": [0] }),
            json!({ "plans": [{ "nodes": { "position_m": [0, "x"] } }], "frontier": 3, "own": [] }),
            json!({ "totals": 0, "histograms": [{ "headway_mm": [] }], "violations": "none" }),
        ] {
            for page in PAGES.map(|page| page.filled(&document)) {
                assert!(
                    page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>")
                );
            }
        }
    }

    #[test]
    fn sections_are_present_in_order() {
        let evaluation = [
            "headline",
            "models",
            "comparison",
            "picker",
            "energy",
            "energy-difference",
            "band",
            "squared-error",
            "curves",
            "bands",
            "fits",
            "systems",
            "braking",
            "cruise",
            "following",
            "learning",
            "groups",
            "trips",
            "findings",
            "provenance",
        ];
        let segmentation = ["headline", "table", "figures", "findings", "provenance"];
        let energy = [
            "headline",
            "flow",
            "power",
            "trips",
            "vehicles",
            "findings",
            "provenance",
        ];
        let calibration = [
            "headline",
            "summary",
            "parameters",
            "sensitivity",
            "correlation",
            "trips",
            "residuals",
            "findings",
            "provenance",
        ];
        let portrait = [
            "headline",
            "pace",
            "limits",
            "headway",
            "smoothness",
            "findings",
            "provenance",
        ];
        let control = [
            "headline",
            "view",
            "barriers",
            "lyapunov",
            "path",
            "programme",
            "loop",
            "findings",
            "provenance",
        ];
        let campaign = [
            "headline",
            "totals",
            "margins",
            "scenarios",
            "violations",
            "findings",
            "provenance",
        ];
        let plan = [
            "headline",
            "road",
            "frontier",
            "plans",
            "savings",
            "budget",
            "assumed",
            "findings",
            "provenance",
        ];
        for (page, sections) in [
            (PLAN.filled(&json!({})), &plan[..]),
            (EVALUATION.filled(&json!({})), &evaluation),
            (SEGMENTATION.filled(&json!({})), &segmentation),
            (ENERGY.filled(&json!({})), &energy),
            (CALIBRATION.filled(&json!({})), &calibration),
            (PORTRAIT.filled(&json!({})), &portrait),
            (CONTROL.filled(&json!({})), &control),
            (CAMPAIGN.filled(&json!({})), &campaign),
        ] {
            let place = |id: &&str| {
                page.find(&format!("id=\"{id}\""))
                    .unwrap_or_else(|| panic!("no {id}"))
            };
            let places: Vec<usize> = sections.iter().map(place).collect();
            assert!(places.is_sorted(), "{places:?}");
        }
    }

    #[test]
    fn the_page_reaches_for_nothing_outside() {
        for page in PAGES.map(|page| page.filled(&json!({}))) {
            assert!(page.contains("default-src 'none'"));
            let without_namespace = page.replace("http://www.w3.org/2000/svg", "");
            for external in [
                "http:",
                "https:",
                "//cdn",
                "@import",
                "url(",
                "fetch(",
                "XMLHttpRequest",
                "<link rel=\"stylesheet\"",
                "innerHTML",
            ] {
                assert!(!without_namespace.contains(external), "{external}");
            }
        }
    }
}
