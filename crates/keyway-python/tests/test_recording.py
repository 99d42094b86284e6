"""Recordings of the flight recorder, read by the readers of others: mcap-ros2-support and rosbags."""

import json
import math
import pathlib
import subprocess
import sys
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_typestore, get_types_from_msg

#: Topics of a run, with the types of their messages.
TOPICS = {
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/odom": "nav_msgs/msg/Odometry",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/goal_pose": "geometry_msgs/msg/PoseStamped",
    "/plan": "nav_msgs/msg/Path",
    "/cmd_vel": "geometry_msgs/msg/TwistStamped",
}


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> tuple[pathlib.Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("recording")
    keyway = [sys.executable, "-m", "keyway"]
    subprocess.run([*keyway, "demo", "--out", "demo"], cwd=folder, check=True, capture_output=True)
    line = [*keyway, "navigate", "--scene", "demo/small_house.toml", "--record", "run.mcap", "--format", "json"]
    report = subprocess.run(line, cwd=folder, check=True, capture_output=True, text=True)
    return folder / "run.mcap", json.loads(report.stdout)


def test_mcap_ros2_support_reads_it(recording: tuple[pathlib.Path, dict[str, Any]]) -> None:
    path, report = recording
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary is not None
        types = {channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values() if channel.schema_id}
        assert {topic: name for topic, name in types.items() if not topic.startswith("/keyway")} == TOPICS
        messages: dict[str, list[Any]] = {}
        for _, channel, _, message in reader.iter_decoded_messages(topics=list(TOPICS)):
            messages.setdefault(channel.topic, []).append(message)
    rows = report["trajectory"]
    cycles = len(messages["/cmd_vel"])
    assert len(messages["/odom"]) == len(messages["/scan"]) == len(messages["/tf"]) == cycles
    assert abs(cycles - len(rows)) <= 1
    for odom, (t, x, y, yaw, v, omega) in zip(messages["/odom"], rows, strict=False):
        stamp = odom.header.stamp.sec + 1e-9 * odom.header.stamp.nanosec
        pose, twist = odom.pose.pose, odom.twist.twist
        assert (stamp, pose.position.x, pose.position.y) == pytest.approx((t, x, y), abs=1e-8)
        assert 2 * math.atan2(pose.orientation.z, pose.orientation.w) == pytest.approx(yaw, abs=1e-9)
        assert (twist.linear.x, twist.angular.z) == pytest.approx((v, omega), abs=1e-9)
    grid = messages["/map"][0]
    assert grid.info.width * grid.info.height == len(grid.data)
    assert set(grid.data) <= {-1, 0, 100} and grid.info.resolution == pytest.approx(0.05)
    scan = messages["/scan"][0]
    assert len(scan.ranges) == 360 and scan.angle_max - scan.angle_min == pytest.approx(2 * math.pi * 359 / 360, abs=1e-5)
    plan = messages["/plan"][0]
    goal = messages["/goal_pose"][0].pose.position
    end = plan.poses[-1].pose.position
    assert (end.x, end.y) == pytest.approx((goal.x, goal.y))


def test_rosbags_decodes_every_message(recording: tuple[pathlib.Path, dict[str, Any]]) -> None:
    path, _ = recording
    # Its own definitions, not those of the file.
    own = get_typestore(Stores.ROS2_JAZZY)
    theirs = get_typestore(Stores.EMPTY)
    counts: dict[str, int] = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages(topics=list(TOPICS)):
            assert schema is not None and channel.message_encoding == "cdr"
            if channel.topic not in counts:
                theirs.register(get_types_from_msg(schema.data.decode(), schema.name))
            typename = TOPICS[channel.topic]
            decoded = own.deserialize_cdr(message.data, typename)
            assert own.serialize_cdr(decoded, typename) == message.data
            again = theirs.deserialize_cdr(message.data, typename)
            assert theirs.serialize_cdr(again, typename) == message.data
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
    assert set(counts) == set(TOPICS)
