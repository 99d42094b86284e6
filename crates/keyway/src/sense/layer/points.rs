//! Points in the sensed layer.

use super::SensedLayer;
use crate::geometry::{Point, Pose};
use crate::map::{Edit, OccupancyGrid};
use crate::robot::Footprint;
use crate::sense::{FieldOfView, SensorPoints, Tracker};

impl SensedLayer {
    /// Takes in points from a sensor of a robot of this footprint at `robot` (world frame). Each
    /// point marks its cell as the hit of a beam does. Points within the footprint are on the
    /// robot itself and those on a moving obstacle in view belong to it; neither marks anything.
    ///
    /// Such a sensor clears only its own points, and only inside its field of view
    /// ([`SensorPoints::clears`]) where it no longer detects anything at the point or before it.
    ///
    /// `edits` is emptied and receives the cells that changed, as by [`Self::update`].
    pub fn update_points(
        &mut self,
        known: &OccupancyGrid,
        footprint: &Footprint,
        robot: Pose,
        points: &SensorPoints<'_>,
        tracker: Option<&Tracker>,
        edits: &mut Vec<Edit>,
    ) {
        let sensor = points.sensor.min(SensorPoints::MOST_SENSORS - 1);
        self.begin(edits);
        let pose = robot.compose(points.mount);
        if pose.point().is_finite() && pose.theta.is_finite() {
            self.clear_in_view(known, sensor, pose, points);
            let met = points.points.iter().filter(|&&point| says_something(point));
            let is_own = |point: Point| footprint.covers(points.mount.world_from_body(point));
            for &point in met.filter(|point| !is_own(**point)) {
                let point = pose.world_from_body(point);
                if !tracker.is_some_and(|tracker| tracker.may_be_mover(point)) {
                    self.mark_point(known, sensor, point);
                }
            }
        }
        self.list_changes(known, edits);
    }

    /// Clears the sensor's own points that are in view and no longer detected.
    fn clear_in_view(
        &mut self,
        known: &OccupancyGrid,
        sensor: usize,
        pose: Pose,
        points: &SensorPoints<'_>,
    ) {
        let Some(view) = points.clears.filter(FieldOfView::is_usable) else { return };
        self.view.look_around(pose, &view, points.points, known.frame().resolution_m());
        let is_gone = |place: Point| {
            place.distance(pose.point()) >= view.range_min_m && self.view.sees_through(place)
        };
        let own = self.met.iter().filter(|((_, of), _)| *of == sensor);
        let gone = own.filter(|(_, place)| is_gone(**place)).map(|((cell, _), _)| *cell);
        for cell in gone.collect::<Vec<_>>() {
            self.met.remove(&(cell, sensor));
            if !self.places.contains_key(&cell) && !self.has_met(cell) {
                self.sensed.set(cell, false);
                self.cleared.push(cell);
            }
        }
        self.cleared.sort_unstable();
    }

    fn mark_point(&mut self, known: &OccupancyGrid, sensor: usize, point: Point) {
        let cell = known.frame().cell_from_world(point);
        if let Some(cell) = cell.filter(|&cell| !known.occupied().get(cell)) {
            self.met.insert((cell, sensor), point);
            self.mark_cell(cell);
        }
    }
}

