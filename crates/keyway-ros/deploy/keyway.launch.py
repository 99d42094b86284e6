"""Starts keyway-ros: ros2 launch keyway.launch.py robot:=waffle, or params_file:=nav2_params.yaml.

If the program is not on the PATH, give its path as program:=/path/to/keyway-ros."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

ARGUMENTS = {
    "program": ("keyway-ros", "path of the program"),
    "robot": ("", "name of a bundled robot, or a robot file"),
    "params_file": ("", "parameter file, of this node or of Nav2"),
    "namespace": ("", "namespace, with its slash"),
    "use_sim_time": ("false", "take the time from /clock"),
}


def start(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    arguments = ["-p", f"use_sim_time:={given['use_sim_time']}"]
    if given["params_file"]:
        arguments += ["--params-file", given["params_file"]]
    if given["robot"]:
        arguments += ["-p", f"robot:={given['robot']}"]
    if given["namespace"]:
        arguments += ["-r", f"__ns:={given['namespace']}"]
    # Restarts after an unexpected end.
    return [ExecuteProcess(cmd=[given["program"], "--ros-args", *arguments], output="screen", respawn=True, respawn_delay=1.0, respawn_max_retries=10)]


def generate_launch_description():
    declared = [DeclareLaunchArgument(name, default_value=value, description=what) for name, (value, what) in ARGUMENTS.items()]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
