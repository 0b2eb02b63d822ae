//! Loops that the compiler turns into the vector instructions of the machine at hand, and what such loops need.

/// Runs `work`, compiled for the best instruction set of this machine. `work` must be `#[inline(always)]`, with everything
/// that it calls.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    struct Run<F>(F);
    impl<R, F: FnOnce() -> R> pulp::NullaryFnOnce for Run<F> {
        type Output = R;
        #[inline(always)]
        fn call(self) -> R {
            (self.0)()
        }
    }
    pulp::Arch::new().dispatch(Run(work))
}

/// `eˣ` for `x ≤ 0`, to about one unit in the last place; 0 becomes exactly 1. W. J. Cody, W. Waite: Software Manual for
/// the Elementary Functions, 1980: `x = k ln 2 + r`, and a polynomial in `r`.
#[inline(always)]
pub(crate) fn exp_f64(x: f64) -> f64 {
    // Adding this leaves the nearest whole number in the low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = x.max(-700.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
    let mut sum = 1.0 / 479_001_600.0;
    for coefficient in [
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * r + coefficient;
    }
    sum * power
}

/// As [`exp_f64`] in single precision.
#[inline(always)]
pub(crate) fn exp_f32(x: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.max(-87.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(127 << 23));
    let mut sum = 1.0 / 5040.0;
    for coefficient in [
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * r + coefficient;
    }
    sum * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_right_to_the_last_places() {
        for k in 0..200_000 {
            let x = -f64::from(k) * 3.4e-3;
            let exact = x.exp();
            assert!((exp_f64(x) - exact).abs() <= 4e-16 * exact, "{x}");
            let (x, single) = (x as f32, exp_f32(x as f32));
            if x > -87.0 {
                let exact = x.exp();
                assert!(
                    (single - exact).abs() <= 2.5e-7 * exact,
                    "{x}: {single} {exact}"
                );
            }
        }
        assert!(exp_f64(0.0).to_bits() == 1.0_f64.to_bits());
        assert!(exp_f64(-1e300) >= 0.0 && exp_f64(f64::NEG_INFINITY) < 1e-300);
    }
}
