"""A robot with the DDS of another vendor, Cyclone, and without ROS: all topics that a robot needs. Of actions only its rmw knows how they
are laid out, and that is in no registry."""

import math
import os
import signal
import subprocess
import time

from cyclone_messages import (
    Header,
    LaserScan,
    MapMetaData,
    OccupancyGrid,
    Odometry,
    Path,
    Pose,
    PoseStamped,
    Quaternion,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    TwistStamped,
    Vector3,
)
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from world import Body, room

BEAMS, RANGE_M = 360, 3.5
RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
ORDINARY = Qos(RELIABLE, Policy.History.KeepLast(10))
LATCHED = Qos(RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
LONGEST_S = 60.0


def header(frame: str) -> Header:
    seconds, nanoseconds = divmod(time.time_ns(), 10**9)
    return Header(Time(seconds, nanoseconds), frame)


def turned(theta: float) -> Quaternion:
    return Quaternion(0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2))


def transform(parent: str, child: str, x: float, y: float, theta: float) -> TransformStamped:
    return TransformStamped(header(parent), child, Transform(Vector3(x, y, 0.0), turned(theta)))


class Robot(Body):
    """A robot and its drivers."""

    def __init__(self) -> None:
        super().__init__(room(), (1.5, 1.5, 0.0))
        self.participant = DomainParticipant(0)
        self.scans = self.writer("scan", LaserScan)
        self.odometry = self.writer("odom", Odometry)
        self.transforms = self.writer("tf", TFMessage)
        self.goals = self.writer("goal_pose", PoseStamped)
        self.maps = self.writer("map", OccupancyGrid, LATCHED)
        self.static = self.writer("tf_static", TFMessage, LATCHED)
        self.commands = self.reader("cmd_vel", TwistStamped)
        self.plans = self.reader("plan", Path)
        self.costmaps = self.reader("local_costmap/costmap", OccupancyGrid)
        self.static.write(TFMessage([transform("base_link", "base_scan", 0.0, 0.0, 0.0)]))
        height, width = self.grid.cells.shape
        info = MapMetaData(Time(), self.grid.resolution_m, width, height, Pose())
        self.maps.write(OccupancyGrid(header("map"), info, self.grid.cells.flatten().tolist()))
        self.cycles = 0

    def writer(self, topic: str, kind: type, qos: Qos = ORDINARY) -> DataWriter:
        return DataWriter(self.participant, Topic(self.participant, f"rt/{topic}", kind, qos=qos), qos=qos)

    def reader(self, topic: str, kind: type) -> DataReader:
        return DataReader(self.participant, Topic(self.participant, f"rt/{topic}", kind, qos=ORDINARY), qos=ORDINARY)

    def cycle(self) -> None:
        """A fiftieth of a second."""
        for command in self.commands.take(10):
            self.obey(command.twist.linear.x, command.twist.angular.z)
        self.step()
        frames = [transform("map", "odom", 0.0, 0.0, 0.0), transform("odom", "base_link", self.x, self.y, self.theta)]
        self.transforms.write(TFMessage(frames))
        told = Odometry(header("odom"), "base_link")
        told.twist.twist.linear.x, told.twist.twist.angular.z = self.v, self.omega
        self.odometry.write(told)
        if self.cycles % 5 == 0:
            step, ranges = self.beams_met(BEAMS, RANGE_M)
            scan = LaserScan(header("base_scan"), -math.pi, math.pi, step, 0.0, 0.0, 0.12, RANGE_M, ranges.tolist())
            self.scans.write(scan)
        self.cycles += 1
        time.sleep(0.02)

    def drives_to(self, x: float, y: float) -> bool:
        """Whether it comes to a goal, and stands there, in time."""
        goal = PoseStamped(header("map"), Pose(Vector3(x, y, 0.0), turned(0.0)))
        end, has_set_out, stood = time.monotonic() + LONGEST_S, False, 0
        while time.monotonic() < end:
            # Until it moves, nobody may have received the goal, or the map.
            if not has_set_out and self.cycles % 50 == 0:
                self.goals.write(goal)
            self.cycle()
            has_set_out |= not self.stands()
            # It may stand for a moment before it turns to the goal's heading.
            stood = stood + 1 if self.stands() else 0
            if math.hypot(self.x - x, self.y - y) < 0.2 and stood == 50:
                return True
        return False


def main() -> int:
    robot = Robot()
    keyway = subprocess.Popen([os.environ["KEYWAY_NODE"], "--ros-args", "-p", "robot:=small"])
    faults = []
    for x, y in ((6.5, 1.5), (1.5, 4.5)):
        began = time.monotonic()
        if not robot.drives_to(x, y):
            faults.append(f"({x}, {y}) is not reached")
        plans, costmaps = robot.plans.take(10), robot.costmaps.take(10)
        if not plans or not plans[-1].poses or not costmaps or max(costmaps[-1].data) != 100:
            faults.append(f"{len(plans)} plans and {len(costmaps)} costmaps came")
        print(f"({x}, {y}) in {time.monotonic() - began:.1f} s, {len(plans)} plans, {len(costmaps)} costmaps", flush=True)
    if robot.contacts:
        faults.append(f"{robot.contacts} contacts")
    keyway.send_signal(signal.SIGINT)
    keyway.wait(10)
    print("\n".join(faults) or "2 goals reached, no contact")
    return min(len(faults), 1)


if __name__ == "__main__":
    raise SystemExit(main())
