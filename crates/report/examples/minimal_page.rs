//! The page of an energy document with nothing in it, which names the keys that it lacks.
//!
//! `cargo run -p report --example minimal_page > energy.html`, then open the file in a browser.

#![allow(clippy::print_stdout)]

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let text = r#"{ "schema": "drivekit/energy/1", "logs": [] }"#;
    let document: serde_json::Value = serde_json::from_str(text)?;
    let page = report::ENERGY.filled(&document);
    println!("{page}");
    Ok(())
}
