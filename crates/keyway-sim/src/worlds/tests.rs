use super::*;
use keyway::map::Cell;

const ENDS: [Point; 2] = [Point::new(1.0, 1.0), Point::new(11.0, 9.0)];

fn all() -> Vec<GeneratedMap> {
    let map = GeneratedMap::empty(12.0, 10.0, 0.05);
    let patterns = [
        Pattern::None,
        Pattern::Discs(Discs(vec![[3.0, 4.0, 0.5], [1.0, 1.0, 0.3]])),
        Pattern::Boxes(Boxes { boxes: vec![[3.0, 4.0, 3.5, 9.0]], turned_deg: 20.0 }),
        Pattern::Clutter(Clutter { share: 0.15, radius_m: [0.1, 0.4] }),
        Pattern::Blocks(Blocks { share: 0.15, side_m: [0.1, 0.4] }),
        Pattern::Rooms(Rooms { room_m: 3.1, door_m: 0.9, wall_m: 0.15, more_doors: 0.2 }),
        Pattern::Maze(Maze { corridor_m: 0.9, wall_m: 0.1 }),
        Pattern::Corridors(Corridors {
            corridor_m: 1.4,
            room_m: [2.5, 1.8],
            door_m: 0.8,
            wall_m: 0.1,
        }),
        Pattern::UTraps(UTraps { count: 9, size_m: [0.8, 2.0], wall_m: 0.1 }),
        Pattern::Mine(Mine { roadway_m: 1.5, pillar_m: 2.0, roughness_m: 0.3, fallen_in: 0.3 }),
    ];
    patterns.into_iter().map(|obstacles| GeneratedMap { obstacles, ..map.clone() }).collect()
}

fn share(map: &OccupancyGrid) -> f64 {
    map.occupied().count_ones() as f64 / map.frame().cell_count() as f64
}

/// Number of free cells that are reachable from the first one, and of all free cells.
fn flooded(map: &OccupancyGrid) -> (usize, usize) {
    let is_free = |cell: Cell| map.frame().contains(cell) && !map.occupied().get(cell);
    let free: Vec<Cell> = map.frame().cells().filter(|&cell| is_free(cell)).collect();
    let mut seen = std::collections::BTreeSet::from([(free[0].x, free[0].y)]);
    let mut open = vec![free[0]];
    while let Some(Cell { x, y }) = open.pop() {
        for (x, y) in [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)] {
            if is_free(Cell::new(x, y)) && seen.insert((x, y)) {
                open.push(Cell::new(x, y));
            }
        }
    }
    (seen.len(), free.len())
}

#[test]
fn a_seed_gives_one_map_and_another_seed_another_one() {
    for map in all() {
        let made = |seed| map.generate(seed, &ENDS).unwrap();
        assert_eq!(made(3).occupied(), made(3).occupied());
        let is_the_same = made(3).occupied() == made(4).occupied();
        assert_eq!(is_the_same, !map.obstacles.is_random(), "{:?}", map.obstacles);
        assert_eq!(share(&made(3)) == 0.0, map.obstacles == Pattern::None);
        assert_eq!((made(3).frame().width(), made(3).frame().height()), (240, 200));
    }
}

#[test]
fn nothing_stands_around_the_ends() {
    for map in all() {
        let grid = map.generate(11, &ENDS).unwrap();
        for (cell, end) in grid.frame().cells().flat_map(|cell| ENDS.map(|end| (cell, end))) {
            let is_far = grid.frame().world_from_cell(cell).distance(end) > map.free_ends_m;
            assert!(is_far || !grid.occupied().get(cell), "{:?} {cell:?}", map.obstacles);
        }
    }
}

#[test]
fn where_there_are_ways_they_lead_everywhere() {
    for seed in 0..20 {
        for map in all() {
            let grid = map.generate(seed, &[]).unwrap();
            let (reached, free) = flooded(&grid);
            match map.obstacles {
                Pattern::None | Pattern::Rooms(_) | Pattern::Maze(_) | Pattern::Corridors(_) => {
                    assert_eq!(reached, free, "{:?} {seed}", map.obstacles);
                }
                // At most the pockets of a rough side are unreachable.
                Pattern::Mine(_) => assert!(reached * 100 >= free * 99, "{reached} of {free}"),
                Pattern::Discs(_)
                | Pattern::Boxes(_)
                | Pattern::Clutter(_)
                | Pattern::Blocks(_)
                | Pattern::UTraps(_) => {}
            }
        }
    }
}

