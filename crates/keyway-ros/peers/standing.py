"""When the robot of robot.py has to stand: late, silent and jumping sensors, new maps, clients and nodes that die."""

import signal
import subprocess
import sys
import time

import rclpy
from nav2_msgs.action import NavigateToPose
from peer import Keyway, ToAndFro, begin, leave, pose, wait
from rclpy.action import ActionClient
from robot import Robot


class Standing(ToAndFro):
    def __init__(self) -> None:
        super().__init__(Robot(), Keyway())
        self.robot.watchdog_s = 0.5

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

    def a_node_whose_terminal_ends_stops_its_robot(self) -> None:
        self.robot.watchdog_s = 60.0
        self.set_out()
        self.keyway.process.send_signal(signal.SIGHUP)
        assert self.keyway.process.wait(10) == 0
        assert wait(self.robot.stands, 2.5) and self.robot.command == (0.0, 0.0)
        self.keyway = Keyway()
        self.connect()

    def a_node_that_ends_stops_its_robot(self) -> None:
        self.set_out()
        self.keyway.stop()
        assert wait(self.robot.stands, 2.5) and self.robot.command == (0.0, 0.0)


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
