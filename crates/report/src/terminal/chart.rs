//! Curves as characters, for terminals.

/// Size of the plot in characters, without its axes.
const COLUMNS: usize = 60;
const ROWS: usize = 14;
const MARKS: [char; 6] = ['●', '○', '◆', '◇', '■', '□'];

/// Speed in m/s over time, each curve with its own mark; axes in km/h and s.
#[must_use]
pub fn speed_over_time(curves_mps: &[&[f64]], step_s: f64) -> String {
    let longest = curves_mps.iter().map(|c| c.len()).max().unwrap_or(0).max(2);
    let highest = curves_mps
        .iter()
        .flat_map(|c| c.iter())
        .fold(0.0_f64, |high, &v| high.max(v));
    let top_kmh = ((3.6 * highest / 10.0).ceil() * 10.0).clamp(10.0, 1e4);
    let mut cells = vec![[' '; COLUMNS]; ROWS];
    for (curve, mark) in curves_mps.iter().zip(MARKS.iter().cycle()) {
        for (column, sample) in (0..COLUMNS).map(|c| (c, c * (longest - 1) / (COLUMNS - 1))) {
            let Some(&speed_mps) = curve.get(sample) else {
                continue;
            };
            let row = (3.6 * speed_mps / top_kmh).clamp(0.0, 1.0) * (ROWS - 1) as f64;
            cells[ROWS - 1 - row.round() as usize][column] = *mark;
        }
    }
    let mut text = String::new();
    for (row, line) in cells.iter().enumerate() {
        let label = match row {
            0 => format!("{top_kmh:.0} km/h"),
            r if r == ROWS - 1 => "0".to_owned(),
            _ => String::new(),
        };
        let line: String = line.iter().collect();
        text.push_str(&format!("{label:>9} │{}\n", line.trim_end()));
    }
    let end = format!("{:.0} s", (longest - 1) as f64 * step_s);
    text.push_str(&format!("{:>9} └{}\n", "", "─".repeat(COLUMNS)));
    text.push_str(&format!("{:>9}  0{end:>width$}\n", "", width = COLUMNS - 1));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_the_lower_left() {
        let rising: Vec<f64> = (0..=80).map(|k| f64::from(k) * 13.8 / 80.0).collect();
        let text = speed_over_time(&[&rising], 0.1);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("  50 km/h │") && lines[0].ends_with('●'));
        assert!(lines[ROWS - 1].contains("│●"));
        assert!(lines[ROWS + 1].ends_with("8 s"));
    }

    #[test]
    fn any_curve_is_drawn() {
        for curve in [&[][..], &[f64::NAN, 1.0], &[f64::INFINITY], &[-5.0, 1e300]] {
            assert!(speed_over_time(&[curve], 0.1).lines().count() == ROWS + 2);
        }
    }
}
