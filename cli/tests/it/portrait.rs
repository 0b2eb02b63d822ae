//! A page about a driver.

use std::fs;

use tempfile::TempDir;

use crate::program::{drivekit, fixture, shared};

#[test]
fn a_driver_is_described_in_sentences_figures_and_a_page() {
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("portrait.html");
    let drives = fixture("drives");
    let text = drivekit(&["portrait", &drives, "--report", page.to_str().unwrap()])
        .ok()
        .stdout;
    for words in [
        "12 drives",
        "Accelerates with",
        "Brakes with",
        "over a limit of 50",
        "Follows at",
        "kWh per 100 km",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("Accelerates with") && !page.contains("src=\"http"));
}

#[test]
fn what_a_log_does_not_tell_is_null_and_not_said() {
    let Some(log) = shared("data/bmw-i3/TripA01.csv") else {
        return;
    };
    let document = drivekit(&["portrait", log.to_str().unwrap(), "--format", "json"])
        .ok()
        .json();
    assert!(document["driver"]["headway"].is_null());
    assert_eq!(document["driver"]["limits"].as_array().unwrap().len(), 0);
    assert!(document["fleet"].is_null());
    let sentences = document["sentences"].to_string();
    assert!(!sentences.contains("limit") && !sentences.contains("Follows"));
    assert!(!sentences.contains("NaN"));
}

#[test]
fn beside_a_fleet_the_sentences_compare() {
    let own = fixture("drives/drive-01.csv");
    let fleet = fixture("drives");
    let document = drivekit(&["portrait", &own, "--fleet", &fleet, "--format", "json"])
        .ok()
        .json();
    assert_eq!(document["fleet"]["drives"], 12);
    assert!(document["sentences"].to_string().contains("the fleet"));
}
