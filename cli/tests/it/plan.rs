//! Speed plans: roads, drives, stated problems, and what cannot be driven.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Run, drivekit_in, fixture, shared};

fn plan(folder: &TempDir, arguments: &[&str]) -> Run {
    drivekit_in(folder.path(), &[&["plan"], arguments].concat())
}

#[test]
fn a_road_is_planned_for_its_arrival_and_the_plan_is_a_log() {
    let folder = TempDir::new().unwrap();
    let road = fixture("roads/town-and-country.toml");
    let run = plan(
        &folder,
        &[
            &road, "--arrive", "300", "-o", "plan.csv", "--format", "json",
        ],
    )
    .ok();
    let document: Value = run.json();
    assert_eq!(document["schema"], "drivekit/plan/1");
    let found = &document["plans"][0];
    assert_eq!(
        (&found["outcome"], &found["bound"]),
        (&"optimal".into(), &"proven".into())
    );
    assert!((found["time_s"].as_f64().unwrap() - 300.0).abs() < 1e-6);
    let energy_j = found["energy_j"].as_f64().unwrap();
    assert!(found["lower_bound_j"].as_f64().unwrap() <= energy_j);
    let sampled_j = found["sampled_energy_j"].as_f64().unwrap();
    assert!(
        (sampled_j - energy_j).abs() < 1e-3 * energy_j,
        "{sampled_j} {energy_j}"
    );
    let window = &found["signals"][0]["window_s"];
    let passage_s = found["signals"][0]["passage_s"].as_f64().unwrap();
    assert!(window[0].as_f64().unwrap() <= passage_s && passage_s <= window[1].as_f64().unwrap());

    let energy = drivekit_in(
        folder.path(),
        &[
            "energy",
            "plan.csv",
            "--vehicle",
            "b250e",
            "--warm-start",
            "--raw",
            "--format",
            "json",
        ],
    )
    .ok()
    .json();
    let modelled_j = energy["logs"][0]["battery_energy_j"].as_f64().unwrap();
    assert!(
        (modelled_j - energy_j).abs() < 2e-3 * energy_j,
        "{modelled_j} {energy_j}"
    );
}

#[test]
fn a_drive_is_planned_in_its_own_time() {
    let folder = TempDir::new().unwrap();
    let drive = fixture("drives/drive-01.csv");
    let run = plan(
        &folder,
        &[&drive, "--vehicle", "bmw-i3-60ah", "--format", "json"],
    )
    .ok();
    let document = run.json();
    let found = &document["plans"][0];
    assert!((found["latest_arrival_s"].as_f64().unwrap() - 599.9).abs() < 1.0);
    assert!(found["gap_pct"].as_f64().unwrap() < 0.01);
}

#[test]
fn what_cannot_be_driven_ends_with_1_and_says_what_could() {
    let folder = TempDir::new().unwrap();
    let road = fixture("roads/town-and-country.toml");
    let run = plan(&folder, &[&road, "--arrive", "100", "--format", "json"]);
    assert_eq!(run.code, 1);
    let document = run.json();
    let obstacle = &document["obstacle"];
    assert_eq!(obstacle["outcome"], "too_late");
    assert!(obstacle["earliest_s"].as_f64().unwrap() > 200.0);
}

