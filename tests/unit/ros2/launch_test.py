#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The package rtd_slam_launch against what the services take and publish. A double stands for ROS 2's module launch."""

import importlib.util
import os
import re
import sys
import types
import unittest
import xml.etree.ElementTree as ElementTree

import yaml

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), '../../..'))
PACKAGE = os.path.join(ROOT, 'deploy/ros2/rtd_slam_launch')


def text_of(path):
    with open(os.path.join(ROOT, path), encoding='utf-8') as file:
        return file.read()


class Call:
    """What an action or substitution of launch was made with."""

    def __init__(self, *args, **kwargs):
        self.args, self.kwargs = args, kwargs


class LaunchConfiguration(Call):
    def perform(self, context):
        return context[self.args[0]]


def load_launch_file():
    modules = {
        'ament_index_python.packages': {'get_package_share_directory': lambda name: PACKAGE},
        'launch': {'LaunchDescription': Call},
        'launch.actions': {name: type(name, (Call,), {}) for name in
                           ('DeclareLaunchArgument', 'ExecuteProcess', 'OpaqueFunction', 'Shutdown')},
        'launch.substitutions': {'LaunchConfiguration': LaunchConfiguration},
        'ament_index_python': {},
    }
    for name, content in modules.items():
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(content)
    sys.dont_write_bytecode = True
    spec = importlib.util.spec_from_file_location('rtd_slam_launch', f'{PACKAGE}/launch/rtd_slam.launch.py')
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


LAUNCH = load_launch_file()
DEFAULTS = {name: default for name, (default, _, _) in LAUNCH.ARGUMENTS.items()}


def processes(**given):
    return LAUNCH.processes({**DEFAULTS, **given})


def command(**given):
    return processes(out='/tmp/out', **given)[0].kwargs['cmd']


def published():
    """Topics of our writers in ROS's words, and which of them are latched."""
    topics = {}
    for name, profile in re.findall(r'"rt(/[^"]+)",\s*QosProfile::(\w+)', text_of('common/bus/topics.hpp')):
        topics[name] = profile
    return topics


def sensors():
    return set(re.findall(r'"rt(/[^"]+)"', text_of('common/msg/imu.hpp')))


def leaves(node):
    if isinstance(node, dict):
        for key, value in node.items():
            if isinstance(value, (dict, list)):
                yield from leaves(value)
            else:
                yield key, value
    elif isinstance(node, list):
        for value in node:
            yield from leaves(value) if isinstance(value, (dict, list)) else [('', value)]


class LaunchFile(unittest.TestCase):
    def test_every_option_is_one_of_rtd_run(self):
        sources = text_of('services/launcher/main.cpp')
        for path in ('common/service/run_settings.hpp', 'common/bus/bus_factory.hpp', 'common/service/bus_config.cpp'):
            sources += text_of(path)
        options = [option for _, _, option in LAUNCH.ARGUMENTS.values() if option] + ['--source', '--out', '--dense',
                                                                                       '--viewer']
        for option in options:
            self.assertRegex(sources, f'"{option}[",]', option)

    def test_topics_of_a_driver_become_the_source(self):
        self.assertIn('--source=ros2:/camera/color/image_raw,/camera/aligned_depth_to_color/image_raw', command())
        self.assertIn('--source=ros2:/c,/d,/i', command(color='/c', depth='/d', info='/i'))
        self.assertIn('--source=openni2:', command(source='openni2:'))

    def test_what_is_not_given_is_not_there(self):
        self.assertEqual(command(), ['rtd', 'run', '--source=ros2:/camera/color/image_raw,'
                                     '/camera/aligned_depth_to_color/image_raw', '--out=/tmp/out', '--detector=auto',
                                     '--filter=rtd', '--base-frame=base_link', '--gravity=level'])
        self.assertEqual(command(dense='true')[-1], '--dense')

    def test_a_namespace_is_a_robot(self):
        self.assertIn('--robot=anna', command(namespace='/anna'))
        self.assertIn('--robot=anna', command(robot='anna'))
        for wrong in ({'namespace': '/fleet/anna'}, {'namespace': 'anna', 'robot': 'bert'}):
            with self.assertRaisesRegex(RuntimeError, 'anna'):
                command(**wrong)

    def test_remappings_become_options(self):
        line = command(remappings='color:=/rgb depth:=/d imu:=/imu/raw wheel_odometry:=/odom')
        self.assertIn('--source=ros2:/rgb,/d', line)
        self.assertIn('--imu=/imu/raw', line)
        self.assertIn('--wheel-odometry=/odom', line)
        for wrong in ('slam/pose:=/pose', 'color', 'color:='):
            with self.assertRaisesRegex(RuntimeError, 'FROM:=TO with FROM one of color'):
                command(remappings=wrong)

    def test_rviz_shows_the_robot(self):
        self.assertEqual(len(processes(out='/tmp/out')), 1)
        started = processes(out='/tmp/out', rviz='true', robot='anna')[1].kwargs['cmd']
        with open(started[2], encoding='utf-8') as file:
            view = file.read()
        os.remove(started[2])
        self.assertIn('Value: /anna/slam/path', view)
        self.assertIn('Fixed Frame: anna/map', view)
        self.assertNotIn('Value: /slam/', view)

    def test_every_argument_is_declared_and_described(self):
        declared = LAUNCH.generate_launch_description().args[0][:-1]
        self.assertEqual([one.args[0] for one in declared], list(LAUNCH.ARGUMENTS))
        for one in declared:
            self.assertGreater(len(one.kwargs['description']), 10)


