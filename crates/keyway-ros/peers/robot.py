"""A robot in rclpy: it publishes map, scan, odometry and transforms, and obeys cmd_vel. It can be told to fail."""

import math
import os
import time
from collections import deque

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage
from world import Body, Grid, room

IS_JAZZY = os.environ.get("ROS_DISTRO") == "jazzy"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)


def map_of(grid: Grid) -> OccupancyGrid:
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.resolution = grid.resolution_m
    message.info.height, message.info.width = grid.cells.shape
    message.info.origin.position.x, message.info.origin.position.y = grid.origin
    message.info.origin.orientation.w = 1.0
    message.data.frombytes(grid.cells.astype(np.int8).tobytes())
    return message


def transform(stamp, parent: str, child: str, x: float, y: float, theta: float) -> TransformStamped:
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, parent, child
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


class Robot(Body, Node):
    """A robot and its drivers."""

    def __init__(
        self, grid: Grid | None = None, at=(1.5, 1.5, 0.0), latency_s=0.0, beams=360, range_m=3.5, has_clock=False
    ) -> None:
        Node.__init__(self, "robot")
        Body.__init__(self, grid or room(), at)
        self.beams, self.range_m, self.latency_s = beams, range_m, latency_s
        self.is_lost = self.is_silent = False
        """While it is lost, nobody is told where it is; while it is silent, it makes no scan."""
        self.error_m = 0.0
        """Its localisation is wrong by this, along x."""
        self.later: deque = deque()
        self.clock_ahead_s = 0.0
        """Its clock is ahead of that of the machine by this, if it tells its own."""
        self.clocks = self.create_publisher(Clock, "/clock", 10) if has_clock else None
        self.maps = self.create_publisher(OccupancyGrid, "map", LATCHED)
        self.static = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        self.odometry = self.create_publisher(Odometry, "odom", 10)
        self.transforms = self.create_publisher(TFMessage, "/tf", 100)
        if IS_JAZZY:
            self.create_subscription(Twist, "cmd_vel", self.take, 10)
        else:
            self.create_subscription(TwistStamped, "cmd_vel", lambda message: self.take(message.twist), 10)
        self.publish_map()
        self.static.publish(TFMessage(transforms=[transform(self.now(), "base_link", "base_scan", 0.0, 0.0, 0.0)]))
        self.create_timer(0.02, self.move)
        self.create_timer(0.1, self.scan)

    def publish_map(self) -> None:
        self.maps.publish(map_of(self.grid))

    def now(self) -> Time:
        ahead = int(1e9 * self.clock_ahead_s)
        seconds, nanoseconds = divmod(time.time_ns() + ahead, 10**9)
        return Time(sec=seconds, nanosec=nanoseconds)

    def take(self, twist: Twist) -> None:
        self.obey(twist.linear.x, twist.angular.z)

    def move(self) -> None:
        self.step()
        if self.clocks is not None:
            self.clocks.publish(Clock(clock=self.now()))
        if not self.is_lost:
            self.tell()
        now = time.monotonic()
        while self.later and self.later[0][0] <= now:
            _, publisher, message = self.later.popleft()
            publisher.publish(message)

    def publish(self, publisher, message) -> None:
        """Publishes after its latency."""
        self.later.append((time.monotonic() + self.latency_s, publisher, message))

    def tell(self) -> None:
        now = self.now()
        pose = (self.x, self.y, self.theta)
        frames = [transform(now, "map", "odom", self.error_m, 0.0, 0.0), transform(now, "odom", "base_link", *pose)]
        self.publish(self.transforms, TFMessage(transforms=frames))
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = now, "odom", "base_link"
        message.twist.twist.linear.x, message.twist.twist.angular.z = self.v, self.omega
        self.publish(self.odometry, message)

    def scan(self) -> None:
        if self.is_silent:
            return
        message = LaserScan()
        message.header.stamp, message.header.frame_id = self.now(), "base_scan"
        message.range_min, message.range_max = 0.12, self.range_m
        message.angle_min = -math.pi
        message.angle_increment, ranges = self.beams_met(self.beams, self.range_m)
        message.ranges.frombytes(ranges.astype(np.float32).tobytes())
        self.publish(self.scans, message)
