mod text;

use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};
use driver_model::cruise::CruiseModel;
use driver_model::following::{FollowingKind, FollowingModel};
use driver_model::speed_ahead::{DirectKind, DirectModel, DirectSettings};
use driver_model::trip_driver::TripDriver;
use driver_model::{
    DriverModel, Error, FittedModel, LeftOut, ModelFile, ModelKind, Motion, PhaseKind, PointsOf,
    TrainingInput, TrainingRecord, TrainingSet, Trip,
};
use serde::Serialize;

use super::left_out;
use super::motions::{mention_finer_grids, motions};
use super::phases::PhaseArgs;
use super::prior::PriorArgs;
use crate::exit::Outcome;
use crate::flags::{Context, Format, LogArgs};
use crate::inputs::{self, Input};
use crate::numbers;
use crate::output;
use crate::render::json::Document;
use crate::require::{Figures, RequireArgs};

/// Fit one model and write it to a file
///
/// The model learns from the acceleration phases of the logs, or from their braking phases. With logs of other drivers
/// it learns from those, too, each of their phases with the prior weight. Models of cruising and following learn from
/// stretches of their own kind.
#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Examples:
  drivekit fit logs/ --model profile-onset -o driver.json
  drivekit fit logs/*.csv --model inverse -o inverse.json && drivekit predict new.csv --model inverse.json
  drivekit fit anna/ --prior others/ --prior-weight 0.33 --model profile-conditioned -o anna.json
  drivekit fit logs/ --model rise-time --phase braking -o braking.json
  drivekit fit logs/ --model idm -o following.json
  drivekit fit logs/ --model svr-rbf --horizons 1,2,5,10 -o ahead.json && drivekit predict new.csv --model ahead.json --horizon 5
  drivekit fit logs/ --model trip-driver -o trips.json
  drivekit fit logs/ --model exponential --to samples -o all.json        the second row of Table 3.6")]
pub(crate) struct FitArgs {
    #[command(flatten)]
    #[serde(flatten)]
    logs: LogArgs,
    #[command(flatten)]
    #[serde(flatten)]
    phases: PhaseArgs,
    #[command(flatten)]
    #[serde(flatten)]
    prior: PriorArgs,
    /// Model of phases: inverse, exponential, exponential-amplitude, rise-time, rise-time-exact, transition-point, profile, profile-conditioned,
    /// profile-onset, or a baseline; of holding a speed: cruise; of following: idm, constant-time-gap; of the next seconds: svr-linear,
    /// svr-quadratic, svr-cubic, svr-rbf, least-squares, blend, ridge, boosted-trees; of whole trips: trip-driver
    #[arg(long, value_name = "KIND")]
    model: Model,
    /// Phases to learn from
    #[arg(long, value_enum, default_value_t = Phase::Acceleration, value_name = "KIND")]
    phase: Phase,
    /// What a function of speed (inverse, exponential, exponential-amplitude) is fitted to
    #[arg(long, value_enum, default_value_t = Points::Means, value_name = "POINTS")]
    to: Points,
    /// Seconds ahead of a model of the next seconds, comma separated
    #[arg(long, value_delimiter = ',', default_values_t = DirectSettings::default().horizons_s, value_parser = numbers::horizon_s, value_name = "S")]
    horizons: Vec<f64>,
    /// Let a model of the next seconds know the slope ahead, if it does not come from the elevation of the same drive
    #[arg(long)]
    slope_ahead: bool,
    /// File for the model
    #[arg(short, long, value_name = "FILE.json")]
    #[serde(skip)]
    output: PathBuf,
    #[command(flatten)]
    #[serde(skip)]
    require: RequireArgs,
}

/// Any model that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Model {
    Phase(ModelKind),
    Following(FollowingKind),
    Cruise,
    SpeedAhead(DirectKind),
    Trip,
}

impl Serialize for Model {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Model {
    /// Whether it learns from phases and stretches.
    fn is_of_phases(self) -> bool {
        !matches!(self, Self::SpeedAhead(_) | Self::Trip)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Phase(kind) => kind.name(),
            Self::Following(kind) => kind.name(),
            Self::Cruise => "cruise",
            Self::SpeedAhead(kind) => kind.name(),
            Self::Trip => "trip-driver",
        }
    }
}

impl std::str::FromStr for Model {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "cruise" => return Ok(Self::Cruise),
            "trip-driver" => return Ok(Self::Trip),
            _ => {}
        }
        if let Some(kind) = FollowingKind::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
        {
            return Ok(Self::Following(kind));
        }
        match text.parse::<DirectKind>() {
            Ok(kind) if kind.is_fitted() => Ok(Self::SpeedAhead(kind)),
            _ => text.parse().map(Self::Phase).map_err(|known: String| {
                let ahead = DirectKind::ALL
                    .into_iter()
                    .filter(|kind| kind.is_fitted())
                    .map(DirectKind::name);
                let ahead: Vec<&str> = ahead.collect();
                format!(
                    "{known}, cruise, idm, constant-time-gap, {}, trip-driver",
                    ahead.join(", ")
                )
            }),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Phase {
    Acceleration,
    Braking,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Points {
    /// Means of segments
    Means,
    /// All samples of segments
    Samples,
}

/// A fitted model with what it was fitted to.
struct Fitted {
    model: FittedModel,
    phases: usize,
    points: usize,
    /// Of functions of speed.
    residual_sum_of_squares: Option<f64>,
    /// Drives that it could learn nothing from.
    left_out: Vec<LeftOut>,
}

pub(crate) fn run(args: &FitArgs, context: &Context) -> anyhow::Result<Outcome> {
    args.check()?;
    args.require
        .check(&Figures::new(include_str!("../../figures/fit.txt")))?;
    let inputs = inputs::load_once(&args.logs, context)?;
    let trips = if args.model.is_of_phases() {
        args.phases.trips(&inputs, context)?
    } else {
        Vec::new()
    };
    let prior_inputs = args.prior.inputs(&args.logs.reading, &inputs, context)?;
    let prior = args.phases.trips(&prior_inputs, context)?;
    let fitted = match args.model {
        Model::Phase(kind) => named(args.fit_phases(kind, &trips, &prior), &trips)?,
        Model::Cruise => named(fit_cruise(&trips), &trips)?,
        Model::Following(kind) => named(fit_following(kind, &trips), &trips)?,
        Model::SpeedAhead(kind) => args.fit_ahead(kind, &inputs, context)?,
        Model::Trip => args.fit_trip_driver(&inputs)?,
    };
    left_out::mention(&fitted.left_out, context);
    let record = TrainingRecord {
        phases: fitted.phases,
        points: fitted.points,
        inputs: hashes(&inputs),
        prior_inputs: hashes(&prior_inputs),
        prior_weight: if args.prior.is_given() {
            args.prior.weight()
        } else {
            0.0
        },
    };
    let config = serde_json::to_value(args)?;
    let file = ModelFile::new(fitted.model, record, config);
    let json = file.to_json()?;
    output::write_file(&args.output, |out| Ok(out.write_all(json.as_bytes())?))?;
    let residuals = fitted.residual_sum_of_squares;
    let body = Body {
        model: &file.model,
        training_phases: file.training.phases,
        training_points: file.training.points,
        residual_sum_of_squares: residuals,
        left_out_drives: &fitted.left_out,
    };
    let mut document = Document::new("fit", args, &inputs, body).beside(&prior_inputs);
    let outcome = document.judged(&args.require)?;
    match context.format {
        Format::Json => output::print_json(&document)?,
        Format::Text => output::print_text(&text::text(args, &file, residuals))?,
    }
    Ok(inputs.outcome().and(prior_inputs.outcome()).and(outcome))
}

impl FitArgs {
    fn fit_phases(&self, model: ModelKind, own: &[Trip], prior: &[Trip]) -> Result<Fitted, Error> {
        let kind = match self.phase {
            Phase::Acceleration => PhaseKind::Acceleration,
            Phase::Braking => PhaseKind::Braking,
        };
        let points_of = match self.to {
            Points::Means => PointsOf::Means,
            Points::Samples => PointsOf::Samples,
        };
        let training = TrainingSet::with_points(points_of, kind, own).with_prior(
            kind,
            prior,
            self.prior.weight(),
        );
        let model = DriverModel::fit(model, &training)?;
        Ok(Fitted {
            phases: training.phases.len(),
            points: training.points.len(),
            residual_sum_of_squares: model.residual_sum_of_squares(&training.points),
            left_out: left_out::without(
                own,
                |trip| trip.phases_of(kind).next().is_some(),
                &format!("no {} phase that counts", kind.name()),
            ),
            model: match self.phase {
                Phase::Acceleration => FittedModel::Acceleration(model),
                Phase::Braking => FittedModel::Braking(model),
            },
        })
    }

    fn fit_ahead(
        &self,
        kind: DirectKind,
        inputs: &[Input],
        context: &Context,
    ) -> anyhow::Result<Fitted> {
        mention_finer_grids(inputs, context);
        let motions = motions(inputs, self.phases.slope_bandwidth)?;
        let settings = DirectSettings {
            slope_ahead: self.slope_ahead,
            ..DirectSettings::at(&self.horizons)
        };
        let (motions, left_out) = settings.usable(motions)?;
        let model = DirectModel::fit(kind, &motions.iter().collect::<Vec<_>>(), &settings)?;
        Ok(Fitted {
            phases: motions.len(),
            points: model.samples(),
            model: FittedModel::SpeedAhead(model),
            residual_sum_of_squares: None,
            left_out,
        })
    }

    fn fit_trip_driver(&self, inputs: &[Input]) -> anyhow::Result<Fitted> {
        let motions = motions(inputs, self.phases.slope_bandwidth)?;
        let motions: Vec<&Motion> = motions.iter().collect();
        let (driver, left_out) = TripDriver::fit_usable(&motions)?;
        Ok(Fitted {
            model: FittedModel::Trip(driver),
            phases: motions.len() - left_out.len(),
            points: 0,
            residual_sum_of_squares: None,
            left_out,
        })
    }

    fn check(&self) -> anyhow::Result<()> {
        let is_function = matches!(
            self.model,
            Model::Phase(
                ModelKind::Inverse | ModelKind::Exponential | ModelKind::ExponentialAmplitude
            )
        );
        if self.to == Points::Samples && !is_function {
            bail!(
                "--to samples: `{}` is fitted to phases; only inverse, exponential and \
                 exponential-amplitude are functions of speed",
                self.model.name()
            );
        }
        if self.prior.is_given() && !matches!(self.model, Model::Phase(_)) {
            bail!("--prior: only models of phases learn from other drivers as well");
        }
        Ok(())
    }
}

/// An error of too little to learn from says what every drive has.
fn named(fitted: Result<Fitted, Error>, trips: &[Trip]) -> anyhow::Result<Fitted> {
    fitted.map_err(|error| match error {
        Error::TooFewPhases { .. } | Error::TooFewStretches { .. } => {
            anyhow::anyhow!("{error}{}", left_out::contents_of(trips))
        }
        error => error.into(),
    })
}

fn fit_cruise(trips: &[Trip]) -> Result<Fitted, Error> {
    let stretches: Vec<_> = trips.iter().flat_map(|trip| &trip.cruise).collect();
    Ok(Fitted {
        model: FittedModel::Cruise(CruiseModel::fit(&stretches)?),
        phases: stretches.len(),
        points: 0,
        residual_sum_of_squares: None,
        left_out: left_out::without(
            trips,
            |trip| !trip.cruise.is_empty(),
            "no stretch of cruising that counts",
        ),
    })
}

fn fit_following(kind: FollowingKind, trips: &[Trip]) -> Result<Fitted, Error> {
    let stretches: Vec<_> = trips.iter().flat_map(|trip| &trip.following).collect();
    Ok(Fitted {
        model: FittedModel::Following(FollowingModel::fit(kind, &stretches)?.model),
        phases: stretches.len(),
        points: 0,
        residual_sum_of_squares: None,
        left_out: left_out::without(
            trips,
            |trip| !trip.following.is_empty(),
            "no stretch behind a vehicle that counts",
        ),
    })
}

fn hashes(inputs: &[Input]) -> Vec<TrainingInput> {
    let entry = |input: &Input| TrainingInput {
        path: input.path.clone(),
        sha256: input.sha256.clone(),
    };
    inputs.iter().map(entry).collect()
}

#[derive(Serialize)]
struct Body<'a> {
    model: &'a FittedModel,
    training_phases: usize,
    training_points: usize,
    residual_sum_of_squares: Option<f64>,
    /// Drives that the model could learn nothing from, with the reason.
    left_out_drives: &'a [LeftOut],
}
