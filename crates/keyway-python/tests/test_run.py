"""Controllers, scenes, runs, and a simulation that Python drives."""

import json
import math
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from conftest import SCENES

import keyway

KEYWAY = [sys.executable, "-m", "keyway"]


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


def test_driving_by_hand_with_a_controller_is_the_same_run(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    controller = keyway.Controller(grid, start=(1, 2), goal=(7, 2), robot="small", stack="keyway")
    simulation = keyway.Simulation(scene)
    rows, t = [(0.0, *simulation.pose, *simulation.velocity)], 0
    seen_post = False
    while simulation.outcome is None:
        ranges = simulation.ranges
        seen_post |= bool(np.isfinite(ranges).any())
        step = controller.step(simulation.pose, simulation.velocity, ranges)
        assert step.status in ("drive", "blocked")
        simulation.step(step.v, step.omega, remaining=controller.remaining)
        t += 1
        rows.append((t * controller.cycle, *simulation.pose, *simulation.velocity))
    assert simulation.outcome == "reached" and seen_post
    expected = keyway.simulate(scene).trajectory.view(np.float64).reshape(-1, 6)
    # By hand it ends when the goal is passed, and not when the robot stands.
    assert np.allclose(np.array(rows), expected[: len(rows)], atol=1e-12)
    assert 0 < len(expected) - len(rows) < 30


def test_ranges_of_any_kind_are_the_same(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)

    def step(ranges: object) -> tuple[float, float, str]:
        controller = keyway.Controller(grid, (1, 2), (7, 2))
        step = controller.step((1, 2, 0), (0.2, 0.0), ranges)  # type: ignore[arg-type]
        return step.v, step.omega, step.status

    ranges = np.full(360, np.inf)
    ranges[175:186] = 0.5
    expected = step(ranges)
    assert expected != step(np.full(360, np.inf))
    wide = np.zeros(720)
    wide[::2] = ranges
    for same in (ranges.tolist(), tuple(ranges), wide[::2], ranges.astype(np.float32), ranges[::-1].copy()[::-1]):
        assert step(same) == expected
    controller = keyway.Controller(grid, (1, 2), (7, 2))
    assert len(controller.no_ranges) == 360 and controller.bearings[180] == pytest.approx(0.0)
    with pytest.raises(ValueError, match=r"ranges: expected 360 numbers, one for each beam .* got 5 of shape \(5,\)"):
        controller.step((1, 2, 0), (0, 0), np.zeros(5))
    with pytest.raises(ValueError, match=r"ranges: expected 360 numbers.*got an array of float64 of shape \(2, 180\)"):
        controller.step((1, 2, 0), (0, 0), np.zeros((2, 180)))
    with pytest.raises(TypeError, match="ranges: expected a row of numbers"):
        controller.step((1, 2, 0), (0, 0), ["far"] * 360)  # type: ignore[list-item]
    with pytest.raises(ValueError, match=r"pose: expected \(x, y, theta\), got 2 numbers"):
        controller.step((1, 2), (0, 0), ranges)
    nan = controller.step((math.nan, 2, 0), (0, 0), ranges)
    assert (nan.status, nan.v) == ("blocked", 0.0) and nan.why and "pose.x cannot be true" in nan.why


def test_a_controller_says_what_is_wrong() -> None:
    occupied = np.zeros((40, 80), dtype=bool)
    occupied[:, 40] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    with pytest.raises(keyway.NoPath):
        keyway.Controller(grid, (1, 2), (7, 2))
    with pytest.raises(keyway.NoRoom, match="goal .* leaves no room"):
        keyway.Controller(grid, (1, 2), (3.95, 2))
    with pytest.raises(keyway.NoPath, match="way-point 1"):
        keyway.Controller(grid, (1, 2), (3, 2), via=[(7, 2)])
    with pytest.raises(ValueError, match="there is no stack `dwa`"):
        keyway.Controller(grid, (1, 2), (3, 2), stack="dwa")
    with pytest.raises(ValueError, match="nobody has published the stack `keyway`"):
        keyway.Controller(grid, (1, 2), (3, 2), stack="keyway", as_published=True)
    with pytest.raises(ValueError, match="`local.horizon_s` must be a number, got the text"):
        keyway.Controller(grid, (1, 2), (3, 2), parameters={"local": {"horizon_s": "far"}})
    with pytest.raises(ValueError, match="local.horizon_s must be a positive number, got -1"):
        keyway.Controller(grid, (1, 2), (3, 2), parameters={"local": {"horizon_s": -1}})
    for stack in keyway.names("stacks"):
        controller = keyway.Controller(grid, (1, 2), (3, 2), stack=stack)
        # A random tree goes astray.
        assert 1.99 < controller.remaining < (6 if stack == "rrt-follow" else 2.2)
    assert controller.route.shape[1] == controller.guide_points.shape[1] == 2
    assert controller.routes_planned == 1 and set(controller.recoveries().values()) == {0}


def test_a_start_too_near_to_a_wall_is_left_and_said() -> None:
    occupied = np.zeros((80, 160), dtype=bool)
    occupied[0] = True
    grid = keyway.Map.from_array(occupied, resolution=0.05)
    controller = keyway.Controller(grid, start=(2, 0.20), goal=(6, 2))
    assert controller.notice and "(an obstacle is 0.150 m away), and leaves it first" in controller.notice
    step = controller.step((2, 0.20, 0), (0, 0), controller.no_ranges)
    assert step.notice == controller.notice
    step = controller.step((2, 0.26, 0), (0, 0), controller.no_ranges)
    assert step.notice is None and controller.notice is None
    with pytest.raises(keyway.NoRoom, match="start .* leaves no room"):
        keyway.Controller(grid, start=(2, 0.15), goal=(6, 2))
    with pytest.raises(keyway.NoRoom, match="start .* leaves no room"):
        keyway.Controller(grid, start=(2, 0.20), goal=(6, 2), parameters={"controller": {"start_error_m": 0}})


def test_a_goal_at_whose_heading_the_robot_does_not_fit_is_refused() -> None:
    occupied = np.zeros((40, 80), dtype=bool)
    occupied[:10] = occupied[15:] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    keyway.Controller(grid, (1, 1.25), (5, 1.25, 0), robot="jackal")
    with pytest.raises(keyway.NoRoom, match=r"does not fit with a yaw of 90 deg; there it fits with one of -180 to "):
        keyway.Controller(grid, (1, 1.25), (5, 1.25, 90), robot="jackal")


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
    with pytest.raises(ValueError, match="`map` cannot be given beside a map in memory"):
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
