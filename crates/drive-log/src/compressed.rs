//! The bytes of a file: read up to a limit, told from nonsense by their first block, and decompressed where they are
//! gzip or zstd, recognised by their first bytes.

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use crate::Error;
use crate::head::{self, GZIP, HEAD_BYTES, LONGEST_LINE_BYTES, ZSTD};

/// What a file may hold, before and after decompression: half a day at 100 Hz with fifty columns.
pub(crate) const LIMIT_BYTES: u64 = 4 << 30;

/// Memory is asked for in blocks of at most this size, so that it never grows to twice of what is read.
const LARGEST_BLOCK_BYTES: usize = 256 << 20;

/// Reads to the end, or to the error that the first block or the limit is. `failed` makes an error of what `input` says.
pub(crate) fn whole(
    path: &Path,
    input: impl Read,
    limit_bytes: u64,
    failed: impl Fn(std::io::Error) -> Error,
) -> Result<Vec<u8>, Error> {
    let mut input = input.take(limit_bytes.saturating_add(1));
    let mut bytes = Vec::new();
    let more = read_block(&mut input, HEAD_BYTES, &mut bytes).map_err(&failed)?;
    head::check(path, &bytes)?;
    if more {
        let rest_of_line = LONGEST_LINE_BYTES - HEAD_BYTES;
        let mut more = read_block(&mut input, rest_of_line, &mut bytes).map_err(&failed)?;
        head::check_first_line(path, &bytes)?;
        while more {
            let block = bytes.len().min(LARGEST_BLOCK_BYTES);
            more = read_block(&mut input, block, &mut bytes).map_err(&failed)?;
        }
    }
    if bytes.len() as u64 > limit_bytes {
        return Err(too_large(path, limit_bytes));
    }
    Ok(bytes)
}

/// Whether the block was filled, so that there may be more.
fn read_block(
    input: &mut impl Read,
    block: usize,
    bytes: &mut Vec<u8>,
) -> Result<bool, std::io::Error> {
    bytes.try_reserve_exact(block)?;
    let read = input.take(block as u64).read_to_end(bytes)?;
    Ok(read == block)
}

pub(crate) fn too_large(path: &Path, limit_bytes: u64) -> Error {
    Error::TooLarge {
        path: path.to_owned(),
        limit_bytes,
    }
}

/// The content of a file, decompressed where it is compressed.
pub(crate) fn decompressed<'a>(
    path: &Path,
    bytes: &'a [u8],
    limit_bytes: u64,
) -> Result<Cow<'a, [u8]>, Error> {
    let damaged = |codec| {
        move |problem| Error::Compressed {
            path: path.to_owned(),
            codec,
            problem,
        }
    };
    if bytes.starts_with(GZIP) {
        let decoder = flate2::read::MultiGzDecoder::new(bytes);
        whole(path, decoder, limit_bytes, damaged("gzip")).map(Cow::Owned)
    } else if bytes.starts_with(ZSTD) {
        let failed = damaged("zstd");
        let decoder = zstd::stream::read::Decoder::new(bytes).map_err(&failed)?;
        whole(path, decoder, limit_bytes, failed).map(Cow::Owned)
    } else if bytes.len() as u64 > limit_bytes {
        Err(too_large(path, limit_bytes))
    } else {
        head::check(path, &bytes[..bytes.len().min(HEAD_BYTES)])?;
        head::check_first_line(path, bytes)?;
        Ok(Cow::Borrowed(bytes))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::io::Write;

    use super::*;

    fn failed(problem: std::io::Error) -> Error {
        Error::Read {
            path: "log".into(),
            problem,
        }
    }

    #[test]
    fn a_bomb_is_refused_without_being_unpacked() {
        let rows = b"1,2\n".repeat(1 << 18);
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        gzip.write_all(&rows).unwrap();
        for bomb in [
            gzip.finish().unwrap(),
            zstd::encode_all(rows.as_slice(), 3).unwrap(),
        ] {
            assert!(bomb.len() < 4096);
            let result = decompressed(Path::new("bomb"), &bomb, 1 << 16);
            assert!(matches!(result, Err(Error::TooLarge { .. })));
            assert_eq!(
                decompressed(Path::new("bomb"), &bomb, 1 << 20)
                    .unwrap()
                    .len(),
                1 << 20
            );
        }
    }

    /// The same row again and again, and how much of it was read.
    struct Rows(&'static [u8], usize);

    impl Read for Rows {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let row = &self.0[..self.0.len().min(into.len())];
            into[..row.len()].copy_from_slice(row);
            self.1 += row.len();
            Ok(row.len())
        }
    }

    #[test]
    fn an_endless_input_ends_at_the_limit() {
        let mut rows = Rows(b"1,2\n", 0);
        let result = whole(Path::new("log"), &mut rows, 3 << 20, failed);
        assert!(matches!(result, Err(Error::TooLarge { .. })));
        assert!(rows.1 <= (3 << 20) + 4, "{}", rows.1);
    }

    #[test]
    fn endless_nonsense_is_refused_after_its_first_block() {
        let mut zeros = Rows(&[0; 1024], 0);
        let result = whole(Path::new("log"), &mut zeros, LIMIT_BYTES, failed);
        assert!(matches!(result, Err(Error::NotALog { .. })));
        assert_eq!(zeros.1, HEAD_BYTES);
    }

    #[test]
    fn a_first_line_without_end_is_refused_early() {
        let mut line = Rows(b"speed 1,2", 0);
        let result = whole(Path::new("log"), &mut line, LIMIT_BYTES, failed);
        assert!(matches!(result, Err(Error::LongLine { line: 1, .. })));
        assert!(line.1 < 2 * LONGEST_LINE_BYTES);
    }
}
