//! Recorded speed, coloured by driving phase (thesis figure 3.11).

use std::collections::BTreeMap;
use std::ops::Range;

use plotters::prelude::*;

use super::PictureError;
use super::sheet::{
    Axes, Canvas, Drawn, INK, LEFT_PX, LIMIT, LIMIT_LINE, MARGIN_PX, RULE, SPEED_LINE,
    UNITS_PER_PX, WIDTH_PX, escaped, line, opened, printable, text, units,
};

/// Height of one drive's panel, and of the legend above all panels.
const PANEL_PX: u32 = 292;
const LEGEND_PX: u32 = 44;
/// Drives in one picture at most.
const MAX_PANELS: usize = 1000;
/// Columns into which the samples of a drive are thinned.
const COLUMNS: usize = WIDTH_PX as usize;

/// One drive: uniform samples of the speed and what was found in them.
#[derive(Debug, Clone)]
pub struct SpeedPlot<'a> {
    /// Above its panel
    pub title: &'a str,
    /// Time of the first sample
    pub t0_s: f64,
    /// Between two samples
    pub step_s: f64,
    /// Samples that are not finite leave a gap
    pub speed_mps: &'a [f64],
    /// As long as the speed
    pub speed_limit_mps: Option<&'a [f64]>,
    /// In any order; what none of them covers is [`Behaviour::Other`]
    pub stretches: Vec<Stretch>,
}

/// Samples of one colour.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stretch {
    /// From the first one to before the last
    pub samples: Range<usize>,
    /// What the driver does
    pub behaviour: Behaviour,
}

/// What a driver does, in the order of the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behaviour {
    /// Speeds up
    Acceleration,
    /// Slows down
    Braking,
    /// Holds the speed
    Cruise,
    /// None of these
    Other,
    /// Any of these under the influence of the car ahead
    LeadInfluenced,
}

impl Behaviour {
    const ALL: [Self; 5] = [
        Self::Acceleration,
        Self::Braking,
        Self::Cruise,
        Self::Other,
        Self::LeadInfluenced,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Acceleration => "acceleration",
            Self::Braking => "braking",
            Self::Cruise => "cruise",
            Self::Other => "other",
            Self::LeadInfluenced => "lead-influenced",
        }
    }

    /// Green, red and blue as in the thesis, in shades that differ in lightness as well, and black behind a leader.
    fn colour(self) -> RGBColor {
        match self {
            Self::Acceleration => RGBColor(0x00, 0x9e, 0x73),
            Self::Braking => RGBColor(0xc8, 0x2b, 0x1d),
            Self::Cruise => RGBColor(0x1f, 0x6f, 0xd0),
            Self::Other => RGBColor(0x9a, 0xa4, 0xae),
            Self::LeadInfluenced => BLACK,
        }
    }
}

/// Speed in km/h over time in s, a panel per drive from top to bottom, coloured by phase, with the segment boundaries as faint
/// vertical lines and the speed limit as a thin step line. The result is the text of an SVG document. Of more than
/// 1000 drives the first ones are drawn.
///
/// # Errors
/// Where the drawing library fails; no content of `plots` makes it fail.
pub fn speed_with_phases(plots: &[SpeedPlot<'_>]) -> Result<String, PictureError> {
    let plots = plots.get(..MAX_PANELS).unwrap_or(plots);
    let panels = plots.len().max(1);
    let height_px = LEGEND_PX + PANEL_PX * panels as u32;
    let mut picture = String::new();
    {
        let root = SVGBackend::with_string(
            &mut picture,
            (WIDTH_PX * UNITS_PER_PX, height_px * UNITS_PER_PX),
        )
        .into_drawing_area();
        root.fill(&WHITE)?;
        let (top, below) = root.split_vertically(units(LEGEND_PX));
        draw_legend(&top, plots)?;
        if plots.is_empty() {
            draw_remark(&below, "no drive to show")?;
        }
        for (plot, area) in plots.iter().zip(below.split_evenly((panels, 1))) {
            draw_panel(&area, plot)?;
        }
        root.present()?;
    }
    Ok(with_header(&picture, plots, height_px))
}

fn draw_remark(area: &Canvas<'_>, remark: &str) -> Drawn {
    area.draw_text(remark, &text(14), (units(LEFT_PX), units(PANEL_PX / 2)))
}

/// The phases and lines that occur in any of the plots.
fn draw_legend(area: &Canvas<'_>, plots: &[SpeedPlot<'_>]) -> Drawn {
    let occurs = |behaviour: &Behaviour| {
        let mut stretches = plots.iter().flat_map(|plot| &plot.stretches);
        stretches.any(|stretch| stretch.behaviour == *behaviour)
    };
    let mut entries: Vec<(&str, RGBColor, u32)> = Behaviour::ALL
        .into_iter()
        .filter(occurs)
        .map(|behaviour| (behaviour.name(), behaviour.colour(), SPEED_LINE))
        .collect();
    if plots.iter().any(|plot| plot.speed_limit_mps.is_some()) {
        entries.push(("speed limit", LIMIT, LIMIT_LINE));
    }
    let middle = units(LEGEND_PX / 2);
    for ((name, colour, width), slot) in entries.into_iter().zip(0..) {
        let left = units(LEFT_PX + slot * 170);
        area.draw(&PathElement::new(
            [(left, middle), (left + units(26), middle)],
            line(colour, width),
        ))?;
        area.draw_text(name, &text(14), (left + units(34), middle - units(8)))?;
    }
    Ok(())
}

