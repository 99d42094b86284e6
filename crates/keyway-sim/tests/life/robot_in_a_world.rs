//! A robot with a navigator in a world, cycle by cycle.

use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::map::{CellState, Clearance, GridFrame, OccupancyGrid};
use keyway::navigate::{Navigator, Stack, Step, touches};
use keyway::robot::Robot;
use keyway::sense::{FieldOfView, Observation, SensorPoints, SensorScan};
use keyway_sim::sim::World;

/// A hall of 12 m x 8 m in cells of 5 cm, with walls around it and further occupied cells.
pub(crate) fn hall(is_wall: impl Fn(Point) -> bool) -> OccupancyGrid {
    let frame = GridFrame::new(240, 160, 0.05, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(239 - cell.x).min(159 - cell.y);
        let is_wall = edge < 1 || is_wall(frame.world_from_cell(cell));
        if is_wall { CellState::Occupied } else { CellState::Free }
    })
}

/// A wall across the hall at x = 6 m, with doors of 1 m at these heights.
pub(crate) fn wall_with_doors(doors_m: &'static [f64]) -> impl Fn(Point) -> bool {
    move |place| {
        let is_door = doors_m.iter().any(|door| (place.y - door).abs() < 0.5);
        (5.9..6.1).contains(&place.x) && !is_door
    }
}

/// Mount of a camera: at the robot's front, pointing ahead.
pub(crate) const CAMERA: Pose = Pose { x: 0.15, y: 0.0, theta: 0.0 };

pub(crate) struct RobotInAWorld {
    pub(crate) robot: Robot,
    pub(crate) navigator: Navigator,
    pub(crate) pose: Pose,
    pub(crate) velocity: Velocity,
    pub(crate) stamp_s: f64,
    /// The true map.
    pub(crate) truth: OccupancyGrid,
    pub(crate) posts: Vec<Disc>,
    /// Posts that only the camera detects, if there is one.
    pub(crate) low_posts: Vec<Disc>,
    pub(crate) camera: Option<FieldOfView>,
    /// The reported pose as a function of the true one.
    pub(crate) told: fn(Pose) -> Pose,
}

impl RobotInAWorld {
    /// The small robot with the default stack, at rest.
    pub(crate) fn new(map: &OccupancyGrid, pose: Pose) -> Self {
        Self::of(Robot::small(), map, pose)
    }

    /// Another robot with the default stack, at rest.
    pub(crate) fn of(robot: Robot, map: &OccupancyGrid, pose: Pose) -> Self {
        let stack = Stack::keyway(&robot).fit(&robot).unwrap();
        let mut navigator = Navigator::new(map, &stack).unwrap();
        navigator.relocate(pose);
        let (truth, velocity) = (map.clone(), Velocity::ZERO);
        let told = |pose| pose;
        let (posts, low_posts, camera, stamp_s) = (Vec::new(), Vec::new(), None, 0.0);
        Self { robot, navigator, pose, velocity, stamp_s, truth, posts, low_posts, camera, told }
    }

    /// Measures, and passes the observation to the navigator.
    pub(crate) fn observe(&mut self) {
        let world = World::from_known(&self.truth, self.posts.clone()).unwrap();
        let scan = world.at(0.0).cast(self.pose, &self.robot.sensors[0]);
        let (stamp_s, velocity) = (self.stamp_s, self.velocity);
        let scans = [SensorScan::of(&self.robot, 0, stamp_s, &scan)];
        let pose = (self.told)(self.pose);
        let (seen, mount) = (self.seen_by_camera(), CAMERA);
        let points = self.camera.map(|view| SensorPoints {
            stamp_s,
            sensor: 0,
            mount,
            points: &seen,
            clears: Some(view),
        });
        let observation = Observation::new(stamp_s, pose, velocity, &scans);
        self.navigator.observe(&observation.with_points(points.as_slice()));
    }

    /// Points of the low posts that the camera detects, in its frame.
    pub(crate) fn seen_by_camera(&self) -> Vec<Point> {
        let camera = self.pose.compose(CAMERA);
        let Some(view) = self.camera else { return Vec::new() };
        let around = |post: &Disc| {
            let &Disc { centre, radius_m } = post;
            (0..60).map(move |i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 60.0).sin_cos();
                centre + Point::new(cos, sin) * radius_m
            })
        };
        // The near side of each.
        let is_near = |post: &Disc, place: &Point| {
            (*place - post.centre).dot(camera.point() - post.centre) > 0.0
        };
        let near = self
            .low_posts
            .iter()
            .flat_map(|post| around(post).filter(move |place| is_near(post, place)));
        let in_view = |point: &Point| {
            (view.from_rad..=view.to_rad).contains(&point.heading())
                && (view.range_min_m..=view.range_max_m).contains(&point.norm())
        };
        near.map(|place| camera.body_from_world(place)).filter(in_view).collect()
    }

    /// Drives for a cycle, and checks that there is no contact.
    pub(crate) fn obey(&mut self, command: Velocity) {
        let Robot { limits, cycle_s, footprint, .. } = &self.robot;
        let reached = limits.reached(self.velocity, command, *cycle_s);
        self.pose = self.pose.after_ramp(self.velocity, reached, *cycle_s);
        (self.velocity, self.stamp_s) = (reached, self.stamp_s + cycle_s);
        let walls = Clearance::new(self.truth.frame(), self.truth.occupied());
        assert!(!touches(footprint, self.pose, &walls), "{:?}", self.pose);
        let radius_m = footprint.inscribed_radius_m();
        let is_clear =
            |post: &Disc| post.centre.distance(self.pose.point()) > post.radius_m + radius_m;
        assert!(self.posts.iter().chain(&self.low_posts).all(is_clear), "{:?}", self.pose);
    }

    /// One cycle.
    pub(crate) fn cycle(&mut self) -> Step {
        self.observe();
        let step = self.navigator.step();
        self.obey(step.command());
        step
    }

    /// Drives for a time.
    pub(crate) fn drive_for(&mut self, duration_s: f64) {
        (0..(duration_s / self.robot.cycle_s).round() as u32).for_each(|_| drop(self.cycle()));
    }

    /// Drives until arrival; returns the time \[s\].
    pub(crate) fn arrive(&mut self) -> f64 {
        let begin_s = self.stamp_s;
        while self.cycle() != Step::Arrived {
            assert!(self.stamp_s - begin_s < 120.0, "{:?}", self.pose);
        }
        self.stamp_s - begin_s
    }
}
