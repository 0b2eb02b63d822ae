//! Plans beside the driver's own way.

use std::path::Path;

use anyhow::bail;
use assistance::{Band, OwnWay, Style};
use driver_model::DriverModel;
use driver_model::trip_driver::TripDriver;
use speed_plan::{Demand, Envelope, Problem};

use super::PlanArgs;
use super::source::Source;
use crate::cmd::model;

/// What is planned for: problems in their styles, and the driver's own way beside them.
pub(super) struct Tasks<'a> {
    pub(super) styled: Vec<(Option<Style>, Problem<'a>)>,
    /// The problem as the road states it, without a driver's band.
    pub(super) road: Problem<'a>,
    pub(super) own: Option<OwnWay>,
    /// The driver's own arrival.
    pub(super) demand: Option<Demand>,
    /// What was assumed of the driver.
    pub(super) findings: Vec<String>,
}

impl<'a> Tasks<'a> {
    pub(super) fn of(
        args: &PlanArgs,
        source: &Source,
        problem: Problem<'a>,
    ) -> anyhow::Result<Self> {
        match &args.driver {
            Some(path) => Self::of_driver(path, args, source, problem),
            None if args.style.is_some() => {
                bail!("--style is that of a driver; give --driver MODEL.json as well")
            }
            None => Ok(Self {
                styled: vec![(None, problem.clone())],
                road: problem,
                own: None,
                demand: None,
                findings: Vec::new(),
            }),
        }
    }

    fn of_driver(
        path: &Path,
        args: &PlanArgs,
        source: &Source,
        problem: Problem<'a>,
    ) -> anyhow::Result<Self> {
        let Some(road) = &source.road else {
            bail!("--driver is for roads and logs; a --case has no road that a driver knows");
        };
        let file = model::read(path)?;
        let DriverModel::Trip(driver) = &file.model else {
            bail!(
                "`{}` is a {}; the way over a road is that of a trip-driver (`drivekit fit LOG… --model trip-driver`)",
                path.display(),
                file.model.kind()
            );
        };
        let own = OwnWay::new(driver, road, &problem)?;
        let is_led = !problem.columns().earliest_s.is_empty();
        let styles = args.style.as_deref().unwrap_or(&[Style::Within(1.0)]);
        let styled = styles.iter().map(|&style| {
            let envelope = match args.accel {
                Some([min, max]) => Envelope::constant(min, max)?,
                None => own.envelope(style)?,
            };
            let columns = own.columns(problem.columns(), style)?;
            let problem = Problem::new(problem.model().clone(), envelope, columns)?;
            Ok((Some(style), problem))
        });
        Ok(Self {
            styled: styled.collect::<anyhow::Result<_>>()?,
            demand: (!is_led).then_some(Demand::Arrival(own.run.time_s)),
            findings: findings(driver, own.band, is_led, road.slow_points.is_none()),
            own: Some(own),
            road: problem,
        })
    }
}

fn findings(
    driver: &TripDriver,
    band: Band,
    is_led: bool,
    slow_points_unknown: bool,
) -> Vec<String> {
    let mut findings = Vec::new();
    if band == Band::Assumed {
        let why = if driver.style().is_none() {
            "the model was not fitted to two trips or more, or by an earlier version"
        } else {
            "of some kinds of places fewer than 30 were seen"
        };
        findings.push(format!(
            "the driver's band is assumed, at least in part (12 % of his speed, at least 1.5 m/s): {why}"
        ));
    }
    if driver
        .style()
        .is_none_or(|style| style.accelerations.is_empty())
    {
        findings.push("the driver's limits of acceleration are those of his laws".to_owned());
    }
    if is_led {
        findings.push(
            "the driver's own way knows nothing of the car ahead: it is no comparison at equal time".to_owned(),
        );
    }
    if slow_points_unknown {
        findings.push(
            "the road names no slow points: neither plan nor own way slows down but for limits and stops"
                .to_owned(),
        );
    }
    findings
}