/// True for a valid point, at which something was detected.
pub(in crate::sense) fn says_something(point: Point) -> bool {
    point.is_finite() && point != Point::new(0.0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, CellState};

    /// A row of cells of 1 m, and a sensor that sees 0.3 rad to either side of its axis.
    struct Case {
        known: OccupancyGrid,
        layer: SensedLayer,
    }

    const VIEW: FieldOfView =
        FieldOfView { from_rad: -0.3, to_rad: 0.3, range_min_m: 0.0, range_max_m: 4.0 };

    impl Case {
        fn new() -> Self {
            let known = OccupancyGrid::from_ascii(&["......#"]);
            let layer = SensedLayer::new(known.frame());
            Self { known, layer }
        }

        /// Sensor update along the row, from the centre of its first cell.
        fn look(
            &mut self,
            (sensor, clears): (usize, Option<FieldOfView>),
            at_m: &[f64],
        ) -> Vec<(i32, CellState)> {
            let points: Vec<Point> = at_m.iter().map(|&x| Point::new(x, 0.0)).collect();
            let mount = Pose::default();
            let points = SensorPoints { stamp_s: 0.0, sensor, mount, points: &points, clears };
            let (pose, mut edits) = (Pose::new(0.5, 0.5, 0.0), Vec::new());
            let disc = Footprint::circle(0.2).unwrap();
            self.layer.update_points(&self.known, &disc, pose, &points, None, &mut edits);
            assert_eq!(self.layer.count(), self.layer.sensed().count_ones());
            edits.iter().map(|edit| (edit.cell.x, edit.state)).collect()
        }
    }

    use CellState::{Free, Occupied};

    #[test]
    fn points_mark_and_their_own_sensor_clears() {
        let mut case = Case::new();
        let (sees, marks) = ((0, Some(VIEW)), (1, None));
        // The robot itself, a point beyond the map, a known obstacle, and no return.
        assert_eq!(case.look(sees, &[0.1, 7.0, 6.0, f64::NAN]), []);
        assert_eq!(case.look(sees, &[3.0, 2.0]), [(3, Occupied), (2, Occupied)]);
        assert_eq!(case.look(marks, &[1.0]), [(1, Occupied)]);
        assert_eq!(case.look(sees, &[3.2]), [(2, Free)], "still met, elsewhere in the cell");
        assert_eq!(case.look(sees, &[1.6]), [(2, Occupied)], "it hides what is behind it");
        assert_eq!(case.look(sees, &[]), [(2, Free), (3, Free)]);
        assert_eq!(case.look(marks, &[]), [], "it sees no ground");
        assert!(case.layer.sensed().get(Cell::new(1, 0)));
        assert_eq!(case.look((1, Some(VIEW)), &[]), [(1, Free)]);
    }

    /// A lidar and two cameras see something in the same cell.
    #[test]
    fn a_cell_is_free_when_nobody_meets_anything_in_it() {
        let mut case = Case::new();
        let scan = |range_m: f64| {
            let scan = crate::sense::Scan {
                angle_increment_rad: 0.1,
                range_max_m: 5.0,
                ranges_m: vec![range_m; 1],
                ..crate::sense::Scan::default()
            };
            crate::sense::test_scan::projected(
                &crate::map::GridFrame::new(7, 1, 1.0, Pose::default()).unwrap(),
                Pose::new(0.5, 0.5, 0.0),
                &scan,
            )
        };
        let mut edits = Vec::new();
        let is_sensed = |case: &Case| case.layer.sensed().get(Cell::new(2, 0));
        for order in 0..2 {
            if order == 0 {
                case.look((0, Some(VIEW)), &[2.0]);
            }
            case.layer.update(&case.known, &scan(2.0), None, &mut edits);
            case.look((0, Some(VIEW)), &[2.0]);
            case.look((1, Some(VIEW)), &[2.1]);
            assert_eq!(case.look((0, Some(VIEW)), &[]), [], "the lidar and the other one meet it");
            assert_eq!(case.look((1, Some(VIEW)), &[]), [], "the lidar meets it");
            assert!(is_sensed(&case));
            case.layer.update(&case.known, &scan(f64::INFINITY), None, &mut edits);
            assert!(!is_sensed(&case) && edits.len() == 1);
        }
        case.look((0, Some(VIEW)), &[2.0]);
        case.layer.update(&case.known, &scan(2.0), None, &mut edits);
        case.layer.update(&case.known, &scan(f64::INFINITY), None, &mut edits);
        assert!(is_sensed(&case) && edits.is_empty(), "the camera meets it");
    }

    #[test]
    fn no_more_is_cleared_than_is_seen() {
        let mut case = Case::new();
        case.look((0, None), &[2.0, 5.0]);
        let views = [
            FieldOfView { from_rad: 0.1, ..VIEW },
            FieldOfView { from_rad: f64::NAN, ..VIEW },
            FieldOfView { to_rad: -0.3, ..VIEW },
            FieldOfView { range_min_m: 2.5, ..VIEW },
            FieldOfView { range_max_m: 1.5, ..VIEW },
            FieldOfView { range_max_m: f64::INFINITY, ..VIEW },
            FieldOfView { to_rad: 100.0, ..VIEW },
        ];
        for view in views {
            assert_eq!(case.look((0, Some(view)), &[]), [], "{view:?}");
        }
        // Full circle, limited by the range only.
        let turn = FieldOfView { from_rad: -4.0, to_rad: -4.0 + std::f64::consts::TAU, ..VIEW };
        assert_eq!(case.look((0, Some(turn)), &[]), [(2, Free)]);
    }
}
