"""Drives the robot of the node's own simulator to the goal of a scene, by its time: simulated.py [SCENE.toml]."""

import math
import sys
from pathlib import Path

import rclpy
from action_msgs.msg import GoalStatus
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Odometry
from peer import Checks, Goal, Keyway, Simulator, begin, leave, pose, wait
from rclpy.qos import qos_profile_sensor_data

HOUSE = Path(__file__).parents[2] / "keyway-cli/scenes/small_house.toml"
GOAL = (8.725, 0.875)


class Simulated(Checks):
    def __init__(self) -> None:
        super().__init__(rclpy.create_node("client"), Keyway("use_sim_time:=true"))
        self.told = None
        self.robot.create_subscription(Odometry, "odom", self.take, qos_profile_sensor_data)
        self.navigate = self.client(NavigateToPose, "navigate_to_pose")
        self.spin()

    def take(self, message: Odometry) -> None:
        self.told = message

    def place(self) -> tuple[float, float]:
        return self.told.pose.pose.position.x, self.told.pose.pose.position.y

    def a_goal_is_reached(self) -> None:
        assert wait(lambda: self.told is not None, 20), "no odometry"
        begins = lambda: Goal(self.navigate, NavigateToPose.Goal(pose=pose(*GOAL)))
        # The map is latched: it may take seconds.
        ended = begins().end()
        while ended.result.error_code == 200:
            ended = begins().end()
        assert ended.status == GoalStatus.STATUS_SUCCEEDED, ended.result
        assert math.dist(self.place(), GOAL) < 0.2, self.place()

    def what_nobody_commands_stands(self) -> None:
        assert wait(lambda: self.told.twist.twist.linear.x == 0.0, 5)


if __name__ == "__main__":
    begin()
    scene = sys.argv[1] if len(sys.argv) > 1 else str(HOUSE)
    simulator = Simulator(scene, "use_sim_time:=true", "rate:=3.0")
    simulated = Simulated()
    code = simulated.run()
    simulator.stop()
    leave(code, simulated.keyway)
