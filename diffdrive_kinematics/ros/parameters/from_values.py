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

"""What the values of a node's parameters amount to, as the core has it."""

from dataclasses import fields
import math
from typing import Any, Collection, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import check_finite, Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    BodySlip, CERTAIN, heading_moments, PoseMoments, sample_heading, SessionSpread, WheelSlip)
from diffdrive_kinematics.core.odometry import MeasuredWheels, Odometry, RateWindow, WheelPair
import numpy as np

Values = Mapping[str, Any]


def wheel_geometry(values: Values) -> WheelGeometry:
    """Return the wheel geometry of a node's values; ``ValueError`` if it is impossible."""
    return WheelGeometry(**{field.name: values[field.name] for field in fields(WheelGeometry)})


def wheel_radii(values: Values) -> Tuple[float, float]:
    """Return the effective radii (left, right) [m] of a node's values."""
    geometry = WheelGeometry(
        1.0, values['wheel_radius'],
        left_wheel_radius_multiplier=values['left_wheel_radius_multiplier'],
        right_wheel_radius_multiplier=values['right_wheel_radius_multiplier'])
    return geometry.left_radius, geometry.right_radius


def wheel_slips(values: Values) -> Tuple[WheelSlip, WheelSlip]:
    """Return bias and slip (left, right) of a node's values; what it has no name for is 0."""
    left, right = (
        WheelSlip(values.get(f'{side}_bias', 0.0), values[f'{side}_slip_variance'],
                  values.get('slip_model', 'travel'), values['slip_distribution'])
        for side in ('left', 'right'))
    return left, right


def body_slip(values: Values) -> BodySlip:
    """Return what slips beside the wheels, by a node's values."""
    return BodySlip(
        *(values[f'{name}_slip_variance'] for name in ('linear', 'turn', 'heading')),
        values.get('slip_distribution', 'gaussian'))


def session_spread(values: Values) -> SessionSpread:
    """Return the standard deviations, between runs, of what lasts a run."""
    return SessionSpread(*(
        values[f'session_{name}_stddev'] for name in ('scale', 'separation', 'curvature')))


def commands_from(numbers: Sequence[float]) -> List[Command]:
    """Return the commands of a flat list of v, omega, duration; ``ValueError`` if it is none."""
    each = 'command: v, omega, duration'
    return [Command(*three) for three in _triples('commands', numbers, each)]


def goals_from(numbers: Sequence[float]) -> List[Pose]:
    """Return the goals of a flat list of x, y, yaw, or raise ``ValueError``."""
    goals = [Pose(*three) for three in _triples('goals', numbers, 'goal: x, y, yaw')]
    for number in numbers:
        check_finite('goals', number)
    return goals


def _triples(name: str, numbers: Sequence[float], each: str) -> List[Sequence[float]]:
    """Return a flat list three by three; ``ValueError`` names it, and what three are for."""
    if len(numbers) % 3:
        raise ValueError(f'{name} has {len(numbers)} numbers, expected three for each {each}')
    return [numbers[i:i + 3] for i in range(0, len(numbers), 3)]


def check_wiring(values: Values, source: str, outputs: Tuple[str, ...]) -> None:
    """Raise ``ValueError`` where a node would listen to itself."""
    for output in outputs:
        if values[output] and values[output].strip('/') == values[source].strip('/'):
            raise ValueError(
                f'{output} is {values[output]!r}, expected another topic than {source}')


def check_sides(values: Values) -> None:
    """Raise ``ValueError`` where a joint is on both sides of the robot."""
    both = set(values['left_wheel_names']) & set(values['right_wheel_names'])
    if both:
        raise ValueError(
            f'left_wheel_names and right_wheel_names both have {sorted(both)!r}, expected '
            'different joints')


