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
evaluates one exact arc from its last anchor, slip on a stream of wheel motion; and what is to be
believed of drivers: their clocks, velocities, several publishers, several wheels of a side.
"""

from diffdrive_kinematics.core.odometry.encoders import Encoder, PositionTrack, wrapped_increment
from diffdrive_kinematics.core.odometry.history import OdometryHistory
from diffdrive_kinematics.core.odometry.joint_assembly import Assembled, Assembly, JointReading
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.odometry import BaseState, Odometry
from diffdrive_kinematics.core.odometry.rate_window import RateWindow
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock, tolerance_of
from diffdrive_kinematics.core.odometry.sender_clocks import REMEMBERED_NS, SenderClocks
from diffdrive_kinematics.core.odometry.slip_stream import SlipStream
from diffdrive_kinematics.core.odometry.sources import Source, Sources, Spoken
from diffdrive_kinematics.core.odometry.velocity_check import Contradiction, VelocityCheck
from diffdrive_kinematics.core.odometry.wheel_motion import (
    baseline, is_run, is_silent, rates_at, Received, rolled, shifted, step_tolerance,
    timeout_from_seconds, update_motion, Verdict, WheelMotion, WheelPair, WheelSample, ZERO)
from diffdrive_kinematics.core.odometry.wheel_side import Disagreement, mean_of, SideTrack

__all__ = [
    'Assembled', 'Assembly', 'BaseState', 'Contradiction', 'Disagreement', 'Encoder',
    'JointReading', 'MeasuredWheels', 'Odometry', 'OdometryHistory', 'WheelPair', 'PositionTrack',
    'REMEMBERED_NS', 'RateWindow', 'Received', 'SenderClock', 'SenderClocks', 'SideTrack',
    'SlipStream', 'Source', 'Sources', 'Spoken', 'VelocityCheck', 'Verdict', 'WheelMotion',
    'WheelSample', 'ZERO', 'baseline', 'is_run', 'is_silent',
    'mean_of', 'rates_at', 'update_motion', 'rolled', 'shifted', 'step_tolerance',
    'timeout_from_seconds', 'tolerance_of', 'wrapped_increment']
