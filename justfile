# `just` lists the recipes.
default:
    @just --list --unsorted

# Everything that must pass before a change lands.
[group('check')]
ci:
    .ci/run

# The tests, as in the README.
[group('check')]
test:
    cargo test --workspace

# Clippy over all targets, warnings are errors.
[group('check')]
lint:
    cargo clippy --workspace --all-targets -- -D warnings

# Formatting without changing anything.
[group('check')]
fmt-check:
    cargo fmt --all --check

# API documentation, warnings are errors.
[group('check')]
doc $RUSTDOCFLAGS="-D warnings":
    cargo doc --workspace --no-deps --document-private-items

# Every benchmark once, without measuring.
[group('check')]
bench-check:
    cargo bench --workspace -- --test

# Format the code.
[group('work')]
fmt:
    cargo fmt --all

# Measure. `just bench drive-log` takes one crate.
[group('work')]
bench crate="":
    cargo bench {{ if crate == "" { "--workspace" } else { "-p " + crate } }}

# Fuzz for some seconds: `just fuzz read_log 600`, also read_layout, segment, read_vehicle, read_road, read_run_log, read_scenario, natnet, robotarium, json_lines. Needs `cargo install cargo-fuzz`.
[group('work')]
fuzz target="read_log" seconds="60":
    cd crates/{{ if target == "segment" { "tseg" } else if target == "read_vehicle" { "ev-energy" } else if target == "read_road" { "driver-model" } else if target =~ "read_(log|layout)" { "drive-log" } else { "testbed-io" } }} && cargo fuzz run --sanitizer none {{ target }} -- -max_total_time={{ seconds }} {{ if target =~ "read_(log|layout)" { "-dict=fuzz/log.dict" } else { "" } }}

# Make the simulated drives that ship with the project anew.
[group('work')]
fixtures:
    cargo run --release -p drivekit -- synth --noise --force -o fixtures/drives

# Make the lists of figures anew that `--require` knows.
[group('work')]
figures:
    DRIVEKIT_FIGURES=write cargo test -p drivekit --test it the_lists_hold_every_figure

# The energy of a cycle against the crate fastsim-core; compiles for minutes.
[group('work')]
rivals:
    cd crates/ev-energy/rivals && cargo bench

# Pack an archive to give away: the programs, completions for shells, manual pages, licences; it lands in target/archive.
[group('work')]
archive:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release -p drivekit
    program=target/release/drivekit
    name="drivekit-$("$program" --version | cut -d' ' -f2)-$(rustc -vV | sed -n 's/^host: //p')"
    folder="target/archive/$name"
    rm -rf "$folder"
    mkdir -p "$folder/completions"
    cp "$program" target/release/ctrl README.md LICENSE* "$folder"
    for shell in bash zsh fish elvish powershell; do "$program" completions "$shell" > "$folder/completions/drivekit.$shell"; done
    "$program" man -o "$folder/man/man1"
    tar -C target/archive -czf "$folder.tar.gz" "$name"
    echo "$folder.tar.gz"
