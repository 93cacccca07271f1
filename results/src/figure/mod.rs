//! Figures as data: each is described once, from what a run has computed, and drawn by the page or into a file.

mod axis;
mod backbone;
mod balance;
mod bands;
mod coincidence;
mod column_store;
mod compared;
mod data;
mod figures;
mod folds;
mod frames;
mod geometry;
mod labels;
mod line;
mod map;
mod modes;
mod motion;
mod narrow;
mod palette;
mod placement;
mod places;
mod rectangle;
mod references;
mod resonance;
mod response;
mod smooth;
mod special;
mod stability;
mod strands;
mod style;
mod subject;
mod text;
mod units;

pub use coincidence::Coincidence;
pub use column_store::{ColumnStore, Ref};
pub use compared::{Compared, ComparedFigures};
pub use data::{Axis, Direction, Entry, Figure, Kind, Measure, Panel, Scale, Series, Span, Unit, chosen};
pub use figures::Figures;
pub use frames::{Frame, ladder};
pub use geometry::{Part, View};
pub use labels::{Field, Spot};
pub use motion::{
    MotionAxis, axes as motion_axes, drawn as motion_drawn, template as motion_template, with_marched as motion_marched,
};
pub use palette::{Colors, LIGHT, PALETTE, Palette, Rgb};
pub use placement::{place, place_for_page, point as label_point, run_points};
pub use references::backbone_series;
pub use response::{FEW, Outline, branch_series, called, is_crowd, make_room, say_thinner};
pub use special::special_points;
pub use stability::straight_gaps;
pub use style::{Color, Marker, Shape, Style};
pub use subject::{BackboneColumns, Subject, level_colors};
pub use text::{CAPITALS, Font, LINE};
pub use units::{convert, write_frequencies};
