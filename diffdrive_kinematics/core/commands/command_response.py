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
How a robot follows its commands: what it does where a twist is asked for, and the inverse.

Robots without encoders turn more or less than asked, lose speed in curves, and begin late:

    v' = a v s(w / v),    w' = b w + d v,

from ``delay`` seconds after the command.  The share s of the speed that is kept falls with the
curvature k = w / v: a loss of order n = 1 or 2 is ``s^n = 1 - |c k|^n``, down to a tenth; a table
of factors at some abs(k) comes on top.  Backward is the mirror image of forward.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.commands.turn_loss import share_kept, table_share
from diffdrive_kinematics.core.commands.wheel_command import STILL, Twist
from diffdrive_kinematics.core.kinematics import Array, check_duration, check_positive
import numpy as np
from numpy.typing import ArrayLike

NO_SPEED, ACCURACY = 1e-300, 1e-12  # [m/s]


class CommandFor(NamedTuple):
    """
    The command to a motion.

    Parameters
    ----------
    command : Twist
        What to ask for.
    reached : bool
        Whether it yields the motion; False: it yields the nearest one within the range driven.

    Examples
    --------
    >>> CommandFor(Twist(0.5, 0.0), reached=False).command.v
    0.5

    """

    command: Twist
    reached: bool


@dataclass(frozen=True)
class CommandResponse:
    """
    What a robot does where a twist is asked for.

    Parameters
    ----------
    max_speed, max_yaw_rate : float
        Largest speed [m/s] and yaw rate [rad/s] driven; commands beyond count as these.
    speed_gain : float
        Gain a [1] of the speed on a straight.
    yaw_rate_gain : float
        Gain b [1].
    veer : float
        By how much d a straight turns [rad/m].
    turn_loss, turn_loss_order : float, int
        Loss c [m] and order n, 1 or 2: at k = 1 / c all speed but the last tenth is lost.
    curvatures, shares : tuple of float
        Table over abs(k) [1/m] of what multiplies s [1]; the first and the last one hold beyond.
    delay : float
        How late the robot follows [s].

    Raises
    ------
    ValueError
        If a number is out of its range, or a larger speed would not always be a larger one.

    Examples
    --------
    A robot that loses speed in curves, and the command that makes up for it:

    >>> response = CommandResponse(0.5, 2.0, turn_loss=0.18, yaw_rate_gain=0.9)
    >>> motion = response.motion_of(Twist(0.1, 0.4))
    >>> round(motion.v, 3), round(motion.w, 3)
    (0.07, 0.36)
    >>> command, reached = response.command_for(motion)
    >>> round(command.v, 9), round(command.w, 9), reached
    (0.1, 0.4, True)
    >>> response.command_for(Twist(3.0, 0.0))
    CommandFor(command=Twist(v=0.5, w=0.0), reached=False)

    """

    max_speed: float
    max_yaw_rate: float
    speed_gain: float = 1.0
    yaw_rate_gain: float = 1.0
    veer: float = 0.0
    turn_loss: float = 0.0
    turn_loss_order: int = 2
    curvatures: Tuple[float, ...] = ()
    shares: Tuple[float, ...] = ()
    delay: float = 0.0

    def __post_init__(self) -> None:
        for name in ('max_speed', 'max_yaw_rate', 'speed_gain', 'yaw_rate_gain'):
            check_positive(name, getattr(self, name))
        check_duration('delay', self.delay)
        if not 0.0 <= self.turn_loss < math.inf:
            raise ValueError(f'turn_loss is {self.turn_loss!r} m, expected 0 or above')
        if self.turn_loss_order not in (1, 2):
            raise ValueError(f'turn_loss_order is {self.turn_loss_order!r}, expected 1 or 2')
        if not abs(self.veer) * max(self.turn_loss, 1e-3) < self.yaw_rate_gain:  # NaN is not
            raise ValueError(
                f'veer is {self.veer!r} rad/m, expected less than yaw_rate_gain / turn_loss, '
                f'{self.yaw_rate_gain!r} / {self.turn_loss!r} m, on either side')
        if self.curvatures or self.shares:
            self._check_table(np.array(self.curvatures), np.array(self.shares))

    def _check_table(self, nodes: Array, shares: Array) -> None:
        order = len(nodes) > 1 and nodes[0] >= 0.0 and (np.diff(nodes) > 0.0).all()
        if len(nodes) != len(shares) or not order:
            raise ValueError(
                f'curvatures are {self.curvatures!r} and shares {self.shares!r}, expected as '
                'many of each, two or more, and curvatures from 0 on in rising order')
        slopes = np.diff(shares) / np.diff(nodes)
        turning = np.abs(slopes * self.veer) / self.yaw_rate_gain
        gains = shares[:-1] - slopes * nodes[:-1] - turning
        if not (np.isfinite(nodes).all() and (shares > 0.0).all() and (gains > 0.0).all()):
            raise ValueError(
                f'shares are {self.shares!r} at the curvatures {self.curvatures!r}, expected '
                'shares above 0, and more speed of the robot for more that is asked for')

    def share(self, curvature: ArrayLike) -> Array:
        """
        Return the share s of the speed that is kept, beside ``speed_gain``.

        Parameters
        ----------
        curvature : array_like
            Curvature k = w / v of the command [1/m].

        Returns
        -------
        numpy.ndarray
            Shares [1], of the same shape.

        Examples
        --------
        >>> CommandResponse(0.5, 2.0, turn_loss=0.2).share([0.0, 3.0, 50.0]).round(2)
        array([1. , 0.8, 0.1])
        >>> table = CommandResponse(0.5, 2.0, curvatures=(0.0, 4.0), shares=(1.0, 0.6))
        >>> table.share([-1.0, 2.0, 50.0])
        array([0.9, 0.8, 0.6])

        """
        k = np.asarray(curvature, dtype=np.float64)
        kept = share_kept(self.turn_loss * k, self.turn_loss_order)
        return kept * table_share(np.abs(k), self.curvatures, self.shares)

    def motion_of(self, command: Twist) -> Twist:
        """
        Return what the robot does, a delay later, where a twist is asked for.

        Parameters
        ----------
        command : Twist
            What is asked for; beyond the range driven its edge counts.

        Returns
        -------
        Twist
            What is driven; standstill where that is asked for.

        Examples
        --------
        See :class:`CommandResponse`.

        """
        v = min(max(command.v, -self.max_speed), self.max_speed)
        w = min(max(command.w, -self.max_yaw_rate), self.max_yaw_rate)
        return Twist(self._speed(v, w), self.yaw_rate_gain * w + self.veer * v)

    def _speed(self, v: float, w: float) -> float:
        if abs(v) < NO_SPEED:
            return 0.0
        k = w / v
        kept = share_kept(self.turn_loss * k, self.turn_loss_order)
        return self.speed_gain * v * kept * table_share(abs(k), self.curvatures, self.shares)

    def command_for(self, motion: Twist, *, most: float = math.inf) -> CommandFor:
        """
        Return the command that yields a motion, solved to 1e-12 m/s.

        Parameters
        ----------
        motion : Twist
            What the robot is to do.
        most : float
            Bound [1] of the speed asked for over the one that a straight takes.

        Returns
        -------
        CommandFor
            The command within the range driven, the nearest where none yields the motion; to
            stand still for standstill.  A motion that is not finite comes back as it is.

        Examples
        --------
        See :class:`CommandResponse`.

        """
        if motion == STILL:
            return CommandFor(STILL, True)
        if not all(map(math.isfinite, motion)):
            return CommandFor(motion, False)
        far = min(self.max_speed, most * abs(motion.v) / self.speed_gain) if motion.v else 0.0
        low, high = 0.0, math.copysign(far, motion.v)
        if abs(self._speed(high, self._yaw_rate(motion.w, high))) <= abs(motion.v):
            low = high
        middle = low + 0.5 * (high - low)
        while abs(high - low) > ACCURACY and middle not in (low, high):
            if abs(self._speed(middle, self._yaw_rate(motion.w, middle))) < abs(motion.v):
                low = middle
            else:
                high = middle
            middle = low + 0.5 * (high - low)
        command = Twist(middle, self._yaw_rate(motion.w, middle))
        there = self.motion_of(command)
        return CommandFor(command, max(abs(there.v - motion.v), abs(there.w - motion.w)) <= 1e-9)

    def _yaw_rate(self, wanted: float, v: float) -> float:
        """Return the yaw rate to ask for beside a speed, within the range driven."""
        w = (wanted - self.veer * v) / self.yaw_rate_gain
        return min(max(w, -self.max_yaw_rate), self.max_yaw_rate)
