"""A robot in rclpy: it publishes map, scan, odometry and transforms, and obeys cmd_vel. It can be told to fail."""

import math
import os
import time
from collections import deque
from dataclasses import dataclass

import numpy as np
from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

RADIUS_M = 0.18
ACCELERATION_MPS2, ANGULAR_ACCELERATION_RADPS2 = 1.0, 3.0
IS_JAZZY = os.environ.get("ROS_DISTRO") == "jazzy"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)


@dataclass
class Grid:
    """Cells, row 0 at the bottom; 100 is occupied, -1 unknown. Its origin is that of the map."""

    cells: np.ndarray
    resolution_m: float
    origin: tuple[float, float] = (0.0, 0.0)

    def index(self, x, y):
        """Row and column of places, on the grid."""
        height, width = self.cells.shape
        column = np.floor((x - self.origin[0]) / self.resolution_m).astype(int)
        row = np.floor((y - self.origin[1]) / self.resolution_m).astype(int)
        return row.clip(0, height - 1), column.clip(0, width - 1)

    def touches(self, x: float, y: float, radius_m: float) -> bool:
        """Whether a disc touches an occupied cell."""
        reach = math.ceil(radius_m / self.resolution_m) + 1
        row, column = (int(value) for value in self.index(np.float64(x), np.float64(y)))
        low, left = max(row - reach, 0), max(column - reach, 0)
        near = self.cells[low : row + reach + 1, left : column + reach + 1]
        rows, columns = np.nonzero(near == 100)
        half = 0.5 * self.resolution_m
        dx = np.abs((columns + left + 0.5) * self.resolution_m + self.origin[0] - x) - half
        dy = np.abs((rows + low + 0.5) * self.resolution_m + self.origin[1] - y) - half
        return bool((np.hypot(dx.clip(0), dy.clip(0)) < radius_m).any())

    def message(self) -> OccupancyGrid:
        message = OccupancyGrid()
        message.header.frame_id = "map"
        message.info.resolution = self.resolution_m
        message.info.height, message.info.width = self.cells.shape
        message.info.origin.position.x, message.info.origin.position.y = self.origin
        message.info.origin.orientation.w = 1.0
        message.data.frombytes(self.cells.astype(np.int8).tobytes())
        return message


def room() -> Grid:
    """8 m x 6 m, with a wall in the middle that leaves 2.5 m at its end."""
    cells = np.zeros((120, 160), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:70, 78:82] = 100
    return Grid(cells, 0.05)


def transform(stamp, parent: str, child: str, x: float, y: float, theta: float) -> TransformStamped:
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, parent, child
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


class Robot(Node):
    """A disc of 0.18 m that obeys its commands within its accelerations."""

    def __init__(self, grid: Grid | None = None, at=(1.5, 1.5, 0.0), latency_s: float = 0.0, beams: int = 360, range_m: float = 3.5) -> None:
        super().__init__("robot")
        self.grid = grid or room()
        self.beams, self.range_m, self.latency_s = beams, range_m, latency_s
        self.x, self.y, self.theta = at
        self.v = self.omega = 0.0
        self.command = (0.0, 0.0)
        self.commanded_at: list[float] = []
        self.contacts = 0
        self.is_lost = self.is_silent = False
        """While it is lost, nobody is told where it is; while it is silent, it makes no scan."""
        self.error_m = 0.0
        """Its localisation is wrong by this, along x."""
        self.watchdog_s = math.inf
        """It stops when no command has come for so long."""
        self.later: deque = deque()
        self.last = time.monotonic()
        self.maps = self.create_publisher(OccupancyGrid, "map", LATCHED)
        self.static = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        self.odometry = self.create_publisher(Odometry, "odom", 10)
        self.transforms = self.create_publisher(TFMessage, "/tf", 100)
        if IS_JAZZY:
            self.create_subscription(Twist, "cmd_vel", self.obey, 10)
        else:
            self.create_subscription(TwistStamped, "cmd_vel", lambda message: self.obey(message.twist), 10)
        self.maps.publish(self.grid.message())
        now = self.get_clock().now().to_msg()
        self.static.publish(TFMessage(transforms=[transform(now, "base_link", "base_scan", 0.0, 0.0, 0.0)]))
        self.create_timer(0.02, self.move)
        self.create_timer(0.1, self.scan)

    def obey(self, twist: Twist) -> None:
        self.command = (twist.linear.x, twist.angular.z)
        self.commanded_at.append(time.monotonic())

    def stands(self) -> bool:
        return self.v == 0.0 and self.omega == 0.0

    def move(self) -> None:
        now = time.monotonic()
        passed, self.last = now - self.last, now
        if self.commanded_at and now - self.commanded_at[-1] > self.watchdog_s:
            self.command = (0.0, 0.0)
        change, turn = ACCELERATION_MPS2 * passed, ANGULAR_ACCELERATION_RADPS2 * passed
        self.v += min(max(self.command[0] - self.v, -change), change)
        self.omega += min(max(self.command[1] - self.omega, -turn), turn)
        self.x += self.v * math.cos(self.theta) * passed
        self.y += self.v * math.sin(self.theta) * passed
        self.theta += self.omega * passed
        self.contacts += self.grid.touches(self.x, self.y, RADIUS_M)
        if not self.is_lost:
            self.tell()
        while self.later and self.later[0][0] <= now:
            _, publisher, message = self.later.popleft()
            publisher.publish(message)

    def publish(self, publisher, message) -> None:
        """Publishes after its latency."""
        self.later.append((time.monotonic() + self.latency_s, publisher, message))

    def tell(self) -> None:
        now = self.get_clock().now().to_msg()
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
        message.header.stamp, message.header.frame_id = self.get_clock().now().to_msg(), "base_scan"
        message.angle_min, message.angle_increment = -math.pi, 2 * math.pi / self.beams
        message.range_min, message.range_max = 0.12, self.range_m
        bearings = self.theta + message.angle_min + message.angle_increment * np.arange(self.beams)
        ranges = np.arange(0.1, self.range_m, 0.02)
        row, column = self.grid.index(
            self.x + np.outer(np.cos(bearings), ranges), self.y + np.outer(np.sin(bearings), ranges)
        )
        hit = self.grid.cells[row, column] == 100
        met = np.where(hit.any(1), ranges[hit.argmax(1)], np.inf)
        message.ranges.frombytes(met.astype(np.float32).tobytes())
        self.publish(self.scans, message)
