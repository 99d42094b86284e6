use super::*;
use keyway::geometry::Disc;
use keyway::map::{GridFrame, OccupancyGrid};
use keyway::robot::Robot;

/// A hall of 12 m x 6 m in cells of 0.1 m, with walls around it, and optionally a wall across
/// with a door from y = 2 m to 3.2 m.
fn hall(with_door: bool) -> OccupancyGrid {
    let frame = GridFrame::new(120, 60, 0.1, keyway::geometry::Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |Cell { x, y }| {
        let is_border = x == 0 || y == 0 || x == 119 || y == 59;
        let is_wall = with_door && (60..62).contains(&x) && !(20..32).contains(&y);
        if is_border || is_wall { CellState::Occupied } else { CellState::Free }
    })
}

fn episode(with_door: bool, robot: Robot) -> Episode {
    let (start, goal) = (Point::new(1.05, 2.55), Point::new(11.05, 2.55));
    Episode::new(hall(with_door), robot, start, goal)
}

fn config(unknown: u32, moving: u32) -> RandomObstacles {
    RandomObstacles {
        unknown: Some(RandomUnknown { count: unknown, radius_m: [0.1, 0.4] }),
        moving: Some(RandomMoving {
            count: moving,
            radius_m: [0.2, 0.3],
            speed_mps: [0.3, 1.0],
            gives_way: false,
        }),
        near_way_m: 0.4,
        free_ends_m: 0.6,
    }
}

fn drawn(config: &RandomObstacles, with_door: bool, robot: Robot, seed: u64) -> Episode {
    let mut episode = episode(with_door, robot);
    config.put_into(&mut episode, seed).unwrap();
    episode
}

fn squares(map: &OccupancyGrid) -> Vec<Cell> {
    map.frame().cells().filter(|&cell| map.occupied().get(cell)).collect()
}

/// Distance from a position to the nearest of several squares, checked one by one \[m\].
fn to_squares_m(squares: &[Cell], at: Point) -> f64 {
    let gap =
        |at: f64, low: i32| (f64::from(low) * 0.1 - at).max(at - f64::from(low + 1) * 0.1).max(0.0);
    let apart_m = |cell: &Cell| gap(at.x, cell.x).hypot(gap(at.y, cell.y));
    squares.iter().map(apart_m).fold(f64::INFINITY, f64::min)
}

/// True if start and goal are connected by cells whose centres keep these distances from squares
/// and discs.
fn has_way(episode: &Episode, radius_m: f64, beside_discs_m: f64) -> bool {
    let (frame, squares) = (episode.known.frame(), squares(&episode.known));
    let is_free = |cell: Cell| {
        let at = frame.world_from_cell(cell);
        let is_beside =
            |disc: &Disc| disc.centre.distance(at) >= disc.radius_m + beside_discs_m - 1e-9;
        frame.contains(cell)
            && episode.obstacles.iter().all(is_beside)
            && to_squares_m(&squares, at) >= radius_m - 1e-9
    };
    let [from, to] = [episode.robots[0].start.position, episode.robots[0].goal.position]
        .map(|end| frame.cell_from_world(end).unwrap());
    let (mut seen, mut open) = (std::collections::BTreeSet::from([from]), vec![from]);
    while let Some(Cell { x, y }) = open.pop() {
        for next in [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)].map(|(x, y)| Cell::new(x, y)) {
            if !seen.contains(&next) && is_free(next) {
                seen.insert(next);
                open.push(next);
            }
        }
    }
    seen.contains(&to)
}

#[test]
fn a_seed_gives_one_world_and_another_seed_another_one() {
    let of = |config: &RandomObstacles, seed| drawn(config, true, Robot::small(), seed);
    let all = config(4, 2);
    assert_eq!(of(&all, 7), of(&all, 7));
    assert_ne!(of(&all, 7).obstacles, of(&all, 8).obstacles);
    assert_ne!(of(&all, 7).movers, of(&all, 8).movers);
    // The static discs do not depend on the number of moving ones, nor the first discs on the
    // number of later ones.
    assert_eq!(of(&all, 7).obstacles, of(&config(4, 0), 7).obstacles);
    assert_eq!(of(&all, 7).obstacles[..3], of(&config(3, 2), 7).obstacles);
    let placed = of(&all, 7).random.unwrap();
    assert_eq!((placed.unknown_asked, placed.moving_asked), (4, 2));
    assert_eq!(placed.left_out(), 0, "{placed:?}");
}

