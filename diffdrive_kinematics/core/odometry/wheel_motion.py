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
What the wheels do between two samples: they hold the rates of the *anchor*, until a timeout.

Stamps are integers of nanoseconds.  The angle at any time is a closed form from the anchor, which
is the last change of the rates: the result depends on stamps only, never on when a sample
happened to arrive or how often somebody looked, and nothing accumulates.  Without a sample for
``timeout_ns`` the wheels stop exactly at ``last_ns + timeout_ns``.
"""

from typing import NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.wheel_sample import is_run, WheelPair, WheelSample, ZERO


class WheelMotion(NamedTuple):
    """
    What is known about the wheels since the anchor.

    Parameters
    ----------
    anchor_ns : int
        Time of the last change of the rates [ns].
    last_ns : int
        Stamp of the last sample [ns].
    rates : pair of float
        Wheel rates [rad/s]; where only positions are known, what the last increment amounts to.
    reference : pair of float
        What the publisher's positions [rad] are, or would be, at the anchor.
    holds : bool
        Whether the rates are held; not so where only positions are known, from which nothing is
        extrapolated.
    source : str
        The publisher.
    counted : bool
        Whether its positions are counted from the reference.

    Examples
    --------
    See :func:`baseline`.

    """

    anchor_ns: int
    last_ns: int
    rates: WheelPair
    reference: WheelPair
    holds: bool
    source: str = ''
    counted: bool = True


def baseline(sample: WheelSample, anchor_ns: Optional[int] = None) -> WheelMotion:
    """
    Return the motion that starts with a sample: its positions are only a baseline.

    Parameters
    ----------
    sample : WheelSample
        The first one.
    anchor_ns : int or None
        Time from which it holds [ns]; None: its stamp.

    Returns
    -------
    WheelMotion
        The motion with its anchor at the sample.

    Examples
    --------
    >>> motion = baseline(WheelSample(5, rates=(1.0, 2.0), positions=(7.0, 8.0)))
    >>> motion.anchor_ns, motion.rates, motion.reference, motion.holds
    (5, (1.0, 2.0), (7.0, 8.0), True)

    """
    return WheelMotion(
        sample.stamp_ns if anchor_ns is None else anchor_ns, sample.stamp_ns,
        sample.rates or ZERO, sample.positions or ZERO, sample.rates is not None,
        sample.source, sample.positions is not None or is_run(sample.source))


def anchored(motion: WheelMotion, time_ns: int, rates: WheelPair, angle: WheelPair) -> WheelMotion:
    """
    Return the motion with its anchor at a later time.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do.
    time_ns : int
        The time [ns].
    rates : pair of float
        Wheel rates from then on [rad/s].
    angle : pair of float
        Angle rolled up to then [rad].

    Returns
    -------
    WheelMotion
        The motion, whose positions count on.

    Examples
    --------
    >>> motion = baseline(WheelSample(0, rates=(1.0, 2.0), positions=(7.0, 8.0)))
    >>> anchored(motion, 500_000_000, motion.rates, angle=(0.5, 1.0)).reference
    (7.5, 9.0)

    """
    return motion._replace(anchor_ns=time_ns, rates=rates, reference=(
        motion.reference[0] + angle[0], motion.reference[1] + angle[1]))


def shifted(motion: WheelMotion, step_ns: int) -> WheelMotion:
    """
    Return the motion as it reads after the clock itself was stepped.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do.
    step_ns : int
        By how much the clock was stepped [ns].

    Returns
    -------
    WheelMotion
        The motion with its times moved.

    Examples
    --------
    >>> motion = shifted(baseline(WheelSample(5, rates=(1.0, 2.0))), step_ns=-2)
    >>> motion.anchor_ns, motion.last_ns
    (3, 3)

    """
    return motion._replace(anchor_ns=motion.anchor_ns + step_ns, last_ns=motion.last_ns + step_ns)


def rolled(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> WheelPair:
    """
    Return the angle rolled from the anchor to a time while the rates are held.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do.
    time_ns : int
        The time [ns].
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they never stop by themselves.

    Returns
    -------
    pair of float
        Angle (left, right) [rad]; 0 before the anchor.

    Examples
    --------
    After half a second without a sample the wheels stop:

    >>> motion = baseline(WheelSample(0, rates=(1.0, 2.0)))
    >>> for time_ns in (250_000_000, 750_000_000):
    ...     (rolled(motion, time_ns, 500_000_000), rates_at(motion, time_ns, 500_000_000),
    ...      is_silent(motion, time_ns, 500_000_000))
    ((0.25, 0.5), (1.0, 2.0), False)
    ((0.5, 1.0), (0.0, 0.0), True)

    """
    if timeout_ns is not None and time_ns > motion.last_ns + timeout_ns:
        time_ns = motion.last_ns + timeout_ns
    if not motion.holds or time_ns <= motion.anchor_ns:
        return ZERO
    seconds = (time_ns - motion.anchor_ns) / NANOSECONDS
    return motion.rates[0] * seconds, motion.rates[1] * seconds


def rates_at(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> WheelPair:
    """
    Return the wheel rates at a time: 0 from the timeout on.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do.
    time_ns : int
        The time [ns].
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they never stop by themselves.

    Returns
    -------
    pair of float
        Wheel rates (left, right) [rad/s].

    Examples
    --------
    See :func:`rolled`.

    """
    return ZERO if is_silent(motion, time_ns, timeout_ns) else motion.rates


def is_silent(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> bool:
    """
    Tell whether at a time nothing has been heard for the timeout.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do.
    time_ns : int
        The time [ns].
    timeout_ns : int or None
        The timeout [ns]; None: there is none.

    Returns
    -------
    bool
        Whether the time is the last stamp plus the timeout, or later.

    Examples
    --------
    See :func:`rolled`.

    """
    return timeout_ns is not None and time_ns >= motion.last_ns + timeout_ns
