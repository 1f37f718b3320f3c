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
Messages that carry only some of the joints, put together by joint.

Joints are measured one after the other.  They make a sample once each has been heard since the
sample before, at the time of the one that was measured first; where the others were then is
between two things that they said, of which those that may still matter are kept.  So stamps go
up, no motion counts twice, and a joint whose messages come late turns nothing.
"""

import math
from typing import Collection, Mapping, NamedTuple, Optional, Tuple

STEP_NS = 1_000_000_000  # back: the clock was stepped; further apart: clocks of their own
MOST_EARLIER = 500  # readings of a joint
POSITION, RATE = 1, 2  # in a reading


class JointReading(NamedTuple):
    """
    What a message says of a joint.

    Parameters
    ----------
    stamp_ns : int
        When the joint was measured [ns].
    position, rate : float
        Of the joint [rad, rad/s]; NaN: the message does not say.

    Examples
    --------
    >>> JointReading(10_000_000, position=1.5)
    JointReading(stamp_ns=10000000, position=1.5, rate=nan)

    """

    stamp_ns: int
    position: float = math.nan
    rate: float = math.nan


class Assembled(NamedTuple):
    """
    All joints at one time.

    Parameters
    ----------
    stamp_ns : int
        The time [ns].
    positions, rates : tuple of float
        Of the n joints [rad, rad/s]; NaN: not known.

    Examples
    --------
    >>> Assembly.of(1).after({0: JointReading(10_000_000, 1.5, 0.5)})[1]
    Assembled(stamp_ns=10000000, positions=(1.5,), rates=(0.5,))

    """

    stamp_ns: int
    positions: Tuple[float, ...]
    rates: Tuple[float, ...]


class Assembly(NamedTuple):
    """
    The last readings of each joint, and which joints came since the last sample.

    A value: :meth:`after` returns a new one.

    Parameters
    ----------
    newest : tuple of (JointReading or None)
        The last reading of each of n joints; None: there is none.
    earlier : tuple of tuple of JointReading
        Those before it, back to the time of the last sample, the oldest first.
    fresh : tuple of bool
        Whether each of the joints was heard since the last sample.

    Examples
    --------
    The second joint comes 10 ms after the first one; where it was then lies in between:

    >>> assembly, sample = Assembly.of(2).after({0: JointReading(0, 1.0), 1: JointReading(0, 2.0)})
    >>> sample.positions
    (1.0, 2.0)
    >>> assembly, sample = assembly.after({0: JointReading(10_000_000, 1.5)})
    >>> sample is None, assembly.fresh
    (True, (True, False))
    >>> assembly, sample = assembly.after({1: JointReading(20_000_000, 4.0)})
    >>> sample.stamp_ns, sample.positions
    (10000000, (1.5, 3.0))

    """

    newest: Tuple[Optional[JointReading], ...]
    earlier: Tuple[Tuple[JointReading, ...], ...]
    fresh: Tuple[bool, ...]

    @staticmethod
    def of(joints: int) -> 'Assembly':
        """
        Return the assembly of so many joints that have not been heard.

        Parameters
        ----------
        joints : int
            How many, 1 or more.

        Returns
        -------
        Assembly
            The assembly, without a reading.

        Examples
        --------
        See :class:`Assembly`.

        """
        return Assembly((None,) * joints, ((),) * joints, (False,) * joints)

    def without(self, joints: Collection[int]) -> 'Assembly':
        """
        Return the assembly in which some joints have not been heard.

        Parameters
        ----------
        joints : collection of int
            Which ones, counted from 0.

        Returns
        -------
        Assembly
            The assembly, without a reading of theirs.

        Examples
        --------
        >>> assembly, _ = Assembly.of(2).after({0: JointReading(0, 1.0)})
        >>> assembly.without([0]) == Assembly.of(2)
        True

        """
        kept = [joint not in joints for joint in range(len(self.fresh))]
        return Assembly(
            tuple(reading if keep else None for reading, keep in zip(self.newest, kept)),
            tuple(readings if keep else () for readings, keep in zip(self.earlier, kept)),
            tuple(fresh and keep for fresh, keep in zip(self.fresh, kept)))

    def after(
            self, readings: Mapping[int, JointReading]
    ) -> Tuple['Assembly', Optional[Assembled]]:
        """
        Return the assembly after a message, and the sample that it completes, if it does.

        A reading that is not newer than the last one of its joint is dropped; where it is older by
        more than ``STEP_NS``, the clock was stepped, and all begins anew with this message.

        Parameters
        ----------
        readings : mapping of int to JointReading
            What the message says, by joint, counted from 0.

        Returns
        -------
        assembly : Assembly
            The assembly after the message.
        sample : Assembled or None
            All joints when the one that was measured first was; None: some have not come yet.

        Raises
        ------
        IndexError
            If the number of a joint is too large for the assembly.

        Examples
        --------
        See :class:`Assembly`.

        """
        newest, earlier, fresh = list(self.newest), list(self.earlier), list(self.fresh)
        for joint, reading in readings.items():
            last = newest[joint]
            if last is not None and reading.stamp_ns < last.stamp_ns - STEP_NS:
                return Assembly.of(len(newest)).after(readings)
            if last is None or reading.stamp_ns > last.stamp_ns:
                newest[joint], fresh[joint] = reading, True
                if last is not None:
                    earlier[joint] = (*earlier[joint], last)[-MOST_EARLIER:]
        if not all(fresh):
            return Assembly(tuple(newest), tuple(earlier), tuple(fresh)), None
        stamp_ns = min(reading.stamp_ns for reading in newest if reading)
        sample = Assembled(
            stamp_ns, *(tuple(_value_at(stamp_ns, what, a, b) for a, b in zip(earlier, newest))
                        for what in (POSITION, RATE)))
        return Assembly(tuple(newest), tuple(
            _since(stamp_ns, each) for each in earlier), (False,) * len(fresh)), sample


def _since(stamp_ns: int, earlier: Tuple[JointReading, ...]) -> Tuple[JointReading, ...]:
    """
    Return the readings from the last one on that is not newer than a time [ns].

    Where the time is of another clock, so that none is, the last one alone.
    """
    if not earlier or earlier[-1].stamp_ns - stamp_ns > STEP_NS:
        return earlier[-1:]
    first = 0
    while first + 1 < len(earlier) and earlier[first + 1].stamp_ns <= stamp_ns:
        first += 1
    return earlier[first:]


def _value_at(
        stamp_ns: int, what: int, earlier: Tuple[JointReading, ...],
        newest: Optional[JointReading]) -> float:
    """Return the position [rad] or rate [rad/s] at a time at or before the newest reading."""
    if newest is None:
        return math.nan
    before, after, *_ = *_since(stamp_ns, earlier), newest, newest
    old, new = before[what], after[what]
    if math.isnan(old) or stamp_ns >= newest.stamp_ns:
        return newest[what]
    if before.stamp_ns >= stamp_ns:
        return old
    share = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
    return old + share * (new - old)
