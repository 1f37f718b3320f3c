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

"""The odometry of a base from values of its parameters."""

import math
from typing import Any, Mapping, Optional, Tuple

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import CERTAIN, heading_moments, PoseMoments, sample_heading
from diffdrive_kinematics.core.odometry import MeasuredWheels, Odometry, RateWindow, WheelPair
from diffdrive_kinematics.ros.parameters.from_values import body_slip, session_spread
import numpy as np


def check_frames(values: Mapping[str, Any]) -> None:
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


def _encoder_bound(values: Mapping[str, Any]) -> float:
    """Return the wheel rate [rad/s] above which positions have jumped."""
    bound = values['max_encoder_rate']
    return math.inf if math.isnan(bound) else bound


def initial_pose(values: Mapping[str, Any]) -> Tuple[Pose, PoseMoments]:
    """Return the pose to start from and its moments: a heading that is drawn is certain."""
    pose = Pose(*values['initial_pose'])
    concentration, seed = values['initial_heading_concentration'], values['initial_heading_seed']
    if seed < 0 or math.isnan(concentration):
        return pose, heading_moments(concentration)
    generator = np.random.default_rng(seed)
    return pose._replace(theta=sample_heading(pose.theta, concentration, generator)), CERTAIN


def initial_odometry(
        values: Mapping[str, Any], geometry: WheelGeometry, timeout_ns: Optional[int],
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
        slip_variances: WheelPair, values: Mapping[str, Any], now_ns: int) -> Odometry:
    """Return the odometry under settings from now on; where all are as before nothing changes."""
    counting = _counting(old, values)
    if (geometry, timeout_ns, slip_variances, counting.anchor, counting.body_slip) != (
            old.geometry, old.timeout_ns, old.slip_variances, old.anchor, old.body_slip):
        old = _counting(old.configured(geometry, timeout_ns, now_ns, slip_variances), values)
    return old._replace(wheels=old.wheels._replace(max_rate=_encoder_bound(values)))


def _counting(odometry: Odometry, values: Mapping[str, Any]) -> Odometry:
    """Return the odometry that counts what lasts a run and slips of the body, from its anchor."""
    return odometry._replace(
        anchor=odometry.anchor.with_session(session_spread(values)), body_slip=body_slip(values))
