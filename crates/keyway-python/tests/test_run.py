"""Navigators, scenes, runs, and a simulation that Python drives."""

import array
import json
import math
import pathlib
import subprocess
import sys
import types
from typing import Any

import numpy as np
import pytest
from conftest import SCENES

import keyway

KEYWAY = [sys.executable, "-m", "keyway"]


def bound_for(grid: keyway.Map, start: Any, goal: Any, via: Any = (), **options: Any) -> keyway.Navigator:
    """A navigator on its way from a start to a goal."""
    navigator = keyway.Navigator(grid, **options)
    navigator.relocate((*start, 0.0))
    navigator.set_goals(list(via), goal)
    return navigator


def next_step(navigator: keyway.Navigator, pose: Any, velocity: Any, scan: Any, cycle: int) -> keyway.Step:
    """The cycle of this number, with a scan that has just been made."""
    navigator.observe(cycle * navigator.cycle, pose, velocity, scan)
    return navigator.step()


def test_a_run_is_that_of_the_program(tmp_path: pathlib.Path) -> None:
    scene = SCENES / "small_house.toml"
    run = keyway.simulate(keyway.Scene.read(scene))
    command = [*KEYWAY, "navigate", "--scene", str(scene), "--format", "json", "--no-times"]
    words = [word for word in command if word != "--no-times"]
    answer = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, check=True)
    report = json.loads(answer.stdout)
    assert run.outcome == report["outcome"] == "reached"
    trajectory = run.trajectory
    assert trajectory.dtype.names == ("t_s", "x_m", "y_m", "yaw_rad", "v_mps", "omega_radps")
    assert np.array_equal(trajectory.view(np.float64).reshape(-1, 6), report["trajectory"])
    assert run.metrics["length_m"] == report["run"]["length_m"]
    assert run.report["smoothed"]["length_m"] == report["smoothed"]["length_m"]
    assert run.route.tolist() == report["smoothed"]["waypoints_m"] and not run.route.flags.writeable
    assert run.metrics["mean_cycle_us"] is None and report["run"]["mean_cycle_us"] > 0
    assert keyway.simulate(keyway.Scene.read(scene), times=True).metrics["mean_cycle_us"] > 0


