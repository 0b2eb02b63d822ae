use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Error;

/// Enough for a thousand speeds times a thousand torques.
const LARGEST_FILE: u64 = 64 << 20;

const HEADER: &str = "speed_rad_s,torque_nm,loss_w";

/// Losses of motor and inverter as a table, in place of the formula.
///
/// The file is CSV with the header `speed_rad_s,torque_nm,loss_w` and one line for every pair of a speed (at least 0) and a
/// torque (negative brakes) of a grid, in any order. Between the points the loss is bilinear, beyond them that of the edge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LossTableSpec {
    /// Path of the CSV file, relative to the vehicle file.
    pub file: String,
    /// Share of the loss without torque that the road load contains already, 0 to 1; see
    /// [`MotorLossSpec`](crate::MotorLossSpec).
    pub spin_share_in_road_load: f64,
    /// What the file says; read with the vehicle file.
    #[serde(skip)]
    pub table: Option<LossTable>,
}

/// Loss in W over motor speed and torque.
#[derive(Debug, Clone, PartialEq)]
pub struct LossTable {
    speed_rad_s: Vec<f64>,
    torque_nm: Vec<f64>,
    /// Row per speed.
    loss_w: Vec<f64>,
}

impl LossTable {
    /// Reads a table.
    ///
    /// # Errors
    /// [`Error::Read`], and [`Error::LossTable`] for anything that is not a whole table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.display().to_string();
        let failed = |source| Error::Read {
            file: file.clone(),
            source,
        };
        // A vehicle file may name anything, an endless device included.
        let metadata = std::fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() || metadata.len() > LARGEST_FILE {
            let problem = format!("is no file of at most {LARGEST_FILE} bytes");
            return Err(failed(std::io::Error::other(problem)));
        }
        let text = std::fs::read_to_string(path).map_err(failed)?;
        Self::from_csv(&text, &file)
    }

    /// Reads a table from CSV text; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::LossTable`] for another header, a line that is not three numbers within range, a pair given twice, a pair that is
    /// missing, and less than two speeds or torques.
    pub fn from_csv(text: &str, file: &str) -> Result<Self, Error> {
        let fail = |line: usize, problem: String| Error::LossTable {
            file: file.to_owned(),
            line,
            problem,
        };
        let mut lines = text.lines().enumerate();
        let header = lines
            .next()
            .map(|(_, line)| line.trim_start_matches('\u{feff}').replace(' ', ""));
        if header.as_deref() != Some(HEADER) {
            return Err(fail(1, format!("expected the header {HEADER}")));
        }
        let mut points = Vec::new();
        for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let point = point(line).map_err(|problem| fail(index + 1, problem))?;
            points.push((index + 1, point));
        }
        let axis = |k: usize| {
            let mut values: Vec<f64> = points.iter().map(|(_, point)| point[k]).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let (speed_rad_s, torque_nm) = (axis(0), axis(1));
        if speed_rad_s.len() < 2 || torque_nm.len() < 2 {
            let problem = format!(
                "{} speeds and {} torques are no table; give two or more of each",
                speed_rad_s.len(),
                torque_nm.len()
            );
            return Err(fail(1, problem));
        }
        // A table whose lines cannot fill it has holes, however large the grid.
        if points.len() < speed_rad_s.len().saturating_mul(torque_nm.len()) {
            return Err(fail(1, hole(&speed_rad_s, &torque_nm, &points)));
        }
        let mut loss_w = vec![f64::NAN; speed_rad_s.len() * torque_nm.len()];
        for (line, [speed, torque, loss]) in points {
            let row = speed_rad_s.partition_point(|s| *s < speed);
            let column = torque_nm.partition_point(|t| *t < torque);
            let place = &mut loss_w[row * torque_nm.len() + column];
            if !place.is_nan() {
                let problem = format!("speed {speed} rad/s and torque {torque} Nm are there twice");
                return Err(fail(line, problem));
            }
            *place = loss;
        }
        Ok(Self {
            speed_rad_s,
            torque_nm,
            loss_w,
        })
    }

    /// The table without a share of its loss at no torque.
    pub(crate) fn without_spin(&self, share: f64) -> Self {
        let mut table = self.clone();
        for (row, &speed) in table
            .loss_w
            .chunks_exact_mut(self.torque_nm.len())
            .zip(&self.speed_rad_s)
        {
            let spin_w = share * self.loss_w(0.0, speed);
            row.iter_mut().for_each(|loss| *loss -= spin_w);
        }
        table
    }

    /// Loss in W at a torque in N m and a motor speed in rad/s, at least 0.
    #[inline]
    pub(crate) fn loss_w(&self, torque_nm: f64, speed_rad_s: f64) -> f64 {
        let (row, down) = place(&self.speed_rad_s, speed_rad_s);
        let (column, across) = place(&self.torque_nm, torque_nm);
        let at = |row: usize| {
            let from = row * self.torque_nm.len() + column;
            self.loss_w[from] + across * (self.loss_w[from + 1] - self.loss_w[from])
        };
        at(row) + down * (at(row + 1) - at(row))
    }
}