#[test]
fn what_stands_is_near_the_way_off_the_ends_and_leaves_a_way() {
    // Without the wall, the shortest path is straight.
    for (seed, robot) in (0..12).zip([Robot::small(), Robot::jackal()].into_iter().cycle()) {
        let inscribed_m = robot.footprint.inscribed_radius_m();
        let circumscribed_m = robot.footprint.circumscribed_radius_m();
        for with_door in [false, true] {
            let episode = drawn(&config(6, 0), with_door, robot.clone(), seed);
            assert_eq!(episode.random.unwrap().unknown_placed as usize, episode.obstacles.len());
            for &Disc { centre, radius_m } in &episode.obstacles {
                assert!((0.1..=0.4).contains(&radius_m));
                assert!(with_door || (centre.y - 2.55).abs() <= 0.4, "{centre:?}");
                for end in [episode.robots[0].start.position, episode.robots[0].goal.position] {
                    let gap_m = end.distance(centre) - radius_m - circumscribed_m;
                    assert!(gap_m >= 0.6, "{gap_m}");
                }
            }
            let beside_m = inscribed_m + RandomObstacles::MARGIN_M;
            assert!(has_way(&episode, inscribed_m, beside_m), "{seed} {with_door}");
        }
    }
}

#[test]
fn beside_a_disc_there_is_room_to_spare() {
    // In the door, 0.5 m are free beside a disc. The robot is 0.36 m wide and fits through a row
    // of cells, but not with a margin.
    let narrow = RandomObstacles {
        unknown: Some(RandomUnknown { count: 1, radius_m: [0.14, 0.14] }),
        moving: None,
        near_way_m: 0.005,
        free_ends_m: 0.0,
    };
    let mut count = 0;
    for seed in 0..30 {
        let mut episode = episode(true, Robot::small());
        episode.robots[0].start.position = Point::new(4.55, 2.55);
        episode.robots[0].goal.position = Point::new(7.65, 2.55);
        narrow.put_into(&mut episode, seed).unwrap();
        count += episode.obstacles.len();
        assert!(
            has_way(&episode, 0.18, 0.18 + RandomObstacles::MARGIN_M),
            "{:?}",
            episode.obstacles
        );
        assert!(episode.obstacles.iter().all(|disc| (disc.centre.x - 6.1).abs() > 0.1));
    }
    assert!(count > 0);
}

#[test]
fn what_moves_crosses_the_way_and_touches_nothing() {
    for seed in 0..6 {
        let episode = drawn(&config(3, 3), false, Robot::small(), seed);
        assert_eq!(episode.random.unwrap().left_out(), 0);
        let squares = squares(&episode.known);
        for mover in &episode.movers {
            let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
            for step in 0..600 {
                let Disc { centre, radius_m } = mover.at(f64::from(step) * 0.1);
                (low_m, high_m) = (low_m.min(centre.y), high_m.max(centre.y));
                assert!(to_squares_m(&squares, centre) >= radius_m - 1e-9, "{centre:?}");
                let is_beside = |disc: &Disc| disc.distance(centre) >= radius_m - 1e-9;
                assert!(episode.obstacles.iter().all(is_beside), "{centre:?}");
                for end in [episode.robots[0].start.position, episode.robots[0].goal.position] {
                    assert!(end.distance(centre) - radius_m - 0.18 >= 0.6 - 1e-9, "{centre:?}");
                }
            }
            assert!(low_m < 2.55 && high_m > 2.55, "{low_m} {high_m}");
            // The robot fits behind it.
            assert!(
                high_m - low_m >= 2.0 * (0.18 + RandomObstacles::MARGIN_M) - 0.2,
                "{low_m} {high_m}"
            );
            assert!((0.3..=1.0).contains(&mover.speed_mps(1.0)));
        }
    }
}

