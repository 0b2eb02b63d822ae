//! Closed paths from files.

use std::path::Path;

use crate::error::Error;

/// Points of a closed path from CSV: x and y in m in the first two columns, in the order of travel, with or without a header.
///
/// # Errors
///
/// A file that cannot be read, or the first line whose columns are no numbers.
pub fn read_path(file: &Path) -> Result<Vec<[f64; 2]>, Error> {
    let bad = |line: u64, found: String| Error::Content {
        path: file.to_owned(),
        place: format!(", line {line}"),
        found,
        help: "give x and y in m, a point per line, in the order of travel".to_owned(),
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(file)
        .map_err(|e| bad(0, e.to_string()))?;
    let mut points_m = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| bad(0, e.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |column: usize| record.get(column).and_then(|text| text.parse::<f64>().ok());
        match (number(0), number(1)) {
            (Some(x_m), Some(y_m)) => points_m.push([x_m, y_m]),
            _ if points_m.is_empty() && line <= 1 => {} // A header.
            _ => return Err(bad(line, format!("`{}` is no point", record.as_slice()))),
        }
    }
    Ok(points_m)
}