/// The interval of an axis in which a value lies and the share of it before the value, 0 to 1.
fn place(axis: &[f64], value: f64) -> (usize, f64) {
    let end = axis
        .partition_point(|point| *point <= value)
        .clamp(1, axis.len() - 1);
    let (from, to) = (axis[end - 1], axis[end]);
    (end - 1, ((value - from) / (to - from)).clamp(0.0, 1.0))
}

fn point(line: &str) -> Result<[f64; 3], String> {
    let values: Result<Vec<f64>, _> = line.split(',').map(|v| v.trim().parse()).collect();
    let Ok(&[speed, torque, loss]) = values.as_deref() else {
        return Err(format!("expected three numbers, found `{line}`"));
    };
    for (name, value, min, max) in [
        ("speed_rad_s", speed, 0.0, 1e5),
        ("torque_nm", torque, -1e5, 1e5),
        ("loss_w", loss, 0.0, 1e8),
    ] {
        if !(min..=max).contains(&value) {
            return Err(format!("`{name}` is {value}, allowed is {min} to {max}"));
        }
    }
    // -0 is 0
    Ok([speed + 0.0, torque + 0.0, loss])
}

/// Names the first pair of the grid that no line gives.
fn hole(speed_rad_s: &[f64], torque_nm: &[f64], points: &[(usize, [f64; 3])]) -> String {
    let key = |speed: f64, torque: f64| (speed.to_bits(), torque.to_bits());
    let given: std::collections::HashSet<_> = points.iter().map(|(_, p)| key(p[0], p[1])).collect();
    let missing = speed_rad_s
        .iter()
        .flat_map(|&speed| torque_nm.iter().map(move |&torque| (speed, torque)))
        .find(|&(speed, torque)| !given.contains(&key(speed, torque)));
    match missing {
        Some((speed, torque)) => format!(
            "no loss at speed {speed} rad/s and torque {torque} Nm; give every pair of the {} speeds and {} torques",
            speed_rad_s.len(),
            torque_nm.len()
        ),
        None => "a pair of speed and torque is there twice".to_owned(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    const TABLE: &str = "speed_rad_s,torque_nm,loss_w\n0,-10,5\n0,10,3\n100,-10,25\n100,10,43\n\n";

    fn error(text: &str) -> String {
        LossTable::from_csv(text, "loss.csv")
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn losses_are_bilinear_and_end_at_the_edges() {
        let table = LossTable::from_csv(TABLE, "loss.csv").unwrap();
        assert_eq!(table.loss_w(-10.0, 0.0), 5.0);
        assert_eq!(table.loss_w(10.0, 100.0), 43.0);
        assert_eq!(table.loss_w(0.0, 50.0), (5.0 + 3.0 + 25.0 + 43.0) / 4.0);
        assert_eq!(table.loss_w(99.0, 999.0), 43.0);
        let without = table.without_spin(1.0);
        assert_eq!(without.loss_w(0.0, 70.0), 0.0);
        assert!((without.loss_w(10.0, 100.0) - 9.0).abs() < 1e-12);
    }

    #[test]
    fn holes_repetitions_and_nonsense_name_their_line() {
        assert!(error("speed,torque\n").contains("line 1: expected the header"));
        let hole = TABLE.replace("100,10,43\n", "");
        assert!(error(&hole).contains("no loss at speed 100 rad/s and torque 10 Nm"));
        let twice = TABLE.replace("100,10,43", "100,10,43\n0,-10,6");
        assert!(error(&twice).contains("line 6"), "{}", error(&twice));
        let filled = TABLE.replace("100,10,43", "0,-10,6");
        assert!(error(&filled).contains("line 5"), "{}", error(&filled));
        for bad in ["nan", "-1", "", "1,2"] {
            let text = TABLE.replace("25", bad);
            assert!(error(&text).starts_with("loss.csv, line 4: "), "{bad}");
        }
        assert!(error("speed_rad_s,torque_nm,loss_w\n0,0,1\n").contains("two or more"));
    }
}
