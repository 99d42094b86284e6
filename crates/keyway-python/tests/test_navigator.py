"""The life of a navigator: goals, maps, limits and clocks change while the robot drives."""

import copy
import math
import pathlib
import pickle
import subprocess
import sys
import types
from collections.abc import Callable

import numpy as np
import pytest

import keyway

CYCLE = 0.1


class Robot:
    """Stands for odometry, lidar and motors: what is told is obeyed at once, and nothing is seen but the map."""

    def __init__(self, occupied: np.ndarray, pose: tuple[float, float, float]) -> None:
        self.navigator = keyway.Navigator(keyway.Map.from_array(occupied, resolution=0.1))
        self.pose, self.velocity, self.stamp = pose, (0.0, 0.0), 5.0
        self.navigator.relocate(pose)

    def observe(self) -> None:
        self.navigator.observe(self.stamp, self.pose, self.velocity, self.navigator.clear_scan)

    def cycle(self) -> keyway.Step:
        self.observe()
        step = self.navigator.step()
        x, y, theta = self.pose
        middle = theta + 0.5 * step.omega * CYCLE
        self.pose = (x + step.v * CYCLE * math.cos(middle), y + step.v * CYCLE * math.sin(middle), theta + step.omega * CYCLE)
        self.velocity, self.stamp = (step.v, step.omega), self.stamp + CYCLE
        return step

    def drive(self, seconds: float) -> None:
        for _ in range(round(seconds / CYCLE)):
            self.cycle()

    def arrive(self) -> None:
        for _ in range(1000):
            if self.cycle().status == "arrived":
                return
        pytest.fail(f"it has not arrived: {self.pose}")


def wall(*doors: float) -> np.ndarray:
    """A hall of 10 m x 8 m with a wall across it that has doors of 1 m at these heights."""
    occupied = np.zeros((80, 100), dtype=bool)
    occupied[:, 50] = True
    for door in doors:
        occupied[round(10 * door) - 5 : round(10 * door) + 5, 50] = False
    return occupied


def passes(navigator: keyway.Navigator, door: float) -> bool:
    route = navigator.route
    crossing = np.interp(5.05, route[:, 0], route[:, 1])
    return bool(abs(crossing - door) < 0.5)


def test_goals_come_and_go() -> None:
    robot = Robot(wall(2, 6), (2, 4, 0))
    navigator = robot.navigator
    assert robot.cycle().status == "idle" and navigator.goal is None and navigator.remaining is None
    assert navigator.route.shape == (0, 2) and "no goal" in repr(navigator)
    for goal in [(8, 2), (2, 7), (8, 6)]:
        navigator.set_goal(goal)
        robot.drive(2)
    with pytest.raises(keyway.NoRoom) as refused:
        navigator.set_goal((5.05, 4))
    assert refused.value.kind == 203 and navigator.goal == [8, 6]  # type: ignore[attr-defined]
    robot.arrive()
    assert math.dist(robot.pose[:2], (8, 6)) < 0.2
    navigator.set_goals([(8, 4), (8, 2)], (9, 1))
    robot.drive(1)
    navigator.cancel()
    robot.drive(2)
    assert robot.cycle().status == "idle" and robot.velocity == (0, 0)


def test_a_goal_needs_a_place() -> None:
    navigator = keyway.Navigator(keyway.Map.from_array(wall(4), resolution=0.1))
    with pytest.raises(ValueError, match="the pose of the robot is unknown") as refused:
        navigator.set_goal((2, 2))
    assert refused.value.kind == 210  # type: ignore[attr-defined]
    step = navigator.step()
    assert (step.status, step.v, step.kind) == ("blocked", 0, 111) and "nothing has been observed" in str(step.why)