#[test]
fn signals_and_a_leader_come_from_files() {
    let folder = TempDir::new().unwrap();
    let road = fixture("roads/town-and-country.toml");
    let lights = r#"[{"position_m": 600, "green_s": [[0, 10], [200, 260]]}]"#;
    fs::write(folder.path().join("lights.json"), lights).unwrap();
    let run = plan(
        &folder,
        &[
            &road,
            "--signals",
            "lights.json",
            "--arrive",
            "480",
            "--format",
            "json",
        ],
    )
    .ok();
    let passage_s = run.json()["plans"][0]["signals"][0]["passage_s"]
        .as_f64()
        .unwrap();
    assert!((201.0..=259.0).contains(&passage_s), "{passage_s}");
    let slow: String = (0..600).map(|t| format!("{t},{}\n", 30 + 8 * t)).collect();
    fs::write(
        folder.path().join("leader.csv"),
        format!("time_s,position_m\n{slow}"),
    )
    .unwrap();
    let run = plan(
        &folder,
        &[
            &road,
            "--leader",
            "leader.csv",
            "--arrive",
            "560",
            "--format",
            "json",
        ],
    )
    .ok();
    let time_s = run.json()["plans"][0]["time_s"].as_f64().unwrap();
    assert!(time_s > 480.0, "{time_s}");
    let backwards = "time_s,position_m\n0,50\n1,40\n";
    fs::write(folder.path().join("leader.csv"), backwards).unwrap();
    let run = plan(&folder, &[&road, "--leader", "leader.csv"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("leader"), "{}", run.stderr);
}

#[test]
fn bad_roads_and_flags_name_what_is_wrong() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("no-limit.toml"), "length_m = 500\n").unwrap();
    fs::write(folder.path().join("one.csv"), "time_s,position_m\n0,30\n").unwrap();
    let road = fixture("roads/town-and-country.toml");
    for (arguments, parts) in [
        (vec!["no-limit.toml"], vec!["limits"]),
        (vec![], vec!["road file", "--case"]),
        (vec![&road, "--case", "x.json"], vec!["--case"]),
        (vec![&road, "--accel", "1,2"], vec!["--accel"]),
        (
            vec![&road, "--layout", "canonical"],
            vec!["--layout", "logs"],
        ),
        (
            vec![&road, "--limit-map", "x.geojson"],
            vec!["--limit-map", "logs"],
        ),
        (
            vec![&road, "--leader", "one.csv"],
            vec!["one.csv", "two times"],
        ),
        (
            vec![&road, "--arrive", "300", "--price", "3"],
            vec!["--arrive", "--price"],
        ),
    ] {
        let run = plan(&folder, &arguments);
        assert_eq!(run.code, 2, "{arguments:?}");
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
        }
    }
}

#[test]
fn a_drive_that_ends_above_the_limit_is_planned_to_end_at_it() {
    let folder = TempDir::new().unwrap();
    let drive = fixture("drives/drive-02.csv");
    let run = plan(&folder, &[&drive, "--format", "json"]).ok();
    let document = run.json();
    let findings = document["findings"].to_string();
    assert!(findings.contains("the plan ends at these"), "{findings}");
    let nodes = &document["plans"][0]["nodes"];
    let last = |name: &str| nodes[name].as_array().unwrap().last().cloned().unwrap();
    assert_eq!(last("speed_mps"), last("limit_mps"));
}

#[test]
fn a_leader_that_stands_is_not_driven_through_and_a_light_is_named_by_its_place() {
    let folder = TempDir::new().unwrap();
    let road = fixture("roads/town-and-country.toml");
    let stands = "time_s,position_m\n0,30\n10,100\n700,100\n";
    fs::write(folder.path().join("leader.csv"), stands).unwrap();
    let run = plan(
        &folder,
        &[
            &road,
            "--leader",
            "leader.csv",
            "--price",
            "3000",
            "--format",
            "json",
        ],
    );
    let document = run.json();
    for plan in document["plans"].as_array().unwrap() {
        assert!(plan["time_s"].as_f64().unwrap() > 700.0);
        assert!(document["findings"].to_string().contains("holds nobody up"));
    }
    let lights = r#"[{"position_m": 600, "green_s": [[0, 5]]}]"#;
    fs::write(folder.path().join("lights.json"), lights).unwrap();
    let run = plan(&folder, &[&road, "--signals", "lights.json"]);
    assert_eq!(run.code, 1);
    assert!(
        run.stdout.contains("the signal at 600.0 m") && run.stdout.contains("red for good"),
        "{}",
        run.stdout
    );
}

#[test]
fn stated_problems_are_planned_on_their_own_grid() {
    let Some(zones) = shared("vectors/planning/zones.json") else {
        return;
    };
    let folder = TempDir::new().unwrap();
    let run = plan(
        &folder,
        &["--case", zones.to_str().unwrap(), "--format", "json"],
    )
    .ok();
    let document = run.json();
    let found = &document["plans"][0];
    assert_eq!(found["nodes"]["position_m"].as_array().unwrap().len(), 117);
    assert!((found["time_s"].as_f64().unwrap() - 230.0).abs() < 1e-5);
    let mut case: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(zones).unwrap()).unwrap();
    case["speeds_mps"] = 3.into();
    fs::write(folder.path().join("case.json"), case.to_string()).unwrap();
    let run = plan(&folder, &["--case", "case.json"]);
    assert_eq!(run.code, 2);
    assert!(
        run.stderr.contains("unknown field `speeds_mps`"),
        "{}",
        run.stderr
    );
}

