//! Documents as HTML pages that need nothing but themselves.

use serde_json::Value;

/// What one kind of page adds to the frame that all share.
pub(crate) struct Page {
    command: &'static str,
    title: &'static str,
    /// Sections by id and name, those of the frame left out.
    contents: &'static [(&'static str, &'static str)],
    sections: &'static str,
    script: &'static str,
}

/// For the schema `drivekit/evaluate/1`: tables, histograms, predicted speed curves, and figures 3.12 to 3.18.
pub(crate) const EVALUATION: Page = Page {
    command: "evaluate",
    title: "Driver model evaluation",
    contents: &[
        ("models", "Models"),
        ("comparison", "Comparison"),
        ("figures", "Figures"),
        ("curves", "Curves"),
        ("bands", "Bands"),
        ("fits", "Function fits"),
        ("systems", "System identification"),
        ("braking", "Braking"),
        ("cruise", "Cruise"),
        ("following", "Following"),
        ("learning", "Learning curve"),
        ("groups", "Speed groups"),
        ("trips", "Held-out trips"),
    ],
    sections: include_str!("report/evaluate.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/canvas.js"),
        include_str!("report/chart.js"),
        include_str!("report/data.js"),
        include_str!("report/phases.js"),
        include_str!("report/scores.js"),
        include_str!("report/comparison.js"),
        include_str!("report/histograms.js"),
        include_str!("report/curves.js"),
        include_str!("report/bands.js"),
        include_str!("report/reliability.js"),
        include_str!("report/fits.js"),
        include_str!("report/systems.js"),
        include_str!("report/squares.js"),
        include_str!("report/braking.js"),
        include_str!("report/driving.js"),
        include_str!("report/learning.js"),
        include_str!("report/main.js"),
    ),
};

/// For the schema `drivekit/segment-compare/1` with its `figures`: Table 3.5 and figures 3.3 to 3.10.
pub(crate) const SEGMENTATION: Page = Page {
    command: "segment --compare",
    title: "Segmentation methods compared",
    contents: &[("table", "Table 3.5"), ("figures", "Figures 3.3 to 3.10")],
    sections: include_str!("report/segments.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/segments.js"),
    ),
};

/// For the schema `drivekit/energy/1`: the flow of energy, power over time, trips and vehicles.
pub(crate) const ENERGY: Page = Page {
    command: "energy",
    title: "Where the energy went",
    contents: &[
        ("flow", "Energy flow"),
        ("power", "Power"),
        ("trips", "Trips"),
        ("vehicles", "Vehicles"),
    ],
    sections: include_str!("report/energy.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/canvas.js"),
        include_str!("report/sankey.js"),
        include_str!("report/flow.js"),
        include_str!("report/power.js"),
        include_str!("report/energy.js"),
    ),
};

/// For the schema `drivekit/calibrate/1`: parameters with their intervals, errors by trip and residuals.
pub(crate) const CALIBRATION: Page = Page {
    command: "calibrate",
    title: "Vehicle calibrated to measured power",
    contents: &[
        ("summary", "Before and after"),
        ("parameters", "Parameters"),
        ("sensitivity", "Sensitivity"),
        ("correlation", "Correlation"),
        ("trips", "Trips"),
        ("residuals", "Residuals"),
    ],
    sections: include_str!("report/calibrate.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/parameters.js"),
        include_str!("report/residuals.js"),
        include_str!("report/calibrate.js"),
    ),
};

/// For the schema `drivekit/portrait/1`: a driver in sentences and pictures.
pub(crate) const PORTRAIT: Page = Page {
    command: "portrait",
    title: "Portrait of a driver",
    contents: &[
        ("pace", "Acceleration and braking"),
        ("limits", "Limits"),
        ("headway", "Following"),
        ("smoothness", "Smoothness and energy"),
    ],
    sections: include_str!("report/portrait.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/chart.js"),
        include_str!("report/portrait-charts.js"),
        include_str!("report/portrait.js"),
    ),
};

/// For the schema `drivekit/evaluate/1` of the trajectory task: errors by horizon, Table 4.1 and figures 4.4 to 4.11.
pub(crate) const TRAJECTORY: Page = Page {
    command: "evaluate --task trajectory",
    title: "Speed ahead",
    contents: &[
        ("horizons", "Horizons"),
        ("trials", "Table 4.1"),
        ("figures", "Figures 4.4 to 4.11"),
        ("free-run", "Free run"),
    ],
    sections: include_str!("report/trajectory.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/chart.js"),
        include_str!("report/trajectory-horizons.js"),
        include_str!("report/trajectory-speed.js"),
        include_str!("report/trajectory-figures.js"),
        include_str!("report/trajectory-free-run.js"),
        include_str!("report/trajectory.js"),
    ),
};

/// For the schema `drivekit/ctrl-run/1`: the run played, barriers, Lyapunov functions, ways, steps and their time.
pub(crate) const CONTROL: Page = Page {
    command: "ctrl run",
    title: "Robots in a lane",
    contents: &[
        ("view", "The run"),
        ("barriers", "Barriers"),
        ("lyapunov", "Lyapunov functions"),
        ("path", "Ways driven"),
        ("programme", "Quadratic program"),
        ("loop", "Control loop"),
    ],
    sections: include_str!("report/ctrl.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/canvas.js"),
        include_str!("report/chart.js"),
        include_str!("report/ctrl-data.js"),
        include_str!("report/ctrl-scene.js"),
        include_str!("report/ctrl-view.js"),
        include_str!("report/ctrl-charts.js"),
        include_str!("report/ctrl-barriers.js"),
        include_str!("report/ctrl-path.js"),
        include_str!("report/ctrl-programme.js"),
        include_str!("report/ctrl.js"),
    ),
};

/// For the schema `drivekit/ctrl-campaign/1`: unsafe runs, margins, scenarios and violations.
pub(crate) const CAMPAIGN: Page = Page {
    command: "ctrl campaign",
    title: "Campaign of runs",
    contents: &[
        ("totals", "Unsafe runs"),
        ("margins", "Margins"),
        ("scenarios", "Scenarios"),
        ("violations", "Violations"),
    ],
    sections: include_str!("report/campaign.html"),
    script: concat!(
        include_str!("report/base.js"),
        include_str!("report/page.js"),
        include_str!("report/tables.js"),
        include_str!("report/chart.js"),
        include_str!("report/campaign.js"),
    ),
};

impl Page {
    /// The page for a document, drawn by its own script from the document inside it. Keys that the document lacks are named
    /// on the page.
    #[must_use]
    pub(crate) fn filled(&self, document: &Value) -> String {
        let link = |(id, label): &(&str, &str)| format!("    <a href=\"#{id}\">{label}</a>\n");
        format!(
            include_str!("report/page.html"),
            command = self.command,
            title = self.title,
            contents = self.contents.iter().map(link).collect::<String>(),
            sections = self.sections,
            style = include_str!("report/report.css"),
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
    use super::*;
    use serde_json::json;

    const DATA_START: &str = r#"<script id="document" type="application/json">"#;

    const PAGES: [Page; 8] = [
        EVALUATION,
        SEGMENTATION,
        ENERGY,
        CALIBRATION,
        PORTRAIT,
        TRAJECTORY,
        CONTROL,
        CAMPAIGN,
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
        for (page, sections) in [
            (EVALUATION.filled(&json!({})), &evaluation[..]),
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
