//! A portrait in plain sentences. Each says what was measured; a judgement only beside a fleet.

use driver_model::portrait::{AccelOverSpeed, LimitKeeping, Portrait, SMOOTH_WINDOW_S};

use crate::words::plural;

/// Differences below this share are none.
const ALIKE: f64 = 0.05;

/// `vehicle` is the one that energies are of, in words.
#[must_use]
pub fn sentences(driver: &Portrait, fleet: Option<&Portrait>, vehicle: &str) -> Vec<String> {
    let mut sentences = vec![format!(
        "{}, {:.0} km in {:.1} h.",
        plural(driver.drives, "drive"),
        driver.distance_m / 1e3,
        driver.duration_s / 3600.0
    )];
    let of_fleet = |pace: fn(&Portrait) -> &AccelOverSpeed| fleet.map(pace);
    sentences.extend(pace(
        "Accelerates",
        &driver.acceleration,
        of_fleet(|f| &f.acceleration),
    ));
    sentences.extend(pace("Brakes", &driver.braking, of_fleet(|f| &f.braking)));
    sentences.extend(limits(&driver.limits));
    sentences.extend(headway(driver, fleet));
    sentences.extend(smoothness(driver, fleet));
    sentences.extend(economy(driver, fleet, vehicle));
    sentences
}

fn pace(verb: &str, own: &AccelOverSpeed, fleet: Option<&AccelOverSpeed>) -> Option<String> {
    let accel = own.accel_mps2?;
    let mut sentence = format!(
        "{verb} with {:.1} m/s² at the median and seldom with more than {:.1}",
        accel.median, accel.p90
    );
    if let (Some(slow), Some(fast)) = (own.bins.first(), own.bins.last())
        && own.bins.len() > 1
    {
        sentence += &format!(
            ": {:.1} m/s² around {:.0} km/h, {:.1} around {:.0} km/h",
            slow.accel_mps2.median,
            1.8 * (slow.from_mps + slow.to_mps),
            fast.accel_mps2.median,
            1.8 * (fast.from_mps + fast.to_mps),
        );
    }
    let fleet = fleet.and_then(|f| f.accel_mps2);
    sentence += &fleet.map_or_else(String::new, |f| {
        beside(accel.median, f.median, "harder", "more gently")
    });
    Some(sentence + ".")
}

fn limits(limits: &[LimitKeeping]) -> Option<String> {
    let most = limits
        .iter()
        .max_by(|a, b| a.duration_s.total_cmp(&b.duration_s))?;
    let named = |keeping: &LimitKeeping| {
        let excess_kmh = 3.6 * keeping.excess_mps.median;
        let side = if excess_kmh < 0.0 { "under" } else { "over" };
        format!(
            "{:.0} km/h {side} a limit of {:.0}",
            excess_kmh.abs(),
            3.6 * keeping.limit_mps
        )
    };
    let rest: Vec<String> = limits
        .iter()
        .filter(|k| (k.limit_mps - most.limit_mps).abs() > 0.1)
        .map(named)
        .collect();
    let rest = match rest.is_empty() {
        true => String::new(),
        false => format!("; also {}", rest.join(", ")),
    };
    Some(format!(
        "On a free road cruises {}{rest} (medians).",
        named(most)
    ))
}

fn headway(driver: &Portrait, fleet: Option<&Portrait>) -> Option<String> {
    let own = driver.headway.as_ref()?;
    let other = fleet.and_then(|f| f.headway.as_ref());
    Some(format!(
        "Follows at {:.1} s at the median, under 1 s for {:.0} % of the time behind a vehicle{}.",
        own.headway_s.median,
        own.under_1_s_pct,
        other.map_or_else(String::new, |f| beside(
            own.headway_s.median,
            f.headway_s.median,
            "farther behind",
            "closer"
        )),
    ))
}

/// `None` where no drive moves.
fn smoothness(driver: &Portrait, fleet: Option<&Portrait>) -> Option<String> {
    let own = &driver.dynamics;
    let moves = own.relative_positive_accel_mps2.is_finite() && own.steady_pct.is_finite();
    moves.then(|| format!(
        "Stops {:.1} times per km and holds a steady speed for {:.0} % of the time in motion; relative positive acceleration \
         {:.2} m/s²{}.",
        own.stops_per_km,
        own.steady_pct,
        own.relative_positive_accel_mps2,
        fleet.map_or_else(String::new, |f| beside(
            own.relative_positive_accel_mps2,
            f.dynamics.relative_positive_accel_mps2,
            "livelier",
            "calmer"
        )),
    ))
}

fn economy(driver: &Portrait, fleet: Option<&Portrait>, vehicle: &str) -> Option<String> {
    let own = driver.economy.consumption_kwh_per_100km?;
    let smooth = driver.economy.smooth_consumption_kwh_per_100km?;
    let other = fleet.and_then(|f| f.economy.consumption_kwh_per_100km);
    Some(format!(
        "Uses {own:.1} kWh per 100 km by the vehicle model ({vehicle}){}; the same drives with speed averaged over {SMOOTH_WINDOW_S:.0} s, never \
         more than {:.0} m from the recorded place, would use {smooth:.1}: restlessness costs {:.0} %.",
        other.map_or_else(String::new, |f| beside(own, f, "more", "less")),
        driver.economy.largest_deviation_m,
        driver.economy.restless_pct?,
    ))
}

/// `, 12 % harder than the fleet`.
fn beside(own: f64, fleet: f64, more: &str, less: &str) -> String {
    let ratio = own / fleet - 1.0;
    match ratio {
        r if !r.is_finite() => String::new(),
        r if r.abs() < ALIKE => ", like the fleet".to_owned(),
        r if r > 0.0 => format!(", {:.0} % {more} than the fleet", 100.0 * r),
        r => format!(", {:.0} % {less} than the fleet", -100.0 * r),
    }
}

#[cfg(test)]
mod tests {
    use super::beside;

    #[test]
    fn differences_are_said_with_their_direction() {
        assert_eq!(
            beside(1.3, 1.0, "harder", "softer"),
            ", 30 % harder than the fleet"
        );
        assert_eq!(
            beside(0.5, 1.0, "harder", "softer"),
            ", 50 % softer than the fleet"
        );
        assert_eq!(beside(1.02, 1.0, "harder", "softer"), ", like the fleet");
        assert_eq!(beside(1.0, 0.0, "harder", "softer"), "");
    }
}