#[test]
fn recorded_trips_are_held_against_what_they_could_have_cost() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    let run = plan(&folder, &[&drives, "--potential", "--format", "json"]).ok();
    let document = run.json();
    assert_eq!(document["schema"], "drivekit/plan-potential/1");
    let trips = document["trips"].as_array().unwrap();
    assert_eq!((trips.len(), &document["total"]["trips"]), (12, &12.into()));
    let figure = |value: &Value, key: &str| value[key].as_f64().unwrap();
    for trip in trips {
        assert_eq!(trip["status"], "planned");
        assert!(
            figure(trip, "plan_energy_j") < figure(trip, "own_energy_j"),
            "{trip}"
        );
        assert!((0.0..0.1).contains(&figure(trip, "gap_pct")), "{trip}");
    }
    let sum: f64 = trips.iter().map(|trip| figure(trip, "own_energy_j")).sum();
    let total = &document["total"];
    assert!((figure(total, "own_energy_j") - sum).abs() < 1e-6 * sum);
    let [low, high] = [0, 1].map(|k| total["quartiles_saving_pct"][k].as_f64().unwrap());
    let median = figure(total, "median_saving_pct");
    assert!(low <= median && median <= high);
    assert!(
        (10.0..30.0).contains(&figure(total, "saving_pct")),
        "{total}"
    );
}

#[test]
fn a_trip_that_cannot_be_planned_stops_no_other() {
    let folder = TempDir::new().unwrap();
    let stands: String = (0..600)
        .map(|k| format!("{},0\n", f64::from(k) / 10.0))
        .collect();
    fs::write(
        folder.path().join("stands.csv"),
        format!("time_s,speed_mps\n{stands}"),
    )
    .unwrap();
    fs::write(folder.path().join("broken.csv"), "time_s,speed_mps\n0,a\n").unwrap();
    let drive = fixture("drives/drive-01.csv");
    let arguments = ["stands.csv", &drive, "--potential"];
    let run = plan(&folder, &arguments);
    assert_eq!(run.code, 1, "{}", run.stderr);
    for part in [
        "stands: not planned: the car does not move",
        "1 trip could not be planned",
        "an upper bound",
    ] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
    let run = plan(
        &folder,
        &["broken.csv", &drive, "--potential", "--format", "json"],
    );
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert_eq!(run.json()["total"]["trips"], 1);
    for (arguments, part) in [
        (
            vec![&drive[..], "--potential", "--arrive", "300"],
            "--arrive",
        ),
        (vec!["--potential"], "ROAD|LOG"),
        (vec![&drive, &drive], "--potential"),
    ] {
        let run = plan(&folder, &arguments);
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
    }
}

#[test]
fn a_plan_is_drawn_and_reported() {
    let folder = TempDir::new().unwrap();
    let road = fixture("roads/town-and-country.toml");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let pictures = ["--plot", "plan.svg", "--report", "plan.html"];
    plan(
        &folder,
        &[&[&road[..], "--arrive", "300"], &pictures[..]].concat(),
    )
    .ok();
    let (picture, page) = (read("plan.svg"), read("plan.html"));
    for part in [
        "<svg",
        "speed (km/h)",
        "time (s)",
        "above the start (m)",
        "coasts",
        "brakes by friction",
        "limit",
        "signal",
    ] {
        assert!(picture.contains(part), "{part}");
    }
    assert!(page.contains("drivekit/plan/1") && page.contains("id=\"budget\""));
    plan(
        &folder,
        &[&[&road[..], "--frontier", "4"], &pictures[..]].concat(),
    )
    .ok();
    let picture = read("plan.svg");
    assert!(picture.contains("energy (kWh)") && !picture.contains("speed (km/h)"));
    // Nothing can be driven: the page says so, and there is nothing to draw.
    let late = [&road[..], "--arrive", "100"];
    let run = plan(&folder, &[&late[..], &pictures[2..]].concat());
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(read("plan.html").contains("too_late"));
    let run = plan(&folder, &[&late[..], &pictures[..2]].concat());
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("no plan to draw"), "{}", run.stderr);
}

