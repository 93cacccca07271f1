//! A figure with what it is looked at with.

use super::layout::Layout;
use super::svg::Canvas;
use crate::error::Error;
use crate::figure::{ColumnStore, Figure, Font, Frame, View};

/// Units of a figure (1/96 inch, as in SVG and CSS) in a millimetre.
pub const MILLIMETRE: f64 = 96.0 / 25.4;

/// A figure that is ready to be drawn.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// The figure.
    pub figure: Figure,
    /// Its columns.
    pub columns: ColumnStore,
    /// The option of its choice.
    pub choice: usize,
    /// The forcing amplitude that it is about, if it is about one.
    pub frame: Option<Frame>,
}

impl Sheet {
    /// What its panels are looked at with.
    pub fn view(&self) -> View<'_> {
        View { choice: self.choice, store: &self.columns, frame: self.frame.as_ref() }
    }

    /// The figure as SVG, of a size in mm.
    ///
    /// # Errors
    /// If there is too little room.
    pub fn svg(&self, width: f64, height: f64) -> Result<String, Error> {
        let font = Font::bundled();
        let size = (width * MILLIMETRE, height * MILLIMETRE);
        let Some(layout) = Layout::new(&self.figure, self.choice, size, &font) else {
            return Err(Error::Other(format!(
                "{width} mm × {height} mm is too little room for this figure: use larger --width and --height"
            )));
        };
        let mut canvas = Canvas::new(&font);
        canvas.head(&layout);
        for (panel, place) in self.figure.panels.iter().zip(&layout.panels) {
            canvas.panel(panel, place, self.view());
        }
        let svg = canvas.end();
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {:.3} {:.3}\">\n{svg}</svg>\n",
            size.0, size.1
        ))
    }
}
