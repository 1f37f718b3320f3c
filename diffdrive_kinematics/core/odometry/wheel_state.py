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

"""What the wheels have rolled, at any time of the own clock."""

import math
from typing import NamedTuple, Optional, Tuple, TypeVar

from diffdrive_kinematics.core.kinematics import RunningSum
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock
from diffdrive_kinematics.core.odometry.timeouts import tolerance_of
from diffdrive_kinematics.core.odometry.wheel_motion import is_silent, rolled, shifted, WheelMotion
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

W = TypeVar('W', bound='WheelState')


class WheelState(NamedTuple):
    """
    What one sender has said of both wheels: their angles at the anchor, and the motion since.

    Parameters
    ----------
    timeout_ns : int or None
        Silence [ns] after which the wheels stop, at the last stamp plus this; None = never.
    max_rate : float
        Wheel rate [rad/s] above which an increment of a driver's positions is no motion; inf:
        none is.
    unmeasured : MeasuredWheels
        What ``measured`` starts from.
    measured : MeasuredWheels or None
        What a driver of somebody else says of the wheels; None: this package's own publishers.
    left, right : RunningSum
        Angles rolled up to the anchor [rad].
    motion : WheelMotion or None
        What the wheels do since the anchor; None until the first sample.
    clock : SenderClock
        By which samples are stamped.

    Examples
    --------
    Two wheels that have turned since time 0:

    >>> wheels = WheelState(timeout_ns=None, motion=WheelMotion(
    ...     anchor_ns=0, last_ns=0, rates=(1.0, 2.0), reference=(0.0, 0.0), holds=True))
    >>> wheels.state_at(500_000_000), wheels.angle_at(500_000_000)
    (((0.5, 1.0), (1.0, 2.0)), (0.5, 1.0))

    """

    timeout_ns: Optional[int]
    max_rate: float = math.inf
    unmeasured: MeasuredWheels = MeasuredWheels()
    measured: Optional[MeasuredWheels] = None
    left: RunningSum = RunningSum(0.0)
    right: RunningSum = RunningSum(0.0)
    motion: Optional[WheelMotion] = None
    clock: SenderClock = SenderClock(tolerance_of(None))

    @property
    def at_rest(self) -> bool:
        """Return whether the wheels were at rest by the last sample."""
        if self.motion is None:
            return False
        return (self.motion if self.measured is None else self.measured).rates == ZERO

    def state_at(self, time_ns: int) -> Tuple[WheelPair, WheelPair]:
        """
        Return what the wheels have rolled since the anchor, and how fast they turn.

        Parameters
        ----------
        time_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        angle : pair of float
            Angles (left, right) [rad] since the anchor; 0 before it.
        rates : pair of float
            Wheel rates (left, right) [rad/s].

        Examples
        --------
        See :class:`WheelState`.

        """
        motion, measured, timeout_ns = self.motion, self.measured, self.timeout_ns
        if motion is None:
            return ZERO, ZERO
        if self.clock.apart:
            time_ns = self.clock.theirs_ns(time_ns)
        rates = ZERO if is_silent(motion, time_ns, timeout_ns) else (measured or motion).rates
        if measured is None:
            return rolled(motion, time_ns, timeout_ns), rates
        return self._angle(motion, time_ns), rates

    def angle_at(self, time_ns: int) -> WheelPair:
        """
        Return what the wheels have rolled since the anchor.

        Parameters
        ----------
        time_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        pair of float
            Angles (left, right) [rad] since the anchor; 0 before it.

        Examples
        --------
        See :class:`WheelState`.

        """
        motion = self.motion
        return ZERO if motion is None else self._angle(motion, self.clock.theirs_ns(time_ns))

    def _angle(self, motion: WheelMotion, theirs_ns: int) -> WheelPair:
        """Return the angle [rad] rolled from the anchor to a time of the sender."""
        measured = self.measured
        if measured is None:
            return rolled(motion, theirs_ns, self.timeout_ns)
        return measured.led(rolled(motion, theirs_ns, measured.reach_ns(self.timeout_ns)))

    def clock_stepped(self: W, step_ns: int) -> W:
        """
        Return the wheels as they read after the own clock was stepped, and with it theirs.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        WheelState
            The wheels with its times moved; those of a clock that is another one stay.

        Examples
        --------
        >>> wheels = WheelState(None, motion=WheelMotion(0, 0, (1.0, 2.0), (0.0, 0.0), holds=True))
        >>> wheels.clock_stepped(5_000_000_000).motion.anchor_ns
        5000000000

        """
        clock = self.clock.clock_stepped(step_ns)
        if self.clock.apart:  # theirs is another one
            return self._replace(clock=clock)
        return self._replace(
            clock=clock, motion=self.motion and shifted(self.motion, step_ns),
            measured=self.measured and self.measured.clock_stepped(step_ns))
