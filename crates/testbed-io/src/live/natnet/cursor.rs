//! Checked reads of little-endian fields.

use super::frame::Malformed;

pub(super) struct Cursor<'a> {
    rest: &'a [u8],
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Bytes that were not read yet.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    pub(super) fn take(&mut self, bytes: usize) -> Result<&'a [u8], Malformed> {
        let (taken, rest) = self.rest.split_at_checked(bytes).ok_or(self.cut(bytes))?;
        self.rest = rest;
        Ok(taken)
    }

    pub(super) fn skip(&mut self, bytes: usize) -> Result<(), Malformed> {
        self.take(bytes).map(|_| ())
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or(self.cut(N))?;
        self.rest = rest;
        Ok(*taken)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Malformed> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, Malformed> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Malformed> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, Malformed> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Result<f32, Malformed> {
        self.array().map(f32::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64, Malformed> {
        self.array().map(f64::from_le_bytes)
    }

    pub(super) fn floats<const N: usize>(&mut self) -> Result<[f32; N], Malformed> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = self.f32()?;
        }
        Ok(floats)
    }

    /// A count of things of at least `bytes` each, for which there are bytes enough.
    pub(super) fn count(&mut self, bytes: usize) -> Result<usize, Malformed> {
        let count = self.u32()?;
        self.fits(count, bytes)
    }

    /// `count` itself if that many things of at least `bytes` each can follow.
    pub(super) fn fits(&self, count: u32, bytes: usize) -> Result<usize, Malformed> {
        let left = self.left();
        let fitting = usize::try_from(count).ok().filter(|count| {
            let needed = count.checked_mul(bytes);
            needed.is_some_and(|needed| needed <= left)
        });
        fitting.ok_or(Malformed::Count { count, left })
    }

    /// A size in bytes of what follows.
    pub(super) fn size(&mut self) -> Result<usize, Malformed> {
        self.count(1)
    }

    /// A name, without the zero at its end.
    pub(super) fn name(&mut self) -> Result<&'a [u8], Malformed> {
        let end = self.rest.iter().position(|byte| *byte == 0);
        let name = self.take(end.ok_or(Malformed::Name)?)?;
        self.skip(1)?;
        Ok(name)
    }

    fn cut(&self, needed: usize) -> Malformed {
        let left = self.left();
        Malformed::Cut { needed, left }
    }
}
