//! A vehicle fitted to drives, and judged on each with that one left out.

mod cycles;
mod words;

use driver_model::energy::{EnergyInput, EnergyScore};
use driver_model::{Error as ModelError, LeftOut, Motion, motion};
use ev_energy::{
    CalibrationRecord, JOULES_PER_KWH, Vehicle,
    calibration::{
        Calibration, CalibrationTrip, Fold, ParameterEstimate, calibrate, leave_one_out,
    },
    comparison::Comparison,
};
use rayon::prelude::*;
use serde::Serialize;

use crate::{Error, HoldOut, Split};
pub use cycles::CalibratedCycle;

/// A drive must have measured power for this long: every drive weighs the same.
const SHORTEST_S: f64 = 60.0;

/// Bins of [`Residuals`] hold this or nothing.
const SPEED_BIN_MPS: f64 = 2.5;
const POWER_BIN_W: f64 = 5e3;
const TEMPERATURE_BIN_K: f64 = 5.0;

/// A vehicle fitted to drives, and how far to trust it.
#[derive(Debug, Clone, Serialize)]
pub struct CalibrationReport {
    /// The fitted vehicle.
    #[serde(skip)]
    pub vehicle: Vehicle,
    /// What was fitted.
    pub parameters: Vec<ParameterEstimate>,
    /// Correlation of the estimates.
    pub correlation: Correlation,
    /// Every trip, with the vehicle fitted to all and with that fitted to the others.
    pub trips: Vec<CalibrationTripScore>,
    /// All trips together.
    pub summary: CalibrationSummary,
    /// Model minus measured power of the fitted vehicle.
    pub residuals: Residuals,
    /// Standard cycles for which the vehicle file has published consumption.
    pub cycles: Vec<CalibratedCycle>,
    /// Drives that cannot be calibrated to, which were left out.
    pub left_out_drives: Vec<LeftOut>,
}

impl CalibrationReport {
    /// The parameters that the trips do not tell, which have their values from before.
    pub fn untold(&self) -> impl Iterator<Item = &ParameterEstimate> {
        self.parameters
            .iter()
            .filter(|parameter| !parameter.identified)
    }

    /// What the vehicle file says of the calibration; `None` where no trip could be held out, or nothing was told.
    #[must_use]
    pub fn record(&self) -> Option<CalibrationRecord> {
        if self.untold().count() == self.parameters.len() {
            return None;
        }
        let score = &self.summary.held_out;
        Some(CalibrationRecord {
            trips: self.trips.len(),
            held_out_mean_abs_error_pct: score.mean_abs_error_pct?,
            held_out_total_error_pct: score.total_error_pct?,
            held_out_median_power_rmse_w: score.median_power_rmse_w?,
        })
    }
}

/// Correlation of estimates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// Parameters, by row and column.
    pub keys: Vec<&'static str>,
    /// Correlations.
    pub matrix: Vec<Vec<f64>>,
}

/// A trip of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationTripScore {
    /// Name of the drive.
    pub name: String,
    /// Volts times amps, J.
    pub measured_terminal_energy_j: f64,
    /// Temperature of the air, °C, if known.
    pub ambient_degc: Option<f64>,
    /// Error of the trip's energy by the vehicle before the fit, %.
    pub start_error_pct: Option<f64>,
    /// By the vehicle fitted to all trips, %.
    pub fitted_error_pct: Option<f64>,
    /// By a vehicle fitted to all others, %.
    pub held_out_error_pct: Option<f64>,
    /// Root mean square of the power's error with the vehicle fitted to all, W.
    pub fitted_power_rmse_w: Option<f64>,
    /// With a vehicle fitted to all others, W.
    pub held_out_power_rmse_w: Option<f64>,
}

/// All trips of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CalibrationSummary {
    /// The vehicle before.
    pub start: EnergyScore,
    /// Fitted to all.
    pub fitted: EnergyScore,
    /// Each trip with the vehicle fitted to the others.
    pub held_out: EnergyScore,
}

/// Model minus measured power against what it may depend on.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Residuals {
    /// Against speed, m/s.
    pub speed: Vec<ResidualBin>,
    /// Against measured power, W.
    pub power: Vec<ResidualBin>,
    /// Against the temperature of the air, °C.
    pub temperature: Vec<ResidualBin>,
}

