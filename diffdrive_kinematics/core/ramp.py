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
A step of the twist on its way to a goal: the limits of both axes, within the bound of the wheels.

The present twist and the goal are within the bound, which is convex.  The axis whose magnitude
falls takes its step first and makes room; the other then goes as far as its limits allow, and no
further than to where the faster wheel is at the bound.  So neither an acceleration nor the bound
is ever exceeded, and as the room only grows, jerk is limited as it is without a bound.
"""

from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.limits import AxisLimits
from diffdrive_kinematics.core.saturation import WheelBound

__all__ = ['RampStep', 'ramp_step']

Pair = Tuple[float, float]


class RampStep(NamedTuple):
    """Forward speed [m/s], yaw rate [rad/s], and whether the wheel bound held one of them back."""

    v: float
    w: float
    held_back: bool


def ramp_step(
        goal: Pair, *, current: Pair, before: Pair, dt: float, linear: AxisLimits,
        angular: AxisLimits, bound: Optional[WheelBound]) -> RampStep:
    """
    Return the twist ``dt`` [s] after ``current`` on the way to ``goal``.

    ``before`` is the twist dt before ``current``; all are (v [m/s], w [rad/s]), and current and
    goal are within the bound.  Each axis stays between where it is and its goal.
    """
    (v, w), (v_goal, w_goal) = current, goal
    v_aim, w_aim = goal

    def speed() -> float:
        return linear.towards(v_aim, current=v, before=before[0], dt=dt)

    def yaw_rate() -> float:
        return angular.towards(w_aim, current=w, before=before[1], dt=dt)

    if bound is None:
        return RampStep(speed(), yaw_rate(), False)
    if (v_goal - v) * v < 0.0:
        v_aim = _aim(v_goal, v, bound.speeds(w))
        v_next = speed()
        w_aim = _aim(w_goal, w, bound.yaw_rates(v_next))
        w_next = yaw_rate()
    else:
        w_aim = _aim(w_goal, w, bound.yaw_rates(v))
        w_next = yaw_rate()
        v_aim = _aim(v_goal, v, bound.speeds(w_next))
        v_next = speed()
    held_back = v_next == v_aim != v_goal or w_next == w_aim != w_goal
    return RampStep(v_next, w_next, held_back)


def _aim(goal: float, current: float, room: Pair) -> float:
    """Return what is nearest to the goal in the room, or the current value; never a way back."""
    aim = min(max(goal, room[0]), room[1])
    return aim if min(current, goal) <= aim <= max(current, goal) else current