#[test]
fn obstacles_that_give_way_are_the_same_ones() {
    let drawn = |gives_way| {
        let moving = config(0, 2).moving.map(|moving| RandomMoving { gives_way, ..moving });
        drawn(&RandomObstacles { moving, ..config(1, 0) }, false, Robot::small(), 5)
    };
    let (stubborn, polite) = (drawn(false), drawn(true));
    assert_eq!(stubborn.obstacles, polite.obstacles);
    assert_eq!(polite.movers.len(), 2);
    for (one, other) in stubborn.movers.iter().zip(&polite.movers) {
        assert_eq!(one.at(0.0), other.at(0.0));
        let (ObstacleMotion::WayPoints(one), ObstacleMotion::GivesWay(other)) =
            (one.motion(), other.motion())
        else {
            panic!("{one:?} {other:?}")
        };
        assert_eq!(one, other);
    }
}

#[test]
fn without_a_number_nothing_is_random() {
    assert!(config(1, 0).is_random() && config(0, 1).is_random());
    assert!(!config(0, 0).is_random());
    assert!(!RandomObstacles { unknown: None, moving: None, ..config(0, 0) }.is_random());
}

#[test]
fn what_finds_no_place_is_counted() {
    // The door is 1.2 m wide, too narrow for a disc of 0.6 m and the robot, and the whole path is
    // within the door.
    let mut episode = episode(true, Robot::small());
    episode.robots[0].start.position = Point::new(5.05, 2.55);
    episode.robots[0].goal.position = Point::new(7.05, 2.55);
    let wide = RandomObstacles {
        unknown: Some(RandomUnknown { count: 2, radius_m: [0.4, 0.4] }),
        moving: Some(RandomMoving {
            count: 3,
            radius_m: [0.5, 0.5],
            speed_mps: [1.0, 1.0],
            gives_way: false,
        }),
        near_way_m: 0.1,
        free_ends_m: 0.1,
    };
    wide.put_into(&mut episode, 1).unwrap();
    let placed = episode.random.unwrap();
    assert_eq!((placed.unknown_placed, placed.moving_placed, placed.left_out()), (0, 0, 5));
    assert!(episode.obstacles.is_empty() && episode.movers.is_empty());
    // Without a path, no obstacle can be placed near it.
    let mut closed = self::episode(true, Robot::small());
    closed.robots[0].goal.position = Point::new(0.05, 0.05);
    config(2, 1).put_into(&mut closed, 1).unwrap();
    assert_eq!(closed.random.unwrap().left_out(), 3);
}

#[test]
fn way_points_are_on_the_way_and_kept_free() {
    let mut episode = episode(false, Robot::small());
    episode.robots[0].via = vec![Point::new(6.05, 4.95)];
    let config = RandomObstacles { near_way_m: 0.2, ..config(12, 0) };
    config.put_into(&mut episode, 3).unwrap();
    let via = episode.robots[0].via[0];
    assert!(episode.obstacles.iter().all(|disc| disc.distance(via) >= 0.6 + 0.18));
    assert!(episode.obstacles.iter().any(|disc| disc.centre.y > 3.0), "{:?}", episode.obstacles);
}

#[test]
fn bad_values_are_named() {
    let field = |change: &dyn Fn(&mut RandomObstacles)| {
        let mut config = config(1, 1);
        change(&mut config);
        config.validate().unwrap_err().path
    };
    assert_eq!(field(&|it| it.near_way_m = -1.0), "near_way_m");
    assert_eq!(field(&|it| it.free_ends_m = f64::NAN), "free_ends_m");
    let unknown = |count, radius_m| Some(RandomUnknown { count, radius_m });
    assert_eq!(field(&|it| it.unknown = unknown(1001, [0.1, 0.2])), "unknown.count");
    assert_eq!(field(&|it| it.unknown = unknown(1, [0.3, 0.2])), "unknown.radius_m[1]");
    let moving = |speed_mps| {
        Some(RandomMoving { count: 1, radius_m: [0.1, 0.2], speed_mps, gives_way: false })
    };
    assert_eq!(field(&|it| it.moving = moving([0.0, 1.0])), "moving.speed_mps[0]");
    assert_eq!(field(&|it| it.moving = moving([1.0, 200.0])), "moving.speed_mps[1]");
}

