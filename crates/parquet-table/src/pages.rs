//! Page headers of a Parquet column chunk, checked before the decoder sees them.
//!
//! The decoder allocates what a header promises; a damaged one promises exabytes, and a failed
//! allocation cannot be caught. Headers are structs in Thrift's compact protocol (Apache Parquet
//! format, `parquet.thrift`, `PageHeader`).

/// Fields of `PageHeader` and of the headers within it.
const UNCOMPRESSED_SIZE: u8 = 2;
const COMPRESSED_SIZE: u8 = 3;
const CHECKSUM: u8 = 4;
const DATA_PAGE: u8 = 5;
const DATA_PAGE_V2: u8 = 8;
const DICTIONARY_PAGE: u8 = 7;
const VALUES: u8 = 1;

/// Structs within structs: a header, the page's header, its statistics.
const MAX_DEPTH: usize = 3;

/// Checks that the pages of a chunk hold the values that the file promises for it, each within the
/// chunk.
pub(crate) fn check_chunk(chunk: &[u8], values: u64) -> Result<(), &'static str> {
    let mut rest = chunk;
    let mut seen = 0;
    while seen < values {
        let mut header = Header::default();
        let mut thrift = Thrift { rest };
        thrift
            .read_struct(&mut header, 0, 0)
            .ok_or("a page header cannot be read")?;
        let compressed =
            usize::try_from(header.compressed_size).map_err(|_| "a page of negative size")?;
        rest = thrift
            .rest
            .get(compressed..)
            .ok_or("a page longer than its column")?;
        if header.uncompressed_size < 0 || header.negative {
            return Err("a page of negative size");
        }
        let page =
            u64::try_from(header.values).map_err(|_| "a page with a negative number of values")?;
        let promised = u64::try_from(header.dictionary)
            .map_err(|_| "a dictionary with a negative number of values")?;
        seen += page;
        if seen > values || promised > values {
            return Err("more values in a page than in its column");
        }
    }
    Ok(())
}

#[derive(Default)]
struct Header {
    compressed_size: i64,
    uncompressed_size: i64,
    values: i64,
    dictionary: i64,
    /// Whether any other count or length is negative.
    negative: bool,
}

impl Header {
    /// Takes a whole number in field `field` of the struct in field `parent` of the header, 0 for
    /// the header itself.
    fn take(&mut self, parent: u8, field: u8, value: i64) {
        match (parent, field) {
            (0, UNCOMPRESSED_SIZE) => self.uncompressed_size = value,
            (0, COMPRESSED_SIZE) => self.compressed_size = value,
            (0, CHECKSUM) => {}
            (DATA_PAGE | DATA_PAGE_V2, VALUES) => self.values = value,
            (DICTIONARY_PAGE, VALUES) => self.dictionary = value,
            _ => self.negative |= value < 0,
        }
    }
}

/// A reader of Thrift's compact protocol; `None` where there is nothing to read, or something that
/// no page header has.
struct Thrift<'a> {
    rest: &'a [u8],
}

impl Thrift<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    fn signed(&mut self) -> Option<i64> {
        let zigzag = self.unsigned()?;
        Some((zigzag >> 1).cast_signed() ^ -(zigzag & 1).cast_signed())
    }

    fn skip(&mut self, bytes: u64) -> Option<()> {
        self.rest = self.rest.get(usize::try_from(bytes).ok()?..)?;
        Some(())
    }

    fn read_struct(&mut self, header: &mut Header, parent: u8, depth: usize) -> Option<()> {
        let mut field: i64 = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            let delta = head >> 4;
            field = if delta == 0 {
                self.signed()?
            } else {
                field + i64::from(delta)
            };
            let id = u8::try_from(field).ok()?;
            match head & 0x0f {
                // booleans are in the head
                1 | 2 => {}
                3 => self.skip(1)?,
                4..=6 => {
                    let value = self.signed()?;
                    if depth < 2 {
                        header.take(parent, id, value);
                    }
                }
                7 => self.skip(8)?,
                8 => {
                    let len = self.unsigned()?;
                    self.skip(len)?;
                }
                12 if depth < MAX_DEPTH => self.read_struct(header, id, depth + 1)?,
                _ => return None,
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A data page: type 0, sizes, and a header with a number of values, all zigzag.
    fn page(values: u8, size: u8) -> Vec<u8> {
        let mut bytes = vec![
            0x15,
            0,
            0x15,
            size * 2,
            0x15,
            size * 2,
            0x2c,
            0x15,
            values,
            0x15,
            0,
            0,
            0,
        ];
        bytes.extend(std::iter::repeat_n(7, usize::from(size)));
        bytes
    }

    #[test]
    fn pages_must_hold_what_the_chunk_promises() {
        let chunk = [page(6, 5), page(4, 0)].concat();
        assert_eq!(check_chunk(&chunk, 5), Ok(()));
        assert_eq!(check_chunk(&chunk, 3), Ok(()));
        assert!(check_chunk(&chunk, 2).is_err(), "a page has three");
        assert!(check_chunk(&chunk, 6).is_err(), "only five are there");
        assert!(check_chunk(&page(1, 5), 1).is_err(), "minus one value");
        assert!(check_chunk(&page(6, 5)[..15], 3).is_err(), "cut");
        assert!(check_chunk(&[], 1).is_err());
    }
}
