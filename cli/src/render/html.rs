//! Documents as HTML pages that need nothing but themselves.

use serde_json::Value;

const EVALUATION_SCRIPT: &str = concat!(
    include_str!("report/base.js"),
    include_str!("report/page.js"),
    include_str!("report/tables.js"),
    include_str!("report/data.js"),
    include_str!("report/scores.js"),
    include_str!("report/histograms.js"),
    include_str!("report/curves.js"),
    include_str!("report/main.js"),
);

const SEGMENTATION_SCRIPT: &str = concat!(
    include_str!("report/base.js"),
    include_str!("report/page.js"),
    include_str!("report/tables.js"),
    include_str!("report/segments.js"),
);

/// The page for a document of the schema `drivekit/evaluate/1`: tables, histograms and predicted speed curves, drawn by the
/// page's own script from the document inside it. Keys that the document lacks are named on the page.
#[must_use]
pub(crate) fn evaluation_page(document: &Value) -> String {
    let body = include_str!("report/evaluate.html");
    page("Driver model evaluation", body, EVALUATION_SCRIPT, document)
}

/// The page for a document of the schema `drivekit/segment-compare/1` with its `figures`: Table 3.5 and figures 3.3 to 3.10.
#[must_use]
pub(crate) fn segmentation_page(document: &Value) -> String {
    let body = include_str!("report/segments.html");
    page(
        "Segmentation methods compared",
        body,
        SEGMENTATION_SCRIPT,
        document,
    )
}

fn page(title: &str, body: &str, script: &str, document: &Value) -> String {
    format!(
        include_str!("report/page.html"),
        title = title,
        style = include_str!("report/report.css"),
        body = body,
        script = script,
        document = script_safe_json(document),
    )
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

    /// What a browser takes for the content of the data element.
    fn embedded(page: &str) -> &str {
        let (_, rest) = page.split_once(DATA_START).unwrap();
        rest.split_once("</script").unwrap().0
    }

    #[test]
    fn hostile_text_stays_data() {
        let trip = "</script><img src=x onerror=alert(1)><!--<script>&amp;\u{2028}\u{2029}\"\\";
        let document = json!({ "phases": [{ "trip": trip }], trip: { "{style}": "{script}" } });
        let page = evaluation_page(&document);
        assert!(!page.contains("<img"));
        let data = embedded(&page);
        assert!(!data.contains(['<', '>', '&', '\u{2028}', '\u{2029}']));
        assert_eq!(serde_json::from_str::<Value>(data).unwrap(), document);
    }

    #[test]
    fn the_document_survives_unchanged() {
        let document = json!({ "schema": "drivekit/evaluate/1", "models": { "profile": { "rmse_mps": 0.1 + 0.2, "in_band_pct": null } },
            "phases": [{ "group": "0–50 → 50–100", "measured_mps": [0.0, 1e-300, -3] }] });
        assert_eq!(
            serde_json::from_str::<Value>(embedded(&evaluation_page(&document))).unwrap(),
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
        ] {
            let page = evaluation_page(&document);
            assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
        }
    }

    #[test]
    fn sections_are_present_in_order() {
        let page = evaluation_page(&json!({}));
        let sections = [
            "headline",
            "models",
            "picker",
            "energy",
            "energy-difference",
            "band",
            "squared-error",
            "curves",
            "groups",
            "trips",
            "findings",
            "provenance",
        ];
        let places: Vec<usize> = sections
            .iter()
            .map(|id| {
                page.find(&format!("id=\"{id}\""))
                    .unwrap_or_else(|| panic!("no {id}"))
            })
            .collect();
        assert!(places.is_sorted(), "{places:?}");
    }

    #[test]
    fn the_page_reaches_for_nothing_outside() {
        let page = evaluation_page(&json!({}));
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
