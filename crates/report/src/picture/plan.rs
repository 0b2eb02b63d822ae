//! A speed plan over the road: speed, time at signals, elevation, and energy against time.

use plotters::prelude::*;

use super::PictureError;
use super::sheet::{
    Axes, Canvas, Drawn, INK, LEFT_PX, LIMIT, LIMIT_LINE, MARGIN_PX, RULE, SPEED_LINE,
    UNITS_PER_PX, WIDTH_PX, escaped, line, opened, printable, text, units,
};

/// Heights of the panels, and of title and legend above them.
const HEAD_PX: u32 = 72;
const SPEED_PX: u32 = 320;
const TIME_PX: u32 = 240;
const ELEVATION_PX: u32 = 180;
const FRONTIER_PX: u32 = 320;
/// Width of the line of the other run, in quarters of a pixel.
const OWN_LINE: u32 = 4;
const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
const RED: RGBColor = RGBColor(0xc8, 0x2b, 0x1d);
const OWN: RGBColor = RGBColor(0x5a, 0x63, 0x6d);
const GROUND: RGBColor = RGBColor(0x8a, 0x5a, 0x44);
/// Slow points are this much below the limit on both sides, m/s.
const DIP_MPS: f64 = 0.5;
/// No value beyond this is drawn.
const MOST: f64 = 1e7;

/// What is drawn; what is empty is left out.
#[derive(Debug, Clone, Default)]
pub struct PlanPicture<'a> {
    /// Above the panels
    pub title: &'a str,
    /// The plan
    pub plan: Option<RoadRun<'a>>,
    /// Another run of the same road, drawn thin beside it
    pub own: Option<RoadRun<'a>>,
    /// Limit in m/s at the nodes of the plan; 0 where the car stands
    pub limit_mps: &'a [f64],
    /// Elevation above the start in m at the nodes of the plan; empty on a level road
    pub elevation_m: &'a [f64],
    /// Signals along the road
    pub signals: Vec<SignalTimes<'a>>,
    /// Arrival in s and energy in J of other plans, by time
    pub frontier: Vec<(f64, f64)>,
    /// The same of the other run
    pub own_point: Option<(f64, f64)>,
}

/// A run over a road by nodes.
#[derive(Debug, Clone)]
pub struct RoadRun<'a> {
    /// Position, m
    pub position_m: &'a [f64],
    /// Speed, m/s
    pub speed_mps: &'a [f64],
    /// Arrival at the node and departure from it, s
    pub time_s: Vec<[f64; 2]>,
    /// What the car does between two nodes; one less than nodes
    pub effort: Vec<Effort>,
}

/// A signal and when it is green.
#[derive(Debug, Clone, Copy)]
pub struct SignalTimes<'a> {
    /// Its place, m
    pub position_m: f64,
    /// Green windows, s; it is red in between
    pub green_s: &'a [[f64; 2]],
}

/// What a car does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// The motor drives
    Drives,
    /// No force at the wheels
    Coasts,
    /// The motor brakes
    Regenerates,
    /// Friction brakes help
    BrakesByFriction,
}

impl Effort {
    const ALL: [Self; 4] = [
        Self::Drives,
        Self::Coasts,
        Self::Regenerates,
        Self::BrakesByFriction,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Drives => "drives",
            Self::Coasts => "coasts",
            Self::Regenerates => "regenerates",
            Self::BrakesByFriction => "brakes by friction",
        }
    }

    fn colour(self) -> RGBColor {
        match self {
            Self::Drives => RGBColor(0x1f, 0x6f, 0xd0),
            Self::Coasts => RGBColor(0xcc, 0x79, 0xa7),
            Self::Regenerates => RGBColor(0x00, 0x9e, 0x73),
            Self::BrakesByFriction => RGBColor(0xc8, 0x2b, 0x1d),
        }
    }
}

/// Speed in km/h over the position in km with limits, time in s with the signals, elevation, and energy in kWh against time, as far as there
/// is something of each. The result is the text of an SVG document.
///
/// # Errors
/// Where the drawing library fails; no content of `picture` makes it fail.
pub fn plan_over_road(picture: &PlanPicture<'_>) -> Result<String, PictureError> {
    let panels = panels(picture);
    let height_px = HEAD_PX
        + panels
            .iter()
            .map(|panel| panel.height_px())
            .sum::<u32>()
            .max(60);
    let mut svg = String::new();
    {
        let size = (WIDTH_PX * UNITS_PER_PX, height_px * UNITS_PER_PX);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, mut below) = root.split_vertically(units(HEAD_PX));
        draw_head(&head, picture)?;
        if panels.is_empty() {
            below.draw_text("nothing to show", &text(14), (units(LEFT_PX), units(20)))?;
        }
        for panel in panels {
            let (area, rest) = below.split_vertically(units(panel.height_px()));
            panel.draw(&area, picture)?;
            below = rest;
        }
        root.present()?;
    }
    let title = format!("Speed plan of {}", escaped(picture.title));
    Ok(opened(&svg, &title, height_px))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Panel {
    Speed,
    Time,
    Elevation,
    Frontier,
}

