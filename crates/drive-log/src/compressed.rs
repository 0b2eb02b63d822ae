//! gzip and zstd, recognised by their first bytes.

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use crate::Error;

/// What a file may hold after decompression: a day at 100 Hz with fifty columns is a tenth of it.
pub(crate) const LIMIT_BYTES: u64 = 4 << 30;

const GZIP: [u8; 2] = [0x1f, 0x8b];
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// The content of a file, decompressed where it is compressed.
pub(crate) fn decompressed<'a>(
    path: &Path,
    bytes: &'a [u8],
    limit_bytes: u64,
) -> Result<Cow<'a, [u8]>, Error> {
    if bytes.starts_with(&GZIP) {
        read_all(
            path,
            "gzip",
            flate2::read::MultiGzDecoder::new(bytes),
            limit_bytes,
        )
    } else if bytes.starts_with(&ZSTD) {
        let decoder =
            zstd::stream::read::Decoder::new(bytes).map_err(|problem| Error::Compressed {
                path: path.to_owned(),
                codec: "zstd",
                problem,
            })?;
        read_all(path, "zstd", decoder, limit_bytes)
    } else if bytes.len() as u64 > limit_bytes {
        Err(Error::TooLarge {
            path: path.to_owned(),
            limit_bytes,
        })
    } else {
        Ok(Cow::Borrowed(bytes))
    }
}

fn read_all<'a>(
    path: &Path,
    codec: &'static str,
    decoder: impl Read,
    limit_bytes: u64,
) -> Result<Cow<'a, [u8]>, Error> {
    let mut content = Vec::new();
    decoder
        .take(limit_bytes + 1)
        .read_to_end(&mut content)
        .map_err(|problem| Error::Compressed {
            path: path.to_owned(),
            codec,
            problem,
        })?;
    if content.len() as u64 > limit_bytes {
        return Err(Error::TooLarge {
            path: path.to_owned(),
            limit_bytes,
        });
    }
    Ok(Cow::Owned(content))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn a_bomb_is_refused_without_being_unpacked() {
        let zeros = vec![0; 1 << 20];
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        gzip.write_all(&zeros).unwrap();
        for bomb in [
            gzip.finish().unwrap(),
            zstd::encode_all(zeros.as_slice(), 3).unwrap(),
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
}