/// Residuals in a range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResidualBin {
    /// From here.
    pub from: f64,
    /// Up to here.
    pub to: f64,
    /// Means of half a second.
    pub count: usize,
    /// Mean residual, W.
    pub mean_w: f64,
    /// Root mean square of the residuals, W.
    pub rms_w: f64,
}

/// Fits a vehicle to the measured power of drives and leaves out one trip after the other, until the trips tell every parameter that
/// is fitted; the others keep their values. Drives with less than a minute of measured power, or with measured energy that is negative
/// on the whole, are left out. The start of a drive is taken for a cold start, or with `warm_start` for that of a warm car. `finished` is called after every fold, as often as there are drives or a multiple of it, and once before.
/// Folds run in parallel on the current rayon pool; the result does not depend on the number of threads.
///
/// # Errors
/// [`Error::Model`]: samples outside the vehicle model's range, a fit that fails, or no drive that can be calibrated to.
pub fn calibrate_vehicle(
    motions: &[Motion],
    vehicle: &Vehicle,
    warm_start: bool,
    finished: &(dyn Fn() + Sync),
) -> Result<CalibrationReport, Error> {
    let drives: Vec<&[Motion]> = motion::drives(motions).collect();
    let measured: Vec<MeasuredDrive> = drives
        .into_par_iter()
        .map(|motions| MeasuredDrive::of(motions, vehicle, warm_start))
        .collect::<Result<_, Error>>()?;
    let (measured, left_out_drives) = usable(measured)?;
    let trips: Vec<&CalibrationTrip> = measured.iter().map(|drive| &drive.trip).collect();
    let names = measured.iter().map(|drive| drive.name.clone());
    let (all, folds) = fit(vehicle, &trips, &HoldOut::one_by_one(names), finished)?;
    let compare = |vehicle: &Vehicle| -> Result<Vec<Comparison>, Error> {
        trips
            .iter()
            .map(|trip| Ok(trip.compare(vehicle).map_err(ModelError::from)?))
            .collect()
    };
    let before = compare(vehicle)?;
    let fitted = compare(&all.vehicle)?;
    let held_out: Vec<Comparison> = folds.iter().map(|fold| fold.held_out).collect();
    let scores = measured
        .iter()
        .enumerate()
        .map(|(k, drive)| CalibrationTripScore {
            name: drive.name.clone(),
            measured_terminal_energy_j: fitted[k].measured_j,
            ambient_degc: drive.ambient_degc,
            start_error_pct: before[k].error_pct(),
            fitted_error_pct: fitted[k].error_pct(),
            held_out_error_pct: held_out.get(k).and_then(Comparison::error_pct),
            fitted_power_rmse_w: fitted[k].power_rmse_w(),
            held_out_power_rmse_w: held_out.get(k).and_then(Comparison::power_rmse_w),
        })
        .collect();
    let Calibration {
        vehicle: fitted_vehicle,
        parameters,
        correlation,
        ..
    } = all;
    Ok(CalibrationReport {
        residuals: residuals(&trips, &fitted_vehicle)?,
        cycles: cycles::cycles(vehicle, &fitted_vehicle)?,
        vehicle: fitted_vehicle,
        correlation: Correlation {
            keys: parameters.iter().map(|parameter| parameter.key).collect(),
            matrix: correlation,
        },
        parameters,
        trips: scores,
        summary: CalibrationSummary {
            start: EnergyScore::of(&before),
            fitted: EnergyScore::of(&fitted),
            held_out: EnergyScore::of(&held_out),
        },
        left_out_drives,
    })
}

/// Drives that can be calibrated to, and the others with the reason.
fn usable(drives: Vec<MeasuredDrive>) -> Result<(Vec<MeasuredDrive>, Vec<LeftOut>), Error> {
    let (mut usable, mut left_out) = (Vec::new(), Vec::new());
    for drive in drives {
        match drive.unusable() {
            Some(reason) => left_out.push(LeftOut::new(&drive.name, reason)),
            None => usable.push(drive),
        }
    }
    if usable.is_empty() {
        let task = "calibration";
        return Err(ModelError::NothingUsable { task, left_out }.into());
    }
    Ok((usable, left_out))
}

