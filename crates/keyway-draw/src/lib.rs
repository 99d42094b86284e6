//! Pictures of maps, searches, plans and runs, as SVG, PNG, GIF and APNG.
//!
//! [`MapPicture`] draws a map with layers from [`layers`] over it, [`MapPanels`] many such
//! pictures side by side; [`speed_curve`] draws speed and turn rate over time, [`log_chart`]
//! quantities on logarithmic axes, [`box_plot`] distributions, [`interval_chart`] values with
//! their intervals, [`point_panels`] points and rates with their intervals. All charts are made
//! of a [`Chart`], whose panels are drawn on through a [`Plot`]; so is a custom chart (example
//! `own_chart`). Each returns an [`Svg`], whose text the caller writes to a file or a page.
//!
//! With the feature `raster`, which is on by default, an [`Svg`] can also be rendered to PNG
//! (`Svg::to_png`), and an `Animation` plays pictures as GIF or APNG. Without it, the crate needs
//! no renderer, no font and no image format.
//!
//! The same input gives the same bytes. Nothing is read from the machine: the font of all raster
//! pictures (`DejaVu Sans`, licence in `fonts/`) is part of the library.
//!
//! ```
//! use keyway::geometry::{Point, Polyline};
//! use keyway::map::OccupancyGrid;
//! use keyway_draw::MapPicture;
//! use keyway_draw::layers::{GoalMark, PathLine, StartMark};
//!
//! let map = OccupancyGrid::from_ascii(&[".....", ".###.", "....."]);
//! let (start, goal) = (Point::new(0.5, 0.5), Point::new(4.5, 2.5));
//! let path = Polyline::new(vec![start, Point::new(4.5, 0.5), goal]);
//! let picture = MapPicture::new(&map)
//!     .with(PathLine::planned(&path))
//!     .with(StartMark(start))
//!     .with(GoalMark { point: goal, tolerance_m: Some(0.3) })
//!     .svg();
//! assert!(picture.as_str().starts_with("<svg"));
//! ```

#[cfg(feature = "raster")]
mod animation;
mod axes;
mod axis;
mod box_plot;
mod canvas;
mod caption;
mod chart;
mod color;
mod interval_chart;
pub mod layers;
mod legend;
mod line_style;
mod log_chart;
mod map_panels;
mod map_picture;
mod marks;
mod name_lines;
mod outline;
#[cfg(feature = "pdf")]
mod pdf;
mod plot;
mod point_panels;
#[cfg(feature = "raster")]
mod raster;
mod speed_curve;
mod svg;
mod text;
#[cfg(all(test, feature = "raster"))]
mod text_room_tests;
mod text_table;
mod ticks;
mod view;
mod writer;

#[cfg(feature = "raster")]
pub use animation::{Animation, animate_frames, animate_search};
pub use axis::Axis;
pub use box_plot::{BoxGroup, BoxPlot, box_plot};
pub use canvas::Canvas;
pub use chart::Chart;
pub use color::{Rgb, SERIES, viridis};
pub use interval_chart::{IntervalChart, IntervalRow, interval_chart};
pub use legend::{ColorBar, LegendEntry, LegendMark};
pub use line_style::{LineStyle, series_style};
pub use log_chart::{LogChart, LogLine, LogPanel, log_chart};
pub use map_panels::MapPanels;
pub use map_picture::{Layout, MapPicture};
pub use plot::{ChartPoint, Plot, PlotArea};
pub use point_panels::{PointPanels, PointSeries, point_panels};
#[cfg(feature = "raster")]
pub use raster::{DrawError, MAX_PNG_SIDE_PX};
pub use speed_curve::{SpeedCurveOptions, SpeedSeries, speed_curve};
pub use svg::Svg;
pub use text_table::TextTable;
pub use ticks::Ticks;
pub use view::{Extent, Region, View};
pub use writer::{Anchor, PathData, SvgWriter, Tag};
