//! The sensors of a robot.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::Rgb;
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::view::Extent;
use keyway::geometry::{Point, Pose};
use keyway::robot::{Mount, RangeSensor};

/// Sensors of a robot at a pose: a dot at each mount, a stroke in its direction, and the ring
/// within which it is blind (`range_min_m`). A single sensor at the centre without a blind ring
/// is not drawn: every robot has it.
#[derive(Clone, Copy, Debug)]
pub struct Sensors<'a> {
    robot: Pose,
    sensors: &'a [RangeSensor],
}

impl<'a> Sensors<'a> {
    const COLOR: Rgb = Rgb(0xd5, 0x5e, 0x00);
    const DOT_PX: f64 = 2.4;
    const STROKE_PX: f64 = 9.0;
    const LINE: LineStyle = LineStyle::solid(Self::COLOR, 1.4);
    const BLIND: LineStyle = LineStyle { color: Self::COLOR, width_px: 0.9, dashes: "2 2" };

    /// Creates the sensors of a robot at a pose in the world frame.
    pub const fn new(robot: Pose, sensors: &'a [RangeSensor]) -> Self {
        Self { robot, sensors }
    }

    fn are_usual(&self) -> bool {
        let is_usual = |one: &RangeSensor| one.mount == Mount::CENTRE && one.range_min_m == 0.0;
        !self.robot.point().is_finite() || self.sensors.len() == 1 && is_usual(&self.sensors[0])
    }
}

impl Layer for Sensors<'_> {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        for sensor in self.sensors {
            extent.include(self.robot.compose(sensor.mount.pose()).point());
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if self.are_usual() {
            return;
        }
        let view = *canvas.view();
        for sensor in self.sensors {
            let at = self.robot.compose(sensor.mount.pose());
            let (x, y) = view.px_from_world(at.point());
            let ahead = at.world_from_body(Point::new(Self::STROKE_PX / view.px_per_m(), 0.0));
            let line = canvas.writer().tag("line").between((x, y), view.px_from_world(ahead));
            line.line_style(Self::LINE).leaf();
            canvas.writer().tag("circle").round(x, y, Self::DOT_PX).fill(Self::COLOR).leaf();
            let blind_px = sensor.range_min_m * view.px_per_m();
            if blind_px > 2.0 * Self::DOT_PX {
                let ring = canvas.writer().tag("circle").round(x, y, blind_px).attr("fill", "none");
                ring.line_style(Self::BLIND).leaf();
            }
        }
        canvas.explain(LegendEntry::new("sensor", LegendMark::Dot(Self::COLOR, Self::DOT_PX)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MapPicture;
    use keyway::map::OccupancyGrid;
    use keyway::robot::Robot;

    #[test]
    fn sensors_are_drawn_where_they_are_mounted() {
        let map = OccupancyGrid::from_ascii(&["......", "......", "......"]);
        let svg = |robot: Pose, sensors: &[RangeSensor]| {
            MapPicture::new(&map).with(Sensors::new(robot, sensors)).svg().as_str().to_owned()
        };
        let pose = Pose::new(2.0, 1.5, std::f64::consts::FRAC_PI_2);
        let dots = |svg: &str| svg.matches("r=\"2.4\"").count();
        let usual = svg(pose, &Robot::small().sensors);
        assert_eq!((dots(&usual), usual.contains("sensor")), (0, false));
        let lost = svg(Pose { x: f64::NAN, ..pose }, &Robot::small().sensors);
        assert_eq!(dots(&lost), 0);
        let mount = |x_m| Mount { x_m, y_m: 0.0, yaw_deg: 180.0 };
        let front = RangeSensor { mount: mount(0.5), ..RangeSensor::new(9, 90.0, 3.0) };
        let rear = RangeSensor { mount: mount(-1.0), range_min_m: 0.3, ..front.clone() };
        let both = svg(pose, &[front, rear]);
        // Two sensors, and the mark in the legend; one of them is blind within a ring.
        assert_eq!((dots(&both), both.matches("stroke-dasharray=\"2 2\"").count()), (3, 1));
        // The robot faces up the page: the rear sensor is 1.5 m below the front one.
        let heights: Vec<f64> = both
            .split("<circle ")
            .filter(|tag| tag.contains("r=\"2.4\""))
            .map(|tag| tag.split("cy=\"").nth(1).unwrap().split('"').next().unwrap())
            .map(|cy| cy.parse().unwrap())
            .collect();
        let per_m = (heights[1] - heights[0]) / 1.5;
        assert!(per_m > 10.0, "{heights:?}");
    }
}
