//! Disturbances that are larger than what the controllers were told to expect.

use testbed_sim::Disturbances;
use unicycle_cbf::{Demands, Hardening, Limits};

use crate::render::table::number;

/// A note with both numbers of each, where the settings would give a guarantee otherwise.
pub(super) fn note(
    disturbances: &Disturbances,
    stated: &Hardening,
    demands: &Demands,
) -> Option<String> {
    if !demands.is_guaranteed {
        return None;
    }
    let beyond = [
        Beyond {
            what: "noise of positions",
            by: 1e3,
            unit: "mm",
            comes: disturbances.position_noise_m,
            stated: stated.position_noise_m,
        },
        Beyond {
            what: "noise of headings",
            by: 1.0_f64.to_degrees(),
            unit: "°",
            comes: disturbances.heading_noise_rad,
            stated: stated.heading_noise_rad,
        },
        Beyond {
            what: "error of wheels",
            by: 100.0,
            unit: "%",
            comes: disturbances.wheel_error,
            stated: stated.wheel_error,
        },
        Beyond {
            what: "time constant of motors",
            by: 1e3,
            unit: "ms",
            comes: disturbances.motor_time_constant_s,
            stated: Limits::MOTORS_S,
        },
    ];
    let texts: Vec<String> = beyond.iter().filter_map(Beyond::text).collect();
    if texts.is_empty() {
        return None;
    }
    Some(format!(
        "disturbances are larger than the controllers expect, nothing is guaranteed: {}; state them under [scenario.controller.hardening]",
        texts.join(", ")
    ))
}

struct Beyond {
    what: &'static str,
    /// From SI to the unit
    by: f64,
    unit: &'static str,
    comes: f64,
    stated: f64,
}

impl Beyond {
    fn text(&self) -> Option<String> {
        // Half a degree is not the same to the last digit everywhere.
        (self.comes > self.stated * (1.0 + 1e-9)).then(|| {
            format!(
                "{} of {} {unit} and not {} {unit}",
                self.what,
                number(self.by * self.comes, 1),
                number(self.by * self.stated, 1),
                unit = self.unit,
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use testbed_sim::Disturbances;
    use unicycle_cbf::{Demands, Preset, Scenario, Testbed};

    use super::note;

    fn noted(preset: Preset, disturbances: &Disturbances) -> Option<String> {
        let scenario = Testbed::Khepera.scenario("on-off", preset).ok()?;
        let stated = scenario.controller.hardening;
        let demands = Demands::new(&Scenario::new(scenario).ok()?);
        note(disturbances, &stated, &demands)
    }

    #[test]
    fn only_what_is_larger_than_stated_is_noted_with_both_numbers() {
        assert_eq!(noted(Preset::Hardened, &Disturbances::HARD), None);
        let larger = Disturbances {
            position_noise_m: 0.01,
            wheel_error: 0.25,
            ..Disturbances::HARD
        };
        let text = noted(Preset::Hardened, &larger).unwrap_or_default();
        for words in ["10.0 mm and not 3.0 mm", "25.0 % and not 10.0 %"] {
            assert!(text.contains(words), "{text}");
        }
        assert!(!text.contains("headings"), "{text}");
        assert_eq!(
            noted(Preset::Thesis, &larger),
            None,
            "it guarantees nothing anyway"
        );
    }
}
