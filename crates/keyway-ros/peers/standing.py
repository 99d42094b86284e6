"""When the robot of robot.py has to stand: late, silent and jumping sensors, new maps, clients and nodes that die."""

import signal
import subprocess
import sys
import time

import rclpy
from action_msgs.msg import GoalStatus
from nav2_msgs.action import ComputePathToPose, NavigateToPose
from peer import Checks, Goal, Keyway, begin, leave, pose, wait
from rclpy.action import ActionClient
from robot import Robot

RIGHT, LEFT = (6.5, 1.5), (1.5, 1.5)


class Standing(Checks):
    def __init__(self) -> None:
        super().__init__(Robot(), Keyway())
        self.robot.watchdog_s = 0.5
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.compute = self.client(ComputePathToPose, "compute_path_to_pose")
        self.spin()
        self.connect()

    def connect(self) -> None:
        """Waits until the node plans. A client takes one that has died for alive for a while, and waits in vain."""
        assert self.navigate.wait_for_server(30) and self.compute.wait_for_server(30)

        def plans() -> bool:
            sent = self.compute.send_goal_async(ComputePathToPose.Goal(goal=pose(*RIGHT)))
            if not wait(sent.done, 3):
                return False
            ended = sent.result().get_result_async()
            return wait(ended.done, 3) and ended.result().result.error_code == 0

        assert wait(plans, 40), "no path after 40 s"

    def far(self) -> tuple[float, float]:
        """The goal that is farther away."""
        return RIGHT if self.robot.x < 4.0 else LEFT

    def set_out(self) -> tuple[Goal, tuple[float, float]]:
        place = self.far()
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(*place)))
        assert wait(lambda: self.robot.v > 0.3, 15), "it does not set out"
        return goal, place

    def arrives(self, goal: Goal, place: tuple[float, float]) -> None:
        ended = goal.end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(*place), (ended.status, self.robot.x, self.robot.y)
        assert self.robot.contacts == 0, self.robot.contacts

    def what_is_late_is_not_driven_by(self) -> None:
        goal, place = self.set_out()
        self.robot.latency_s = 0.25
        assert wait(self.robot.stands, 3) and self.robot.command == (0.0, 0.0)
        time.sleep(1.0)
        assert self.robot.stands()
        self.robot.latency_s = 0.05
        self.arrives(goal, place)
        self.robot.latency_s = 0.0

    def what_is_silent_is_not_driven_by(self) -> None:
        goal, place = self.set_out()
        self.robot.is_silent = True
        began = time.monotonic()
        assert wait(self.robot.stands, 3), "it drives without scans"
        stood_s = time.monotonic() - began
        time.sleep(2.0)
        assert self.robot.stands() and stood_s < 2.2, stood_s
        self.robot.is_silent = False
        self.arrives(goal, place)

    def what_jumps_is_driven_on_by(self) -> None:
        goal, place = self.set_out()
        self.robot.error_m = 0.3
        time.sleep(2.0)
        self.robot.error_m = 0.0
        self.arrives(goal, place)

    def a_map_that_changes_on_the_way(self) -> None:
        goal, place = self.set_out()
        grid = self.robot.grid
        before = grid.cells
        grid.cells = before.copy()
        grid.cells[100:, 78:82] = 100
        self.robot.publish_map()
        self.arrives(goal, place)
        grid.cells = before
        self.robot.publish_map()

    def a_client_that_dies_leaves_its_goal(self) -> None:
        place = self.far()
        client = subprocess.Popen([sys.executable, __file__, "client", *map(str, place)])
        assert wait(lambda: self.robot.v > 0.3, 30), "it does not set out"
        client.kill()
        client.wait()
        assert wait(lambda: self.is_at(*place) and self.robot.stands(), 60)

    def a_node_that_is_halted_stops_its_robot(self) -> None:
        self.set_out()
        self.keyway.process.send_signal(signal.SIGSTOP)
        assert wait(self.robot.stands, 2.5), "the base has a watchdog"
        time.sleep(1.0)
        self.keyway.process.send_signal(signal.SIGCONT)
        time.sleep(3.0)
        assert self.robot.stands(), "it drives on by itself"
        self.connect()
        self.arrives(*self.set_out())

    def a_node_that_is_killed_and_comes_back(self) -> None:
        self.set_out()
        self.keyway.process.kill()
        self.keyway.process.wait()
        assert wait(self.robot.stands, 2.5), "the base has a watchdog"
        began, before = time.monotonic(), len(self.robot.commanded_at)
        self.keyway = Keyway()
        self.connect()
        goal, place = self.set_out()
        first = self.robot.commanded_at[before] - began
        print(f"    start to first command: {first:.1f} s, with a client that waits for the map", flush=True)
        self.arrives(goal, place)

    def a_node_that_ends_stops_its_robot(self) -> None:
        self.set_out()
        self.robot.watchdog_s = 60.0
        self.keyway.stop()
        assert wait(self.robot.stands, 2.5) and self.robot.command == (0.0, 0.0)

    def nothing_was_touched(self) -> None:
        assert self.robot.contacts == 0, self.robot.contacts


def send_goal(x: float, y: float) -> None:
    """A client that sends a goal and waits until it is killed."""
    node = rclpy.create_node("client")
    client = ActionClient(node, NavigateToPose, "navigate_to_pose")
    client.wait_for_server()
    client.send_goal_async(NavigateToPose.Goal(pose=pose(x, y)))
    rclpy.spin(node)


if __name__ == "__main__":
    begin()
    if sys.argv[1:2] == ["client"]:
        send_goal(*map(float, sys.argv[2:4]))
    standing = Standing()
    code = standing.run()
    standing.keyway.process.kill()
    leave(code)