def test_driving_by_hand_with_a_navigator_is_the_same_run(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    navigator = bound_for(grid, (1, 2), (7, 2), robot="small", stack="keyway")
    simulation = keyway.Simulation(scene)
    rows, t = [(0.0, *simulation.pose, *simulation.velocity)], 0
    seen_post = False
    while simulation.outcome is None:
        scan = simulation.scan
        seen_post |= bool(np.isfinite(scan.ranges).any())
        navigator.observe(simulation.stamp, simulation.pose, simulation.velocity, scan)
        step = navigator.step()
        assert step.status in ("drive", "blocked")
        simulation.step(step.v, step.omega, remaining=navigator.remaining)
        t += 1
        rows.append((t * navigator.cycle, *simulation.pose, *simulation.velocity))
    assert simulation.outcome == "reached" and seen_post
    expected = keyway.simulate(scene).trajectory.view(np.float64).reshape(-1, 6)
    # By hand it ends when the goal is passed, and not when the robot stands.
    assert np.allclose(np.array(rows), expected[: len(rows)], atol=1e-12)
    assert 0 < len(expected) - len(rows) < 30


def test_headings_are_radians_and_those_of_files_degrees() -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    scene = keyway.Scene(grid, start=(1, 2, math.pi / 2), goal=(7, 2, math.radians(30)))
    assert "start = [1.0, 2.0, 90.0]" in scene.to_toml() and "goal = [7.0, 2.0, 30.0]" in scene.to_toml()
    trajectory = keyway.simulate(scene).trajectory
    assert trajectory["yaw_rad"][0] == math.pi / 2
    assert trajectory["yaw_rad"][-1] == pytest.approx(math.radians(30), abs=0.2)
    run = keyway.simulate(scene)
    assert run.start == [1, 2, math.pi / 2] and run.goal == pytest.approx([7, 2, math.radians(30)])
    assert keyway.simulate(keyway.Scene(grid, (1, 2), (7, 2))).goal == [7, 2]
    assert scene.start == [1, 2, math.pi / 2] and scene.goal == pytest.approx([7, 2, math.radians(30)])
    assert keyway.Simulation(scene).goal_heading == pytest.approx(math.radians(30))
    for start, goal in (((1, 2, 90), (7, 2)), ((1, 2), (7, 2, -30))):
        with pytest.warns(UserWarning, match="headings are in radians, and only in files in degrees"):
            keyway.Scene(grid, start, goal)
    with pytest.warns(UserWarning, match="goal: .*headings are in radians"):
        bound_for(grid, (1, 1), (1, 2, 90))
    navigator = bound_for(grid, (1, 1), (1, 1, -math.pi / 2))
    assert navigator.goal == [1, 1, -math.pi / 2]
    assert next_step(navigator, (1, 1, 0), (0, 0), navigator.clear_scan, 0).omega < 0
    assert next_step(navigator, (1, 1, -math.pi / 2), (0, 0), navigator.clear_scan, 1).status == "arrived"


def test_ranges_of_any_kind_are_the_same(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)

    def scan(ranges: Any) -> keyway.Scan:
        return keyway.Scan(ranges, angle_min=-math.pi, angle_increment=math.tau / 360)

    def step(ranges: object) -> tuple[float, float, str]:
        step = next_step(bound_for(grid, (1, 2), (7, 2)), (1, 2, 0), (0.2, 0.0), scan(ranges), 0)
        return step.v, step.omega, step.status

    ranges = np.full(360, np.inf)
    ranges[175:186] = 0.5
    expected = step(ranges)
    assert expected != step(np.full(360, np.inf))
    wide = np.zeros(720)
    wide[::2] = ranges
    for same in (ranges.tolist(), tuple(ranges), wide[::2], ranges.astype(np.float32), ranges[::-1].copy()[::-1]):
        assert step(same) == expected
    navigator = bound_for(grid, (1, 2), (7, 2))
    assert len(navigator.clear_scan) == 360 and navigator.clear_scan.bearings[180] == pytest.approx(0.0)
    with pytest.raises(ValueError, match=r"ranges: expected a sequence of numbers, got an array of float64 of shape \(2, 180\)"):
        scan(np.zeros((2, 180)))
    with pytest.raises(TypeError, match="ranges: expected a sequence of numbers"):
        scan(["far"] * 360)
    with pytest.raises(ValueError, match=r"pose: expected \(x, y, theta\), got 2 numbers"):
        navigator.observe(0.0, (1, 2), (0, 0), scan(ranges))
    nan = next_step(navigator, (math.nan, 2, 0), (0, 0), scan(ranges), 0)
    assert (nan.status, nan.v) == ("blocked", 0.0) and nan.why and "pose.x is implausible" in nan.why


def test_a_scan_says_where_its_beams_look(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    # A wall 0.45 m ahead, in the layouts of different sensors.
    bearings = np.arange(360) * math.tau / 360 - math.pi
    ahead = np.abs(bearings) < 0.8
    ranges = np.where(ahead, 0.45 / np.cos(bearings), np.inf)

    def drive(scan: Any) -> list[tuple[float, float]]:
        navigator = bound_for(grid, (1, 2), (7, 2))
        steps = [next_step(navigator, (1, 2, 0), (0.2, 0.0), scan, cycle) for cycle in range(3)]
        return [(round(step.v, 9), round(step.omega, 9)) for step in steps]

    back = keyway.Scan(ranges, -math.pi, math.tau / 360)
    front = keyway.Scan(np.roll(ranges, 180), 0.0, math.tau / 360)
    clockwise = keyway.Scan(np.roll(ranges, 180)[::-1], math.tau - math.tau / 360, -math.tau / 360)
    message = types.SimpleNamespace(ranges=array.array("d", np.roll(ranges, 180)), angle_min=0.0, angle_increment=math.tau / 360)
    expected = drive(back)
    assert expected[-1][0] < 0.2
    for same in (front, clockwise, message):
        assert drive(same) == expected
    assert drive(keyway.Scan(np.roll(ranges, 180), -math.pi, math.tau / 360)) != expected
    for wrong in (ranges, ranges.tolist(), 3.0):
        with pytest.raises(TypeError, match="ranges alone do not contain the bearings of the beams"):
            drive(wrong)
    with pytest.raises(TypeError, match="angle_min"):
        keyway.Scan(ranges)  # type: ignore[call-arg]
    for angles, why in [((0, 1), "degrees"), ((-180, 0.01), "degrees"), ((0, 0), "other than 0"), ((math.nan, 0.01), "first beam")]:
        with pytest.raises(ValueError, match=why):
            keyway.Scan(ranges, *angles)
    scan = keyway.Simulation(scene).scan
    again = keyway.Scan(scan.ranges, scan.angle_min, scan.angle_increment)
    assert (len(again), again.angle_min, again.bearings.tolist()) == (360, -math.pi, scan.bearings.tolist())


def test_a_navigator_says_what_is_wrong() -> None:
    occupied = np.zeros((40, 80), dtype=bool)
    occupied[:, 40] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    with pytest.raises(keyway.NoPath):
        bound_for(grid, (1, 2), (7, 2))
    with pytest.raises(keyway.NoRoom, match="goal .* has too little clearance"):
        bound_for(grid, (1, 2), (3.95, 2))
    with pytest.raises(keyway.NoPath, match="way-point 1"):
        bound_for(grid, (1, 2), (3, 2), via=[(7, 2)])
    with pytest.raises(ValueError, match="there is no stack `dwa`"):
        bound_for(grid, (1, 2), (3, 2), stack="dwa")
    with pytest.raises(ValueError, match="the stack `keyway` has no published parameters"):
        bound_for(grid, (1, 2), (3, 2), stack="keyway", as_published=True)
    with pytest.raises(ValueError, match="`local.horizon_s`: .*, expected a number"):
        bound_for(grid, (1, 2), (3, 2), parameters={"local": {"horizon_s": "far"}})
    with pytest.raises(ValueError, match="local.horizon_s must be a positive number, got -1"):
        bound_for(grid, (1, 2), (3, 2), parameters={"local": {"horizon_s": -1}})
    for stack in keyway.names("stacks"):
        navigator = bound_for(grid, (1, 2), (3, 2), stack=stack)
        # A random tree goes astray.
        assert navigator.remaining and 1.99 < navigator.remaining < (6 if stack == "rrt-follow" else 2.2)
    assert navigator.route.shape[1] == navigator.guide_points.shape[1] == 2
    assert navigator.routes_planned == 1 and set(navigator.recoveries().values()) == {0}


def test_a_start_too_near_to_a_wall_is_left_and_said() -> None:
    occupied = np.zeros((80, 160), dtype=bool)
    occupied[0] = True
    grid = keyway.Map.from_array(occupied, resolution=0.05)
    navigator = bound_for(grid, (2, 0.20), (6, 2))
    assert navigator.notice and "(an obstacle is 0.150 m away); the robot moves away" in navigator.notice
    step = next_step(navigator, (2, 0.20, 0), (0, 0), navigator.clear_scan, 0)
    assert step.notice == navigator.notice
    step = next_step(navigator, (2, 0.26, 0), (0, 0), navigator.clear_scan, 1)
    assert step.notice is None and navigator.notice is None
    with pytest.raises(keyway.NoRoom, match="start .* has too little clearance"):
        bound_for(grid, (2, 0.15), (6, 2))
    with pytest.raises(keyway.NoRoom, match="start .* has too little clearance"):
        bound_for(grid, (2, 0.20), (6, 2), parameters={"controller": {"start_error_m": 0}})


def test_a_goal_at_whose_heading_the_robot_does_not_fit_is_refused() -> None:
    occupied = np.zeros((40, 80), dtype=bool)
    occupied[:10] = occupied[15:] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    bound_for(grid, (1, 1.25), (5, 1.25, 0), robot="jackal")
    with pytest.raises(keyway.NoRoom, match=r"does not fit with a yaw of 90 deg; it fits there with a yaw of -180 to "):
        bound_for(grid, (1, 1.25), (5, 1.25, math.pi / 2), robot="jackal")


def test_scenes_are_files_and_values(tmp_path: pathlib.Path, scene: keyway.Scene) -> None:
    text = scene.replace(seed=4, stack="s1-adaptive").to_toml()
    assert 'stack = "s1-adaptive"' in text
    keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1).write(tmp_path / "room.yaml")
    (tmp_path / "scene.toml").write_text(scene.to_toml().replace('"array"', '"room.yaml"'))
    again = keyway.simulate(keyway.Scene.read(tmp_path / "scene.toml"))
    here = keyway.simulate(scene)
    assert np.array_equal(again.trajectory, here.trajectory)
    assert again.report["inputs"]["map_digest"] == here.report["inputs"]["map_digest"]
    assert here._repr_svg_().startswith("<svg") and here._repr_png_().startswith(b"\x89PNG")
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    with pytest.raises(ValueError, match="`rules.time`: unknown field `time`"):
        keyway.Scene(grid, (1, 2), (7, 2), rules={"time": 3})
    with pytest.raises(ValueError, match="`map` cannot be combined with a map in memory"):
        keyway.Scene(grid, (1, 2), (7, 2), map="a.yaml")
    with pytest.raises(FileNotFoundError):
        keyway.simulate(keyway.Scene.from_toml(scene.to_toml().replace("array", "array.map")))
    with pytest.raises(ValueError, match="there is no robot `hal`"):
        keyway.simulate(scene.replace(robot="hal"))


def test_a_start_without_a_route_is_an_outcome() -> None:
    occupied = np.zeros((40, 80), dtype=bool)
    occupied[:, 40] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    run = keyway.simulate(keyway.Scene(grid, (1, 2), (7, 2)))
    assert (run.outcome, run.metrics, run.trajectory.shape, run.route.shape) == ("no_path", {}, (0,), (0, 2))
    assert run.reason and run._repr_svg_().startswith("<svg")
    with pytest.raises(keyway.NoPath):
        keyway.Simulation(keyway.Scene(grid, (1, 2), (7, 2)))


def test_a_simulation_ends(scene: keyway.Scene) -> None:
    simulation = keyway.Simulation(scene)
    assert simulation.limits == ((simulation.limits[0][0], -simulation.limits[1][1]), simulation.limits[1])
    while simulation.outcome is None:
        simulation.step(9.0, 0.0)
    assert simulation.outcome == "collided"
    pose = simulation.pose
    assert simulation.step(0.5, 0.0) == "collided" and simulation.pose == pose
    standing = keyway.Simulation(scene)
    while standing.outcome is None:
        standing.step(0.0, 0.0)
    assert standing.outcome == "stuck"
    with pytest.raises(ValueError, match="is not a number"):
        keyway.Simulation(scene).step(math.nan, 0.0)


def test_safe_is_one_word_everywhere() -> None:
    grid = keyway.Map.from_array(np.zeros((80, 160), dtype=bool), resolution=0.05)
    scene = keyway.Scene(grid, (1, 2), (7, 2), stack="astar-follow", safe=True)
    assert "safe = true" in scene.to_toml()
    assert keyway.simulate(scene).report["run"]["unsafe_commands"] is not None
    plain = scene.replace(safe=False)
    assert keyway.simulate(plain).report["run"]["unsafe_commands"] is None
    assert keyway.simulate(plain.replace(safe=True)).report == keyway.simulate(scene).report
    # Something comes towards a robot that follows its path, whatever stands there.
    wall = np.full(360, np.inf)
    wall[150:211] = 0.4
    scan = keyway.Scan(wall, angle_min=-np.pi, angle_increment=np.pi / 180)
    careless = bound_for(grid, (1, 2), (7, 2), stack="astar-follow")
    careful = bound_for(grid, (1, 2), (7, 2), stack="astar-follow", safe=True)
    steps = [next_step(navigator, (1, 2, 0), (0.5, 0), scan, 0) for navigator in (careless, careful)]
    assert steps[1].v < 0.5 and steps[1].v <= steps[0].v


def test_a_robot_that_sees_nothing_stands_and_says_so() -> None:
    grid = keyway.Map.from_array(np.zeros((80, 160), dtype=bool), resolution=0.05)
    navigator = bound_for(grid, (1, 2), (7, 2))
    for first, ranges in ((0, np.full(360, np.nan)), (20, np.zeros(360))):
        scan = keyway.Scan(ranges, angle_min=-np.pi, angle_increment=np.pi / 180)
        for cycle in range(first, first + 20):
            step = next_step(navigator, (1, 2, 0), (0, 0), scan, cycle)
            assert (step.v, step.status) == (0, "blocked") and "is blind" in str(step.why)
    assert next_step(navigator, (1, 2, 0), (0, 0), navigator.clear_scan, 40).v > 0


def test_a_robot_does_not_stop_for_its_own_housing() -> None:
    grid = keyway.Map.from_array(np.zeros((80, 160), dtype=bool), resolution=0.05)
    simulation = keyway.Simulation(keyway.Scene(grid, (1, 2, 0), (7, 2)))
    navigator = bound_for(grid, (1, 2), (7, 2))
    for cycle in range(300):
        scan = simulation.scan
        ranges = scan.ranges.copy()
        for beam in (45, 135, 225, 315):
            ranges[beam - 3 : beam + 4] = 0.12
        seen = keyway.Scan(ranges, scan.angle_min, scan.angle_increment)
        step = next_step(navigator, simulation.pose, simulation.velocity, seen, cycle)
        if simulation.step(step.v, step.omega, 1e3 - cycle):
            break
    assert simulation.outcome == "reached"


def test_a_path_stands_for_its_scene() -> None:
    file = SCENES / "small_house.toml"
    expected = keyway.simulate(keyway.Scene.read(file))
    for path in (file, str(file)):
        assert np.array_equal(keyway.simulate(path).trajectory, expected.trajectory)
        assert keyway.Simulation(path).map.digest == expected.map.digest
    (alone,) = keyway.simulate_team(file)
    assert np.array_equal(alone.trajectory, expected.trajectory)
    with pytest.raises(FileNotFoundError, match="cannot read nowhere.toml"):
        keyway.simulate("nowhere.toml")
    for wrong in (3, None, expected):
        with pytest.raises(TypeError, match="^expected a keyway.Scene, or the path of a scene file, got "):
            keyway.simulate(wrong)  # type: ignore[arg-type]


def test_a_simulation_shows_its_world() -> None:
    values = np.zeros((40, 80), dtype=np.int8)
    values[:2], values[38:] = 100, -1
    grid = keyway.Map.from_array(values, resolution=0.1)
    scene = keyway.Scene(
        grid, (1, 2, 0), (7, 2, math.pi / 2),
        unknown=[
            {"position": [4, 2.1], "radius_m": 0.3}, {"position": [4, 3], "radius_m": 0.1, "from_s": 0.5},
            {"vertices_m": [[5, 1], [5.6, 1], [5.2, 1.4]]}, {"cells": [[20, 30], [21, 31]]},
        ],
        moving=[{"way_points": [[6.5, 1], [6.5, 3]], "speed_mps": 0.5, "radius_m": 0.25}],
        disturbances={"localisation": {"position_m": 0.05}},
    )
    simulation = keyway.Simulation(scene)
    assert simulation.obstacles.tolist() == [[4, 2.1, 0.3]] and simulation.moving.tolist() == [[6.5, 1, 0.25]]
    assert [polygon.tolist() for polygon in simulation.polygons] == [[[5, 1], [5.6, 1], [5.2, 1.4]]]
    # Unknown space is an obstacle, but not a hidden one.
    assert np.argwhere(simulation.hidden).tolist() == [[30, 20], [31, 21]]
    assert np.array_equal(simulation.map.occupancy, grid.occupancy)
    for _ in range(10):
        simulation.step(0.5, 0.0)
    assert simulation.obstacles.tolist() == [[4, 2.1, 0.3], [4, 3, 0.1]]
    assert simulation.moving[0].tolist() == pytest.approx([6.5, 1.5, 0.25])
    x, y, theta = simulation.true_pose
    assert simulation.pose != simulation.true_pose and math.dist(simulation.pose[:2], (x, y)) < 0.5
    assert np.hypot(*(simulation.outline - (x, y)).T) == pytest.approx(np.full(len(simulation.outline), 0.18), abs=0.1)
    turned = keyway.Simulation(scene.replace(robot="jackal")).outline
    assert turned.shape == (4, 2) and turned.mean(axis=0) == pytest.approx((1, 2), abs=0.05)


def test_moving_obstacles_of_a_run_are_where_they_were() -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    moving = [{"way_points": [[6.5, 1], [6.5, 3]], "speed_mps": 0.5, "radius_m": 0.25}]
    run = keyway.simulate(keyway.Scene(grid, (1, 2), (4, 2), moving=moving))
    (path,) = run.moving
    assert path.dtype.names == ("t_s", "x_m", "y_m", "radius_m")
    assert np.array_equal(path["t_s"], run.trajectory["t_s"])
    # To and fro: 4 s for one way.
    assert np.allclose(path["y_m"], 3 - np.abs(path["t_s"] % 8 - 4) / 2)
    assert keyway.simulate(keyway.Scene(grid, (1, 2), (4, 2))).moving == []
