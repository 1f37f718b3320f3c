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

"""
From messages about wheels to a pose at any time.

Wheel motion from stamped rates and positions, encoders that wrap around, the odometry that
evaluates one exact arc from its last anchor, slip on a stream of wheel motion; and checks of what
drivers say: their clocks, velocities, several publishers, several wheels of a side.  An order in
which to read the files:

* messages: ``wheel_sample``, ``encoders``, ``timeouts``;
* the wheels between two messages: ``wheel_motion``, ``motion_evidence``, ``motion_update``;
* over time: ``wheel_state`` and ``wheel_track``, on the ``clock_offset`` of a ``sender_clock``;
* after positions of a driver: ``rate_window``, ``velocity_check``, ``measured_state`` and
  ``measured_wheels``;
* the pose: ``anchor``, ``odometry_state`` and ``odometry``, ``history``;
* who speaks: ``source`` and ``sources``, ``sender_clocks``, ``joint_assembly``, ``wheel_side`` by
  ``wheel_comparison``;
* streams of wheel motion: ``slip_stream``, ``answered_motion``.
"""

from diffdrive_kinematics.core.odometry.anchor import Anchor, BaseState
from diffdrive_kinematics.core.odometry.answered_motion import AnsweredMotion
from diffdrive_kinematics.core.odometry.encoders import Encoder, PositionTrack, wrapped_increment
from diffdrive_kinematics.core.odometry.history import OdometryHistory
from diffdrive_kinematics.core.odometry.joint_assembly import Assembled, Assembly, JointReading
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.motion_evidence import agree_within_rounding
from diffdrive_kinematics.core.odometry.motion_update import MotionUpdate, update_motion
from diffdrive_kinematics.core.odometry.odometry import Odometry
from diffdrive_kinematics.core.odometry.odometry_state import OdometryState
from diffdrive_kinematics.core.odometry.rate_window import RateWindow
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock
from diffdrive_kinematics.core.odometry.sender_clocks import REMEMBERED_NS, SenderClocks
from diffdrive_kinematics.core.odometry.slip_stream import SlipStream
from diffdrive_kinematics.core.odometry.source import JointMessage, Source
from diffdrive_kinematics.core.odometry.sources import Sources
from diffdrive_kinematics.core.odometry.timeouts import (
    ClockStep, NO_STEP, step_tolerance, timeout_from_seconds)
from diffdrive_kinematics.core.odometry.velocity_check import Mismatch, VelocityCheck
from diffdrive_kinematics.core.odometry.wheel_comparison import Disagreement, mean_of
from diffdrive_kinematics.core.odometry.wheel_motion import (
    baseline, rates_at, rolled, shifted, WheelMotion)
from diffdrive_kinematics.core.odometry.wheel_sample import (
    is_run, Verdict, WheelPair, WheelSample, ZERO)
from diffdrive_kinematics.core.odometry.wheel_side import SideTrack
from diffdrive_kinematics.core.odometry.wheel_state import WheelState
from diffdrive_kinematics.core.odometry.wheel_track import WheelTrack

__all__ = [
    'Anchor', 'AnsweredMotion', 'Assembled', 'Assembly', 'BaseState', 'ClockStep', 'Disagreement',
    'Encoder', 'JointMessage', 'JointReading', 'MeasuredWheels', 'Mismatch', 'MotionUpdate',
    'NO_STEP', 'Odometry', 'OdometryHistory', 'OdometryState', 'PositionTrack', 'REMEMBERED_NS',
    'RateWindow', 'SenderClock', 'SenderClocks', 'SideTrack', 'SlipStream', 'Source', 'Sources',
    'VelocityCheck', 'Verdict', 'WheelMotion', 'WheelPair', 'WheelSample', 'WheelState',
    'WheelTrack', 'ZERO', 'agree_within_rounding', 'baseline', 'is_run', 'mean_of', 'rates_at',
    'rolled', 'shifted', 'step_tolerance', 'timeout_from_seconds', 'update_motion',
    'wrapped_increment']
