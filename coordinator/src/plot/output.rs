//! Files of figures: SVG, PNG and PDF. Texts are outlines, so that they look the same everywhere.

use super::style::MILLIMETRE;
use crate::error::Error;
use plotive::Style;
use plotive::drawing::PreparedFigure;
use plotive_pxl::{Params, PxlRender};
use plotive_svg::SvgSurface;
use std::path::Path;
use svg2pdf::usvg::{Options, Tree};
use svg2pdf::{ConversionOptions, PageOptions};

/// Pixels of a PNG in a millimetre: 300 in an inch.
const PIXELS: f64 = 300.0 / 25.4;

/// What kind of file a figure becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Vectors, for the web and for editing.
    Svg,
    /// Pixels, 300 in an inch.
    Png,
    /// Vectors, for LaTeX.
    Pdf,
}

impl Format {
    /// By the extension of a file.
    ///
    /// # Errors
    /// If it is none of them, with a message that names them.
    pub fn of(file: &Path) -> Result<Self, Error> {
        let extension = file.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            Some("pdf") => Ok(Self::Pdf),
            _ => Err(Error::Other(format!("-o {}: end it in .svg, .png or .pdf", file.display()))),
        }
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// If the figure is too large for pixels.
    pub fn bytes(self, figure: &PreparedFigure) -> Result<Vec<u8>, Error> {
        match self {
            Self::Svg => svg(figure).map(String::into_bytes),
            Self::Png => png(figure),
            Self::Pdf => pdf(&svg(figure)?),
        }
    }
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Other(format!("the figure cannot be written: {error}"))
}

fn svg(figure: &PreparedFigure) -> Result<String, Error> {
    let size = figure.size();
    let (width, height) = (size.width() as u32, size.height() as u32);
    let mut surface = SvgSurface::new(width, height);
    figure.draw(&mut surface, &Style::light());
    let mut bytes = Vec::new();
    surface.write(&mut bytes).map_err(failed)?;
    let text = String::from_utf8(bytes).map_err(failed)?;
    // plotive knows whole pixels only; in print, the size counts.
    let millimetres = |units: f32| (f64::from(units) / MILLIMETRE * 1000.0).round() / 1000.0;
    let text =
        text.replacen(&format!("height=\"{height}\""), &format!("height=\"{}mm\"", millimetres(size.height())), 1);
    Ok(text.replacen(&format!("width=\"{width}\""), &format!("width=\"{}mm\"", millimetres(size.width())), 1))
}

fn png(figure: &PreparedFigure) -> Result<Vec<u8>, Error> {
    let params = Params { style: Style::light(), scale: (PIXELS / MILLIMETRE) as f32, ..Default::default() };
    figure.to_png_data(&(), params).map_err(failed)
}

fn pdf(svg: &str) -> Result<Vec<u8>, Error> {
    let tree = Tree::from_str(svg, &Options::default()).map_err(failed)?;
    svg2pdf::to_pdf(&tree, ConversionOptions::default(), PageOptions { dpi: 96.0 }).map_err(failed)
}
