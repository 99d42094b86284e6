//! Times of places and headings, compared with the relaxation of all motions until nothing changes.

use super::*;
use crate::geometry::Pose as WorldPose;
use crate::local::space_time::lattice::Lattice;
use crate::map::GridFrame;
use crate::random::Random;
use crate::robot::Robot;

const SIDE: usize = 13;

/// All points of a small lattice, a path through its middle, and its middle.
fn everywhere() -> (Near, Point) {
    let frame = GridFrame::new(20, 20, 1.0, WorldPose::default()).unwrap();
    let middle = Point::new(10.5, 10.5);
    let lattice = Lattice::around(&frame, middle, 5.0, 1.0);
    assert_eq!(lattice.side, SIDE);
    let mut near = Near::default();
    near.collect(lattice, &[middle], 99.0, 12);
    assert_eq!(near.count(), SIDE * SIDE);
    (near, middle)
}

/// By definition: the poses that lead to a pose, with their ticks.
fn relaxed(
    near: &Near,
    fitting: &Fitting,
    motions: &MotionTicks,
    end: &WayEnd,
) -> Vec<[u16; HEADINGS]> {
    let is_free = |number: usize, heading: usize| fitting.free(number) >> heading & 1 == 1;
    let mut times = vec![[NEVER; HEADINGS]; near.count()];
    for number in near.around(end.at) {
        for heading in (0..HEADINGS).filter(|&heading| is_free(number, heading)) {
            times[number][heading] = motions.at_end(heading, end.facing).unwrap_or(NEVER);
        }
    }
    loop {
        let before = times.clone();
        for (number, own) in before.iter().enumerate() {
            for (heading, &time) in own.iter().enumerate().filter(|(_, time)| **time != NEVER) {
                let mut lower = |to: usize, heading: usize, ticks: u16| {
                    if is_free(to, heading) {
                        times[to][heading] = times[to][heading].min(time + ticks);
                    }
                };
                let (left, right) = ((heading + 1) % HEADINGS, (heading + HEADINGS - 1) % HEADINGS);
                for (side, from) in [(left, heading), (right, right)] {
                    if motions.turns_in_place && fitting.turning(number) >> from & 1 == 1 {
                        lower(number, side, motions.turn);
                    }
                }
                let mut directions = vec![heading / 2, heading.div_ceil(2) % 16];
                directions.dedup();
                for direction in directions {
                    let (dx, dy) = STEPS[direction];
                    let ahead = AHEAD[kind(direction)];
                    let back = motions.back[kind(direction)];
                    for (step, ticks) in [((-dx, -dy), ahead), ((dx, dy), back)] {
                        if step == (dx, dy) && !motions.can_reverse {
                            continue;
                        }
                        let place = near.places()[number] as usize;
                        let (x, y) = step;
                        let steps = motions.arc_steps[kind(direction)];
                        let far = (i32::from(steps) * x, i32::from(steps) * y);
                        let arc_ticks = (steps * ticks).max(motions.turn).min(511);
                        let [straight, turned] = if motions.turns_in_place {
                            [(step, ticks), (step, ticks.max(motions.turn))]
                        } else {
                            [(step, ticks), (far, arc_ticks)]
                        };
                        for ((step, ticks), headings) in
                            [(straight, vec![heading]), (turned, vec![left, right])]
                        {
                            let from = near.number(place.wrapping_add_signed(near.step(step)));
                            let Some(from) = from else { continue };
                            for heading in headings {
                                lower(from, heading, ticks);
                            }
                        }
                    }
                }
            }
        }
        if times == before {
            return times;
        }
    }
}

#[test]
fn times_are_those_of_the_relaxation_of_all_motions() {
    let (near, middle) = everywhere();
    let mut random = Random::new(46);
    // The same memory for all: nothing of the previous one may be left.
    let mut times = PoseTimes::default();
    for round in 0..40 {
        let mut bits = |share: f64| {
            (0..HEADINGS)
                .fold(0, |bits, heading| bits | Sectors::from(random.unit() < share) << heading)
        };
        let share = [0.2, 0.5, 0.8, 1.0][round % 4];
        let free: Vec<Sectors> = (0..near.count()).map(|_| bits(share)).collect();
        let turning: Vec<Sectors> = (0..near.count()).map(|_| bits(share)).collect();
        let fitting = Fitting::of(free, turning);
        let mut limits = Robot::jackal().limits;
        limits.v_min_mps = [0.0, -0.1, -0.5, -2.0][round / 4 % 4];
        limits.omega_max_radps = [0.05, 0.4, 1.5, 6.0][round / 2 % 4];
        limits.min_turning_radius_m = [0.0, 0.0, 1.0, 4.0, 40.0][round % 5];
        let motions =
            MotionTicks::new(&limits, limits.v_min_mps < 0.0, (0.1 / limits.v_max_mps, 0.4));
        let facing = match round % 3 {
            0 => Facing::Any,
            1 => Facing::At(1.0),
            _ => Facing::On(-2.0),
        };
        let end = WayEnd { at: middle, facing };
        times.look_behind(&near, None);
        times.grow_poses(&near, &fitting, &motions, &end);
        let expected = relaxed(&near, &fitting, &motions, &end);
        assert!(expected.as_flattened().iter().any(|&ticks| ticks != NEVER), "round {round}");
        assert_eq!(times.by_pose, expected, "round {round}");
    }
}
