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

"""How a velocity follows its target within the limits of one axis of the twist."""

from dataclasses import dataclass

from diffdrive_kinematics.core.commands.easing import eased
from diffdrive_kinematics.core.commands.limit_ranges import LimitRanges


@dataclass(frozen=True)
class AxisLimits(LimitRanges):
    """
    Limits of one axis; units are m or rad, and s.  See the table of ``limit_ranges``.

    Parameters
    ----------
    max_velocity, min_velocity : float
        Highest and lowest velocity [m/s or rad/s].
    max_acceleration, max_acceleration_reverse : float
        Rates of speeding up, forward and in reverse [m/s^2 or rad/s^2].
    max_deceleration, max_deceleration_reverse : float
        Rates of slowing down, forward and in reverse [m/s^2 or rad/s^2].
    max_jerk, min_jerk : float
        Rise and fall of the acceleration per second [m/s^3 or rad/s^3].

    Raises
    ------
    ValueError
        If a limit has the wrong sign: one that forbids standing still, or a rate of 0, which
        would mean never to speed up or, worse, never to slow down.

    Examples
    --------
    >>> limits = AxisLimits(max_velocity=1.0, max_acceleration=0.5, max_deceleration=-2.0)
    >>> limits.limit_velocity(-3.0), limits.limit(-3.0, current=0.0, before=0.0, dt=0.5)
    (-1.0, -0.25)

    """

    def limit(self, target: float, *, current: float, before: float, dt: float) -> float:
        """
        Return the velocity a step after ``current`` on the way to ``target``.

        The target is limited to the range of velocities, then jerk and acceleration on the way.

        Parameters
        ----------
        target, current, before : float
            Velocities asked for, now and ``dt`` ago [m/s or rad/s].
        dt : float
            The step [s].

        Returns
        -------
        float
            Velocity [m/s or rad/s].

        Examples
        --------
        See :class:`AxisLimits`.

        """
        return self.towards(self.limit_velocity(target), current=current, before=before, dt=dt)

    def towards(self, target: float, *, current: float, before: float, dt: float) -> float:
        """
        Return the velocity a step after ``current``, with jerk and acceleration limited.

        It is never outside the interval from ``current`` to ``target``, whatever the limits.

        Parameters
        ----------
        target, current, before : float
            Velocities asked for, now and ``dt`` ago [m/s or rad/s].
        dt : float
            The step [s].

        Returns
        -------
        float
            Velocity [m/s or rad/s].

        Examples
        --------
        >>> limits = AxisLimits(max_acceleration=2.0, max_jerk=2.0)
        >>> way = [0.0, 0.0]
        >>> for _ in range(3):
        ...     way.append(limits.towards(9.0, current=way[-1], before=way[-2], dt=0.5))
        >>> way
        [0.0, 0.0, 0.5, 1.5, 2.5]

        """
        if self.eases:
            target = self.limit_jerk(target, current=current, before=before, dt=dt)
        return self.limit_acceleration(target, current=current, dt=dt)

    def limit_velocity(self, target: float) -> float:
        """
        Return the target, clamped to the velocity range.

        Parameters
        ----------
        target : float
            Velocity that is asked for [m/s or rad/s].

        Returns
        -------
        float
            Velocity in the range [m/s or rad/s].

        Examples
        --------
        See :class:`AxisLimits`.

        """
        low, high = self.velocity_range
        return min(max(target, low), high)

    def limit_acceleration(self, target: float, *, current: float, dt: float) -> float:
        """
        Return the velocity nearest to the target that can be reached within a step.

        To slow down and to speed up are limited apart, in either direction of travel.  A step
        that passes through zero slows down until it stands and speeds up for what remains of
        dt; a limiter that applies the rate of the side it starts from would speed up in the
        new direction at the rate of a braking robot.

        Parameters
        ----------
        target, current : float
            Velocities asked for and now [m/s or rad/s].
        dt : float
            The step [s].

        Returns
        -------
        float
            Velocity [m/s or rad/s].

        Examples
        --------
        A quarter of a second to stop, and another to speed up backward:

        >>> limits = AxisLimits(max_acceleration=0.5, max_deceleration=-2.0)
        >>> limits.limit_acceleration(-1.0, current=0.5, dt=0.5)
        -0.125

        """
        up, down = self.forward_rates
        reverse_up, reverse_down = self.reverse_rates
        highest = _reachable(current, up, reverse_down, dt)
        lowest = -_reachable(-current, reverse_up, down, dt)
        return min(max(target, lowest), highest)

    def limit_jerk(self, target: float, *, current: float, before: float, dt: float) -> float:
        """
        Return the target, with growth and fall of the acceleration towards it limited.

        Where the acceleration points away from the target it ends at once.  Where it is larger
        than can end at the target, as when the target has come nearer, it falls at once to what
        can: to keep within current and target goes before the limit of jerk.

        Parameters
        ----------
        target, current, before : float
            Velocities asked for, now and ``dt`` ago [m/s or rad/s].
        dt : float
            The step [s].

        Returns
        -------
        float
            Velocity [m/s or rad/s]; its acceleration is not limited yet.

        Examples
        --------
        >>> limits = AxisLimits(max_jerk=2.0)
        >>> limits.limit_jerk(9.0, current=1.0, before=0.5, dt=0.5)  # 1.0 + 0.5 + 2 * 0.5**2
        2.0

        """
        if target == current:
            return target
        low, high = self.jerk_range
        if target > current:
            return eased(
                target, current=current, before=before, dt=dt, rise=high, fall=-low,
                up=self.forward_rates[0], down=self.reverse_rates[1])
        return -eased(
            -target, current=-current, before=-before, dt=dt, rise=-low, fall=high,
            up=self.reverse_rates[0], down=self.forward_rates[1])


def _reachable(current: float, up: float, down_reverse: float, dt: float) -> float:
    """Return the highest velocity within dt: slow down to a stand, then speed up."""
    if current >= 0.0:
        return current + up * dt
    to_stand = -current / down_reverse
    if to_stand >= dt:
        return current + down_reverse * dt
    return up * (dt - to_stand)
