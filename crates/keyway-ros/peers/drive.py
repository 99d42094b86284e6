"""Drives the robot of robot.py by the actions of keyway-ros, which must be running, and checks what comes of it."""

import math
import sys
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import ComputePathToPose, FollowPath, NavigateToPose
from rclpy.action import ActionClient
from rclpy.executors import MultiThreadedExecutor
from robot import Robot

LONGEST_S = 90.0


def pose(x: float, y: float, theta: float = 0.0) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = "map"
    message.pose.position.x, message.pose.position.y = x, y
    message.pose.orientation.z, message.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


def wait(is_over, longest_s: float = LONGEST_S) -> bool:
    end = time.monotonic() + longest_s
    while not is_over() and time.monotonic() < end:
        time.sleep(0.01)
    return is_over()


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

    def end(self):
        assert wait(self.result_later.done), "no result"
        return self.result_later.result()


class Check:
    """The checks, in their order: where the robot is after one is where it begins the next."""

    def __init__(self) -> None:
        self.robot = Robot()
        executor = MultiThreadedExecutor()
        executor.add_node(self.robot)
        threading.Thread(target=executor.spin, daemon=True).start()
        self.navigate = ActionClient(self.robot, NavigateToPose, "navigate_to_pose")
        self.compute = ActionClient(self.robot, ComputePathToPose, "compute_path_to_pose")
        self.follow = ActionClient(self.robot, FollowPath, "follow_path")
        for client in (self.navigate, self.compute, self.follow):
            assert client.wait_for_server(30), "the node does not serve its actions"
        # The map and the static transform are latched: they may take seconds.
        assert wait(lambda: self.path(pose(6.5, 1.5)).result.error_code == 0, 30), "no map after 30 s"

    def path(self, goal: PoseStamped):
        return Goal(self.compute, ComputePathToPose.Goal(goal=goal)).end()

    def is_at(self, x: float, y: float) -> bool:
        return math.hypot(self.robot.x - x, self.robot.y - y) < 0.2

    def stands(self) -> bool:
        return wait(lambda: self.robot.v == 0.0 and self.robot.omega == 0.0, 3)

    def a_path_is_computed(self) -> None:
        poses = self.path(pose(6.5, 1.5)).result.path.poses
        steps = [math.dist(*[(p.pose.position.x, p.pose.position.y) for p in pair]) for pair in zip(poses, poses[1:])]
        assert 5.0 < sum(steps) < 12.0 and max(steps) < 0.06, (sum(steps), max(steps))

    def a_goal_is_reached(self) -> None:
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(6.5, 1.5, 1.0)))
        ended = goal.end()
        assert (ended.status, ended.result.error_code) == (GoalStatus.STATUS_SUCCEEDED, 0), ended
        assert self.is_at(6.5, 1.5) and abs(self.robot.theta - 1.0) < 0.3, (self.robot.x, self.robot.y)
        left = [feedback.distance_remaining for feedback in goal.feedback]
        assert len(left) > 20 and left[0] > 5.0 and left[-1] < 0.5, left

    def a_goal_is_given_up(self) -> None:
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(1.5, 1.5)))
        time.sleep(3.0)
        assert goal.cancel() == 0 and goal.end().status == GoalStatus.STATUS_CANCELED
        assert self.stands()

    def a_goal_takes_the_place_of_another(self) -> None:
        first = Goal(self.navigate, NavigateToPose.Goal(pose=pose(1.5, 1.5)))
        time.sleep(1.0)
        second = Goal(self.navigate, NavigateToPose.Goal(pose=pose(6.5, 4.5)))
        assert first.end().status == GoalStatus.STATUS_ABORTED
        assert second.end().status == GoalStatus.STATUS_SUCCEEDED and self.is_at(6.5, 4.5)

    def a_path_is_followed(self) -> None:
        path = self.path(pose(1.5, 4.5)).result.path
        ended = Goal(self.follow, FollowPath.Goal(path=path)).end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(1.5, 4.5), ended

    def what_cannot_be_reached_has_a_number(self) -> None:
        for (x, y), code in {(60.5, 1.5): 204, (4.0, 1.5): 206}.items():
            ended = Goal(self.navigate, NavigateToPose.Goal(pose=pose(x, y))).end()
            assert (ended.status, ended.result.error_code) == (GoalStatus.STATUS_ABORTED, code), ended
            assert ended.result.error_msg

    def a_lost_robot_stands(self) -> None:
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(6.5, 4.5)))
        assert wait(lambda: self.robot.v > 0.2, 10)
        self.robot.is_lost = True
        time.sleep(1.5)
        assert self.robot.command == (0.0, 0.0), self.robot.command
        self.robot.is_lost = False
        assert goal.end().status == GoalStatus.STATUS_SUCCEEDED

    def nothing_was_touched(self) -> None:
        assert self.robot.contacts == 0, self.robot.contacts


def main() -> int:
    rclpy.init()
    check = Check()
    names = [name for name in vars(Check) if name.startswith(("a_", "what_", "nothing_"))]
    failed = 0
    for name in names:
        try:
            getattr(check, name)()
            print(f"{name} ... ok", flush=True)
        except AssertionError as error:
            failed += 1
            print(f"{name} ... FAILED: {error}", flush=True)
    print(f"{len(names) - failed} passed, {failed} failed", flush=True)
    return min(failed, 1)


if __name__ == "__main__":
    code = main()
    # The executor's thread never ends; shutting it down is not what is checked here.
    sys.stdout.flush()
    import os

    os._exit(code)
