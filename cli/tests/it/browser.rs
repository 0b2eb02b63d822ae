//! The pages of the program in a browser. `browser.js` looks at them there.

use std::env;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program::{drivekit_in, fixture};

/// The name of a page, the least number of its figures, and the arguments that make it; `drives/` is that of the fixtures.
const PAGES: [(&str, usize, &str); 9] = [
    (
        "evaluate",
        18,
        "evaluate drives/drive-01.csv drives/drive-02.csv drives/drive-03.csv --learning-curve",
    ),
    (
        "energy",
        2,
        "energy drives/drive-01.csv drives/drive-02.csv --vehicle b250e --vehicle vw-id3",
    ),
    (
        "segment",
        10,
        "segment drives/drive-01.csv drives/drive-02.csv --compare --first 1000 --segments 40",
    ),
    (
        "calibrate",
        4,
        "calibrate drives/drive-01.csv drives/drive-02.csv --vehicle b250e -o car.toml",
    ),
    (
        "portrait",
        5,
        "portrait drives/drive-01.csv drives/drive-02.csv --fleet drives/drive-03.csv",
    ),
    (
        "trajectory",
        11,
        "evaluate --task trajectory drives/drive-01.csv drives/drive-02.csv drives/drive-03.csv --models svr-linear --horizons 1,2,5 --max-samples 500",
    ),
    ("plan", 2, "plan drives/drive-01.csv"),
    (
        "robots",
        11,
        "ctrl run --scenario stop --preset hardened --disturb all --duration 25",
    ),
    (
        "campaign",
        3,
        "ctrl campaign --preset hardened --disturb none,all --runs 26 --duration 10",
    ),
];
const OPTIONS: [&str; 14] = [
    "--headless",
    "--window-size=1300,30000",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--allow-file-access-from-files",
    "--enable-logging=stderr",
    "--virtual-time-budget=1000000000",
    "--dump-dom",
];
const PATIENCE: Duration = Duration::from_secs(240);

