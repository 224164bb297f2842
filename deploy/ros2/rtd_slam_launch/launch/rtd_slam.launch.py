# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Starts RTD-SLAM with topics of a camera driver, a recording or its own camera, and RViz if wanted.

    ros2 launch rtd_slam_launch rtd_slam.launch.py color:=/camera/color/image_raw depth:=/camera/depth/image_raw
    ros2 launch rtd_slam_launch rtd_slam.launch.py source:=mcap:/data/office.mcap rviz:=true

The services keep their own names of topics: a namespace becomes --robot, topics that they read become options.
"""

import os
import tempfile

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration

# Each argument: default, what it means, and the option of `rtd run` that it becomes; None: used below.
ARGUMENTS = {
    'source': ('', 'where frames come from, as --source of rtd run; empty: the topics color, depth and info', None),
    'color': ('/camera/color/image_raw', 'topic of the colour image', None),
    'depth': ('/camera/aligned_depth_to_color/image_raw', 'topic of the depth image', None),
    'info': ('', 'topic of the calibration; empty: camera_info next to the colour image', None),
    'remappings': ('', 'FROM:=TO, separated by blanks, for color, depth, info, imu and wheel_odometry', None),
    'namespace': ('', 'of the topics and frames of this robot: one name, without a slash within', None),
    'robot': ('', 'the same under the name that RTD-SLAM uses', '--robot'),
    'out': ('', 'folder for trajectory, map, logs and report; empty: a new one for temporary files', None),
    'dds': ('', 'fastdds or cyclonedds; empty: RTD_DDS or the usual one', '--dds'),
    'profile': ('', 'lan, wifi or secure for ROS 2 on other hosts; empty: this host', '--profile'),
    'detector': ('auto', 'the detector: auto, off, remote', '--detector'),
    'filter': ('rtd', 'mode of the filter', '--filter'),
    'map': ('', 'map file to continue', '--map'),
    'save_map': ('', 'map file to write', '--save-map'),
    'base_frame': ('base_link', 'frame of the robot, with camera_in_base', '--base-frame'),
    'camera_in_base': ('', 'where the camera is on the robot: x,y,z,qx,qy,qz,qw, or tf; empty: poses of the camera',
                       '--camera-in-base'),
    'gravity': ('level', 'what is up in a new map: level, floor, imu', '--gravity'),
    'imu': ('', 'topic of an IMU', '--imu'),
    'wheel_odometry': ('', 'topic of a wheel odometry, with camera_in_base', '--wheel-odometry'),
    'config': ('', 'YAML file with settings of the services', '--config'),
    'dense': ('false', 'true: also a dense map and a floor plan on /map', None),
    'viewer': ('false', 'true: also the page for a browser and for Foxglove', None),
    'rviz': ('false', 'true: also RViz', None),
}
TOPICS = ('color', 'depth', 'info', 'imu', 'wheel_odometry')


def remapped(values):
    """Puts the topics of `remappings` into the arguments that they mean."""
    for remapping in values['remappings'].split():
        name, separator, topic = remapping.partition(':=')
        name = name.strip('/')
        if not separator or not topic or name not in TOPICS:
            raise RuntimeError(f"remappings: '{remapping}' is not understood: write FROM:=TO with FROM one of "
                               f"{', '.join(TOPICS)}; what RTD-SLAM publishes has fixed names below the robot's")
        values[name] = topic
    return values


def robot_of(values):
    """A namespace is a robot; it has one part."""
    namespace = values['namespace'].strip('/')
    if '/' in namespace:
        raise RuntimeError(f"namespace: '{values['namespace']}' has several parts, a robot's name has one")
    if values['robot'] and namespace and values['robot'] != namespace:
        raise RuntimeError(f"namespace '{namespace}' and robot '{values['robot']}' name the same: give one")
    return values['robot'] or namespace


def source_of(values):
    if values['source']:
        return values['source']
    return 'ros2:' + ','.join(topic for topic in (values['color'], values['depth'], values['info']) if topic)


def command_of(values):
    """The command line of `rtd run`. An option without a value counts as not given."""
    out = values['out'] or tempfile.mkdtemp(prefix='rtd_slam_')
    command = ['rtd', 'run', f'--source={source_of(values)}', f'--out={out}']
    for name, (_, _, option) in ARGUMENTS.items():
        if option is not None and values[name]:
            command.append(f'{option}={values[name]}')
    return command + [f'--{name}' for name in ('dense', 'viewer') if values[name] == 'true']


def rviz_file(robot):
    """The view; of a robot with a name one with its topics and frames."""
    path = os.path.join(get_package_share_directory('rtd_slam_launch'), 'rviz', 'rtd_slam.rviz')
    if not robot:
        return path
    with open(path, encoding='utf-8') as file:
        text = file.read()
    for part in ('slam', 'camera', 'detector', 'filter', 'dense'):
        text = text.replace(f'Value: /{part}/', f'Value: /{robot}/{part}/')
    text = text.replace('Fixed Frame: map', f'Fixed Frame: {robot}/map')
    with tempfile.NamedTemporaryFile('w', suffix='.rviz', delete=False, encoding='utf-8') as file:
        file.write(text)
    return file.name


def processes(context):
    values = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    values = remapped(values)
    values['robot'] = robot_of(values)
    actions = [ExecuteProcess(cmd=command_of(values), name='rtd', output='screen', on_exit=Shutdown())]
    if values['rviz'] == 'true':
        actions.append(ExecuteProcess(cmd=['rviz2', '-d', rviz_file(values['robot'])], name='rviz2', output='screen'))
    return actions


def generate_launch_description():
    declared = [DeclareLaunchArgument(name, default_value=default, description=text)
                for name, (default, text, _) in ARGUMENTS.items()]
    return LaunchDescription(declared + [OpaqueFunction(function=processes)])
