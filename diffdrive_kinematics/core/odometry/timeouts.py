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
Silence after which wheels stop, steps of the own clock, and how far off stamps may be then.

Clock and messages come by ways of their own: messages of before a step may come after it, and
those of after it before it is heard.
"""

from typing import NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS

STEP_TOLERANCE_NS = 1_000_000_000
TOLERANCE_NS = 250_000_000
IN_FLIGHT_NS = 1_000_000_000  # for which a message of before a step may still come


def timeout_from_seconds(seconds: float) -> Optional[int]:
    """
    Return a timeout in nanoseconds.

    Parameters
    ----------
    seconds : float
        The timeout [s]; 0: none.

    Returns
    -------
    int or None
        The timeout [ns]; None: none.

    Examples
    --------
    >>> timeout_from_seconds(0.5), timeout_from_seconds(0.0)
    (500000000, None)

    """
    return round(seconds * NANOSECONDS) if seconds else None


def step_tolerance(timeout_ns: Optional[int]) -> int:
    """
    Return how far a stamp may be off before it is taken for a step of the clock.

    Parameters
    ----------
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they do not.

    Returns
    -------
    int
        The timeout, and a second at least [ns].

    Examples
    --------
    >>> step_tolerance(None), step_tolerance(2_000_000_000)
    (1000000000, 2000000000)

    """
    return max(timeout_ns or 0, STEP_TOLERANCE_NS)


def tolerance_of(timeout_ns: Optional[int]) -> int:
    """
    Return how far stamps may be off where silence has a timeout: half of it.

    Parameters
    ----------
    timeout_ns : int or None
        The timeout [ns]; None: there is none.

    Returns
    -------
    int
        The tolerance [ns], a quarter of a second at most.

    Examples
    --------
    >>> tolerance_of(None), tolerance_of(100_000_000)
    (250000000, 50000000)

    """
    return TOLERANCE_NS if timeout_ns is None else min(TOLERANCE_NS, timeout_ns // 2)


class ClockStep(NamedTuple):
    """
    A step that the own clock made.

    Parameters
    ----------
    step_ns : int
        By how much it was stepped [ns], negative where it was set back.
    now_ns : int
        What it shows since then [ns].

    Examples
    --------
    A clock went from 9 s to 4 s; the stamps are of before it, of after it, and of another clock:

    >>> step = ClockStep(step_ns=-5000, now_ns=4000)
    >>> [step.read(stamp, now_ns=4010) for stamp in (8990, 4005, 40000)]
    [3990, 4005, 40000]
    >>> [step.is_after(stamp, tolerance_ns=1000) for stamp in (8980, 3980, 40000)]
    [True, False, False]

    """

    step_ns: int
    now_ns: int

    def read(self, stamp_ns: int, now_ns: int) -> int:
        """
        Return a stamp as the clock would give it since it was set back.

        Parameters
        ----------
        stamp_ns : int
            The stamp [ns].
        now_ns : int
            The time [ns].

        Returns
        -------
        int
            The stamp, moved in the first second after the step where it is nearer to the time
            before it than to the time now, by less than half of the step.

        Examples
        --------
        See :class:`ClockStep`.

        """
        before_ns = self.now_ns - self.step_ns
        apart_ns = abs(stamp_ns - before_ns)
        if now_ns < min(before_ns, self.now_ns + IN_FLIGHT_NS) and (
                apart_ns < stamp_ns - now_ns and 2 * apart_ns < -self.step_ns):
            return max(0, stamp_ns + self.step_ns)
        return stamp_ns

    def is_after(self, stamp_ns: int, tolerance_ns: int) -> bool:
        """
        Return whether the step came after the last message, by the stamp of that.

        Otherwise that message was of after it, or of another clock: what is placed by such stamps
        stays.

        Parameters
        ----------
        stamp_ns : int
            The last stamp [ns].
        tolerance_ns : int
            How long ago [ns] the last message is at most.

        Returns
        -------
        bool
            Whether it did, as far as can be known.

        Examples
        --------
        See :class:`ClockStep`.

        """
        ago_ns = self.now_ns - self.step_ns - stamp_ns
        return ago_ns >= -tolerance_ns and (stamp_ns > self.now_ns or ago_ns <= tolerance_ns)


NO_STEP = ClockStep(0, 0)