#[test]
fn sizes_are_those_that_were_asked_for() {
    let of = |obstacles: &Pattern| {
        let map = GeneratedMap { obstacles: obstacles.clone(), ..all()[0].clone() };
        map.generate(5, &[]).unwrap()
    };
    // Discs at random positions with a total area of S cover 1 - exp(-S), minus the part outside
    // the map.
    let clutter = |share_m| of(&Pattern::Clutter(Clutter { share: share_m, radius_m: [0.1, 0.2] }));
    assert!((share(&clutter(0.3)) - (1.0 - (-0.3_f64).exp())).abs() < 0.02);
    assert_eq!(share(&clutter(0.0)), 0.0);
    // Blocks are added until at least the requested share is covered; the last block has at most
    // 16 of the 48,000 cells.
    let blocks = share(&of(&Pattern::Blocks(Blocks { share: 0.3, side_m: [0.1, 0.2] })));
    assert!((0.3..0.3 + 16.0 / 48_000.0).contains(&blocks), "{blocks}");
    let full = Blocks { share: 1.0, side_m: [9.0, 90.0] };
    assert_eq!(share(&of(&Pattern::Blocks(full))), 1.0);
    // A square of 2 m: three sides of 0.1 m, which share two corners, and one that is open.
    let trap = of(&Pattern::UTraps(UTraps { count: 1, size_m: [2.0, 2.0], wall_m: 0.1 }));
    let expected_m2 = 2.0 * 0.1 * 3.0 - 2.0 * 0.1 * 0.1;
    assert!((share(&trap) * 120.0 - expected_m2).abs() < 0.15, "{}", share(&trap) * 120.0);
    let (reached, free) = flooded(&trap);
    assert_eq!(reached, free);
    // Pillars of 2 m, smooth, on a pitch of 3.5 m: four across, three up, the last ones cut off at
    // 12 and 10 m.
    let mine = Mine { roadway_m: 1.5, pillar_m: 2.0, roughness_m: 0.0, fallen_in: 0.0 };
    let mine = of(&Pattern::Mine(mine));
    assert!((share(&mine) * 120.0 - 6.0 * 5.5).abs() < 1.0, "{}", share(&mine) * 120.0);
}

#[test]
fn discs_are_the_cells_whose_centres_they_hold() {
    let discs = [[-1.0, 4.2, 0.5], [3.0, 7.9, 0.3], [-3.9, 3.0, 0.4]];
    let map = GeneratedMap {
        origin: Point::new(-4.0, 3.0),
        obstacles: Pattern::Discs(Discs(discs.to_vec())),
        ..GeneratedMap::empty(8.0, 5.0, 0.1)
    };
    let grid = map.generate(0, &[]).unwrap();
    let is_held =
        |at: Point| discs.iter().any(|&[x, y, radius_m]| (at.x - x).hypot(at.y - y) <= radius_m);
    for cell in grid.frame().cells() {
        let centre = grid.frame().world_from_cell(cell);
        assert_eq!(grid.occupied().get(cell), is_held(centre), "{centre:?}");
    }
}

/// A box rotated by 90 degrees about the middle of the map, which is at (0, 5.5): x becomes
/// -(y - 5.5), and y - 5.5 becomes x.
#[test]
fn boxes_are_turned_together() {
    let boxes = vec![[1.0, 4.0, 9.0, 5.0], [-2.0, 5.0, -1.0, 7.0]];
    let map = |turned_deg| GeneratedMap {
        origin: Point::new(-4.0, 3.0),
        obstacles: Pattern::Boxes(Boxes { boxes: boxes.clone(), turned_deg }),
        ..GeneratedMap::empty(8.0, 5.0, 0.1)
    };
    let [straight, turned] = [0.0, 90.0].map(|deg| map(deg).generate(0, &[]).unwrap());
    assert_eq!(straight.occupied().count_ones(), 30 * 10 + 10 * 20);
    for cell in turned.frame().cells() {
        let Point { x, y } = turned.frame().world_from_cell(cell);
        let at = straight.frame().cell_near(Point::new(y - 5.5, 5.5 - x));
        if straight.frame().contains(at) {
            assert_eq!(turned.occupied().get(cell), straight.occupied().get(at), "{cell:?}");
        }
    }
}

