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
Commands that are found from where the robot is: steering laws.

A :class:`Law` tells the twist at a pose on the way to a goal: :class:`HeadingRegulator`,
:class:`PointForward` and :class:`PoseController`.  :class:`PurePursuit` follows :class:`Points`.
All slow down in proportion to the way that is left and keep :class:`SteeringLimits`;
:class:`Approach` notices that a robot comes no nearer.
"""

from diffdrive_kinematics.core.commands.pose_controller import PoseController
from diffdrive_kinematics.core.commands.pursuit import Points, points_of, PurePursuit, Pursued
from diffdrive_kinematics.core.commands.steering import (
    Approach, HeadingRegulator, Law, PointForward, Steered, SteeringLimits)

__all__ = [
    'Approach', 'HeadingRegulator', 'Law', 'PointForward', 'Points', 'PoseController',
    'PurePursuit', 'Pursued', 'Steered', 'SteeringLimits', 'points_of']