def test_maps_change() -> None:
    robot = Robot(wall(2, 6.5), (2, 3, 0))
    robot.navigator.set_goal((8, 3))
    assert passes(robot.navigator, 2)
    robot.drive(1)
    door = keyway.Map.from_array(np.ones((10, 1), dtype=bool), resolution=0.1, origin=(5, 1.5))
    robot.navigator.edit_map(door)
    assert passes(robot.navigator, 6.5)
    assert np.array_equal(robot.navigator.map.occupied, wall(6.5))
    opened = np.zeros((90, 120), dtype=bool)
    opened[10:, 20:] = wall(2, 6.5)
    robot.navigator.set_map(keyway.Map.from_array(opened, resolution=0.1, origin=(-2, -1)))
    assert passes(robot.navigator, 2)
    robot.arrive()


def test_limits_and_masks() -> None:
    robot = Robot(wall(2, 6.5), (2, 3, 0))
    navigator = robot.navigator
    navigator.set_goal((8, 3))
    navigator.set_speed_limit(0.2)
    robot.drive(2)
    assert 0.15 < robot.velocity[0] <= 0.2 + 1e-9
    navigator.set_speed_limit()
    robot.drive(2)
    assert robot.velocity[0] > 0.3
    with pytest.raises(ValueError, match="speed_mps must be a positive number"):
        navigator.set_speed_limit(-1.0)
    zone = keyway.Map.from_array(np.ones((2, 2), dtype=bool), resolution=0.6, origin=(4.5, 1.4))
    navigator.set_masks(keep_out=zone)
    assert passes(navigator, 6.5)
    navigator.set_masks(slow=(zone, 0.1))
    assert passes(navigator, 2)
    with pytest.raises(ValueError, match="must be a positive speed"):
        navigator.set_masks(slow=(zone, 0.0))
    robot.arrive()


def test_single_acts() -> None:
    robot = Robot(wall(2), (2, 4, 0))
    robot.navigator.spin(math.pi / 2, 20)
    robot.arrive()
    assert robot.pose[2] == pytest.approx(math.pi / 2, abs=0.02)
    robot.navigator.drive_on_heading(1.0, 30)
    robot.arrive()
    assert robot.pose[1] == pytest.approx(5, abs=0.02)
    with pytest.raises(ValueError, match="does not drive backwards"):
        robot.navigator.back_up(1.0, 30)
    robot.navigator.drive_on_heading(9.0, 1.5)
    robot.drive(1)
    step = robot.cycle()
    assert (step.status, step.kind) == ("blocked", 113)
    robot.drive(1)
    assert robot.cycle().kind == 114


def test_ways_are_asked_for_and_followed() -> None:
    robot = Robot(wall(2, 6.5), (2, 3, 0))
    navigator = robot.navigator
    route = navigator.plan((2, 3), (8, 3))
    assert navigator.is_path_valid(route) and not navigator.is_path_valid([(2, 3), (8, 3)])
    assert navigator.goal is None
    with pytest.raises(keyway.NoRoom, match="does not fit along the path"):
        navigator.follow([(2, 3), (8, 3)])
    with pytest.raises(ValueError, match="needs two points or more"):
        navigator.follow([(2, 3)])
    navigator.follow([(2, 3), (2, 6.5), (8, 6.5)])
    assert passes(navigator, 6.5) and navigator.goal == [8, 6.5]
    robot.arrive()


def test_stamps() -> None:
    robot = Robot(wall(4), (2, 4, 0))
    navigator = robot.navigator
    navigator.set_goal((8, 4))
    robot.drive(1)
    robot.observe()
    once, twice = navigator.step(), navigator.step()
    assert (once.v, once.omega) == (twice.v, twice.omega)
    navigator.observe(1.0, robot.pose, robot.velocity)
    step = navigator.step()
    assert (step.v, step.kind) == (0, 110) and "older than the last one" in str(step.why)
    navigator.restart_clock()
    robot.stamp = 1.0
    assert robot.cycle().status == "drive"
    # Nobody says where it is any more.
    kinds = [navigator.step().kind for _ in range(10)]
    assert kinds[0] is None and kinds[-1] == 112
    # The stamp of a message counts, or that of a scan.
    ranges, increment = np.full(360, np.inf), math.tau / 360
    stamp = types.SimpleNamespace(sec=2, nanosec=500_000_000)
    header = types.SimpleNamespace(stamp=stamp)
    message = types.SimpleNamespace(ranges=ranges, angle_min=0.0, angle_increment=increment, header=header)
    for scan in (message, keyway.Scan(ranges, 0.0, increment, stamp=2.5)):
        late = Robot(wall(4), (2, 4, 0))
        late.navigator.set_goal((8, 4))
        for stamp_s in (2.5, 2.9, 3.0, 3.2):
            late.navigator.observe(stamp_s, late.pose, (0, 0), scan)
            kind = late.navigator.step().kind
        assert kind == 107, "the scan is more than half a second old"


