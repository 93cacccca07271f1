//! Files of figures: SVG, PNG and PDF.

use super::sheet::MILLIMETRE;
use crate::error::Error;
use resvg::render;
use resvg::tiny_skia::{Color, Pixmap, Transform};
use std::path::Path;
use svg2pdf::usvg::{Options, Tree};
use svg2pdf::{ConversionOptions, PageOptions};

/// Pixels of a PNG in a millimetre: 300 in an inch.
const PIXELS: f64 = 300.0 / 25.4;

/// What kind of file a figure becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// Vectors, for the web and for editing.
    Svg,
    /// Pixels, 300 in an inch.
    Png,
    /// Vectors, for LaTeX.
    Pdf,
}

impl FileFormat {
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
            _ => Err(Error::Usage(format!("-o {}: end it in .svg, .png or .pdf", file.display()))),
        }
    }

    /// The bytes of the file of a figure, which comes as SVG.
    ///
    /// # Errors
    /// If the figure is too large for pixels.
    pub fn bytes(self, svg: String) -> Result<Vec<u8>, Error> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            Self::Png => png(&svg),
            Self::Pdf => pdf(&svg),
        }
    }
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Other(format!("the figure cannot be written: {error}"))
}

fn tree(svg: &str) -> Result<Tree, Error> {
    Tree::from_str(svg, &Options::default()).map_err(failed)
}

fn png(svg: &str) -> Result<Vec<u8>, Error> {
    let tree = tree(svg)?;
    let scale = (PIXELS / MILLIMETRE) as f32;
    let pixels = |length: f32| (length * scale).round() as u32;
    let size = (pixels(tree.size().width()), pixels(tree.size().height()));
    let mut picture = Pixmap::new(size.0, size.1).ok_or_else(|| failed("it is too large"))?;
    picture.fill(Color::WHITE);
    render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(failed)
}

fn pdf(svg: &str) -> Result<Vec<u8>, Error> {
    svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), PageOptions { dpi: 96.0 }).map_err(failed)
}
