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
Rolling robots as control systems, as S. M. LaValle's chapter on mobile robots has them.

A :class:`ControlSystem` has states and commands with names, units and bounds, f(x, u), and the
:func:`transition` over a time in which u is held.  The robots (:func:`unicycle`,
:func:`differential_drive`, :func:`tricycle`, ...) are values of one kind, :class:`Rolling`: their
command decides the twist, so they move along exact arcs.  :func:`augmented` makes a command a
state with a bounded rate, again and again.  :func:`rolling_centre` finds the point about which
wheels turn.  A :class:`Disturbance` of the commands makes :func:`sample_paths` and, where it is
bounded, the :func:`reachable_boundary`.  All take arrays of robots as well as one.  An order in
which to read the files: ``quantities``, ``system``, ``rolling``, ``robots`` and ``cars``,
``augmentation``; ``disturbance``, ``transitions``; the set: ``reach``, by ``pieces``, ``stray``
and ``mesh``; and ``wheels`` alone.
"""

from diffdrive_kinematics.core.models.augmentation import Augmented, augmented
from diffdrive_kinematics.core.models.cars import (
    ackermann_car, car, front_wheel_angles, least_turning_radius)
from diffdrive_kinematics.core.models.disturbance import bounded, Disturbance, disturbed, Step
from diffdrive_kinematics.core.models.quantities import Quantity
from diffdrive_kinematics.core.models.reach import reachable_boundary
from diffdrive_kinematics.core.models.robots import (
    bicycle, differential_drive, front_drive_tricycle, rear_wheels_tricycle, tricycle, unicycle)
from diffdrive_kinematics.core.models.rolling import Rolling
from diffdrive_kinematics.core.models.system import admitted, check_command, ControlSystem, Vector
from diffdrive_kinematics.core.models.transitions import (
    sample_paths, transition, transition_euler, transition_runge_kutta)
from diffdrive_kinematics.core.models.wheels import Motion, rolling_centre, RollingCentre, Wheel

__all__ = [
    'Augmented', 'ControlSystem', 'Disturbance', 'Motion', 'Quantity', 'Rolling',
    'RollingCentre', 'Step', 'Vector', 'Wheel', 'ackermann_car', 'admitted', 'augmented',
    'bicycle', 'bounded', 'car', 'check_command', 'differential_drive', 'disturbed',
    'front_drive_tricycle', 'front_wheel_angles', 'least_turning_radius', 'reachable_boundary',
    'rear_wheels_tricycle', 'rolling_centre', 'sample_paths', 'transition', 'transition_euler',
    'transition_runge_kutta', 'tricycle', 'unicycle']
