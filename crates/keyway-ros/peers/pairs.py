"""Drives from place to place on a map: pairs.py MAP.yaml COUNT [robot_navigator.py]. With the file of Nav2's BasicNavigator
by that, as it is; without it by a client that makes the same calls. Sensors and transforms are 50 ms late."""

import importlib.util
import math
import sys
import threading
import time
from pathlib import Path

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseWithCovarianceStamped
from lifecycle_msgs.srv import GetState
from maps import places, read_map
from nav2_msgs.action import NavigateToPose
from peer import Checks, Goal, Keyway, begin, leave, pose, wait
from rclpy.executors import SingleThreadedExecutor
from robot import IS_JAZZY, LATCHED, Robot

LATE_S = 0.05
LONGEST_S = 120.0


class Client(Checks):
    """A client of our own."""

    def __init__(self, robot: Robot, keyway: Keyway) -> None:
        super().__init__(robot, keyway)
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.spin()
        for node in ("bt_navigator", "amcl"):
            is_active = lambda: self.call(GetState, f"{node}/get_state", GetState.Request()).current_state.id == 3
            assert wait(is_active, 30), f"{node} is not active"

    def drive(self, x: float, y: float, theta: float) -> str:
        ended = Goal(self.navigate, NavigateToPose.Goal(pose=pose(x, y, theta))).end(LONGEST_S)
        return "" if ended.status == GoalStatus.STATUS_SUCCEEDED else f"{ended.status} {ended.result}"


class BasicNavigator:
    """That of Nav2, as it is."""

    def __init__(self, path: str, robot: Robot) -> None:
        poses = robot.create_publisher(PoseWithCovarianceStamped, "amcl_pose", LATCHED)
        robot.create_subscription(PoseWithCovarianceStamped, "initialpose", poses.publish, 10)
        executor = SingleThreadedExecutor()
        executor.add_node(robot)
        threading.Thread(target=executor.spin, daemon=True).start()
        spec = importlib.util.spec_from_file_location("robot_navigator", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        self.succeeded = module.TaskResult.SUCCEEDED
        self.navigator = module.BasicNavigator()
        self.navigator.setInitialPose(pose(robot.x, robot.y, robot.theta))
        self.navigator.waitUntilNav2Active()

    def drive(self, x: float, y: float, theta: float) -> str:
        self.navigator.goToPose(pose(x, y, theta))
        return self.end()

    def end(self) -> str:
        end = time.monotonic() + LONGEST_S
        told = 0
        while not self.navigator.isTaskComplete():
            told += self.navigator.getFeedback() is not None
            if time.monotonic() > end:
                self.navigator.cancelTask()
                return "it takes too long"
        result = self.navigator.getResult()
        return "" if result == self.succeeded and told else f"{result}, {told} times told how far it is"

    def other_calls(self, robot: Robot) -> None:
        """Each of the other calls that it has, once."""
        navigator, here = self.navigator, pose(robot.x, robot.y, robot.theta)
        there = pose(*self.last, 0.0)
        path = navigator.getPath(here, there)
        assert path is not None and len(path.poses) > 10
        assert len(navigator.getPathThroughPoses(here, [there, here]).poses) > len(path.poses)
        assert len(navigator.smoothPath(path).poses) > 10
        navigator.followPath(path)
        assert self.end() == "", "followPath"
        if IS_JAZZY:
            # That of Kilted takes neither the list that its own signature asks for, nor the message.
            navigator.goThroughPoses([here, there])
            assert self.end() == "", "goThroughPoses"
        navigator.followWaypoints([here])
        assert self.end() == "", "followWaypoints"
        navigator.spin(1.57, 20)
        assert self.end() == "", "spin"
        navigator.driveOnHeading(0.1, 0.1, 20)
        assert self.end() == "", "driveOnHeading"
        navigator.backup(0.1, 0.1, 20)
        assert self.end() != "", "it has no reverse gear"
        navigator.goToPose(there)
        time.sleep(2.0)
        navigator.cancelTask()
        assert "CANCELED" in str(self.end()), "cancelTask"
        navigator.clearAllCostmaps()
        assert navigator.getGlobalCostmap().data and navigator.getLocalCostmap().data
        try:
            navigator.dockRobotByID("nowhere")
        except AttributeError as error:
            # Refused: of that Kilted's file tells by the name of a constant that does not exist.
            assert "UNKNOWN" in str(error), error

    @property
    def last(self) -> tuple[float, float]:
        return self.places[-1]


def main() -> int:
    path, count = Path(sys.argv[1]), int(sys.argv[2])
    grid = read_map(path)
    ways = places(grid, 0.35, count + 1, 3.0, 8.0, seed=45)
    robot = Robot(grid, (*ways[0], 0.0), latency_s=LATE_S)
    keyway = Keyway("stands_for:=[bt_navigator, amcl, map_server]")
    client = BasicNavigator(sys.argv[3], robot) if len(sys.argv) > 3 else Client(robot, keyway)
    reached = 0
    for number, (x, y) in enumerate(ways[1:]):
        theta = math.remainder(2.4 * number, math.tau)
        began = time.monotonic()
        fault = client.drive(x, y, theta)
        off_m = math.hypot(robot.x - x, robot.y - y)
        if not fault and off_m > 0.2:
            fault = f"{off_m:.2f} m from the goal"
        reached += not fault
        print(f"({x:.2f}, {y:.2f}) in {time.monotonic() - began:.1f} s ... {fault or 'ok'}", flush=True)
    print(f"{reached} of {count} reached, {robot.contacts} contacts", flush=True)
    failed = reached < count or robot.contacts > 0
    if isinstance(client, BasicNavigator):
        client.places = ways[:-1]
        try:
            client.other_calls(robot)
            print("other calls ... ok", flush=True)
        except AssertionError as error:
            failed = True
            print(f"other calls ... FAILED: {error}", flush=True)
    leave(int(failed), keyway)


if __name__ == "__main__":
    begin()
    main()