fn draw_panel(area: &Canvas<'_>, plot: &SpeedPlot<'_>) -> Drawn {
    area.draw_text(
        &printable(plot.title),
        &text(15),
        (units(LEFT_PX), units(6)),
    )?;
    let Some(frame) = Frame::of(plot) else {
        return draw_remark(area, "no samples to show");
    };
    let mut chart = ChartBuilder::on(area)
        .margin_top(units(32))
        .margin_right(units(24))
        .margin_left(units(MARGIN_PX))
        .set_label_area_size(LabelAreaPosition::Left, units(LEFT_PX - MARGIN_PX))
        .set_label_area_size(LabelAreaPosition::Bottom, units(48))
        .build_cartesian_2d(frame.start_s..frame.end_s, frame.low_kmh..frame.high_kmh)?;
    let digits = frame.time_digits();
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
        .x_label_formatter(&|time_s| format!("{:.digits$}", time_s + 0.0))
        .y_label_formatter(&|speed_kmh| format!("{:.0}", speed_kmh + 0.0))
        .label_style(text(13))
        .axis_desc_style(text(13))
        .x_desc("time (s)")
        .y_desc("speed (km/h)")
        .draw()?;
    draw_boundaries(&mut chart, plot, &frame)?;
    draw_limit(&mut chart, plot)?;
    draw_speed(&mut chart, plot)
}

/// The ranges of a panel's axes.
struct Frame {
    start_s: f64,
    end_s: f64,
    low_kmh: f64,
    high_kmh: f64,
}

impl Frame {
    /// `None` where there is nothing to see: fewer than two samples, none of them a speed, or a time that does not advance.
    fn of(plot: &SpeedPlot<'_>) -> Option<Self> {
        let (start_s, end_s) = (plot.t0_s, plot.time_s(plot.speed_mps.len().checked_sub(1)?));
        let advances = end_s - start_s > 1e-9 * start_s.abs().max(end_s.abs());
        let speeds = || {
            plot.speed_mps
                .iter()
                .filter_map(|&speed_mps| kmh(speed_mps))
        };
        speeds().next()?;
        let limits = plot
            .speed_limit_mps
            .unwrap_or_default()
            .iter()
            .filter_map(|&limit_mps| kmh(limit_mps));
        let high_kmh = speeds().chain(limits).fold(10.0, f64::max) * 1.05;
        let low_kmh = speeds().fold(0.0, f64::min);
        (advances && end_s.is_finite()).then_some(Self {
            start_s,
            end_s,
            low_kmh,
            high_kmh,
        })
    }

    /// Decimals of the labels of the time axis.
    fn time_digits(&self) -> usize {
        match self.end_s - self.start_s {
            span_s if span_s < 1.0 => 3,
            span_s if span_s < 12.0 => 1,
            _ => 0,
        }
    }
}

impl SpeedPlot<'_> {
    fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.step_s
    }

    /// Samples per column of the picture, at least one.
    fn stride(&self) -> usize {
        self.speed_mps.len().div_ceil(COLUMNS).max(1)
    }

    /// The samples cut into ranges of one colour, in time order, each with the first sample of the next so that they join.
    fn coloured_ranges(&self) -> Vec<(Range<usize>, RGBColor)> {
        let count = self.speed_mps.len();
        let other = Behaviour::Other.colour();
        let has_samples =
            |stretch: &&Stretch| stretch.samples.start < stretch.samples.end.min(count);
        let mut stretches: Vec<&Stretch> = self.stretches.iter().filter(has_samples).collect();
        stretches.sort_by_key(|stretch| stretch.samples.start);
        let mut ranges = Vec::with_capacity(stretches.len());
        let mut covered = 0;
        for Stretch { samples, behaviour } in stretches {
            if covered < samples.start {
                ranges.push((covered..samples.start + 1, other));
            }
            covered = samples.end.min(count);
            ranges.push((samples.start..(covered + 1).min(count), behaviour.colour()));
        }
        if covered < count {
            ranges.push((covered..count, other));
        }
        ranges
    }
}

