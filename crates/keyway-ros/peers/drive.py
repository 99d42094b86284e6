"""Drives the robot of robot.py by the actions of keyway-ros, which must be running, and checks what comes of it."""

import math
import sys
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, PoseStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs.action import (
    BackUp,
    ComputePathThroughPoses,
    ComputePathToPose,
    DriveOnHeading,
    FollowPath,
    FollowWaypoints,
    NavigateThroughPoses,
    NavigateToPose,
    SmoothPath,
    Spin,
    Wait,
)
from nav2_msgs.srv import ClearEntireCostmap, GetCostmap, LoadMap, ManageLifecycleNodes
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
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.through = self.client(NavigateThroughPoses, "navigate_through_poses")
        self.stops = self.client(FollowWaypoints, "follow_waypoints")
        self.follow = self.client(FollowPath, "follow_path")
        self.spin = self.client(Spin, "spin")
        self.back_up = self.client(BackUp, "backup")
        self.ahead = self.client(DriveOnHeading, "drive_on_heading")
        self.pause = self.client(Wait, "wait")
        self.compute = self.client(ComputePathToPose, "compute_path_to_pose")
        self.compute_through = self.client(ComputePathThroughPoses, "compute_path_through_poses")
        self.smooth = self.client(SmoothPath, "smooth_path")
        # The map and the static transform are latched: they may take seconds.
        assert wait(lambda: self.path(pose(6.5, 1.5)).result.error_code == 0, 30), "no map after 30 s"

    def client(self, action, name: str) -> ActionClient:
        client = ActionClient(self.robot, action, name)
        assert client.wait_for_server(30), f"the node does not serve {name}"
        return client

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

    def a_path_by_way_of_a_pose(self) -> None:
        goal = ComputePathThroughPoses.Goal()
        goal.goals.goals = [pose(4.0, 5.0), pose(1.5, 1.5)]
        ended = Goal(self.compute_through, goal).end()
        highest = max(p.pose.position.y for p in ended.result.path.poses)
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and highest > 4.95, ended.status
        smoothed = Goal(self.smooth, SmoothPath.Goal(path=ended.result.path, check_for_collisions=True)).end()
        assert smoothed.result.was_completed and len(smoothed.result.path.poses) > 20, smoothed.result.error_msg
        goal.goals.goals = []
        assert Goal(self.compute_through, goal).end().result.error_code == 309

    def a_goal_by_way_of_a_pose(self) -> None:
        goal = NavigateThroughPoses.Goal()
        goal.poses.goals = [pose(4.0, 5.0), pose(1.5, 4.5)]
        sent = Goal(self.through, goal)
        ended = sent.end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(1.5, 4.5), ended.result
        left = [feedback.number_of_poses_remaining for feedback in sent.feedback]
        assert left[0] == 2 and left[-1] == 1, left

    def a_stop_that_is_missed(self) -> None:
        stops = [pose(2.5, 2.0), pose(60.0, 2.0), pose(1.5, 1.5)]
        ended = Goal(self.stops, FollowWaypoints.Goal(poses=stops)).end()
        missed = [(status.waypoint_index, status.error_code) for status in ended.result.missed_waypoints]
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(1.5, 1.5), ended.result
        assert missed == [(1, 204)], missed

    def a_single_motion(self) -> None:
        allowance = Duration(sec=20)
        before = self.robot.theta
        ended = Goal(self.spin, Spin.Goal(target_yaw=1.57, time_allowance=allowance)).end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and abs(self.robot.theta - before - 1.57) < 0.1
        x, y = self.robot.x, self.robot.y
        goal = DriveOnHeading.Goal(target=Point(x=0.4), speed=0.2, time_allowance=allowance)
        ended = Goal(self.ahead, goal).end()
        driven = math.hypot(self.robot.x - x, self.robot.y - y)
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and abs(driven - 0.4) < 0.05, driven
        # This robot has no reverse gear.
        ended = Goal(self.back_up, BackUp.Goal(target=Point(x=0.2), speed=0.1, time_allowance=allowance)).end()
        assert (ended.status, ended.result.error_code) == (GoalStatus.STATUS_ABORTED, 713), ended.result
        began = time.monotonic()
        ended = Goal(self.pause, Wait.Goal(time=Duration(sec=1))).end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and 0.9 < time.monotonic() - began < 2.0

    def call(self, service, name: str, request):
        client = self.robot.create_client(service, name)
        assert client.wait_for_service(20), f"the node does not serve {name}"
        answered = client.call_async(request)
        assert wait(answered.done, 20), f"no answer of {name}"
        return answered.result()

    def a_service_is_answered(self) -> None:
        state = self.call(GetState, "bt_navigator/get_state", GetState.Request()).current_state
        assert (state.id, state.label) == (3, "active"), state
        costmap = self.call(GetCostmap, "global_costmap/get_costmap", GetCostmap.Request()).map
        assert (costmap.metadata.size_x, costmap.metadata.size_y) == (160, 120), costmap.metadata
        assert costmap.data[0] == 254 and costmap.data[60 * 160 + 20] == 0
        self.call(ClearEntireCostmap, "local_costmap/clear_entirely_local_costmap", ClearEntireCostmap.Request())
        loaded = self.call(LoadMap, "map_server/load_map", LoadMap.Request(map_url="/nowhere.yaml"))
        assert loaded.result == 1, loaded.result

    def a_node_is_stopped_and_started(self) -> None:
        manage = "lifecycle_manager_navigation/manage_nodes"
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(6.5, 4.5)))
        assert wait(lambda: self.robot.v > 0.1, 10)
        assert self.call(ManageLifecycleNodes, manage, ManageLifecycleNodes.Request(command=4)).success
        assert goal.end().status == GoalStatus.STATUS_ABORTED and self.stands()
        assert self.call(ManageLifecycleNodes, manage, ManageLifecycleNodes.Request(command=0)).success
        ended = Goal(self.navigate, NavigateToPose.Goal(pose=pose(2.5, 2.0))).end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED, ended.result

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
