//! A figure: one or several panels, laid out.

use super::labels::{frame, placed};
use super::panel::Panel;
use super::style::{INK, MILLIMETRE, TICK, TITLE, text};
use crate::error::Error;
use plotive::Prepare;
use plotive::des::figure::LegendPos;
use plotive::des::{FigLegend, Figure, PlotIdx, Subplots};
use plotive::drawing::PreparedFigure;
use plotive::fontdb::Database;
use plotive::geom::Padding;
use plotive::geom::Size;
use plotive::text::TextProps;

/// Space between panels, in units of the figure.
const SPACE: f32 = 12.0;

/// Room around everything; on the right the last number of an axis is wider than the panel.
const PADDING: Padding = Padding::Custom { top: 8.0, right: 20.0, bottom: 8.0, left: 8.0 };

/// A figure before it is laid out.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// What is written above it.
    pub title: Option<String>,
    /// Where the legend of named curves is, if there is one.
    pub legend: Option<LegendPos>,
}

impl From<Panel> for Sheet {
    fn from(panel: Panel) -> Self {
        Self { panels: vec![panel], columns: 1, title: None, legend: None }
    }
}

impl Sheet {
    /// Lays the figure out, mm.
    ///
    /// # Errors
    /// If there is too little room.
    pub fn prepare(&self, width: f64, height: f64) -> Result<PreparedFigure, Error> {
        let size = Size::new((width * MILLIMETRE) as f32, (height * MILLIMETRE) as f32);
        let fonts = plotive::bundled_font_db();
        let mut figure = self.design(size);
        let bare = figure.prepare(&(), Some(&fonts)).map_err(|error| refused(error, width, height))?;
        self.add_labels(&mut figure, &bare, &fonts)?;
        figure.prepare(&(), Some(&fonts)).map_err(|error| refused(error, width, height))
    }

    fn index(&self, panel: usize) -> PlotIdx {
        PlotIdx::new((panel / self.columns) as u32, (panel % self.columns) as u32)
    }

    fn design(&self, size: Size) -> Figure {
        let rows = self.panels.len().div_ceil(self.columns);
        let grid = Subplots::new(rows as u32, self.columns as u32).with_space(SPACE);
        let panels = self.panels.iter().enumerate();
        let grid = panels.fold(grid, |grid, (i, panel)| grid.with_plot(self.index(i), panel.design()));
        let figure = grid.into_figure().with_size(size).with_padding(PADDING);
        let figure = match &self.title {
            Some(title) => figure.with_title(text(title, TITLE, INK)),
            None => figure,
        };
        let Some(position) = self.legend else { return figure };
        let font = TextProps { size: Some(TICK), ..Default::default() };
        let legend = FigLegend::new(position).with_font(font).with_border(None).with_fill(None);
        let legend = legend.with_padding(Padding::Even(0.0)).with_margin(12.0).with_spacing(Size::new(14.0, 3.0));
        figure.with_legend(legend)
    }

    fn add_labels(&self, figure: &mut Figure, bare: &PreparedFigure, fonts: &Database) -> Result<(), Error> {
        for (i, panel) in self.panels.iter().enumerate().filter(|(_, panel)| !panel.labels.is_empty()) {
            let Some(frame) = frame(bare, self.index(i)) else { continue };
            let labels = placed(panel, &frame, fonts).map_err(|error| Error::Other(format!("labels: {error}")))?;
            if let Some(plot) = figure.plots_mut().plot_mut(self.index(i)) {
                labels.into_iter().for_each(|label| plot.push_annotation(label));
            }
        }
        Ok(())
    }
}

fn refused(error: plotive::drawing::Error, width: f64, height: f64) -> Error {
    Error::Other(match error {
        plotive::drawing::Error::NotEnoughSpace => {
            format!("{width} mm × {height} mm is too little room for this figure: use larger --width and --height")
        }
        error => format!("the figure cannot be drawn: {error}"),
    })
}