/// The panels with something in them.
fn panels(picture: &PlanPicture<'_>) -> Vec<Panel> {
    let mut panels = Vec::new();
    if let Some(plan) = picture.plan.as_ref().filter(|plan| plan.is_drawable()) {
        panels.push(Panel::Speed);
        if !picture.signals.is_empty() {
            panels.push(Panel::Time);
        }
        if picture.elevation_m.len() == plan.position_m.len()
            && picture.elevation_m.iter().all(|m| m.abs() < MOST)
        {
            panels.push(Panel::Elevation);
        }
    }
    let is_drawable =
        |&(time_s, energy_j): &(f64, f64)| time_s.abs() < MOST && energy_j.is_finite();
    if picture.frontier.len() > 1 && picture.frontier.iter().all(is_drawable) {
        panels.push(Panel::Frontier);
    }
    panels
}

impl Panel {
    fn height_px(self) -> u32 {
        match self {
            Self::Speed => SPEED_PX,
            Self::Time => TIME_PX,
            Self::Elevation => ELEVATION_PX,
            Self::Frontier => FRONTIER_PX,
        }
    }

    fn draw(self, area: &Canvas<'_>, picture: &PlanPicture<'_>) -> Drawn {
        if self == Self::Frontier {
            return draw_frontier(area, picture);
        }
        let Some(plan) = &picture.plan else {
            return Ok(());
        };
        match self {
            Self::Speed => draw_speed(area, picture, plan),
            Self::Time => draw_time(area, picture, plan),
            Self::Elevation => draw_elevation(area, picture, plan),
            Self::Frontier => Ok(()),
        }
    }
}

impl RoadRun<'_> {
    fn is_drawable(&self) -> bool {
        let nodes = self.position_m.len();
        let in_range = |values: &[f64]| values.iter().all(|value| value.abs() < MOST);
        nodes > 1
            && self.speed_mps.len() == nodes
            && self.time_s.len() == nodes
            && self.effort.len() + 1 == nodes
            && in_range(self.position_m)
            && in_range(self.speed_mps)
            && self.time_s.iter().all(|times| in_range(times))
            && self.ends_km()[1] > self.ends_km()[0]
    }

    fn ends_km(&self) -> [f64; 2] {
        [self.position_m.first(), self.position_m.last()].map(|m| m.map_or(0.0, |m| m / 1e3))
    }

    fn km(&self, node: usize) -> f64 {
        self.position_m[node] / 1e3
    }

    fn speeds(&self, nodes: impl Iterator<Item = usize>) -> Vec<(f64, f64)> {
        nodes
            .map(|k| (self.km(k), 3.6 * self.speed_mps[k]))
            .collect()
    }

    fn times(&self) -> Vec<(f64, f64)> {
        let at = |(k, times): (usize, &[f64; 2])| times.map(|time_s| (self.km(k), time_s));
        self.time_s.iter().enumerate().flat_map(at).collect()
    }
}

fn draw_head(area: &Canvas<'_>, picture: &PlanPicture<'_>) -> Drawn {
    area.draw_text(
        &printable(picture.title),
        &text(15),
        (units(LEFT_PX), units(10)),
    )?;
    let efforts: &[Effort] = picture.plan.as_ref().map_or(&[], |plan| &plan.effort);
    let mut entries: Vec<(&str, RGBColor, u32)> = Effort::ALL
        .into_iter()
        .filter(|effort| efforts.contains(effort))
        .map(|effort| (effort.name(), effort.colour(), SPEED_LINE))
        .collect();
    if picture.own.is_some() || picture.own_point.is_some() {
        entries.push(("own run", OWN, OWN_LINE));
    }
    if picture.limit_mps.iter().any(|limit| *limit > 0.0) {
        entries.push(("limit", LIMIT, LIMIT_LINE));
    }
    if picture.plan.is_some() && !picture.signals.is_empty() {
        entries.push(("signal", INK, 2));
    }
    let middle = units(HEAD_PX - 20);
    for ((name, colour, width), slot) in entries.into_iter().zip(0..) {
        let left = units(LEFT_PX + slot * 170);
        let ends = [(left, middle), (left + units(26), middle)];
        area.draw(&PathElement::new(ends, line(colour, width)))?;
        area.draw_text(name, &text(14), (left + units(34), middle - units(8)))?;
    }
    Ok(())
}

