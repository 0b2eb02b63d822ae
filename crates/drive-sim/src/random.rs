use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What random numbers are drawn for. Each use has a stream of its own, so that a drive keeps its roads when the driver
/// changes, and its motion when sensors become noisy.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stream {
    Route,
    Driver,
    Traffic,
    Sensors,
}

/// Random numbers of one drive and one use. The conversions are our own, so that no dependency can change them.
#[derive(Debug, Clone)]
pub(super) struct Random(ChaCha8Rng);

/// Draws beyond this many standard deviations are pulled back to it.
const TAIL: f64 = 2.5;

impl Random {
    pub(super) fn new(seed: u64, drive: usize, stream: Stream) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(4 * drive as u64 + stream as u64);
        Self(rng)
    }

    /// Uniform in `0..1`, 53 bits.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in `low..high`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// True with a probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// Normal with mean 0, without the tails: a driver's habit has no outliers.
    pub(super) fn habit(&mut self, standard_deviation: f64) -> f64 {
        standard_deviation * self.normal().clamp(-TAIL, TAIL)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn normal_has_mean_0_and_variance_1() {
        let mut random = Random::new(7, 0, Stream::Sensors);
        let draws: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / draws.len() as f64;
        // Four standard errors.
        assert!(mean.abs() < 0.013, "{mean}");
        assert!((variance - 1.0).abs() < 0.018, "{variance}");
    }

    #[test]
    fn streams_differ_and_repeat() {
        let first = |seed, drive, stream| Random::new(seed, drive, stream).unit();
        let draws = [
            first(1, 0, Stream::Route),
            first(1, 0, Stream::Sensors),
            first(1, 1, Stream::Route),
            first(2, 0, Stream::Route),
        ];
        for (i, a) in draws.iter().enumerate() {
            assert!(draws[..i].iter().all(|b| a != b));
        }
        assert_eq!(draws[0], first(1, 0, Stream::Route));
    }
}
