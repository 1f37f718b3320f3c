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
"""Names that a node does not know: typos, those of its peers, and those of other packages."""

from typing import Any, Collection, Dict, Mapping, Tuple

from diffdrive_kinematics.ros.parameters.qos import PREFIX as QOS_PREFIX
from diffdrive_kinematics.ros.parameters.said import is_new
from diffdrive_kinematics.ros.parameters.tables import KNOWN_NAMES

BUILT_IN = ('use_sim_time', 'start_type_description_service')
ALIASES = {'use_stamped_vel': 'enable_stamped_cmd_vel', 'publish_cmd': 'publish_limited_velocity'}
"""Older names of ros2_controllers' parameters, which are obeyed."""

R2C, FAKE, LOOPBACK = 'ros2_controllers', 'turtlebot3_fake_node', 'nav2_loopback_sim'
MEANS_NOTHING: Dict[str, Tuple[str, str]] = {
    'type': (R2C, 'no controller manager loads the nodes'),
    'is_async': (R2C, 'no controller manager runs the nodes'),
    'wheels_per_side': (R2C, 'the joints in left_wheel_names and right_wheel_names are counted'),
    'open_loop': (R2C, 'simulated_base hears wheel_rates (open loop), wheel_odometry the driver'),
    'publish_wheel_data': (R2C, 'wheel_rates and joint_states are published always'),
    'preserve_turning_radius': (
        R2C, 'max_wheel_rate always scales both wheels by one factor, which preserves it'),
    'joint_states_frame': (FAKE, 'a JointState has no frame'),
    **{name: (LOOPBACK, 'there is no laser here') for name in (
        'scan_frame_id', 'scan_publish_dur', 'publish_scan', 'scan_range_min', 'scan_range_max',
        'scan_angle_min', 'scan_angle_max', 'scan_angle_increment', 'scan_use_inf')}}
RIGHT_NAMES: Dict[str, Tuple[str, str]] = {
    'wheels.separation': (FAKE, 'wheel_separation'), 'wheels.radius': (FAKE, 'wheel_radius'),
    'odom_frame': (FAKE, 'odom_frame_id'), 'base_frame': (FAKE, 'base_frame_id'),
    'update_duration': (LOOPBACK, 'publish_rate, its inverse'),
    'odom_publish_dur': (LOOPBACK, 'publish_rate of the base, its inverse'),
    'map_frame_id': (LOOPBACK, 'odom_frame_id of the base that is the ground truth'),
    'speed_factor': (LOOPBACK, 'real_time_factor of diffdrive_sim, with clock_step'),
    'publish_clock': (LOOPBACK, 'clock_step of diffdrive_sim')}


def aliased(given: Mapping[str, Any], known: Collection[str]) -> Dict[str, str]:
    """Return the older names that are set, by the name for which they are obeyed."""
    return {name: older for older, name in ALIASES.items()
            if older in given and name in known and name not in given}


def is_understood(name: Any, known: Collection[str]) -> bool:
    """Return whether a parameter has an effect in a node that knows some, or none on purpose."""
    return isinstance(name, str) and (
        name in known or name in BUILT_IN or ALIASES.get(name) in known or name in MEANS_NOTHING
        or name.startswith(QOS_PREFIX))


def resembling(name: Any, known: Collection[str]) -> str:
    """Return the end of a sentence about a name that nobody knows: which one it may be."""
    if name in RIGHT_NAMES:
        return f', the name here is {RIGHT_NAMES[name][1]}'
    import difflib  # for the typo only: it takes milliseconds of every start
    near = difflib.get_close_matches(str(name), sorted(known), n=1)
    return f", did you mean '{near[0]}'?" if near else ''


def report_unknown(node: Any, given: Collection[str], known: Collection[str]) -> None:
    """
    Report names that nobody here knows, each once in a process.

    Parameters
    ----------
    node : rclpy.node.Node
        For which they are set; its context is the process, for this.
    given : collection of str
        Names that are set from outside.
    known : collection of str
        Names of the table of the node.

    """
    logger = node.get_logger()
    for name in given:
        if name in KNOWN_NAMES or name in BUILT_IN or name.startswith(QOS_PREFIX):
            continue
        if name in ALIASES and ALIASES[name] not in known or not is_new(node, name):
            continue
        harmless = False
        if name in ALIASES:
            harmless = True
            text = (f'is ignored, {ALIASES[name]} is set' if ALIASES[name] in given
                    else f'is taken for {ALIASES[name]}')
        elif name in MEANS_NOTHING:
            harmless = True
            package, why = MEANS_NOTHING[name]
            text = f'of {package} means nothing here: {why}'
        elif name in RIGHT_NAMES:
            package, right = RIGHT_NAMES[name]
            text = f'of {package} is ignored, the name here is {right}'
        else:
            hint = resembling(name, KNOWN_NAMES)
            text = f'is ignored: no node of this package knows it{hint}'
        if harmless:  # for rclpy a line of code has one severity
            logger.info(f"parameter '{name}' {text}")
        else:
            logger.warning(f"parameter '{name}' {text}")