/// A wide robot that drives on the left, and two robots that pass through the door from opposite
/// sides.
fn team(with_door: bool) -> Episode {
    let robot = |robot: Robot, from: [f64; 2], to: [f64; 2]| {
        EpisodeRobot::new(robot, Point::from(from), Point::from(to))
    };
    let robots = vec![
        robot(Robot::jackal(), [3.05, 1.05], [3.05, 5.05]),
        robot(Robot::small(), [1.05, 2.55], [11.05, 2.55]),
        robot(Robot::small(), [11.05, 4.55], [1.05, 4.55]),
    ];
    Episode::of_robots(hall(with_door), robots)
}

#[test]
fn one_robot_or_a_team_of_one_has_the_same_obstacles() {
    for seed in 0..4 {
        let config = config(4, 2);
        let alone = drawn(&config, true, Robot::small(), seed);
        let mut team = team(true);
        team.robots = vec![team.robots.swap_remove(1)];
        config.put_into(&mut team, seed).unwrap();
        assert_eq!(team.obstacles, alone.obstacles);
        assert_eq!((team.movers, team.random), (alone.movers, alone.random));
    }
}

#[test]
fn of_several_robots_each_has_its_way_and_its_ends_free() {
    let (mut near, mut crossing) = ([0; 3], 0);
    for seed in 0..6 {
        let mut team = team(true);
        config(8, 3).put_into(&mut team, seed).unwrap();
        let placed = team.random.unwrap();
        assert_eq!(
            (placed.unknown_placed as usize, placed.moving_placed as usize),
            (team.obstacles.len(), team.movers.len())
        );
        crossing += team.movers.len();
        for (i, EpisodeRobot { robot, start, goal, .. }) in team.robots.iter().enumerate() {
            let mut alone = episode(true, robot.clone());
            (alone.robots[0].start, alone.robots[0].goal) = (*start, *goal);
            alone.obstacles.clone_from(&team.obstacles);
            let radius_m = robot.footprint.inscribed_radius_m();
            assert!(has_way(&alone, radius_m, radius_m + RandomObstacles::MARGIN_M), "{seed}: {i}");
            let reach_m = robot.footprint.circumscribed_radius_m() + 0.6 - 1e-9;
            for end in [start.position, goal.position] {
                let is_off = |disc: &Disc| disc.centre.distance(end) >= reach_m + disc.radius_m;
                assert!(team.obstacles.iter().all(is_off), "{seed}: {i}");
                let times = (0..600).map(|i| f64::from(i) * 0.1);
                for mover in &team.movers {
                    assert!(times.clone().all(|t_s| is_off(&mover.at(t_s))), "{seed}: {i}");
                }
            }
            // Only the wider robot's path is so far to the left and so far up.
            let is_near = |disc: &&Disc| {
                let Point { x, y } = disc.centre;
                match i {
                    0 => x < 4.0 && y > 3.8,
                    1 => x > 7.0 && y < 3.0,
                    _ => x > 7.0 && y > 3.0,
                }
            };
            near[i] += team.obstacles.iter().filter(is_near).count();
        }
    }
    assert!(near.iter().all(|&count| count > 0) && crossing > 6, "{near:?}, {crossing}");
}

/// The walled-in robot stays at its start; the others still drive.
#[test]
fn a_robot_without_a_way_keeps_its_ends_free() {
    let mut team = team(false);
    let goal = Point::new(11.05, 2.55);
    let is_cell = |cell: Cell| (105..117).contains(&cell.x) && (20..32).contains(&cell.y);
    let inner = |cell: Cell| (106..116).contains(&cell.x) && (21..31).contains(&cell.y);
    let open = hall(false);
    team.known = OccupancyGrid::from_fn(*open.frame(), |cell| {
        let is_wall = is_cell(cell) && !inner(cell);
        if is_wall { CellState::Occupied } else { open.state(cell).unwrap() }
    });
    let config = RandomObstacles { near_way_m: 3.0, ..config(20, 0) };
    config.put_into(&mut team, 1).unwrap();
    assert!(team.obstacles.len() > 10);
    let reach_m = Robot::small().footprint.circumscribed_radius_m() + 0.6 - 1e-9;
    let apart_m = |disc: &Disc| disc.centre.distance(goal) - disc.radius_m;
    assert!(team.obstacles.iter().all(|disc| apart_m(disc) >= reach_m));
}