/// A speed that can be drawn: finite, and not so absurd (beyond a million km/h) that the axis would have no labels.
fn kmh(speed_mps: f64) -> Option<f64> {
    Some(speed_mps * 3.6).filter(|speed_kmh| speed_kmh.abs() < 1e6)
}

fn draw_boundaries(chart: &mut Axes<'_, '_>, plot: &SpeedPlot<'_>, frame: &Frame) -> Drawn {
    let count = plot.speed_mps.len();
    let ends = plot
        .stretches
        .iter()
        .flat_map(|stretch| [stretch.samples.start, stretch.samples.end]);
    // One line per column is all that can be seen.
    let columns: BTreeMap<usize, usize> = ends
        .filter(|&end| end > 0 && end < count)
        .map(|end| (end / plot.stride(), end))
        .collect();
    for boundary in columns.into_values() {
        let time_s = plot.time_s(boundary);
        let ends = [(time_s, frame.low_kmh), (time_s, frame.high_kmh)];
        chart
            .plotting_area()
            .draw(&PathElement::new(ends, line(RULE, 3)))?;
    }
    Ok(())
}

/// The limit as a step line, with a vertex only where it changes.
fn draw_limit(chart: &mut Axes<'_, '_>, plot: &SpeedPlot<'_>) -> Drawn {
    let limits = plot
        .speed_limit_mps
        .unwrap_or_default()
        .iter()
        .take(plot.speed_mps.len());
    let mut steps: Vec<(f64, f64)> = Vec::new();
    let mut previous = None;
    for (index, limit) in limits
        .map(|&limit_mps| kmh(limit_mps))
        .chain([None])
        .enumerate()
    {
        if limit != previous {
            let time_s = plot.time_s(index.min(plot.speed_mps.len() - 1));
            steps.extend(previous.map(|limit_kmh| (time_s, limit_kmh)));
            steps.extend(limit.map(|limit_kmh| (time_s, limit_kmh)));
            if limit.is_none() {
                chart.plotting_area().draw(&PathElement::new(
                    std::mem::take(&mut steps),
                    line(LIMIT, LIMIT_LINE),
                ))?;
            }
            previous = limit;
        }
    }
    Ok(())
}

fn draw_speed(chart: &mut Axes<'_, '_>, plot: &SpeedPlot<'_>) -> Drawn {
    for (range, colour) in plot.coloured_ranges() {
        for run in thinned(plot.speed_mps, range, plot.stride()) {
            let points: Vec<(f64, f64)> = run
                .into_iter()
                .map(|(index, speed_kmh)| (plot.time_s(index), speed_kmh))
                .collect();
            chart
                .plotting_area()
                .draw(&PathElement::new(points, line(colour, SPEED_LINE)))?;
        }
    }
    Ok(())
}

/// The samples of a range as runs without gaps, thinned to the first, lowest, highest and last of every `stride` samples, which
/// leaves the picture as it was.
fn thinned(speed_mps: &[f64], range: Range<usize>, stride: usize) -> Vec<Vec<(usize, f64)>> {
    let mut runs = vec![Vec::new()];
    let samples = speed_mps
        .get(range.clone())
        .unwrap_or_default()
        .iter()
        .zip(range);
    let points: Vec<(usize, Option<f64>)> =
        samples.map(|(&speed, index)| (index, kmh(speed))).collect();
    for gapless in points.chunk_by(|before, after| before.1.is_some() == after.1.is_some()) {
        let drawable: Vec<(usize, f64)> = gapless
            .iter()
            .filter_map(|&(index, speed)| Some((index, speed?)))
            .collect();
        let columns = drawable.chunk_by(|before, after| before.0 / stride == after.0 / stride);
        runs.push(columns.flat_map(extremes).collect());
    }
    runs.retain(|run: &Vec<_>| run.len() > 1);
    runs
}

/// The first, lowest, highest and last of the points, in their order and each once.
fn extremes(points: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let by_speed = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
    let chosen = [
        points.first(),
        points.iter().min_by(by_speed),
        points.iter().max_by(by_speed),
        points.last(),
    ];
    let mut chosen: Vec<(usize, f64)> = chosen.into_iter().flatten().copied().collect();
    chosen.sort_by_key(|point| point.0);
    chosen.dedup_by_key(|point| point.0);
    chosen
}

/// The picture with its size and a title for screen readers.
fn with_header(picture: &str, plots: &[SpeedPlot<'_>], height_px: u32) -> String {
    let drawn = match plots {
        [plot] => escaped(plot.title),
        plots => format!("{} drives", plots.len()),
    };
    let title = format!("Speed over time of {drawn}, coloured by driving phase");
    opened(picture, &title, height_px)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests;
