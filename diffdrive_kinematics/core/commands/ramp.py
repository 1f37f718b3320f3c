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

from diffdrive_kinematics.core.commands.limits import AxisLimits
from diffdrive_kinematics.core.commands.saturation import WheelBound

WheelPair = Tuple[float, float]


class RampStep(NamedTuple):
    """
    A step of the twist.

    Parameters
    ----------
    v : float
        Forward speed after it [m/s].
    w : float
        Yaw rate after it [rad/s].
    held_back : bool
        Whether the wheel bound held one of them back.

    Examples
    --------
    See :func:`ramp_step`.

    """

    v: float
    w: float
    held_back: bool


def ramp_step(
        goal: WheelPair, *, current: WheelPair, before: WheelPair, dt: float, linear: AxisLimits,
        angular: AxisLimits, bound: Optional[WheelBound]) -> RampStep:
    """
    Return the twist a step after ``current`` on the way to ``goal``.

    Each axis stays between where it is and its goal.

    Parameters
    ----------
    goal : pair of float
        Twist (v [m/s], w [rad/s]) to get to, within the bound.
    current, before : pair of float
        Twists now, within the bound, and a step ago.
    dt : float
        The step [s].
    linear, angular : AxisLimits
        Limits of v and of w.
    bound : WheelBound or None
        The twists that the wheels can do; None: any.

    Returns
    -------
    RampStep
        The twist ``dt`` after ``current``.

    Examples
    --------
    Before the robot may turn as fast as its limits allow it has to slow down:

    >>> settings = {'dt': 0.25, 'linear': AxisLimits(max_acceleration=1.0),
    ...             'angular': AxisLimits(max_acceleration=4.0)}
    >>> ramp_step((0.0, 2.0), current=(1.0, 0.0), before=(1.0, 0.0), bound=None, **settings)
    RampStep(v=0.75, w=1.0, held_back=False)
    >>> bound = WheelBound(left=1.0, right=1.0, half=0.5)
    >>> ramp_step((0.0, 2.0), current=(1.0, 0.0), before=(1.0, 0.0), bound=bound, **settings)
    RampStep(v=0.75, w=0.5, held_back=True)

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


def _aim(goal: float, current: float, room: WheelPair) -> float:
    """Return what is nearest to the goal in the room, or the current value; never a way back."""
    aim = min(max(goal, room[0]), room[1])
    return aim if min(current, goal) <= aim <= max(current, goal) else current