/// Axes of a panel with their names; the horizontal one is named below.
fn axes<'a, 'b>(
    area: &'a Canvas<'b>,
    x: ([f64; 2], &str),
    y: ([f64; 2], &str),
    digits: usize,
) -> Result<Axes<'a, 'b>, DrawingAreaErrorKind<std::io::Error>> {
    let mut chart = ChartBuilder::on(area)
        .margin_top(units(12))
        .margin_right(units(24))
        .margin_left(units(MARGIN_PX))
        .set_label_area_size(LabelAreaPosition::Left, units(LEFT_PX - MARGIN_PX))
        .set_label_area_size(LabelAreaPosition::Bottom, units(48))
        .build_cartesian_2d(x.0[0]..x.0[1], y.0[0]..y.0[1])?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .bold_line_style(line(RULE, 4))
        .light_line_style(TRANSPARENT)
        .axis_style(line(INK, 3))
        .set_all_tick_mark_size(units(4))
        .x_labels(13)
        .y_labels(6)
        // Adding 0 turns a negative zero into a positive one.
        .x_label_formatter(&|value| shortest(*value, x.0))
        .y_label_formatter(&|value| format!("{:.digits$}", value + 0.0))
        .label_style(text(13))
        .axis_desc_style(text(13))
        .x_desc(x.1)
        .y_desc(y.1)
        .draw()?;
    Ok(chart)
}

/// A label with as many decimals as the span of its axis needs.
fn shortest(value: f64, [low, high]: [f64; 2]) -> String {
    let digits = match high - low {
        span if span < 0.5 => 3,
        span if span < 5.0 => 2,
        span if span < 30.0 => 1,
        _ => 0,
    };
    format!("{:.digits$}", value + 0.0)
}

fn path(chart: &mut Axes<'_, '_>, points: Vec<(f64, f64)>, style: ShapeStyle) -> Drawn {
    chart.plotting_area().draw(&PathElement::new(points, style))
}

fn draw_speed(area: &Canvas<'_>, picture: &PlanPicture<'_>, plan: &RoadRun<'_>) -> Drawn {
    let own = picture.own.as_ref().filter(|own| own.is_drawable());
    let of_own = own.map_or(&[][..], |own| own.speed_mps);
    let all = plan.speed_mps.iter().chain(of_own).chain(picture.limit_mps);
    let top_kmh = 3.6 * all.copied().filter(|v| v.abs() < MOST).fold(3.0, f64::max);
    let mut chart = axes(
        area,
        (plan.ends_km(), "position (km)"),
        ([0.0, 1.05 * top_kmh], "speed (km/h)"),
        0,
    )?;
    draw_limits(&mut chart, picture, plan)?;
    if let Some(own) = own {
        let speeds = own.speeds(0..own.position_m.len());
        path(&mut chart, speeds, line(OWN, OWN_LINE))?;
    }
    let mut from = 0;
    for run in plan.effort.chunk_by(|a, b| a == b) {
        let to = from + run.len();
        path(
            &mut chart,
            plan.speeds(from..=to),
            line(run[0].colour(), SPEED_LINE),
        )?;
        from = to;
    }
    let stops = (0..plan.position_m.len()).filter(|k| plan.speed_mps[*k] <= 0.0);
    for stop in stops {
        let mark = Circle::new((plan.km(stop), 0.0), units(3), INK.filled());
        chart.plotting_area().draw(&mark)?;
    }
    for signal in picture
        .signals
        .iter()
        .filter(|signal| signal.position_m.abs() < MOST)
    {
        let at_km = signal.position_m / 1e3;
        let ends = vec![(at_km, 0.0), (at_km, 1.05 * top_kmh)];
        path(&mut chart, ends, line(INK, 2))?;
    }
    Ok(())
}

