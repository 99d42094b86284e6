"""What the tests share: the node as a process, goals, and waiting."""

import math
import os
import signal
import subprocess
import sys
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import ComputePathToPose, NavigateToPose
from rclpy.action import ActionClient
from rclpy.executors import MultiThreadedExecutor
from robot import IS_JAZZY, Robot

LONGEST_S = 90.0


def pose(x: float, y: float, theta: float = 0.0) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = "map"
    message.pose.position.x, message.pose.position.y = float(x), float(y)
    message.pose.orientation.z, message.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


def several(poses: list[PoseStamped]):
    """Poses as goals have them: Kilted has a message of its own for them."""
    if IS_JAZZY:
        return poses
    from nav_msgs.msg import Goals

    return Goals(goals=poses)


def wait(is_over, longest_s: float = LONGEST_S) -> bool:
    end = time.monotonic() + longest_s
    while not is_over() and time.monotonic() < end:
        time.sleep(0.01)
    return is_over()


class Keyway:
    """The node, as a process."""

    def __init__(self, *arguments: str, robot: str = "small", start=subprocess.Popen) -> None:
        program = os.environ["KEYWAY_NODE"]
        given = [argument for parameter in (f"robot:={robot}", *arguments) for argument in ("-p", parameter)]
        self.process = start([program, "--ros-args", *given])

    def cpu_s(self) -> float:
        with open(f"/proc/{self.process.pid}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_mb(self) -> float:
        with open(f"/proc/{self.process.pid}/status") as file:
            return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1024

    def stop(self) -> None:
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise


class Simulator(Keyway):
    """The simulator of the node, as a process."""

    def __init__(self, scene: str, *arguments: str) -> None:
        given = [argument for parameter in arguments for argument in ("-p", parameter)]
        self.process = subprocess.Popen([os.environ["KEYWAY_NODE"], "sim", scene, "--ros-args", *given])


class Goal:
    """A goal that was sent to an action."""

    def __init__(self, client: ActionClient, goal) -> None:
        self.feedback: list = []
        sent = client.send_goal_async(goal, feedback_callback=lambda message: self.feedback.append(message.feedback))
        assert wait(sent.done, 20), "no answer to a goal"
        self.handle = sent.result()
        assert self.handle.accepted
        self.result_later = self.handle.get_result_async()

    def cancel(self) -> int:
        answered = self.handle.cancel_goal_async()
        assert wait(answered.done, 10), "no answer to a cancellation"
        return answered.result().return_code

    def end(self, longest_s: float = LONGEST_S):
        assert wait(self.result_later.done, longest_s), "no result"
        return self.result_later.result()


class Checks:
    """A robot, the node, and checks in the order of their definition: where the robot is after one is where it begins the next."""

    def __init__(self, robot: Robot, keyway: Keyway) -> None:
        self.robot, self.keyway = robot, keyway

    def spin(self) -> None:
        """Lets the robot live. Clients of actions must be there before: an executor may meet them half made."""
        executor = MultiThreadedExecutor()
        executor.add_node(self.robot)
        threading.Thread(target=executor.spin, daemon=True).start()

    def client(self, action, name: str) -> ActionClient:
        client = ActionClient(self.robot, action, name)
        assert client.wait_for_server(30), f"the node does not serve {name}"
        return client

    def call(self, service, name: str, request):
        client = self.robot.create_client(service, name)
        assert client.wait_for_service(20), f"the node does not serve {name}"
        answered = client.call_async(request)
        assert wait(answered.done, 20), f"no answer of {name}"
        return answered.result()

    def is_at(self, x: float, y: float) -> bool:
        return math.hypot(self.robot.x - x, self.robot.y - y) < 0.2

    def run(self) -> int:
        names = [name for kind in type(self).__mro__ for name in vars(kind) if name.startswith(("a_", "what_", "nothing_", "who_"))]
        failed = 0
        for name in names:
            try:
                getattr(self, name)()
                print(f"{name} ... ok", flush=True)
            except AssertionError as error:
                failed += 1
                print(f"{name} ... FAILED: {error}", flush=True)
        print(f"{len(names) - failed} passed, {failed} failed", flush=True)
        return min(failed, 1)


class ToAndFro(Checks):
    """Checks of a robot that drives from one side of the room to the other."""

    RIGHT, LEFT = (6.5, 1.5), (1.5, 1.5)

    def __init__(self, robot: Robot, keyway: Keyway) -> None:
        super().__init__(robot, keyway)
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.compute = self.client(ComputePathToPose, "compute_path_to_pose")
        self.spin()
        self.connect()

    def connect(self) -> None:
        """Waits until the node plans. A client takes one that has died for alive for a while, and waits in vain."""
        assert self.navigate.wait_for_server(30) and self.compute.wait_for_server(30)

        def plans() -> bool:
            sent = self.compute.send_goal_async(ComputePathToPose.Goal(goal=pose(*self.RIGHT)))
            if not wait(sent.done, 3):
                return False
            ended = sent.result().get_result_async()
            return wait(ended.done, 3) and ended.result().result.error_code == 0

        assert wait(plans, 40), "no path after 40 s"

    def far(self) -> tuple[float, float]:
        """The goal that is farther away."""
        return self.RIGHT if self.robot.x < 4.0 else self.LEFT

    def set_out(self) -> tuple[Goal, tuple[float, float]]:
        place = self.far()
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(*place)))
        assert wait(lambda: self.robot.v > 0.3, 15), "it does not set out"
        return goal, place

    def arrives(self, goal: Goal, place: tuple[float, float]) -> None:
        ended = goal.end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(*place), (ended.status, self.robot.x, self.robot.y)
        assert self.robot.contacts == 0, self.robot.contacts

    def nothing_was_touched(self) -> None:
        assert self.robot.contacts == 0, self.robot.contacts


def leave(code: int, keyway: Keyway | None = None) -> None:
    """Ends the program: the executor's thread never ends, and its end is not what is checked here."""
    if keyway is not None:
        keyway.stop()
    sys.stdout.flush()
    os._exit(code)


def begin() -> None:
    rclpy.init()
