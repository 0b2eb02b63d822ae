//! What is predicted of a drive that is still going on, in lines.

use std::fmt::Write as _;

use driver_model::live::{Event, Forecast, Horizon};

/// A phase whose like have mostly ended by then has likely ended.
const LIKELY_PCT: f64 = 50.0;

/// Of all lines, for a terminal.
#[must_use]
pub fn header() -> String {
    format!(
        "\u{1b}[1m{:>9}  {:12}  {:>6}  km/h after so many seconds, and where 90 % lie\u{1b}[0m\n",
        "at s", "what", "km/h"
    )
}

/// One event in one line; a remark is its text.
#[must_use]
pub fn line(event: &Event) -> String {
    let mut line = match event {
        Event::Ahead {
            time_s,
            speed_mps,
            horizons,
            ..
        } => {
            let mut line = start(*time_s, "ahead", *speed_mps);
            horizons.iter().for_each(|at| horizon(&mut line, at));
            line
        }
        Event::PhaseBegins {
            phase,
            begin_s,
            from_s,
            known_s,
            speed_mps,
            lead_influenced,
            forecast,
            ..
        } => {
            let mut line = start(*from_s, phase.name(), *speed_mps);
            let _ = write!(line, "  began at {begin_s:.1} s, known at {known_s:.1} s;");
            likely(&mut line, forecast);
            if *lead_influenced {
                line.push_str("; a vehicle ahead is near, and the model knows free phases");
            }
            line
        }
        Event::PhaseEnds {
            phase,
            begin_s,
            end_s,
            end_speed_mps,
            counts,
            rmse_mps,
            in_band_pct,
        } => {
            let mut line = start(*end_s, phase.name(), *end_speed_mps);
            let duration_s = end_s - begin_s;
            let _ = write!(line, "  ended after {duration_s:.1} s");
            if let (Some(rmse_mps), Some(in_band_pct)) = (rmse_mps, in_band_pct) {
                let rmse_kmh = rmse_mps * 3.6;
                let _ = write!(
                    line,
                    ", off by {rmse_kmh:.1} km/h, {in_band_pct:.0} % in the band"
                );
            }
            if !counts {
                line.push_str("; none that counts");
            }
            line
        }
        Event::Remark { text } => text.clone(),
    };
    line.push('\n');
    line
}

fn start(time_s: f64, what: &str, speed_mps: f64) -> String {
    format!("{time_s:>9.1}  {what:12}  {:>6.1}", speed_mps * 3.6)
}

fn horizon(line: &mut String, at: &Horizon) {
    let _ = write!(line, "  {} s {:.1}", at.horizon_s, at.speed_mps * 3.6);
    if let (Some(low_mps), Some(high_mps)) = (at.low_mps, at.high_mps) {
        let _ = write!(line, " ({:.1}–{:.1})", low_mps * 3.6, high_mps * 3.6);
    }
}

/// The seconds that most of the similar phases lasted, at least one, and what comes after.
fn likely(line: &mut String, forecast: &Forecast) {
    let lasting = |second: &driver_model::live::Second| second.going_on_pct >= LIKELY_PCT;
    let seconds = forecast.seconds.iter().enumerate();
    for (_, second) in seconds.take_while(|(k, second)| *k == 0 || lasting(second)) {
        let at = Horizon {
            horizon_s: second.after_s,
            speed_mps: second.speed_mps,
            low_mps: Some(second.low_mps),
            high_mps: Some(second.high_mps),
        };
        horizon(line, &at);
    }
    let _ = write!(
        line,
        "; likely to {:.0} km/h, {:.1} s in all; {:.0} % like it come to count",
        forecast.end_speed_mps * 3.6,
        forecast.duration_s,
        forecast.counts_pct
    );
}