#[test]
fn browser_finds_nothing_wrong_with_the_pages() {
    let Some(browser) = chromium() else { return };
    let folder = TempDir::new().unwrap();
    thread::scope(|scope| {
        for (name, _, arguments) in PAGES {
            let folder = folder.path();
            scope.spawn(move || write_page(folder, name, arguments));
        }
    });
    let pages: Vec<_> = PAGES.iter().map(|(name, n, _)| (*name, *n)).collect();
    let found = problems(&browser, folder.path(), &pages);
    assert!(
        found.is_empty(),
        "{} problems:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn browser_reports_each_fault_of_a_page() {
    let Some(browser) = chromium() else { return };
    let folder = TempDir::new().unwrap();
    let pages: [(&str, &str, &[&str]); 5] = [
        (
            "sound",
            r#"<figure><canvas id="c" role="img" aria-label="A square"></canvas></figure>
            <script>document.getElementById('c').getContext('2d').fillRect(9, 9, 9, 9)</script>"#,
            &[],
        ),
        (
            "drawn-when-seen",
            r#"<figure style="padding-top: 6000px"><canvas id="c" role="img" aria-label="A square"></canvas></figure><script>
            const canvas = document.getElementById('c');
            const draw = ([entry]) => entry.isIntersecting && canvas.getContext('2d').fillRect(9, 9, 9, 9);
            new IntersectionObserver(draw).observe(canvas)</script>"#,
            &[],
        ),
        (
            "console",
            r#"<script>console.error('a complaint')</script><script>console.warn('a warning')</script>
            <script>absent()</script><img alt="" src="https://example.org/x.png">"#,
            &[
                "a complaint",
                "a warning",
                "absent is not defined",
                "Content Security Policy",
                "0 figures instead of 1",
            ],
        ),
        (
            "pictures",
            r#"<figure><canvas role="img" aria-label="Blank"></canvas></figure>
            <figure><svg role="img" aria-label="Hollow"><line class="axis" x2="9"></line></svg></figure>
            <figure><svg><rect width="9" height="9"></rect></svg></figure>
            <figure><svg role="img" aria-label="A text" width="50"><rect width="9" height="9"></rect><text y="20">Too long for it</text></svg></figure>
            <figure></figure>"#,
            &[
                "not drawn: <canvas> in the page Blank",
                "not drawn: <svg> in the page Hollow",
                "picture without role and name",
                "text cut off",
                "figure without picture",
            ],
        ),
        (
            "text",
            r#"<figure><svg role="img" aria-label="Square"><rect width="9" height="9"></rect></svg></figure>
            <h3>Deep</h3><section><p>It is NaN km.</p></section><div style="width: 500px">wide</div>
            <table><tr><td>1</td></tr></table><button style="height: 12px">Go</button><input style="height: 30px">
            <button style="margin-left: 450px; height: 30px">Far</button>"#,
            &[
                "heading level 3 follows 1",
                "section without heading",
                "a value that is none",
                "at 360 px: overflow",
                "table without caption",
                "table without headings",
                "12.0 px high",
                "control without label",
                "at 360 px: control outside the page",
            ],
        ),
    ];
    for (name, body, _) in pages {
        let page = format!(
            r#"<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{name}</title><link rel="icon" href="data:,">
            <meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; script-src 'unsafe-inline'; style-src 'unsafe-inline'">
            <main><h1>{name}</h1>{body}</main></html>"#
        );
        fs::write(folder.path().join(format!("{name}.html")), page).unwrap();
    }
    let found = problems(&browser, folder.path(), &pages.map(|(name, ..)| (name, 1)));
    for (name, _, expected) in pages {
        let own = |line: &&String| line.contains(&format!("{name}.html"));
        let lines: Vec<_> = found.iter().filter(own).collect();
        for part in expected {
            let reported = lines.iter().any(|line| line.contains(part));
            assert!(reported, "{name}, `{part}`: {lines:#?}");
        }
        let unexpected = |line: &&&String| !expected.iter().any(|part| line.contains(part));
        let surplus: Vec<_> = lines.iter().filter(unexpected).collect();
        assert!(surplus.is_empty(), "{name}: {surplus:#?}");
    }
}

/// A browser, where there is one; without it the test passes unless one is required.
fn chromium() -> Option<PathBuf> {
    let found = env::var_os("CHROMIUM").map(PathBuf::from).or_else(|| {
        let path = env::var_os("PATH")?;
        ["chromium", "chromium-browser", "google-chrome"]
            .iter()
            .flat_map(|name| env::split_paths(&path).map(move |folder| folder.join(name)))
            .find(|file| file.is_file())
    });
    if found.is_none() {
        assert!(
            env::var_os("DRIVEKIT_REQUIRE_BROWSER").is_none(),
            "no Chromium, and DRIVEKIT_REQUIRE_BROWSER is set"
        );
        eprintln!("skipped: no Chromium");
    }
    found
}

fn write_page(folder: &Path, name: &str, arguments: &str) {
    let input = |argument: &str| match argument.starts_with("drives/") {
        true => fixture(argument),
        false => argument.to_owned(),
    };
    let report = format!("--report {name}.html");
    let words = arguments.split(' ').chain(report.split(' ')).map(input);
    let words: Vec<String> = words.collect();
    drivekit_in(
        folder,
        &words.iter().map(String::as_str).collect::<Vec<_>>(),
    )
    .ok();
}

/// What is wrong with the pages of a folder, given by their names and least numbers of figures.
fn problems(browser: &Path, folder: &Path, pages: &[(&str, usize)]) -> Vec<String> {
    let entry = |(name, figures): &(&str, usize)| json!({ "file": format!("{name}.html"), "figures": figures });
    let list: Value = pages.iter().map(entry).collect();
    let script = include_str!("browser.js");
    let wrapper = format!(
        r#"<!DOCTYPE html><meta charset="utf-8"><link rel="icon" href="data:,"><body><pre id="result"></pre>
        <script>const PAGES = {list};{script}</script>"#
    );
    fs::write(folder.join("wrapper.html"), wrapper).unwrap();
    let (document, log) = opened(browser, folder, "wrapper.html");
    let result = document
        .split_once(r#"<pre id="result">"#)
        .and_then(|(_, rest)| rest.split_once("</pre>"));
    let mut found: Vec<String> = result
        .and_then(|(list, _)| serde_json::from_str(list).ok())
        .unwrap_or_else(|| panic!("the browser came to no result: {log}"));
    let messages = log.lines().filter(|line| line.contains("CONSOLE"));
    found.extend(messages.map(str::to_owned));
    found
}

/// The document that a page has become, and what the browser logged.
fn opened(browser: &Path, folder: &Path, page: &str) -> (String, String) {
    let (document, log) = (folder.join("document.txt"), folder.join("log.txt"));
    let mut child = Command::new(browser)
        .args(OPTIONS)
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .arg(format!("file://{}", folder.join(page).display()))
        .stdin(Stdio::null())
        .stdout(File::create(&document).unwrap())
        .stderr(File::create(&log).unwrap())
        .spawn()
        .unwrap_or_else(|error| panic!("{}: {error}", browser.display()));
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("the browser hung: {}", fs::read_to_string(&log).unwrap());
        }
        thread::sleep(Duration::from_millis(50));
    }
    let text = |file| String::from_utf8_lossy(&fs::read(file).unwrap()).into_owned();
    (text(&document), text(&log))
}
