"""A robot in rclpy, in a room with a wall: it publishes map, scan, odometry and transforms, and obeys cmd_vel."""

import math
import time

import numpy as np
from geometry_msgs.msg import TransformStamped, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

RESOLUTION_M = 0.05
RADIUS_M = 0.18
RANGE_M = 3.5
ACCELERATION_MPS2, ANGULAR_ACCELERATION_RADPS2 = 1.0, 3.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)


def room() -> np.ndarray:
    """8 m x 6 m, with a wall in the middle that leaves 2.5 m at its end; 100 is occupied, row 0 at the bottom."""
    grid = np.zeros((120, 160), np.int8)
    grid[[0, -1], :] = grid[:, [0, -1]] = 100
    grid[:70, 78:82] = 100
    return grid


def transform(stamp, parent: str, child: str, x: float, y: float, theta: float) -> TransformStamped:
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, parent, child
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(theta / 2), math.cos(theta / 2)
    return message


class Robot(Node):
    """A disc of 0.18 m that obeys its commands within its accelerations."""

    def __init__(self) -> None:
        super().__init__("robot")
        self.grid = room()
        self.x, self.y, self.theta = 1.5, 1.5, 0.0
        self.v = self.omega = 0.0
        self.command = (0.0, 0.0)
        self.commanded_at: list[float] = []
        self.contacts = 0
        self.is_lost = False
        """While it is, nobody is told where it is."""
        self.last = time.monotonic()
        maps = self.create_publisher(OccupancyGrid, "map", LATCHED)
        static = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        self.odometry = self.create_publisher(Odometry, "odom", 10)
        self.transforms = self.create_publisher(TFMessage, "/tf", 100)
        self.create_subscription(TwistStamped, "cmd_vel", self.obey, 10)
        maps.publish(self.map())
        now = self.get_clock().now().to_msg()
        static.publish(TFMessage(transforms=[transform(now, "base_link", "base_scan", 0.0, 0.0, 0.0)]))
        self.kept = (maps, static)
        self.create_timer(0.02, self.move)
        self.create_timer(0.1, self.scan)

    def map(self) -> OccupancyGrid:
        message = OccupancyGrid()
        message.header.frame_id = "map"
        message.info.resolution = RESOLUTION_M
        message.info.height, message.info.width = self.grid.shape
        message.info.origin.orientation.w = 1.0
        message.data = self.grid.flatten().tolist()
        return message

    def obey(self, message: TwistStamped) -> None:
        self.command = (message.twist.linear.x, message.twist.angular.z)
        self.commanded_at.append(time.monotonic())

    def move(self) -> None:
        now = time.monotonic()
        passed, self.last = now - self.last, now
        change, turn = ACCELERATION_MPS2 * passed, ANGULAR_ACCELERATION_RADPS2 * passed
        self.v += min(max(self.command[0] - self.v, -change), change)
        self.omega += min(max(self.command[1] - self.omega, -turn), turn)
        self.x += self.v * math.cos(self.theta) * passed
        self.y += self.v * math.sin(self.theta) * passed
        self.theta += self.omega * passed
        self.contacts += self.touches()
        if not self.is_lost:
            self.tell()

    def touches(self) -> bool:
        rows, columns = np.nonzero(self.grid)
        dx = np.abs((columns + 0.5) * RESOLUTION_M - self.x) - 0.5 * RESOLUTION_M
        dy = np.abs((rows + 0.5) * RESOLUTION_M - self.y) - 0.5 * RESOLUTION_M
        return bool((np.hypot(dx.clip(0), dy.clip(0)) < RADIUS_M).any())

    def tell(self) -> None:
        now = self.get_clock().now().to_msg()
        pose = (self.x, self.y, self.theta)
        frames = [transform(now, "map", "odom", 0.0, 0.0, 0.0), transform(now, "odom", "base_link", *pose)]
        self.transforms.publish(TFMessage(transforms=frames))
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = now, "odom", "base_link"
        message.twist.twist.linear.x, message.twist.twist.angular.z = self.v, self.omega
        self.odometry.publish(message)

    def scan(self) -> None:
        beams = 360
        message = LaserScan()
        message.header.stamp, message.header.frame_id = self.get_clock().now().to_msg(), "base_scan"
        message.angle_min, message.angle_increment = -math.pi, 2 * math.pi / beams
        message.range_min, message.range_max = 0.12, RANGE_M
        bearings = self.theta + message.angle_min + message.angle_increment * np.arange(beams)
        ranges = np.arange(0.1, RANGE_M, 0.02)
        column = ((self.x + np.outer(np.cos(bearings), ranges)) / RESOLUTION_M).astype(int)
        row = ((self.y + np.outer(np.sin(bearings), ranges)) / RESOLUTION_M).astype(int)
        height, width = self.grid.shape
        hit = self.grid[row.clip(0, height - 1), column.clip(0, width - 1)] > 0
        met = np.where(hit.any(1), ranges[hit.argmax(1)], np.inf)
        message.ranges = met.astype(np.float32).tolist()
        self.scans.publish(message)