def test_contradictions_are_told() -> None:
    robot = Robot(wall(4), (2, 4, 0))
    robot.navigator.set_goal((8, 4))
    robot.drive(1)
    assert robot.navigator.doubts == []
    x, y, theta = robot.pose
    robot.pose = (x, y + 0.3, theta)
    robot.cycle()
    assert len(robot.navigator.doubts) == 1 and "the pose has jumped by 0.30 m" in robot.navigator.doubts[0]


def test_a_relocated_robot_goes_on() -> None:
    robot = Robot(wall(2, 6.5), (2, 3, 0))
    robot.navigator.set_goal((8, 3))
    robot.drive(1)
    robot.pose = (2, 6.5, 0)
    robot.navigator.relocate(robot.pose)
    assert passes(robot.navigator, 6.5)
    robot.arrive()


def test_the_example_drives() -> None:
    script = pathlib.Path(__file__).parents[1] / "examples" / "own_robot.py"
    answer = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert "arrived after" in answer.stdout and "turned to" in answer.stdout


@pytest.mark.parametrize(
    "call",
    [
        lambda navigator: navigator.relocate((1, 2)),
        lambda navigator: navigator.set_goals((1, 2), (3, 4)),
        lambda navigator: navigator.set_map(np.zeros((3, 3))),
        lambda navigator: navigator.edit_map(None),
        lambda navigator: navigator.set_masks(keep_out=3),
        lambda navigator: navigator.spin("left", 3),
        lambda navigator: navigator.is_path_valid(7),
        lambda navigator: navigator.observe("now", (1, 1, 0), (0, 0)),
    ],
)
def test_wrong_arguments_are_refused(call: Callable[[keyway.Navigator], object]) -> None:
    with pytest.raises((TypeError, ValueError)):
        call(keyway.Navigator(keyway.Map.from_array(wall(4), resolution=0.1)))


def test_a_life_goes_on_from_a_snapshot() -> None:
    robot = Robot(wall(4.0), (2.0, 2.0, 0.0))
    robot.navigator.set_goals([(4, 6)], (8, 2))
    robot.navigator.set_speed_limit(0.4)
    robot.drive(3.0)
    twins = [keyway.Navigator.restore(robot.navigator.snapshot()), copy.deepcopy(robot.navigator), pickle.loads(pickle.dumps(robot.navigator))]
    for _ in range(100):
        robot.observe()
        scan = robot.navigator.clear_scan
        for twin in twins:
            twin.observe(robot.stamp, robot.pose, robot.velocity, scan)
        steps = [twin.step() for twin in twins]
        step = robot.cycle()
        assert all((it.v, it.omega, it.status, it.kind) == (step.v, step.omega, step.status, step.kind) for it in steps)
    for broken in (b"", robot.navigator.snapshot()[:-1], b"\x00" * 100):
        with pytest.raises(ValueError, match="snapshot: "):
            keyway.Navigator.restore(broken)


def test_ways_are_smoothed_and_goals_that_cannot_be_reached_replaced() -> None:
    navigator = keyway.Navigator(keyway.Map.from_array(wall(4.0), resolution=0.1))
    steps = [(2.0, 2.0), (3.0, 3.5), (5.05, 4.0), (6.0, 4.0), (8.0, 6.0)]
    smoothed = navigator.smooth(steps)
    length = np.hypot(*np.diff(smoothed, axis=0).T).sum()
    assert length < np.hypot(*np.diff(steps, axis=0).T).sum() and navigator.is_path_valid(smoothed)
    assert navigator.nearest_reachable((2, 2), (8, 6)) == (8, 6)
    closed = keyway.Navigator(keyway.Map.from_array(wall(), resolution=0.1))
    nearest = closed.nearest_reachable((2, 2), (8, 6))
    assert nearest is not None and 4.5 < nearest[0] < 5.0 and nearest[1] == pytest.approx(6, abs=0.2)


