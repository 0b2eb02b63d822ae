//! A log as columns of text.

/// A log, and how it is written down.
#[derive(Clone)]
pub(super) struct Table {
    pub(super) columns: Vec<(String, Vec<String>)>,
    pub(super) delimiter: &'static str,
    pub(super) decimal_comma: bool,
    pub(super) quoted: bool,
    /// What stands where a value is missing.
    pub(super) missing: &'static str,
}

impl Table {
    pub(super) fn read(text: &str, delimiter: char) -> Table {
        let mut lines = text.lines();
        let headers = lines.next().unwrap().split(delimiter);
        let mut columns: Vec<(String, Vec<String>)> = headers
            .map(|header| (header.to_owned(), Vec::new()))
            .collect();
        for line in lines {
            for ((_, cells), cell) in columns.iter_mut().zip(line.split(delimiter)) {
                cells.push(cell.to_owned());
            }
        }
        Table {
            columns,
            delimiter: ",",
            decimal_comma: false,
            quoted: false,
            missing: "",
        }
    }

    /// The columns of these names under others, in the order of the table.
    pub(super) fn renamed(&self, names: &[(&str, &str)]) -> Table {
        let columns = self.columns.iter().filter_map(|(header, cells)| {
            let (_, name) = names.iter().find(|(from, _)| from == header)?;
            Some(((*name).to_owned(), cells.clone()))
        });
        Table {
            columns: columns.collect(),
            ..self.clone()
        }
    }

    pub(super) fn has(&self, header: &str) -> bool {
        self.columns.iter().any(|(name, _)| name == header)
    }

    /// The table with every number of a column turned into text.
    pub(super) fn written(&self, header: &str, name: &str, text: impl Fn(f64) -> String) -> Table {
        let mut table = self.clone();
        for (old, cells) in &mut table.columns {
            if old == header {
                name.clone_into(old);
                for cell in cells.iter_mut().filter(|cell| !cell.is_empty()) {
                    *cell = text(cell.parse().unwrap());
                }
            }
        }
        table
    }

    /// The table with a column converted, all digits kept.
    pub(super) fn with(&self, header: &str, name: &str, convert: impl Fn(f64) -> f64) -> Table {
        self.written(header, name, |value| convert(value).to_string())
    }

    /// The rows in the order of `rows`, which may repeat some.
    pub(super) fn in_order(&self, rows: &[usize]) -> Table {
        let mut table = self.clone();
        for (_, cells) in &mut table.columns {
            *cells = rows.iter().map(|row| cells[*row].clone()).collect();
        }
        table
    }

    pub(super) fn rows(&self) -> usize {
        self.columns[0].1.len()
    }

    pub(super) fn headers(&self) -> Vec<String> {
        self.columns
            .iter()
            .map(|(header, _)| header.clone())
            .collect()
    }

    /// The lines, the header first.
    pub(super) fn lines(&self) -> Vec<String> {
        let quoted = |cell: &str| match self.quoted {
            true => format!("\"{cell}\""),
            false => cell.to_owned(),
        };
        let cell = |cell: &String| match cell.as_str() {
            "" => self.missing.to_owned(),
            number if self.decimal_comma && number.parse::<f64>().is_ok() => {
                number.replace('.', ",")
            }
            text => text.to_owned(),
        };
        let header: Vec<String> = self.headers().iter().map(|header| quoted(header)).collect();
        let row = |row: usize| {
            let cells = self
                .columns
                .iter()
                .map(|(_, cells)| quoted(&cell(&cells[row])));
            cells.collect::<Vec<_>>().join(self.delimiter)
        };
        std::iter::once(header.join(self.delimiter))
            .chain((0..self.rows()).map(row))
            .collect()
    }

    pub(super) fn text(&self) -> String {
        self.lines().join("\n") + "\n"
    }
}
