"""Drives to and fro for a time: endurance.py MINUTES. At 20 Hz, on a map of 2000 x 2000 cells, with a lidar of 720 beams; how
even the commands come, by a listener in a process of its own, and what the node takes of the machine."""

import json
import signal
import subprocess
import sys
import time
from collections import Counter

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist, TwistStamped
from nav2_msgs.action import NavigateToPose
from peer import Checks, Goal, Keyway, begin, leave, pose, wait
from robot import IS_JAZZY, Robot
from world import Grid


def field() -> Grid:
    """100 m x 100 m with pillars."""
    random = np.random.default_rng(20)
    cells = np.zeros((2000, 2000), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    for x, y in random.integers(20, 1980, (1500, 2)):
        if abs(x - 1000) > 30 or abs(y - 1000) > 30:
            cells[y : y + 6, x : x + 6] = 100
    return Grid(cells, 0.05, (-50.0, -50.0))


class Endurance(Checks):
    def __init__(self) -> None:
        robot = Robot(field(), (0.0, 0.0, 0.0), latency_s=0.05, beams=720, range_m=10.0)
        super().__init__(robot, Keyway("controller_frequency:=20.0"))
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.spin()
        here = lambda: Goal(self.navigate, NavigateToPose.Goal(pose=pose(0.0, 0.0))).end().status == 4
        # The map is latched: it may take seconds.
        assert wait(here, 60), "no map after a minute"

    def measure(self, minutes: float) -> int:
        listener = subprocess.Popen([sys.executable, __file__, "listen"], stdout=subprocess.PIPE)
        random, end = np.random.default_rng(1), time.monotonic() + 60 * minutes
        reached = sent = 0
        cpu_s, at, memory = self.keyway.cpu_s(), time.monotonic(), []
        while time.monotonic() < end:
            x, y = random.uniform(-8.0, 8.0, 2)
            if self.robot.grid.touches(x, y, 0.35):
                continue
            sent += 1
            ended = Goal(self.navigate, NavigateToPose.Goal(pose=pose(x, y))).end(180)
            reached += ended.status == 4
            memory.append(self.keyway.memory_mb())
            print(f"({x:.2f}, {y:.2f}) ... {'ok' if ended.status == 4 else ended.result.error_msg}", flush=True)
        share = (self.keyway.cpu_s() - cpu_s) / (time.monotonic() - at)
        listener.send_signal(signal.SIGTERM)
        heard = json.loads(listener.communicate(timeout=20)[0])
        periods = np.diff(heard["commanded_at"])
        # Between two goals there are none.
        periods = periods[periods < 0.5]
        middle, late, most = np.percentile(periods, [50, 99, 100])
        print(f"{reached} of {sent} goals, {self.robot.contacts} contacts")
        print(f"period {1e3 * middle:.1f} ms, p99 {1e3 * late:.1f} ms, longest {1e3 * most:.1f} ms, of {len(periods)}")
        print(f"{100 * share:.1f} % of a core, {memory[0]:.1f} MB after the first goal, {memory[-1]:.1f} MB after the last")
        for said, seconds in heard["said"].items():
            print(f"    {seconds} s: {said}", flush=True)
        return int(self.robot.contacts > 0)


def listen() -> None:
    """Until it is told to end: when commands come, and what the node says of itself."""
    node, commanded_at, said = rclpy.create_node("listener"), [], Counter()
    # As bytes: what is in them does not matter.
    kind = Twist if IS_JAZZY else TwistStamped
    node.create_subscription(kind, "cmd_vel", lambda _: commanded_at.append(time.monotonic()), 10, raw=True)

    def hear(message: DiagnosticArray) -> None:
        for status in message.status:
            # Numbers change from one to the next.
            said["".join(letter for letter in status.message if not letter.isdigit())] += 1
            for value in status.values:
                if value.key == "doubt":
                    said["doubt: " + value.value] += 1

    node.create_subscription(DiagnosticArray, "/diagnostics", hear, 10)
    signal.signal(signal.SIGTERM, lambda *_: rclpy.shutdown())
    try:
        rclpy.spin(node)
    except Exception:
        # Its context has ended.
        pass
    print(json.dumps({"commanded_at": commanded_at, "said": said}), flush=True)


if __name__ == "__main__":
    begin()
    if sys.argv[1] == "listen":
        listen()
        sys.exit()
    endurance = Endurance()
    leave(endurance.measure(float(sys.argv[1])), endurance.keyway)
