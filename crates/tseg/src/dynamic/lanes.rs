//! One value per column of a walk, and vector instructions for all of them at once.

use std::ops::{Index, IndexMut};

/// Columns that are walked together: the segments `[l, r₀), [l, r₀ + 1), …`.
pub(crate) const LANES: usize = 16;

/// One value per column, aligned for vector instructions.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

impl Lanes {
    pub(crate) fn all(value: f64) -> Self {
        Self([value; LANES])
    }
}

impl Index<usize> for Lanes {
    type Output = f64;
    #[inline(always)]
    fn index(&self, lane: usize) -> &f64 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Lanes {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0[lane]
    }
}

#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The first values of a longer slice.
#[inline(always)]
pub(crate) fn lanes(values: &[f64]) -> &[f64; LANES] {
    match values.first_chunk() {
        Some(lanes) => lanes,
        None => &[0.0; LANES],
    }
}

#[inline(always)]
pub(crate) fn extremes(values: &Lanes) -> (f64, f64) {
    let (mut least, mut most) = (*values, *values);
    let mut half = LANES / 2;
    while half > 0 {
        for j in 0..half {
            least[j] = smaller(least[j], least[j + half]);
            most[j] = larger(most[j], most[j + half]);
        }
        half /= 2;
    }
    (least[0], most[0])
}

/// A kernel is compiled once per instruction set and run with the best that the processor has. Rust contracts no
/// multiplications and additions, so results do not depend on which.
pub(crate) fn vectorised<K: pulp::NullaryFnOnce>(kernel: K) -> K::Output {
    pulp::Arch::new().dispatch(kernel)
}
