/// Highs and lows that trip drivers learn from differ by at least this, m/s.
pub(super) const PROMINENCE_MPS: f64 = 1.5;

/// A turning point of the speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extremum {
    /// First highest sample.
    High(usize),
    /// Last lowest sample.
    Low(usize),
}

/// Highs and lows in turn, more than a prominence in m/s apart; what has not turned by the end is not among them.
#[must_use]
pub fn zigzag(speed_mps: &[f64], prominence_mps: f64) -> Vec<Extremum> {
    #[derive(Clone, Copy, PartialEq)]
    enum Seeking {
        Either,
        High,
        Low,
    }
    let v = speed_mps;
    let mut extrema = Vec::new();
    let (mut seeking, mut high, mut low) = (Seeking::Either, 0, 0);
    for i in 1..v.len() {
        if seeking != Seeking::Low && v[i] > v[high] {
            high = i;
        }
        if seeking != Seeking::High && v[i] <= v[low] {
            low = i;
        }
        if seeking != Seeking::Low && v[i] < v[high] - prominence_mps {
            extrema.push(Extremum::High(high));
            (seeking, low) = (Seeking::Low, i);
        } else if seeking != Seeking::High && v[i] > v[low] + prominence_mps {
            extrema.push(Extremum::Low(low));
            (seeking, high) = (Seeking::High, i);
        }
    }
    extrema
}

#[cfg(test)]
mod tests {
    use super::Extremum::{High, Low};
    use super::*;

    #[test]
    fn turns_alternate_and_ripple_does_not_count() {
        let speed = [
            0.0, 0.0, 5.0, 10.0, 10.0, 9.0, 10.0, 4.0, 3.0, 3.0, 4.4, 3.2, 8.0, 7.0,
        ];
        assert_eq!(zigzag(&speed, 1.5), [Low(1), High(3), Low(9)]);
        let falling: Vec<f64> = speed.iter().rev().copied().collect();
        assert_eq!(zigzag(&falling, 1.5), [High(1), Low(5), High(7)]);
        assert!(zigzag(&[1.0, 2.4, 1.0], 1.5).is_empty() && zigzag(&[], 1.5).is_empty());
    }
}
