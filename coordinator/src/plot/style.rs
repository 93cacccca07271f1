//! How figures look: sizes, colours that stay apart in print and for the colour-blind, lines and texts.

use plotive::Rgba8;
use plotive::des::Text;
use plotive::style::series::{Marker, Stroke};
use plotive::style::{Fill, LinePattern, MarkerShape};

/// Units of a figure (1/96 inch, as in SVG and CSS) in a millimetre.
pub const MILLIMETRE: f64 = 96.0 / 25.4;
/// Units in a point (1/72 inch).
pub const POINT: f32 = 96.0 / 72.0;

/// Titles of axes.
pub const TITLE: f32 = 8.5 * POINT;
/// Numbers at ticks, and legends.
pub const TICK: f32 = 7.5 * POINT;
/// Labels of curves and points.
pub const LABEL: f32 = 7.0 * POINT;

/// Lines that are there for comparison.
pub const FINE: f32 = 0.75;
/// Main branches.
pub const THIN: f32 = 1.1;
/// Curves that a figure is about.
pub const MEDIUM: f32 = 1.6;
/// Isolas.
pub const BOLD: f32 = 2.2;

/// Lines and texts.
pub const INK: Rgba8 = Rgba8::from_hex(b"#1a1a1a");
/// What stands back.
pub const GREY: Rgba8 = Rgba8::from_hex(b"#7a7a7a");
/// What is not found.
pub const ALERT: Rgba8 = Rgba8::from_hex(b"#c0392b");
/// What is not there yet.
pub const PENDING: Rgba8 = Rgba8::from_hex(b"#9a9a9a");

/// How much of a colour is in its light areas.
const TINT: f32 = 0.2;

/// Viridis without its light end: darker means more, in grey too.
const SEQUENCE: [[f64; 3]; 5] =
    [[94.0, 171.0, 82.0], [32.0, 144.0, 141.0], [49.0, 104.0, 142.0], [68.0, 58.0, 131.0], [62.0, 8.0, 75.0]];

/// Of Okabe and Ito, in an order of alternating lightness.
const SEPARATE: [Rgba8; 6] = [
    Rgba8::from_hex(b"#0072b2"),
    Rgba8::from_hex(b"#e08e00"),
    Rgba8::from_hex(b"#006b4f"),
    Rgba8::from_hex(b"#c4609a"),
    Rgba8::from_hex(b"#7a3300"),
    Rgba8::from_hex(b"#46a5dc"),
];

/// The colour at a share of a sequence, from 0 (little) to 1 (much).
pub fn sequential(share: f64) -> Rgba8 {
    let place = share.clamp(0.0, 1.0) * (SEQUENCE.len() - 1) as f64;
    let below = (place as usize).min(SEQUENCE.len() - 2);
    let mix = |c: usize| SEQUENCE[below][c] + (place - below as f64) * (SEQUENCE[below + 1][c] - SEQUENCE[below][c]);
    Rgba8::new(mix(0).round() as u8, mix(1).round() as u8, mix(2).round() as u8, 255)
}

/// The colour of a place in a sequence of so many.
pub fn nth(index: usize, count: usize) -> Rgba8 {
    sequential(if count < 2 { 1.0 } else { index as f64 / (count - 1) as f64 })
}

/// One of a few colours that are told apart.
pub fn separate(index: usize) -> Rgba8 {
    SEPARATE[index % SEPARATE.len()]
}

/// Patterns that are told apart without colours.
pub fn dash(index: usize) -> LinePattern {
    match index % 5 {
        0 => LinePattern::Solid,
        1 => LinePattern::Custom(vec![5.0, 2.5]),
        2 => LinePattern::Custom(vec![1.2, 1.8]),
        3 => LinePattern::Custom(vec![6.0, 2.0, 1.2, 2.0]),
        _ => LinePattern::Custom(vec![9.0, 3.0]),
    }
}

/// A solid line.
pub fn solid(color: Rgba8, width: f32) -> Stroke {
    (color.into(), width).into()
}

/// A dashed line.
pub fn dashed(color: Rgba8, width: f32) -> Stroke {
    solid(color, width).with_pattern(dash(1))
}

/// A dotted line.
pub fn dotted(color: Rgba8, width: f32) -> Stroke {
    solid(color, width).with_pattern(dash(2))
}

/// A light area of a colour. Nothing in a figure is transparent: printers dislike it, and svg2pdf writes transparent
/// things in another order every time.
pub fn tint(color: Rgba8) -> Fill<plotive::style::series::Color> {
    let light = |part: u8| 255 - ((255.0 - f32::from(part)) * TINT).round() as u8;
    Fill::solid(Rgba8::new(light(color.r()), light(color.g()), light(color.b()), 255).into())
}

/// A marker so many units wide, filled or open.
pub fn marker(shape: MarkerShape, color: Rgba8, width: f32, is_filled: bool) -> Marker {
    let fill = if is_filled { color } else { plotive::color::WHITE };
    Marker {
        size: (width * width).into(),
        shape,
        fill: Some(Fill::solid(fill.into())),
        stroke: Some(solid(color, 1.0)),
    }
}

/// A text of a size and colour; what a name contains is no markup.
pub fn text(text: &str, size: f32, color: Rgba8) -> Text {
    Text::Rich(format!("[size={size};color={}]{}[/size;color]", color.html(), escaped(text)))
}

/// A text whose brackets and backslashes are taken as they are.
pub fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('[', "\\[")
}