#[test]
fn another_solver_stands_beside_the_plan_where_it_can() {
    let folder = TempDir::new().unwrap();
    let road = "length_m = 2000.0\nlimits = [{ position_m = 0, limit_kmh = 70 }]\nstops = [{ position_m = 900, dwell_s = 5 }]\n";
    fs::write(folder.path().join("road.toml"), road).unwrap();
    let arguments = ["road.toml", "--arrive", "160", "--certify", "convex"];
    let document = plan(&folder, &[&arguments[..], &["--format", "json"]].concat())
        .ok()
        .json();
    let certificate = &document["plans"][0]["certificate"];
    assert_eq!(
        (&certificate["solver"], &certificate["status"]),
        (&"clarabel".into(), &"solved".into())
    );
    let gap_pct = certificate["gap_pct"].as_f64().unwrap();
    assert!((0.0..0.5).contains(&gap_pct), "{gap_pct} %");
    let text = plan(&folder, &arguments).ok().stdout;
    assert!(
        text.contains("by a convex relaxation no other plan that arrives no later takes less"),
        "{text}"
    );

    let signals = r#"[{"position_m": 400, "green_s": [[0, 100]]}]"#;
    fs::write(folder.path().join("signals.json"), signals).unwrap();
    plan(
        &folder,
        &[&arguments[..], &["--signals", "signals.json"]].concat(),
    )
    .refused(&["knows of no signals"]);
}

#[test]
fn a_plan_fits_the_driver() {
    let folder = TempDir::new().unwrap();
    let drives: Vec<String> = (1..=3)
        .map(|k| fixture(&format!("drives/drive-0{k}.csv")))
        .collect();
    let mut fit: Vec<&str> = vec!["fit"];
    fit.extend(drives.iter().map(String::as_str));
    fit.extend(["--model", "trip-driver", "-o", "trips.json"]);
    drivekit_in(folder.path(), &fit).ok();
    let road = fixture("roads/town-and-country.toml");
    let of_driver = [&road[..], "--driver", "trips.json"];
    let json = ["--style", "1,free", "--format", "json"];
    let document = plan(&folder, &[&of_driver[..], &json[..]].concat())
        .ok()
        .json();
    let own = &document["own"];
    let plans = document["plans"].as_array().unwrap();
    assert_eq!(plans.len(), 2);
    assert_eq!(
        (&plans[0]["style"], &plans[1]["style"]),
        (&1.0.into(), &"free".into())
    );
    let figure = |value: &Value, key: &str| value[key].as_f64().unwrap();
    for found in plans {
        assert!(figure(found, "time_s") <= figure(own, "time_s") + 1e-6);
        assert!(figure(found, "energy_j") < figure(own, "energy_j"));
        assert_eq!(found["style_distance"]["band"], "fitted");
        // Limits are those of the road, not of the band.
        assert_eq!(found["nodes"]["limit_mps"], own["nodes"]["limit_mps"]);
    }
    assert!(figure(&plans[1], "energy_j") <= figure(&plans[0], "energy_j"));
    let text = plan(&folder, &of_driver).ok().stdout;
    assert!(
        text.contains("beside his own way") && text.contains("kJ"),
        "{text}"
    );
    for (arguments, part) in [
        (vec![&road[..], "--style", "1"], "--driver"),
        (vec![&road[..], "--driver", &road], "town-and-country"),
        (
            [&of_driver[..], &["--style", "1,free", "-o", "p.csv"]].concat(),
            "--style",
        ),
    ] {
        let run = plan(&folder, &arguments);
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
    }
}

#[test]
fn what_is_saved_beside_the_driver_is_said_in_kilojoules() {
    let folder = TempDir::new().unwrap();
    let drives = fixture("drives");
    let fit = ["fit", &drives, "--model", "trip-driver", "-o", "anna.json"];
    drivekit_in(folder.path(), &fit).ok();
    let road = fixture("roads/town-and-country.toml");
    let styles = ["--driver", "anna.json", "--style", "1,free"];
    let run = plan(
        &folder,
        &[&[&road[..]], &styles[..], &["--plot", "plan.svg"]].concat(),
    )
    .ok();
    assert!(run.stdout.contains(": saves "), "{}", run.stdout);
    assert!(
        run.stderr.contains("the first of 2 plans is drawn"),
        "{}",
        run.stderr
    );
    let picture = fs::read_to_string(folder.path().join("plan.svg")).unwrap();
    assert!(picture.contains("own run"));
}
