//! Obstacles that are present only for a time, or that sensors miss.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::Rgb;
use crate::legend::{LegendEntry, LegendMark};
use crate::marks::{hatched_disc, hatched_polygon};
use crate::view::Extent;
use keyway_sim::sim::{ElusiveObstacle, ElusiveShape};

/// Obstacles that are present only for a time, or that sensors miss, hatched in a separate
/// colour: all of them, or those that are present at a time.
#[derive(Clone, Copy, Debug)]
pub struct ElusiveObstacles<'a> {
    all: &'a [ElusiveObstacle],
    at_s: Option<f64>,
}

impl<'a> ElusiveObstacles<'a> {
    const COLOR: Rgb = Rgb(0x00, 0x8b, 0x8b);

    /// Creates the layer of all of them, for a picture of a whole run.
    pub const fn new(all: &'a [ElusiveObstacle]) -> Self {
        Self { all, at_s: None }
    }

    /// Creates the layer of those that are present at a time \[s\].
    pub const fn at(all: &'a [ElusiveObstacle], t_s: f64) -> Self {
        Self { all, at_s: Some(t_s) }
    }

    fn shown(&self) -> impl Iterator<Item = &'a ElusiveShape> {
        let at_s = self.at_s;
        let stands = move |it: &&ElusiveObstacle| at_s.is_none_or(|t_s| it.stands_at(t_s));
        self.all.iter().filter(stands).map(ElusiveObstacle::shape)
    }
}

impl Layer for ElusiveObstacles<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn extend(&self, extent: &mut Extent) {
        // Absent ones count, too: all frames of an animation show the same area.
        for shape in self.all.iter().map(ElusiveObstacle::shape) {
            match shape {
                ElusiveShape::Disc(disc) => extent.include_disc(disc.centre, disc.radius_m),
                ElusiveShape::Polygon(polygon) => {
                    polygon.vertices().iter().for_each(|&vertex| extent.include(vertex));
                }
                _ => {}
            }
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        for shape in self.shown() {
            match shape {
                ElusiveShape::Disc(disc) => {
                    let radius = disc.radius_m * view.px_per_m();
                    let centre = view.px_from_world(disc.centre);
                    hatched_disc(canvas.writer(), centre, radius, Self::COLOR);
                    canvas.discs.push((centre, radius));
                }
                ElusiveShape::Polygon(polygon) => {
                    let vertices = polygon.vertices().iter().map(|&at| view.px_from_world(at));
                    let vertices: Vec<_> = vertices.collect();
                    hatched_polygon(canvas.writer(), &vertices, Self::COLOR);
                }
                _ => {}
            }
        }
        if self.shown().next().is_some() {
            let label = "temporary or hard-to-detect obstacle";
            canvas.explain(LegendEntry::new(label, LegendMark::HatchedDisc(Self::COLOR)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MapPicture;
    use keyway::geometry::{Disc, Point};
    use keyway::map::OccupancyGrid;
    use keyway_sim::sim::{Presence, StandingPolygon};

    #[test]
    fn those_that_stand_are_drawn_and_explained() {
        let map = OccupancyGrid::from_ascii(&["......", "......"]);
        let corners = [[1.0, 0.5], [2.0, 0.5], [2.0, 1.5]].map(Point::from).to_vec();
        let door = ElusiveShape::Polygon(StandingPolygon::new(corners).unwrap());
        let parcel = ElusiveShape::Disc(Disc::new(Point::new(4.0, 1.0), 0.5));
        let until_3_s = Presence { until_s: Some(3.0), ..Presence::ALWAYS };
        let from_5_s = Presence { from_s: 5.0, ..Presence::ALWAYS };
        let all = [
            ElusiveObstacle::new(door, until_3_s).unwrap(),
            ElusiveObstacle::new(parcel, from_5_s).unwrap(),
        ];
        let color = ElusiveObstacles::COLOR.to_string();
        // Each is an area and its hatching, and so is the mark in the legend.
        let marks = |layer: ElusiveObstacles<'_>| {
            let svg = MapPicture::new(&map).with(layer).svg().as_str().to_owned();
            let drawn = svg.matches(&format!("fill=\"{color}\"")).count();
            (drawn, svg.contains("temporary or hard-to-detect obstacle"))
        };
        assert_eq!(marks(ElusiveObstacles::new(&all)), (3, true));
        assert_eq!(marks(ElusiveObstacles::at(&all, 1.0)), (2, true));
        assert_eq!(marks(ElusiveObstacles::at(&all, 4.0)), (0, false));
        assert_eq!(marks(ElusiveObstacles::at(&all, 5.0)), (2, true));
    }
}