def check_frames(values: Values) -> None:
    """Raise ``ValueError`` where a frame would have two parents, or itself as its parent."""
    if values['enable_odom_tf'] and values['publish_map_odom_tf']:
        raise ValueError(
            'enable_odom_tf and publish_map_odom_tf are both true, expected enable_odom_tf to be '
            'false: a frame has one parent, and that of base_frame_id is the frame of '
            "belief_topic's odometry")
    if values['odom_frame_id'] == values['base_frame_id']:
        raise ValueError(
            f"odom_frame_id and base_frame_id are both {values['odom_frame_id']!r}, expected "
            'different frames')


def _encoder_bound(values: Values) -> float:
    """Return the wheel rate [rad/s] above which positions have jumped."""
    bound = values['max_encoder_rate']
    return math.inf if math.isnan(bound) else bound


def initial_pose(values: Values) -> Tuple[Pose, PoseMoments]:
    """Return the pose to start from and its moments: a heading that is drawn is certain."""
    pose = Pose(*values['initial_pose'])
    concentration, seed = values['initial_heading_concentration'], values['initial_heading_seed']
    if seed < 0 or math.isnan(concentration):
        return pose, heading_moments(concentration)
    generator = np.random.default_rng(seed)
    return pose._replace(theta=sample_heading(pose.theta, concentration, generator)), CERTAIN


def initial_odometry(
        values: Values, geometry: WheelGeometry, timeout_ns: Optional[int],
        slip_variances: WheelPair) -> Odometry:
    """Return the odometry that has heard nothing yet."""
    pose, moments = initial_pose(values)
    return _counting(Odometry.starting_at(
        pose, geometry=geometry, timeout_ns=timeout_ns, slip_variances=slip_variances,
        max_rate=_encoder_bound(values), unmeasured=MeasuredWheels(
            values['extrapolate_positions'],
            RateWindow(values['velocity_rolling_window_size']))).with_moments(moments), values)


def configured_odometry(
        old: Odometry, geometry: WheelGeometry, timeout_ns: Optional[int],
        slip_variances: WheelPair, values: Values, now_ns: int) -> Odometry:
    """Return the odometry under settings from now on; where all are as before nothing changes."""
    counting = _counting(old, values)
    if (geometry, timeout_ns, slip_variances, counting.anchor, counting.body_slip) != (
            old.geometry, old.timeout_ns, old.slip_variances, old.anchor, old.body_slip):
        old = _counting(old.configured(geometry, timeout_ns, now_ns, slip_variances), values)
    return old._replace(wheels=old.wheels._replace(max_rate=_encoder_bound(values)))


def _counting(odometry: Odometry, values: Values) -> Odometry:
    """Return the odometry that counts what lasts a run and slips of the body, from its anchor."""
    return odometry._replace(
        anchor=odometry.anchor.with_session(session_spread(values)), body_slip=body_slip(values))


class Member(NamedTuple):
    """A node to compose: its class, its name, and the namespace where the name has one."""

    kind: str
    name: str
    namespace: str


def members_of(nodes: Sequence[str], known: Collection[str]) -> Tuple[Member, ...]:
    """
    Return the nodes of a list, or raise ``ValueError``.

    Parameters
    ----------
    nodes : sequence of str
        Each ``class`` or ``class:name``, the name with its namespace.
    known : collection of str
        The classes there are.

    """
    if not nodes:
        raise ValueError(f"nodes is not set, expected 'class' or 'class:name' of {list(known)}")
    members = tuple(_member(text, known) for text in nodes)
    if len({(member.namespace, member.name) for member in members}) != len(members):
        raise ValueError(f'nodes is {list(nodes)!r}, expected different names')
    return members


def _member(text: str, known: Collection[str]) -> Member:
    kind, _, path = text.partition(':')
    namespace, _, name = (path or kind).rpartition('/')
    if kind not in known or not name:
        raise ValueError(
            f"nodes has {text!r}, expected 'class' or 'class:name', class one of {list(known)}")
    return Member(kind, name, namespace)
