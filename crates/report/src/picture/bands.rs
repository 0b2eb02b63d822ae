//! Predicted speeds with their bands.

use plotters::prelude::*;

use super::PictureError;

const SIZE_PX: (u32, u32) = (900, 480);
const COLOURS: [RGBColor; 3] = [
    RGBColor(0x1f, 0x6f, 0xd0),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
];

/// Speeds over time, from 0.
#[derive(Debug, Clone)]
pub struct SpeedCurve<'a> {
    /// Between two samples, in s
    pub step_s: f64,
    /// The samples
    pub speed_mps: &'a [f64],
    /// Half the width of a band about them, as long, where there is one
    pub half_width_mps: Option<&'a [f64]>,
}

/// Speed in km/h over time in s of every curve, with its band where there is one, as the text of an SVG document.
///
/// # Errors
/// Where the drawing library fails; no content of `curves` makes it fail.
pub fn speeds_with_bands(title: &str, curves: &[SpeedCurve<'_>]) -> Result<String, PictureError> {
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, SIZE_PX).into_drawing_area();
        canvas.fill(&WHITE)?;
        let longest_s = greatest(curves.iter().map(SpeedCurve::duration_s));
        let top_kmh = 3.6
            * greatest(
                curves
                    .iter()
                    .flat_map(|curve| curve.speed_mps.iter().copied()),
            );
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
        for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
            let points = |offset: f64| {
                let (step_s, widths) = (curve.step_s, curve.half_width_mps);
                curve.speed_mps.iter().enumerate().map(move |(k, v)| {
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

impl SpeedCurve<'_> {
    fn duration_s(&self) -> f64 {
        self.speed_mps.len().saturating_sub(1) as f64 * self.step_s
    }
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|v| v.is_finite()).fold(0.0, f64::max)
}