def test_a_robot_may_be_a_dictionary(tmp_path: pathlib.Path) -> None:
    slow: dict[str, object] = {"like": "small", "cycle_s": 0.2, "limits": {"v_max_mps": 0.3}}
    file = tmp_path / "slow.toml"
    file.write_text('like = "small"\ncycle_s = 0.2\nlimits = { v_max_mps = 0.3 }\n')
    grid = keyway.Map.from_array(np.zeros((60, 60), dtype=bool), resolution=0.1)
    robots: list[dict[str, object] | str | pathlib.Path] = [slow, str(file), file]
    navigators = [keyway.Navigator(grid, robot=robot) for robot in robots]
    assert [navigator.cycle for navigator in navigators] == [0.2] * 3
    runs = [keyway.simulate(keyway.Scene(grid, (1, 1), (5, 4)).replace(robot=robot)) for robot in robots]
    assert runs[0].outcome == "reached" and runs[0].metrics["time_s"] > 15
    for run in runs[1:]:
        np.testing.assert_array_equal(run.trajectory, runs[0].trajectory)
    in_scene = keyway.simulate(keyway.Scene(grid, (1, 1), (5, 4), robot=slow))
    np.testing.assert_array_equal(in_scene.trajectory, runs[0].trajectory)
    with pytest.raises(TypeError, match="the name of a robot, its file, or a dictionary"):
        keyway.Navigator(grid, robot=3)  # type: ignore[arg-type]


def test_points_mark_and_their_sensor_clears() -> None:
    robot = Robot(np.zeros((80, 100), dtype=bool), (2.0, 4.0, 0.0))
    navigator = robot.navigator
    navigator.set_goal((8, 4))
    view = {"bearings": (-0.7, 0.7), "ranges": (0.2, 3.0)}

    def sees(*positions: tuple[float, float], **more: object) -> None:
        navigator.observe(robot.stamp, robot.pose, (0, 0), navigator.clear_scan, points=keyway.Points(positions, **{**view, **more}))  # type: ignore[arg-type]
        robot.stamp += CYCLE

    def is_straight() -> bool:
        navigator.step()
        return bool(np.ptp(navigator.route[:, 1]) < 0.1)

    box = [(1.5, 0.05 * i) for i in range(-8, 9)]
    sees(*box)
    assert not is_straight()
    # The lidar sees nothing there; a sensor of another number is not asked, and one that looks aside sees nothing.
    sees(sensor=1)
    sees(bearings=(1.0, 2.0))
    navigator.set_goal((8, 4))
    assert not is_straight()
    sees()
    navigator.set_goal((8, 4))
    assert is_straight()
    sees(*box, bearings=None, ranges=None)
    sees(bearings=None, ranges=None)
    navigator.set_goal((8, 4))
    assert not is_straight()
    navigator.forget_sensed()
    assert is_straight()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sensor": 8}, "sensor: expected a number from 0 to 7, got 8"),
        ({"bearings": (0.0, 1.0)}, "expected both or neither"),
        ({"bearings": (1.0, 0.0), "ranges": (0.1, 2.0)}, "the right and the left edge"),
        ({"bearings": (0.0, 1.0), "ranges": (2.0, 1.0)}, "the smallest and the largest range"),
        ({"mount": (0.0, math.nan, 0.0)}, "mount: expected three finite numbers"),
        ({"mount": (0.0, 1.0)}, "mount: expected \\(x, y, theta\\), got 2 numbers"),
    ],
)
def test_points_that_cannot_be_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        keyway.Points([(1.0, 0.0)], **arguments)  # type: ignore[arg-type]