#[test]
fn bad_values_are_named() {
    let field = |map: GeneratedMap| map.validate().unwrap_err().path;
    let base = all()[0].clone();
    assert_eq!(field(GeneratedMap { width_m: 0.0, ..base.clone() }), "width_m");
    assert_eq!(field(GeneratedMap { resolution_m: 1e-9, ..base.clone() }), "resolution_m");
    let nowhere = Point::new(0.0, f64::NAN);
    assert_eq!(field(GeneratedMap { origin: nowhere, ..base.clone() }), "origin[1]");
    let of = |obstacles| field(GeneratedMap { obstacles, ..base.clone() });
    let clutter = Clutter { share: 1.5, radius_m: [0.1, 0.2] };
    assert_eq!(of(Pattern::Clutter(clutter)), "obstacles.clutter.share");
    let clutter = Clutter { share: 0.5, radius_m: [0.3, 0.2] };
    assert_eq!(of(Pattern::Clutter(clutter)), "obstacles.clutter.radius_m[1]");
    let blocks = Blocks { share: 0.5, side_m: [3.0, 2.0] };
    assert_eq!(of(Pattern::Blocks(blocks)), "obstacles.blocks.side_m[1]");
    let discs = Discs(vec![[1.0, 1.0, 0.1], [1.0, 1.0, -0.1]]);
    assert_eq!(of(Pattern::Discs(discs)), "obstacles.discs[1][2]");
    let discs = Discs(vec![[1.0, f64::NAN, 0.1]]);
    assert_eq!(of(Pattern::Discs(discs)), "obstacles.discs[0][1]");
    let boxes = |of, turned_deg| Pattern::Boxes(Boxes { boxes: vec![of], turned_deg });
    assert_eq!(of(boxes([0.0, 0.0, 1.0, -1.0], 0.0)), "obstacles.boxes.boxes[0][3]");
    assert_eq!(of(boxes([0.0, f64::NAN, 1.0, 1.0], 0.0)), "obstacles.boxes.boxes[0][1]");
    assert_eq!(of(boxes([0.0; 4], f64::INFINITY)), "obstacles.boxes.turned_deg");
    let rooms = Rooms { room_m: 1.0, door_m: 0.95, wall_m: 0.1, more_doors: 0.0 };
    assert_eq!(of(Pattern::Rooms(rooms)), "obstacles.rooms.door_m");
    let traps = UTraps { count: 1, size_m: [1.0, 1.0], wall_m: 0.3 };
    assert_eq!(of(Pattern::UTraps(traps)), "obstacles.u-traps.wall_m");
    let mine = Mine { roadway_m: 1.0, pillar_m: 1.0, roughness_m: 0.5, fallen_in: 0.0 };
    assert_eq!(of(Pattern::Mine(mine)), "obstacles.mine.roughness_m");
}

/// A single block of one to three cells of 1 m has sides of these lengths.
#[test]
fn blocks_have_the_sides_that_were_asked_for() {
    let blocks = Blocks { share: 1e-9, side_m: [1.0, 3.0] };
    let map =
        GeneratedMap { obstacles: Pattern::Blocks(blocks), ..GeneratedMap::empty(20.0, 20.0, 1.0) };
    let mut seen = std::collections::BTreeSet::new();
    for seed in 0..200 {
        let grid = map.generate(seed, &[]).unwrap();
        let cells: Vec<Cell> =
            grid.frame().cells().filter(|&cell| grid.occupied().get(cell)).collect();
        let side = |of: fn(&Cell) -> i32| {
            1 + cells.iter().map(of).max().unwrap() - cells.iter().map(of).min().unwrap()
        };
        let (width, height) = (side(|cell| cell.x), side(|cell| cell.y));
        assert_eq!((width * height) as usize, cells.len(), "{cells:?}");
        seen.insert((width, height));
    }
    let all = (1..=3).flat_map(|width| (1..=3).map(move |height| (width, height))).collect();
    assert_eq!(seen, all);
}
