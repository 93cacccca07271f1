//! Texts by the bundled font: how wide they are, and their outlines, so that they look the same everywhere.

use ttf_parser::Face;
#[cfg(feature = "figures")]
use ttf_parser::OutlineBuilder;

/// Noto Sans, without what figures do not write.
const FONT: &[u8] = include_bytes!("../../font/NotoSans-subset.ttf");
/// Height of a line of text, in ems.
pub const LINE: f64 = 1.36;
/// How far capitals rise above the line, in ems.
pub const CAPITALS: f64 = 0.714;

/// The bundled font.
#[derive(Debug)]
pub struct Font {
    face: Face<'static>,
}

impl Font {
    /// Reads the one that is part of the program.
    pub fn bundled() -> Self {
        Self { face: Face::parse(FONT, 0).expect("the bundled font is whole") }
    }

    fn scale(&self, size: f64) -> f64 {
        size / f64::from(self.face.units_per_em())
    }

    fn advance(&self, character: char) -> f64 {
        f64::from(self.face.glyph_index(character).and_then(|glyph| self.face.glyph_hor_advance(glyph)).unwrap_or(600))
    }

    /// How wide a text of a size is.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        self.scale(size) * text.chars().map(|character| self.advance(character)).sum::<f64>()
    }

    /// The outlines of a text that begins at a point, as of the attribute `d` of SVG.
    #[cfg(feature = "figures")]
    pub fn outline(&self, text: &str, size: f64, (x, y): (f64, f64), is_upwards: bool) -> String {
        let mut pen = Pen { path: String::new(), x, y, scale: self.scale(size), along: 0.0, is_upwards };
        for character in text.chars() {
            if let Some(glyph) = self.face.glyph_index(character) {
                self.face.outline_glyph(glyph, &mut pen);
            }
            pen.along += self.advance(character);
        }
        pen.path
    }
}

/// Writes outlines of glyphs one after the other.
#[cfg(feature = "figures")]
struct Pen {
    path: String,
    x: f64,
    y: f64,
    scale: f64,
    /// How far along the line the next glyph begins, in units of the font.
    along: f64,
    is_upwards: bool,
}

#[cfg(feature = "figures")]
impl Pen {
    fn to(&mut self, command: char, points: &[(f32, f32)]) {
        use std::fmt::Write;
        self.path.push(command);
        for (i, &(right, up)) in points.iter().enumerate() {
            let (right, up) = ((self.along + f64::from(right)) * self.scale, f64::from(up) * self.scale);
            let (x, y) = if self.is_upwards { (self.x - up, self.y - right) } else { (self.x + right, self.y - up) };
            let space = if i > 0 { " " } else { "" };
            write!(self.path, "{space}{x:.2} {y:.2}").expect("texts are written to memory");
        }
    }
}

#[cfg(feature = "figures")]
impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.to('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.to('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.to('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.to('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.path.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_signs_are_there() {
        let font = Font::bundled();
        for character in "Aa09 ωµ°−·…×≤≥ₖ⁻²▲▼äé".chars() {
            assert!(font.face.glyph_index(character).is_some(), "{character}");
        }
        assert!(font.width("mm", 10.0) > font.width("m", 10.0));
    }
}
