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

"""What a trajectory fit can find, and how the user calls it."""

from typing import Dict, NamedTuple


class CalibrationParameters(NamedTuple):
    """
    What is systematic about one drive.

    Parameters
    ----------
    left, right, separation : float
        Factors on both radii and the separation [1].
    x, y : float
        Position of the reference's frame on the robot [m].
    yaw : float
        Its heading on the robot [rad].
    offset : float
        Part of ``reference stamp = wheel stamp + offset + drift (stamp - middle of the
        drive)`` [s].  A delay with which commands are followed is an offset.
    drift : float
        Rate of the two clocks against each other [s/s].

    Examples
    --------
    >>> CalibrationParameters(separation=1.02).left
    1.0

    """

    left: float = 1.0
    right: float = 1.0
    separation: float = 1.0
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    offset: float = 0.0
    drift: float = 0.0


FIELDS = CalibrationParameters._fields
WHEELS = ('left', 'right', 'separation')
FRAME = ('x', 'y', 'yaw')
NAMES: Dict[str, str] = {
    'left': 'left_wheel_radius_multiplier', 'right': 'right_wheel_radius_multiplier',
    'separation': 'wheel_separation_multiplier',
    'x': 'frame_x', 'y': 'frame_y', 'yaw': 'frame_yaw', 'offset': 'offset', 'drift': 'drift'}
"""What the user calls a field."""
