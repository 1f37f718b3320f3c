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
Encoders of the wheels: positions that wrap around, and positions in whole ticks.

An encoder of range R reports the angle modulo R.  Between two readings that are less than half a
range apart the angle is known: the increment is taken modulo R into (-R/2, R/2].  Each wheel is
followed by itself, since the mean of wrapped positions means nothing.
"""

from dataclasses import dataclass
import math
from typing import Sequence, Tuple

from diffdrive_kinematics.core.kinematics import check_non_negative


def wrapped_increment(increment: float, period: float) -> float:
    """
    Return an increment modulo the range of the encoder.

    Parameters
    ----------
    increment : float
        Difference of two readings [rad].
    period : float
        Range of the encoder [rad]; 0: it does not wrap.

    Returns
    -------
    float
        The increment [rad] in (-period/2, period/2]; as it is where the encoder does not wrap.

    Examples
    --------
    >>> wrapped_increment(-3.0, period=4.0), wrapped_increment(-3.0, period=0.0)
    (1.0, -3.0)

    """
    if not period:
        return increment
    remainder = math.remainder(increment, period)  # exact
    return remainder + period if remainder <= -0.5 * period else remainder


@dataclass(frozen=True)
class PositionTrack:
    """
    Follows wrapped positions over their wrap-around.

    Parameters
    ----------
    period : float
        Range of the encoders [rad]; 0: they do not wrap.
    positions : tuple of float
        The last readings [rad], one a wheel, without their wraps.

    Examples
    --------
    >>> track = PositionTrack(period=4.0).followed((1.5, 0.0)).followed((-1.5, 0.5))
    >>> track.positions
    (2.5, 0.5)

    """

    period: float = 0.0
    positions: Tuple[float, ...] = ()

    def followed(self, readings: Sequence[float]) -> 'PositionTrack':
        """
        Return the track after further readings.

        The first readings, and those of another number of wheels, are taken as they are.  What
        follows differs from the reading by a whole number of ranges, so rounding does not add up.

        Parameters
        ----------
        readings : sequence of float
            Positions that were read [rad], one a wheel, all finite.

        Returns
        -------
        PositionTrack
            The track with their positions.

        Examples
        --------
        See :class:`PositionTrack`.

        """
        if not self.period or len(readings) != len(self.positions):
            return PositionTrack(self.period, tuple(readings))
        return PositionTrack(self.period, tuple(
            reading + self.period * round(
                (last + wrapped_increment(reading - last, self.period) - reading) / self.period)
            for reading, last in zip(readings, self.positions)))


@dataclass(frozen=True)
class Encoder:
    """
    A simulated encoder: what it reads of the angle that its wheel has rolled.

    Parameters
    ----------
    period : float
        Readings wrap into [-period/2, period/2) [rad]; 0: they do not wrap.
    resolution : float
        Ticks a turn of the wheel, not necessarily a whole number (gears); 0: any angle.

    Raises
    ------
    ValueError
        If a value is not finite or is below 0.

    Examples
    --------
    >>> Encoder(period=4.0).reading(2.5)
    -1.5
    >>> round(Encoder(resolution=360.0).reading(math.radians(1.5)), 6)  # 1 degree
    0.017453

    """

    period: float = 0.0
    resolution: float = 0.0

    def __post_init__(self) -> None:
        check_non_negative('encoder range', self.period)
        check_non_negative('encoder resolution', self.resolution)

    def reading(self, angle: float) -> float:
        """
        Return the position that is read at an angle: the tick passed last.

        Parameters
        ----------
        angle : float
            What the wheel has rolled [rad].

        Returns
        -------
        float
            Position [rad].

        Examples
        --------
        See :class:`Encoder`.

        """
        ticked = self._last_tick(angle) if self.resolution else angle
        if not self.period:
            return ticked
        remainder = math.remainder(ticked, self.period)
        return remainder - self.period if remainder >= 0.5 * self.period else remainder

    def _last_tick(self, angle: float) -> float:
        """Return the highest tick at or below an angle, so that ticks are read as themselves."""
        ticks = math.floor(angle * self.resolution / math.tau)
        if self._tick(ticks + 1) <= angle:
            ticks += 1
        return self._tick(ticks if self._tick(ticks) <= angle else ticks - 1)

    def _tick(self, number: int) -> float:
        return number * math.tau / self.resolution
