use super::random::Random;

/// What there is at the end of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LegEnd {
    /// Nothing but the sign with the next limit.
    Sign,
    /// A bend or junction that is taken at this speed.
    Turn { speed_mps: f64 },
    /// A stop line, with the time at standstill.
    Stop { dwell_s: f64 },
}

/// A stretch of road with one speed limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg {
    /// Distance from the start of the route to the end of the leg.
    pub(super) end_m: f64,
    pub(super) limit_mps: f64,
    pub(super) end: LegEnd,
}

/// One wave of the elevation profile; its slope is `amplitude · sin(2π s/wavelength + phase)`.
#[derive(Debug, Clone, Copy)]
struct Hill {
    amplitude: f64,
    wavelength_m: f64,
    phase_rad: f64,
}

/// A road over smooth hills: town, country road and now and then a motorway.
#[derive(Debug, Clone)]
pub(super) struct Route {
    legs: Vec<Leg>,
    hills: [Hill; 4],
    base_elevation_m: f64,
}

/// Shares of the steepest slope, 5 %, with the range of wavelengths in m.
const HILLS: [(f64, f64, f64); 4] = [
    (0.008, 150.0, 300.0),
    (0.012, 400.0, 800.0),
    (0.015, 1000.0, 2000.0),
    (0.015, 2500.0, 5000.0),
];

impl Route {
    /// Draws a route of at least `length_m`. The legs are long enough to reach the limit from rest and to brake again.
    pub(super) fn draw(random: &mut Random, length_m: f64) -> Self {
        let hills = HILLS.map(|(amplitude, shortest_m, longest_m)| Hill {
            amplitude,
            wavelength_m: random.between(shortest_m, longest_m),
            phase_rad: random.between(0.0, std::f64::consts::TAU),
        });
        let mut route = Self {
            legs: Vec::new(),
            hills,
            base_elevation_m: random.between(100.0, 400.0),
        };
        while route.length_m() < length_m {
            route.add_town(random);
            if random.chance(0.55) {
                route.add_country_road(random);
            }
            if random.chance(0.1) {
                route.add_motorway(random);
            }
        }
        route
    }

    fn length_m(&self) -> f64 {
        self.legs.last().map_or(0.0, |leg| leg.end_m)
    }

    fn add(&mut self, limit_kmh: f64, length_m: f64, end: LegEnd) {
        self.legs.push(Leg {
            end_m: self.length_m() + length_m,
            limit_mps: limit_kmh / 3.6,
            end,
        });
    }

    fn add_town(&mut self, random: &mut Random) {
        let legs = random.between(3.0, 7.0) as usize;
        for _ in 0..legs {
            let (limit_kmh, length_m) = if random.chance(0.25) {
                (30.0, random.between(150.0, 280.0))
            } else {
                (50.0, random.between(260.0, 460.0))
            };
            let end = junction(random, 0.4, 0.45, 16.0);
            self.add(limit_kmh, length_m, end);
        }
    }

    fn add_country_road(&mut self, random: &mut Random) {
        let legs = random.between(1.0, 3.0) as usize;
        for _ in 0..legs {
            let (limit_kmh, length_m) = if random.chance(0.6) {
                (70.0, random.between(500.0, 1000.0))
            } else {
                (100.0, random.between(900.0, 1800.0))
            };
            let end = junction(random, 0.3, 0.45, 12.0);
            self.add(limit_kmh, length_m, end);
        }
    }

    fn add_motorway(&mut self, random: &mut Random) {
        self.add(100.0, random.between(900.0, 1200.0), LegEnd::Sign);
        self.add(120.0, random.between(1800.0, 3000.0), LegEnd::Sign);
        self.add(
            70.0,
            random.between(500.0, 700.0),
            LegEnd::Stop { dwell_s: 8.0 },
        );
    }

    /// The leg of this number; a route that is used up goes on in its last leg.
    pub(super) fn leg(&self, index: usize) -> Leg {
        let open = Leg {
            end_m: f64::INFINITY,
            limit_mps: 50.0 / 3.6,
            end: LegEnd::Sign,
        };
        self.legs.get(index).copied().unwrap_or(open)
    }

    pub(super) fn legs(&self) -> usize {
        self.legs.len()
    }

    pub(super) fn limit_mps(&self, position_m: f64) -> f64 {
        self.leg(self.legs.partition_point(|leg| leg.end_m <= position_m))
            .limit_mps
    }

    /// Slope angle, positive uphill, within ±5 %.
    pub(super) fn slope_rad(&self, position_m: f64) -> f64 {
        let climb = |hill: &Hill| hill.amplitude * hill.angle_rad(position_m).sin();
        self.hills.iter().map(climb).sum::<f64>().asin()
    }

    /// Elevation, the integral of the sine of the slope along the road.
    pub(super) fn elevation_m(&self, position_m: f64) -> f64 {
        let rise_m = |hill: &Hill| {
            let per_rad_m = hill.amplitude * hill.wavelength_m / std::f64::consts::TAU;
            per_rad_m * (hill.phase_rad.cos() - hill.angle_rad(position_m).cos())
        };
        self.base_elevation_m + self.hills.iter().map(rise_m).sum::<f64>()
    }
}

impl Hill {
    fn angle_rad(&self, position_m: f64) -> f64 {
        std::f64::consts::TAU * position_m / self.wavelength_m + self.phase_rad
    }
}

fn junction(random: &mut Random, stop: f64, turn: f64, longest_dwell_s: f64) -> LegEnd {
    let draw = random.between(0.0, 1.0);
    if draw < stop {
        let dwell_s = random.between(3.0, longest_dwell_s);
        LegEnd::Stop { dwell_s }
    } else if draw < stop + turn {
        let speed_mps = random.between(3.5, 6.0);
        LegEnd::Turn { speed_mps }
    } else {
        LegEnd::Sign
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::Stream;
    use super::*;

    #[test]
    fn legs_follow_each_other_and_suffice() {
        let route = Route::draw(&mut Random::new(3, 0, Stream::Route), 20_000.0);
        let mut start_m = 0.0;
        for leg in (0..route.legs()).map(|i| route.leg(i)) {
            assert!(leg.end_m - start_m >= 150.0);
            assert!((route.limit_mps(0.5 * (start_m + leg.end_m)) - leg.limit_mps).abs() < 1e-12);
            start_m = leg.end_m;
        }
        assert!(start_m >= 20_000.0);
    }

    #[test]
    fn elevation_is_the_integral_of_the_slope() {
        let route = Route::draw(&mut Random::new(4, 2, Stream::Route), 5_000.0);
        for k in 0..500 {
            let (s, h) = (10.0 * f64::from(k), 1e-3);
            let rise = (route.elevation_m(s + h) - route.elevation_m(s - h)) / (2.0 * h);
            assert!((rise - route.slope_rad(s).sin()).abs() < 1e-6);
            assert!(rise.abs() <= 0.0501);
        }
    }
}
