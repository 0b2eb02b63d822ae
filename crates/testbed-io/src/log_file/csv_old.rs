//! CSV run logs of before: two lines that begin with `#`, then names and rows without a check.

use ::csv::ByteRecord;

use super::flaw::{DAMAGED, Flaw, shortened};
use super::kind::{Kind, kind};
use super::records::{Records, check_fields, header, push};
use super::table::{LogTable, table};

pub(super) const MAGIC: &str = "# drivekit run log 1 ";
const TYPES: &str = "# types ";
const FOREIGN: &str = "the second line of such a run log names the types of its columns";

pub(super) fn read(bytes: &[u8]) -> Result<LogTable, Flaw> {
    let end = bytes.iter().position(|byte| *byte == b'\n');
    let (first, rest) = bytes.split_at(end.map_or(bytes.len(), |end| end + 1));
    let meta = str::from_utf8(&first[MAGIC.len()..]);
    let meta = meta.map_err(|_| Flaw::at(", line 1".to_owned(), "it is not UTF-8", DAMAGED))?;
    let mut records = Records::new(rest, 2);
    let mut record = ByteRecord::new();
    let mut columns = Vec::new();
    let mut next = |record: &mut ByteRecord| {
        let more = records.next(record)?;
        more.then_some(())
            .ok_or_else(|| Flaw::new("it ends in its header", DAMAGED))
    };
    next(&mut record)?;
    let kinds = kinds(&record)?;
    if !kinds.is_empty() {
        next(&mut record)?;
        columns = header(&record, &kinds)?;
    }
    let is_cut = records.is_cut(kinds.len())?;
    while records.next(&mut record)? {
        check_fields(&record, columns.len())?;
        push(&mut columns, &record)?;
    }
    let table = table(meta.trim_end_matches(['\r', '\n']), columns, is_cut)?;
    Ok(LogTable {
        states_its_end: false,
        ..table
    })
}

/// The line with the types is a record of as many fields as the rest.
fn kinds(record: &ByteRecord) -> Result<Vec<Kind>, Flaw> {
    let wrong = |found: &[u8]| {
        let found = shortened(&String::from_utf8_lossy(found));
        Flaw::at(", line 2".to_owned(), format!("{found:?}"), FOREIGN)
    };
    let first = record.get(0).unwrap_or_default();
    let first = first
        .strip_prefix(TYPES.as_bytes())
        .ok_or_else(|| wrong(first))?;
    if record.len() == 1 && first.is_empty() {
        return Ok(Vec::new());
    }
    let fields = std::iter::once(first).chain(record.iter().skip(1));
    let kinds = fields.map(|field| match field {
        [letter] => kind(char::from(*letter)).ok_or_else(|| wrong(field)),
        _ => Err(wrong(field)),
    });
    kinds.collect()
}