/// The fit to all trips, and those without each of them, with every parameter held that the intervals do not tell.
fn fit(
    vehicle: &Vehicle,
    trips: &[&CalibrationTrip],
    hold_out: &HoldOut,
    finished: &(dyn Fn() + Sync),
) -> Result<(Calibration, Vec<Fold>), Error> {
    let mut all = calibrate(vehicle, trips).map_err(ModelError::from)?;
    finished();
    loop {
        let fold = |split: Split<'_>| {
            let fold = leave_one_out(vehicle, &all, trips, split.fold());
            Ok(fold.map_err(ModelError::from)?)
        };
        let folds = match trips.len() {
            // Of one trip nothing can be left out.
            1 => Vec::new(),
            _ => hold_out.run(finished, fold)?,
        };
        all = all.with_intervals(&folds);
        let fewer = all.without_untold(vehicle, trips);
        match fewer.map_err(ModelError::from)? {
            None => return Ok((all, folds)),
            Some(fewer) => all = fewer,
        }
    }
}

/// A drive as the fit takes it.
struct MeasuredDrive {
    name: String,
    ambient_degc: Option<f64>,
    trip: CalibrationTrip,
    /// At the terminals, J.
    measured_j: f64,
}

impl MeasuredDrive {
    /// Why it cannot be calibrated to.
    fn unusable(&self) -> Option<String> {
        if self.trip.measured_s() < SHORTEST_S {
            return Some(
                "less than a minute of volts and amps, which are the measured power".to_owned(),
            );
        }
        let kwh = self.measured_j / JOULES_PER_KWH;
        (kwh < 0.0).then(|| {
            format!("measured energy is negative on the whole, {kwh:.3} kWh: turn the sign of the current, or it is downhill")
        })
    }

    fn of(motions: &[Motion], vehicle: &Vehicle, warm_start: bool) -> Result<Self, Error> {
        let mut trip = CalibrationTrip::default();
        let mut ambient_degc = None;
        for (motion, input) in motions.iter().zip(EnergyInput::of_drive(motions)) {
            ambient_degc = ambient_degc.or(input.weather.map(|weather| weather.temperature_degc));
            let mut driven = input.trip();
            if warm_start {
                driven.since_cold_start_s = None;
            }
            trip.add(vehicle, &driven, &input.power_w, &input.motor_torque_nm)
                .map_err(|error| ModelError::from(error).in_log(motion.name()))?;
        }
        Ok(Self {
            name: motion::name(motions).to_owned(),
            ambient_degc,
            measured_j: trip.compare(vehicle).map_err(ModelError::from)?.measured_j,
            trip,
        })
    }
}

fn residuals(trips: &[&CalibrationTrip], vehicle: &Vehicle) -> Result<Residuals, Error> {
    let mut speed = Bins::new(SPEED_BIN_MPS);
    let mut power = Bins::new(POWER_BIN_W);
    let mut temperature = Bins::new(TEMPERATURE_BIN_K);
    for trip in trips {
        trip.for_each_mean(vehicle, |mean, weather| {
            let measured_w = mean.measured_w.unwrap_or_default();
            let residual_w = mean.modelled_w - measured_w;
            speed.add(mean.speed_mps, residual_w);
            power.add(measured_w, residual_w);
            if let Some(weather) = weather {
                temperature.add(weather.temperature_degc, residual_w);
            }
        })
        .map_err(ModelError::from)?;
    }
    Ok(Residuals {
        speed: speed.finish(),
        power: power.finish(),
        temperature: temperature.finish(),
    })
}

/// Sums by equal ranges.
struct Bins {
    width: f64,
    /// Count, sum, sum of squares by the number of the range.
    sums: std::collections::BTreeMap<i64, (usize, f64, f64)>,
}

impl Bins {
    fn new(width: f64) -> Self {
        Self {
            width,
            sums: std::collections::BTreeMap::new(),
        }
    }

    fn add(&mut self, place: f64, value: f64) {
        let sums = self
            .sums
            .entry((place / self.width).floor() as i64)
            .or_default();
        *sums = (sums.0 + 1, sums.1 + value, sums.2 + value * value);
    }

    fn finish(self) -> Vec<ResidualBin> {
        let width = self.width;
        let bin = |(number, (count, sum, squares)): (i64, (usize, f64, f64))| ResidualBin {
            from: number as f64 * width,
            to: (number + 1) as f64 * width,
            count,
            mean_w: sum / count as f64,
            rms_w: (squares / count as f64).sqrt(),
        };
        self.sums.into_iter().map(bin).collect()
    }
}
