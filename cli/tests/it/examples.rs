//! Every example of every crate runs; `cargo test` has built them.

use std::path::{Path, PathBuf};
use std::process::Command;

/// `crates/*/examples/*.rs`.
fn examples() -> Vec<PathBuf> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let folders = crates
        .read_dir()
        .unwrap()
        .map(|krate| krate.unwrap().path());
    let files = folders.filter_map(|folder| folder.join("examples").read_dir().ok());
    let paths = files.flatten().map(|file| file.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|suffix| suffix == "rs"))
        .collect()
}

#[test]
fn every_example_runs_and_prints() {
    let built = std::env::current_exe().unwrap();
    let built = built.ancestors().nth(2).unwrap().join("examples");
    let examples = examples();
    assert!(examples.len() > 20, "{examples:?}");
    for example in examples {
        let program = built.join(example.file_stem().unwrap());
        let output = Command::new(&program)
            .output()
            .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        assert!(
            output.status.success() && !output.stdout.is_empty(),
            "{}: {}",
            example.display(),
            String::from_utf8_lossy(&output.stderr)
        );
    }
}
