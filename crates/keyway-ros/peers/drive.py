"""Drives the robot of robot.py by the actions and services of keyway-ros, and checks what comes of it."""

import math
import time

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, PolygonStamped, PoseStamped, Twist
from lifecycle_msgs.srv import GetState
from map_msgs.msg import OccupancyGridUpdate
from nav2_msgs.action import (
    AssistedTeleop,
    BackUp,
    ComputePathThroughPoses,
    ComputePathToPose,
    ComputeRoute,
    DockRobot,
    DriveOnHeading,
    FollowPath,
    FollowWaypoints,
    NavigateThroughPoses,
    NavigateToPose,
    SmoothPath,
    Spin,
    UndockRobot,
    Wait,
)
from nav2_msgs.msg import CostmapFilterInfo
from nav2_msgs.srv import ClearEntireCostmap, GetCostmap, LoadMap, ManageLifecycleNodes
from nav_msgs.msg import OccupancyGrid, Path
from peer import Checks, Goal, Keyway, begin, leave, pose, several, wait
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.qos import qos_profile_sensor_data
from robot import IS_JAZZY, LATCHED, Robot, map_of
from visualization_msgs.msg import MarkerArray


class Drive(Checks):
    def __init__(self) -> None:
        super().__init__(Robot(), Keyway("stands_for:=[bt_navigator, map_server]"))
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.through = self.client(NavigateThroughPoses, "navigate_through_poses")
        self.stops = self.client(FollowWaypoints, "follow_waypoints")
        self.follow = self.client(FollowPath, "follow_path")
        self.turn = self.client(Spin, "spin")
        self.back_up = self.client(BackUp, "backup")
        self.ahead = self.client(DriveOnHeading, "drive_on_heading")
        self.pause = self.client(Wait, "wait")
        self.compute = self.client(ComputePathToPose, "compute_path_to_pose")
        self.compute_through = self.client(ComputePathThroughPoses, "compute_path_through_poses")
        self.smooth = self.client(SmoothPath, "smooth_path")
        refused = {"assisted_teleop": AssistedTeleop, "compute_route": ComputeRoute, "dock_robot": DockRobot, "undock_robot": UndockRobot}
        self.refused = {name: (action, self.client(action, name)) for name, action in refused.items()}
        self.spin()
        # The map and the static transform are latched: they may take seconds.
        assert wait(lambda: self.path(pose(6.5, 1.5)).result.error_code == 0, 30), "no map after 30 s"

    def path(self, goal: PoseStamped):
        return Goal(self.compute, ComputePathToPose.Goal(goal=goal)).end()

    def stands(self) -> bool:
        return wait(self.robot.stands, 3)

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
        goal.goals = several([pose(4.0, 5.0), pose(1.5, 1.5)])
        ended = Goal(self.compute_through, goal).end()
        highest = max(p.pose.position.y for p in ended.result.path.poses)
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and highest > 4.95, ended.status
        smoothed = Goal(self.smooth, SmoothPath.Goal(path=ended.result.path, check_for_collisions=True)).end()
        assert smoothed.result.was_completed and len(smoothed.result.path.poses) > 20, smoothed.result.error_msg
        goal.goals = several([])
        assert Goal(self.compute_through, goal).end().result.error_code == 309

    def a_goal_by_way_of_a_pose(self) -> None:
        goal = NavigateThroughPoses.Goal()
        goal.poses = several([pose(4.0, 5.0), pose(1.5, 4.5)])
        sent = Goal(self.through, goal)
        ended = sent.end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(1.5, 4.5), ended.result
        left = [feedback.number_of_poses_remaining for feedback in sent.feedback]
        assert left[0] == 2 and left[-1] == 1, left

    def a_stop_that_is_missed(self) -> None:
        stops = [pose(2.5, 2.0), pose(60.0, 2.0), pose(1.5, 1.5)]
        ended = Goal(self.stops, FollowWaypoints.Goal(poses=stops)).end()
        missed = [(one.index if IS_JAZZY else one.waypoint_index, one.error_code) for one in ended.result.missed_waypoints]
        assert ended.status == GoalStatus.STATUS_SUCCEEDED and self.is_at(1.5, 1.5), ended.result
        assert missed == [(1, 204)], missed

    def a_single_motion(self) -> None:
        allowance = Duration(sec=20)
        before = self.robot.theta
        ended = Goal(self.turn, Spin.Goal(target_yaw=1.57, time_allowance=allowance)).end()
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

    def what_is_not_there_is_refused(self) -> None:
        for name, (action, client) in self.refused.items():
            sent = client.send_goal_async(action.Goal())
            assert wait(sent.done, 10) and not sent.result().accepted, name

    def what_may_be_changed_is_changed(self) -> None:
        listed = self.call(ListParameters, "keyway/list_parameters", ListParameters.Request()).result.names
        assert {"robot", "max_pose_age", "use_sim_time"} <= set(listed), listed
        got = self.call(GetParameters, "keyway/get_parameters", GetParameters.Request(names=["robot", "max_pose_age"]))
        assert [got.values[0].string_value, got.values[1].double_value] == ["small", 0.2], got
        age = Parameter(name="max_pose_age", value=ParameterValue(type=3, double_value=0.3))
        robot = Parameter(name="robot", value=ParameterValue(type=4, string_value="jackal"))
        request = SetParameters.Request(parameters=[age, robot])
        results = self.call(SetParameters, "keyway/set_parameters", request).results
        assert [result.successful for result in results] == [True, False], results
        assert "start" in results[1].reason, results

    def what_it_does_is_shown(self) -> None:
        shown = {}
        topics = {
            "local_plan": Path,
            "local_costmap/costmap": OccupancyGrid,
            "global_costmap/costmap": OccupancyGrid,
            "local_costmap/published_footprint": PolygonStamped,
            "markers": MarkerArray,
            "fan": MarkerArray,
            "/diagnostics": DiagnosticArray,
        }
        listeners = [
            self.robot.create_subscription(kind, topic, lambda message, topic=topic: shown.__setitem__(topic, message), 1)
            for topic, kind in topics.items()
        ]
        goal = Goal(self.navigate, NavigateToPose.Goal(pose=pose(6.5, 1.5)))
        wait(lambda: set(topics) <= set(shown) and shown["local_plan"].poses, 20)
        assert set(topics) <= set(shown), set(topics) - set(shown)
        local, footprint = shown["local_costmap/costmap"], shown["local_costmap/published_footprint"]
        # 3 m to each side, and no more than the room.
        assert 60 < local.info.height <= 120 and max(local.data) == 100, local.info
        first = shown["local_plan"].poses[0].pose.position
        assert len(footprint.polygon.points) == 16 and self.is_at(first.x, first.y)
        states = {status.name: status.message for status in shown["/diagnostics"].status}
        assert states["keyway: driving"] == "drives", states
        assert any(len(marker.points) > 20 for marker in shown["fan"].markers)
        assert goal.end().status == GoalStatus.STATUS_SUCCEEDED
        for listener in listeners:
            self.robot.destroy_subscription(listener)

    def what_does_not_fit_is_named(self) -> None:
        said, told = [], {}
        listeners = [
            self.robot.create_subscription(Log, "/rosout", lambda message: said.append(message.msg), 10),
            self.robot.create_subscription(
                DiagnosticArray, "/diagnostics", lambda message: told.update({status.name: status for status in message.status}), 1
            ),
        ]
        # Of another kind, and with less than the node asks for.
        senders = [self.robot.create_publisher(Twist, "speed_limit", 1), self.robot.create_publisher(PoseStamped, "goal_pose", qos_profile_sensor_data)]
        faults = [
            "/goal_pose: another node sends with less reliability than the receiver requests",
            "/speed_limit: another node sends geometry_msgs/msg/Twist, but this node expects nav2_msgs/msg/SpeedLimit",
        ]
        shown = lambda: [pair.value for pair in told["keyway: topics"].values] if told else None
        assert wait(lambda: shown() == faults, 10), told
        assert set(faults) <= set(said), said
        for sender in senders:
            self.robot.destroy_publisher(sender)
        assert wait(lambda: shown() == [], 10), told
        for listener in listeners:
            self.robot.destroy_subscription(listener)

    def a_part_of_the_map_changes(self) -> None:
        # A door is closed, by an update; then the whole map is told again.
        updates = self.robot.create_publisher(OccupancyGridUpdate, "map_updates", 1)
        update = OccupancyGridUpdate(x=78, y=70, width=4, height=50, data=[100] * 200)
        update.header.frame_id = "map"
        found = []

        def is_closed() -> bool:
            # The reader may not have found the writer yet: what is published then is lost.
            updates.publish(update)
            found.append(self.path(pose(1.5, 1.5)).result.error_code)
            return found[-1] == 208

        assert wait(is_closed, 10), f"the door is not closed: {found}"
        self.robot.publish_map()
        assert wait(lambda: self.path(pose(1.5, 1.5)).result.error_code == 0, 10), "the door is not open"

    def a_mask_is_kept_to(self) -> None:
        mask = map_of(self.robot.grid)
        columns, rows = mask.info.width, mask.info.height
        mask.data = [100 if 60 < index % columns < 100 and index // columns > 95 else 0 for index in range(columns * rows)]
        info = CostmapFilterInfo(type=0, filter_mask_topic="/keepout_mask", base=0.0, multiplier=1.0)
        masks = self.robot.create_publisher(OccupancyGrid, "/keepout_mask", LATCHED)
        infos = self.robot.create_publisher(CostmapFilterInfo, "costmap_filter_info", LATCHED)
        masks.publish(mask)
        infos.publish(info)
        lowest = lambda: max((p.pose.position.y for p in self.path(pose(1.5, 1.5)).result.path.poses), default=9.0)
        assert wait(lambda: lowest() < 4.75, 15), lowest()
        masks.publish(map_of(self.robot.grid))

    def nothing_was_touched(self) -> None:
        assert self.robot.contacts == 0, self.robot.contacts


if __name__ == "__main__":
    begin()
    drive = Drive()
    leave(drive.run(), drive.keyway)
