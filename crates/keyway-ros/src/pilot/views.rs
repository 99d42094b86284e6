//! Visualisation messages of the robot's state.

use super::Pilot;
use crate::messages::geometry_msgs::{Point32, Polygon, PolygonStamped, Pose as PoseMessage};
use crate::messages::geometry_msgs::{PoseStamped, Vector3};
use crate::messages::nav_msgs::Path;
use crate::messages::std_msgs::{ColorRgba, Header};
use crate::messages::visualization_msgs::{Marker, MarkerArray};
use keyway::geometry::{Point, Pose};
use keyway::local::Fate;
use keyway::robot::Footprint;
use keyway::sense::Mover;
use std::f64::consts::TAU;

const ORANGE: ColorRgba = ColorRgba { r: 0.90, g: 0.45, b: 0.05, a: 0.8 };
const BLUE: ColorRgba = ColorRgba { r: 0.10, g: 0.35, b: 0.85, a: 1.0 };
const GREEN: ColorRgba = ColorRgba { r: 0.15, g: 0.60, b: 0.25, a: 0.5 };
const GREY: ColorRgba = ColorRgba { r: 0.50, g: 0.50, b: 0.50, a: 0.3 };

impl Pilot {
    /// The footprint of the robot at its pose.
    pub(crate) fn footprint(&self, now_s: f64) -> Option<PolygonStamped> {
        const CORNERS: u32 = 16;
        let pose = self.pose?;
        let corners = match &self.settings.stack.robot().footprint {
            Footprint::Polygon(polygon) => polygon.vertices().to_vec(),
            Footprint::Circle(circle) => (0..CORNERS)
                .map(|corner| {
                    let (sin, cos) = (TAU * f64::from(corner) / f64::from(CORNERS)).sin_cos();
                    Point::new(cos, sin) * circle.radius_m()
                })
                .collect(),
        };
        let point = |corner: &Point| {
            let place = pose.world_from_body(*corner);
            Point32 { x: place.x as f32, y: place.y as f32, z: 0.0 }
        };
        let polygon = Polygon { points: corners.iter().map(point).collect() };
        Some(PolygonStamped { header: self.header(now_s), polygon })
    }

    /// The route; `None` without a goal.
    pub(crate) fn route(&self, now_s: f64) -> Option<Path> {
        let navigator = self.navigator()?;
        let heading_rad = navigator.goal().and_then(|goal| goal.heading_rad);
        let points = navigator.route()?.smoothed.points();
        Some(Path::along(&self.header(now_s), points, heading_rad))
    }

    /// The trajectory that the last command started; empty without one.
    pub(crate) fn local_plan(&self, now_s: f64) -> Option<Path> {
        let header = self.header(now_s);
        let stamped = |pose: Pose| PoseStamped { header: header.clone(), pose: pose.into() };
        let poses = self.navigator()?.course().into_iter().map(stamped).collect();
        Some(Path { header: header.clone(), poses })
    }

    /// Markers of the moving obstacles, the local target, and the obstacles avoided by a detour.
    pub(crate) fn markers(&self, now_s: f64) -> Option<MarkerArray> {
        let navigator = self.navigator()?;
        let draw = Drawing { header: self.header(now_s) };
        let mut markers = vec![draw.nothing()];
        for mover in navigator.movers() {
            markers.extend(draw.mover(mover));
        }
        let guide = navigator.guidance().filter(|_| navigator.goal().is_some());
        if let Some(guidance) = guide {
            markers.push(draw.round("guide", 0, (guidance.point, 0.08), BLUE));
        }
        for (id, disc) in navigator.gone_around().iter().enumerate() {
            let disc = (disc.centre, disc.radius_m);
            markers.push(draw.round("gone_around", id as i32, disc, GREY));
        }
        Some(MarkerArray { markers })
    }

    /// Markers of the candidates of the last decision, admissible ones and others. Computing them
    /// takes many times as long as the decision.
    pub(crate) fn fan(&self, now_s: f64) -> Option<MarkerArray> {
        let explanation = self.navigator()?.explain();
        let draw = Drawing { header: self.header(now_s) };
        let mut markers = vec![draw.nothing()];
        for (namespace, is_refused, color) in
            [("refused", true, GREY), ("admissible", false, GREEN)]
        {
            let poses = explanation
                .candidates
                .iter()
                .filter(|candidate| matches!(candidate.fate, Fate::Refused { .. }) == is_refused);
            let legs = poses.flat_map(|candidate| candidate.poses.windows(2));
            let points = legs.flatten().map(|pose| above(pose.point())).collect();
            markers.push(draw.lines(Marker::LINE_LIST, namespace, points, color));
        }
        let chosen = explanation.chosen.map(|chosen| &explanation.candidates[chosen].poses);
        let points = chosen.into_iter().flatten().map(|pose| above(pose.point())).collect();
        markers.push(draw.lines(Marker::LINE_STRIP, "chosen", points, BLUE));
        Some(MarkerArray { markers })
    }

    /// Header of a message in the map frame, at a time \[s\].
    pub(crate) fn header(&self, now_s: f64) -> Header {
        Header::new(now_s, &self.settings.frames.map)
    }
}

/// Header shared by all markers of a picture.
struct Drawing {
    header: Header,
}

impl Drawing {
    /// A marker that deletes the last picture.
    fn nothing(&self) -> Marker {
        let header = self.header.clone();
        Marker { header, action: Marker::DELETE_ALL, ..Marker::default() }
    }

    /// Marker of a disc on the ground.
    fn round(
        &self,
        namespace: &str,
        id: i32,
        (centre, radius_m): (Point, f64),
        color: ColorRgba,
    ) -> Marker {
        const HEIGHT_M: f64 = 0.1;
        Marker {
            header: self.header.clone(),
            namespace: namespace.to_owned(),
            id,
            shape: Marker::CYLINDER,
            pose: PoseMessage { position: above(centre), ..PoseMessage::default() },
            scale: Vector3 { x: 2.0 * radius_m, y: 2.0 * radius_m, z: HEIGHT_M },
            color,
            ..Marker::default()
        }
    }

    /// Markers of a moving obstacle and its position in one second.
    fn mover(&self, mover: &Mover) -> [Marker; 2] {
        const SHAFT_M: f64 = 0.06;
        let id = mover.id as i32;
        let body = self.round("movers", id, (mover.centre, mover.radius_m), ORANGE);
        let arrow = Marker {
            namespace: "speeds".to_owned(),
            shape: Marker::ARROW,
            pose: PoseMessage::default(),
            scale: Vector3 { x: SHAFT_M, y: 2.0 * SHAFT_M, z: 0.0 },
            points: vec![above(mover.centre), above(mover.centre + mover.velocity_mps)],
            ..body.clone()
        };
        [body, arrow]
    }

    fn lines(&self, shape: i32, namespace: &str, points: Vec<Vector3>, color: ColorRgba) -> Marker {
        const WIDTH_M: f64 = 0.015;
        Marker {
            header: self.header.clone(),
            namespace: namespace.to_owned(),
            shape,
            scale: Vector3 { x: WIDTH_M, y: 0.0, z: 0.0 },
            color,
            points,
            ..Marker::default()
        }
    }
}

/// A point just above the ground, so that a map does not hide it.
fn above(place: Point) -> Vector3 {
    Vector3 { x: place.x, y: place.y, z: 0.05 }
}