class XmlFiles(unittest.TestCase):
    def test_include_the_python_file_with_arguments_that_it_has(self):
        files = [name for name in os.listdir(f'{PACKAGE}/launch') if name.endswith('.xml')]
        self.assertGreaterEqual(len(files), 3)
        for name in files:
            root = ElementTree.parse(f'{PACKAGE}/launch/{name}').getroot()
            declared = {arg.get('name') for arg in root.findall('arg')}
            ours = [include for include in root.findall('include') if 'rtd_slam.launch.py' in include.get('file')]
            self.assertEqual(len(ours), 1, name)
            self.assertLessEqual({arg.get('name') for arg in ours[0].findall('arg')}, set(LAUNCH.ARGUMENTS), name)
            used = set(re.findall(r'\$\(var (\w+)\)', ElementTree.tostring(root, encoding='unicode')))
            self.assertEqual(used, declared, name)


class View(unittest.TestCase):
    def test_shows_topics_that_are_published_as_they_are(self):
        view = yaml.safe_load(text_of('deploy/ros2/rtd_slam_launch/rviz/rtd_slam.rviz'))['Visualization Manager']
        topics = published()
        shown = [display['Topic'] for display in view['Displays'] if 'Topic' in display]
        self.assertGreaterEqual(len(shown), 6)
        for topic in shown:
            self.assertIn(topic['Value'], topics)
            latched = topics[topic['Value']] == 'kLatched'
            self.assertEqual(topic['Durability Policy'], 'Transient Local' if latched else 'Volatile', topic['Value'])
        for wanted in ('/slam/pose', '/slam/path', '/slam/map_points', '/camera/color/image_raw/compressed'):
            self.assertIn(wanted, [topic['Value'] for topic in shown])
        self.assertIn('rviz_default_plugins/TF', [display['Class'] for display in view['Displays']])
        self.assertIn(f'map_frame = "{view["Global Options"]["Fixed Frame"]}"', text_of('services/slam/config.hpp'))


class Configurations(unittest.TestCase):
    def check(self, name):
        config = yaml.safe_load(text_of(f'deploy/ros2/rtd_slam_launch/config/{name}'))
        frames = set(re.findall(r'(?:map|odom)_frame = "(\w+)"', text_of('services/slam/config.hpp')))
        frames |= set(re.findall(r'frame = "(base_link)"', text_of('common/service/run_settings.hpp')))
        self.assertEqual(frames, {'map', 'odom', 'base_link'})
        seen = set()
        for key, value in leaves(config):
            if isinstance(value, str) and value.startswith('/'):
                self.assertIn(value, set(published()) | sensors(), f'{name}: {key}')
                seen.add(value)
            if key.endswith('frame'):
                self.assertIn(value, frames, f'{name}: {key}')
        return config, seen

    def test_nav2_names_topics_and_frames_of_ours(self):
        config, seen = self.check('nav2.yaml')
        self.assertEqual(seen, {'/slam/odometry', '/map'})
        self.assertNotIn('amcl', config)
        for key, value in leaves(config):
            if key == 'transform_tolerance':
                self.assertGreaterEqual(value, 0.1)  # a pose is older than its image
        layer = config['global_costmap']['global_costmap']['ros__parameters']['static_layer']
        self.assertTrue(layer['map_subscribe_transient_local'])  # /map is latched
        self.assertEqual(published()['/map'], 'kLatched')

    def test_robot_localization_leaves_tf_to_slam(self):
        config, seen = self.check('robot_localization.yaml')
        self.assertLessEqual({'/slam/odometry'}, seen)
        node = config['ekf_filter_node']['ros__parameters']
        self.assertFalse(node['publish_tf'])  # odom -> base_link has one publisher
        for sensor in ('odom0', 'odom1', 'imu0'):
            self.assertEqual(len(node[f'{sensor}_config']), 15)


if __name__ == '__main__':
    unittest.main()
