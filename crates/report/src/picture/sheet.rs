//! What pictures with panels below each other share.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Axes<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Width of the picture in pixels.
pub(super) const WIDTH_PX: u32 = 1200;
/// The SVG backend rounds to whole units; a finer grid under a view box keeps slow ramps from becoming stairs.
pub(super) const UNITS_PER_PX: u32 = 4;
/// The space left of the axes, and how much of it stays empty.
pub(super) const LEFT_PX: u32 = 68;
pub(super) const MARGIN_PX: u32 = 10;
/// Widths of lines in quarters of a pixel.
pub(super) const SPEED_LINE: u32 = 7;
pub(super) const LIMIT_LINE: u32 = 4;
const FONT: &str = "system-ui, sans-serif";
pub(super) const INK: RGBColor = RGBColor(0x39, 0x42, 0x4c);
pub(super) const RULE: RGBColor = RGBColor(0xdd, 0xe1, 0xe5);
pub(super) const LIMIT: RGBColor = RGBColor(0xe6, 0x9f, 0x00);

/// A length in pixels, in the units of the drawing.
pub(super) fn units(length_px: u32) -> i32 {
    (length_px * UNITS_PER_PX) as i32
}

pub(super) fn text(size_px: u32) -> TextStyle<'static> {
    // The SVG backend divides the size by 1.24.
    (FONT, f64::from(size_px * UNITS_PER_PX) * 1.24)
        .into_font()
        .color(&INK)
}

pub(super) fn line(colour: RGBColor, quarter_px: u32) -> ShapeStyle {
    colour.stroke_width(quarter_px * UNITS_PER_PX / 4)
}

/// Puts a size in pixels and a title for screen readers, which has been escaped, in place of the backend's own opening tag.
pub(super) fn opened(picture: &str, title: &str, height_px: u32) -> String {
    let body = picture.split_once('>').map_or("", |(_, body)| body);
    let (width, height) = (WIDTH_PX * UNITS_PER_PX, height_px * UNITS_PER_PX);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" stroke-linejoin=\"round\">\n<title>{title}</title>{body}"
    )
}

/// The text without the characters that XML cannot hold.
pub(super) fn printable(text: &str) -> String {
    text.replace(
        |character: char| character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}'),
        "\u{fffd}",
    )
}

pub(super) fn escaped(text: &str) -> String {
    printable(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
