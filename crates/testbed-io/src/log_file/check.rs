//! CRC-32 (IEEE 802.3) of what was logged so far.

use crc32fast::Hasher;
use parquet_table::{Column, Values};

/// The check of all fields so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Check(Hasher);

impl Check {
    /// Fields are told apart by a comma after each.
    pub(super) fn add(&mut self, field: &[u8]) {
        self.0.update(field);
        self.0.update(b",");
    }

    /// Of the names and values of columns, bit for bit but for NaNs.
    pub(super) fn of(columns: &[Column]) -> Self {
        let mut check = Self::default();
        for column in columns {
            check.add(column.name.as_bytes());
            match &column.values {
                Values::Float(values) => values.iter().for_each(|v| check.add(&float_bytes(*v))),
                Values::Integer(values) => values.iter().for_each(|v| check.add(&v.to_le_bytes())),
                Values::Text(values) => values.iter().for_each(|v| check.add(v.as_bytes())),
            }
        }
        check
    }

    /// As it stands in files. The word keeps other programs from taking it for a number.
    pub(super) fn text(&self) -> String {
        format!("crc {:08x}", self.0.clone().finalize())
    }
}

fn float_bytes(value: f64) -> [u8; 8] {
    let value = if value.is_nan() { f64::NAN } else { value };
    value.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::Check;

    #[test]
    fn the_check_is_that_of_other_programs() {
        let mut check = Check::default();
        check.add(b"1");
        check.add(b"-2.5");
        assert_eq!(check.text(), "crc 225faaf5", "CRC-32 of `1,-2.5,`");
    }
}
