//! The phases that a model predicts, as an SVG picture.

use driver_model::phase_model::PredictiveBand;
use driver_model::{Phase, PhaseModel};
use plotters::prelude::*;
use serde::Serialize;

use super::svg::PlotError;

const SIZE_PX: (u32, u32) = (900, 480);
const COLOURS: [RGBColor; 3] = [
    RGBColor(0x1f, 0x6f, 0xd0),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
];

/// A phase that the model predicts.
#[derive(Debug, Serialize)]
pub(crate) struct Example {
    #[serde(flatten)]
    pub(crate) outline: Phase,
    pub(crate) speed_mps: Vec<f64>,
    /// Half-width of the 90 % band, where the model has one.
    pub(crate) half_width_mps: Option<Vec<f64>>,
}

impl Example {
    pub(crate) fn new(model: &PhaseModel, outline: Phase) -> Self {
        let bands = model.bands(&outline);
        Self {
            speed_mps: model.predict(&outline),
            half_width_mps: PredictiveBand::of_90_pct(&bands).map(|b| b.half_width_mps.clone()),
            outline,
        }
    }
}

/// Speed over time of every example, with its 90 % band where there is one.
pub(crate) fn draw(title: &str, examples: &[Example]) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, SIZE_PX).into_drawing_area();
        canvas.fill(&WHITE)?;
        let longest_s = fold(examples.iter().map(|e| e.outline.duration_s()));
        let top_kmh = 3.6 * fold(examples.iter().flat_map(|e| e.speed_mps.iter().copied()));
        let mut axes = ChartBuilder::on(&canvas)
            .caption(title, ("system-ui, sans-serif", 20))
            .margin(12)
            .x_label_area_size(40)
            .y_label_area_size(56)
            .build_cartesian_2d(0.0..longest_s, 0.0..1.1 * top_kmh.clamp(10.0, 1e3))?;
        axes.configure_mesh()
            .x_desc("time, s")
            .y_desc("speed, km/h")
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (example, colour) in examples.iter().zip(COLOURS.iter().cycle()) {
            let points = |offset: f64| {
                let step_s = example.outline.step_s;
                let widths = example.half_width_mps.as_deref();
                example.speed_mps.iter().enumerate().map(move |(k, v)| {
                    let width = widths.and_then(|w| w.get(k)).copied().unwrap_or(0.0);
                    (
                        k as f64 * step_s,
                        3.6 * (v + offset * width).clamp(0.0, 1e3),
                    )
                })
            };
            let edge: Vec<_> = points(-1.0)
                .chain(points(1.0).collect::<Vec<_>>().into_iter().rev())
                .collect();
            axes.draw_series(std::iter::once(Polygon::new(edge, colour.mix(0.15))))?;
            axes.draw_series(LineSeries::new(points(0.0), colour.stroke_width(2)))?;
        }
        canvas.present()?;
    }
    Ok(svg)
}

fn fold(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|v| v.is_finite()).fold(0.0, f64::max)
}