/// Limits as steps, the higher of both ends, and slow points as dots.
fn draw_limits(chart: &mut Axes<'_, '_>, picture: &PlanPicture<'_>, plan: &RoadRun<'_>) -> Drawn {
    let limit_mps = picture.limit_mps;
    if limit_mps.len() != plan.position_m.len()
        || limit_mps.iter().any(|v| v.abs() >= MOST || v.is_nan())
    {
        return Ok(());
    }
    let of_step: Vec<f64> = limit_mps
        .windows(2)
        .map(|ends| ends[0].max(ends[1]))
        .collect();
    let steps = of_step.iter().enumerate();
    let points = steps.flat_map(|(k, limit)| [k, k + 1].map(|node| (plan.km(node), 3.6 * limit)));
    path(chart, points.collect(), line(LIMIT, LIMIT_LINE))?;
    for (k, pair) in of_step.windows(2).enumerate() {
        let limit = limit_mps[k + 1];
        if limit > 0.0 && limit < pair[0].min(pair[1]) - DIP_MPS {
            let mark = Circle::new(
                (plan.km(k + 1), 3.6 * limit),
                units(3),
                line(LIMIT, LIMIT_LINE),
            );
            chart.plotting_area().draw(&mark)?;
        }
    }
    Ok(())
}

/// Time over the position: signals are red but in their windows.
fn draw_time(area: &Canvas<'_>, picture: &PlanPicture<'_>, plan: &RoadRun<'_>) -> Drawn {
    let own = picture.own.as_ref().filter(|own| own.is_drawable());
    let runs = std::iter::once(plan).chain(own);
    let last_s = runs.flat_map(|run| run.time_s.last()).map(|times| times[1]);
    let end_s = last_s.fold(1.0, f64::max);
    let x = (plan.ends_km(), "position (km)");
    let mut chart = axes(area, x, ([0.0, 1.02 * end_s], "time (s)"), 0)?;
    for signal in picture
        .signals
        .iter()
        .filter(|signal| signal.position_m.abs() < MOST)
    {
        let at_km = signal.position_m / 1e3;
        path(
            &mut chart,
            vec![(at_km, 0.0), (at_km, 1.02 * end_s)],
            line(RED, 20),
        )?;
        for [from_s, to_s] in signal.green_s.iter().filter(|[from, to]| from < to) {
            let ends = [*from_s, *to_s].map(|time_s| (at_km, time_s.clamp(0.0, 1.02 * end_s)));
            path(&mut chart, ends.to_vec(), line(GREEN, 20))?;
        }
    }
    if let Some(own) = own {
        path(&mut chart, own.times(), line(OWN, OWN_LINE))?;
    }
    path(
        &mut chart,
        plan.times(),
        line(Effort::Drives.colour(), SPEED_LINE),
    )
}

fn draw_elevation(area: &Canvas<'_>, picture: &PlanPicture<'_>, plan: &RoadRun<'_>) -> Drawn {
    let [low, high] = around(picture.elevation_m.iter().copied(), 5.0);
    let x = (plan.ends_km(), "position (km)");
    let mut chart = axes(area, x, ([low, high], "above the start (m)"), 0)?;
    let elevations = picture.elevation_m.iter().enumerate();
    let points = elevations.map(|(k, m)| (plan.km(k), *m)).collect();
    path(&mut chart, points, line(GROUND, SPEED_LINE))
}

fn draw_frontier(area: &Canvas<'_>, picture: &PlanPicture<'_>) -> Drawn {
    let kwh = |(time_s, energy_j): (f64, f64)| (time_s, energy_j / 3.6e6);
    let curve: Vec<(f64, f64)> = picture.frontier.iter().copied().map(kwh).collect();
    let own = picture.own_point.map(kwh);
    let all = || curve.iter().copied().chain(own);
    let x = around(all().map(|point| point.0), 1.0);
    let y = around(all().map(|point| point.1), 1e-3);
    let mut chart = axes(area, (x, "arrival (s)"), (y, "energy (kWh)"), 3)?;
    path(
        &mut chart,
        curve.clone(),
        line(Effort::Drives.colour(), SPEED_LINE),
    )?;
    for point in curve {
        let mark = Circle::new(point, units(3), Effort::Drives.colour().filled());
        chart.plotting_area().draw(&mark)?;
    }
    if let Some(point) = own.filter(|point| point.0.is_finite() && point.1.is_finite()) {
        let mark = Circle::new(point, units(5), OWN.filled());
        chart.plotting_area().draw(&mark)?;
    }
    Ok(())
}

/// The range of values with some room around them, at least `least` each.
fn around(values: impl Iterator<Item = f64>, least: f64) -> [f64; 2] {
    let within = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
    let known = values.filter(|value| value.is_finite());
    let [low, high] = known.fold([f64::INFINITY, f64::NEG_INFINITY], within);
    if low > high {
        return [0.0, 1.0];
    }
    let room = (0.08 * (high - low)).max(least);
    [low - room, high + room]
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests;
