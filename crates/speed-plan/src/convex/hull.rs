//! Lines above functions of a speed.

/// `at_zero + slope · x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) at_zero: f64,
    pub(super) slope: f64,
}

impl Line {
    fn through(from: [f64; 2], to: [f64; 2]) -> Self {
        let slope = (to[1] - from[1]) / (to[0] - from[0]);
        Self {
            at_zero: from[1] - slope * from[0],
            slope,
        }
    }
}

/// The least concave function above points `[x, y]` in the order of `x`, as lines of which the lowest counts.
pub(super) fn concave_hull(points: &[[f64; 2]]) -> Vec<Line> {
    let mut hull: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for &point in points {
        if let Some(last) = hull.last_mut()
            && point[0] - last[0] < 1e-9
        {
            last[1] = last[1].max(point[1]);
            continue;
        }
        while let [.., before, last] = hull.as_slice() {
            if Line::through(*before, *last).slope > Line::through(*last, point).slope {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    if let [only] = hull.as_slice() {
        return vec![Line {
            at_zero: only[1],
            slope: 0.0,
        }];
    }
    hull.windows(2)
        .map(|pair| Line::through(pair[0], pair[1]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lowest(lines: &[Line], x: f64) -> f64 {
        let values = lines.iter().map(|line| line.at_zero + line.slope * x);
        values.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_hull_is_above_the_points_and_touches_its_corners() {
        let points = [[0.0, 0.0], [1.0, 0.0], [3.0, 2.0], [5.0, 2.0], [9.0, 1.0]];
        let lines = concave_hull(&points);
        assert_eq!(lines.len(), 3);
        assert!(points.iter().all(|[x, y]| lowest(&lines, *x) >= y - 1e-12));
        for [x, y] in [points[0], points[2], points[3], points[4]] {
            assert!((lowest(&lines, x) - y).abs() < 1e-12);
        }
        assert!((lowest(&lines, 1.0) - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn one_place_is_a_constant() {
        let lines = concave_hull(&[[2.0, 1.0], [2.0, 3.0]]);
        assert!((lowest(&lines, 7.0) - 3.0).abs() < 1e-12);
    }
}
