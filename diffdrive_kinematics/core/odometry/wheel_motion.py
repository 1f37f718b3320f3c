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
Wheel motion over time: from stamped samples of rates and positions to the angle rolled.

Stamps are integers of nanoseconds; pairs are (left, right).  The result depends on stamps only,
never on when a sample happened to arrive or how often somebody looked.

* The *anchor* is the last change of the rates.  From there the angle at any time is a closed
  form; a repeat of the same rates only renews ``last_ns``, so nothing accumulates.
* Where two samples carry positions, the increment is the truth (a lost sample costs nothing);
  otherwise the rates of the anchor are held.
* Without a sample for ``timeout_ns`` the wheels stop exactly at ``last_ns + timeout_ns``.
* Up to ``last_ns`` the rates are known to have been held: an increment that says otherwise is
  about the time since then, so a lost change of the rates costs one message's arc, no more.
* A sample between the anchor and ``last_ns`` supersedes what followed it.  So does one at the
  anchor where the wheels have not turned yet: a publisher's first message says that they stand,
  and the next one, of the same time, that they begin to turn.  Any other is a repeat or too late.
* A sample without positions is the baseline, 0, from which the positions of its publisher
  count, where it says who it is; of an unknown one it is the first positions after it, up to
  which the rates are held.  The first sample ever heard, and the first of another source (a
  publisher that was restarted, or a second one), is a baseline whatever it carries: up to it
  the rates are held.
  So is one whose positions would need a wheel rate above ``max_rate``: encoders that started
  again elsewhere.
"""

from dataclasses import dataclass
import enum
import math
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import is_sane, LARGEST, NANOSECONDS

__all__ = [
    'WheelPair', 'Received', 'Verdict', 'WheelMotion', 'WheelSample', 'ZERO', 'baseline', 'is_run',
    'is_silent', 'rates_at', 'update_motion', 'rolled', 'shifted', 'step_tolerance',
    'timeout_from_seconds']

WheelPair = Tuple[float, float]
ZERO: WheelPair = (0.0, 0.0)
STEP_TOLERANCE_NS = 1_000_000_000


@dataclass(frozen=True)
class WheelSample:
    """
    One message about the wheels.

    Parameters
    ----------
    stamp_ns : int
        Its stamp [ns].
    rates : pair of float or None
        Wheel rates [rad/s]; None where absent.
    positions : pair of float or None
        Angles of the wheels [rad]; None where absent.
    source : str
        What tells one publisher from another, where it is known; see :func:`is_run`.

    Raises
    ------
    ValueError
        If both are absent, or a value is not finite or is absurdly large.

    Examples
    --------
    See :func:`update_motion`.

    """

    stamp_ns: int
    rates: Optional[WheelPair]
    positions: Optional[WheelPair] = None
    source: str = ''

    def __post_init__(self) -> None:
        rates, positions = self.rates, self.positions
        if rates is None and positions is None:
            raise ValueError('velocity and position are absent, expected at least one of them')
        if rates is not None and not is_sane(*rates):
            raise _absurd('velocity', rates)
        if positions is not None and not is_sane(*positions):
            raise _absurd('position', positions)


def _absurd(name: str, pair: WheelPair) -> ValueError:
    return ValueError(
        f'{name} (left, right) is {pair!r}, expected finite numbers within +-{LARGEST:g}')


def is_run(source: str) -> bool:
    """
    Tell whether a source is one run of a publisher of this package.

    They have a ``#`` in it; anything else is what somebody else's driver takes for a frame.  Its
    positions count from anywhere, and its rates are what it makes of them.

    Parameters
    ----------
    source : str
        Of a sample.

    Returns
    -------
    bool
        Whether it has a ``#``.

    Examples
    --------
    >>> is_run('/simulated_base#1f3a'), is_run('base_link')
    (True, False)

    """
    return '#' in source


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


class Verdict(enum.Enum):
    """
    What became of a sample.

    Examples
    --------
    See :func:`update_motion`.

    """

    FIRST = 'first'
    MOVED = 'moved'
    REPEATED = 'repeated'
    JUMPED = 'jump'
    OUT_OF_ORDER = 'out of order'
    CLOCK_STEP = 'clock step'


class Received(NamedTuple):
    """
    The motion after a sample, and what was rolled up to it.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do from the sample on.
    rolled : pair of float
        Angle [rad] rolled between the two anchors.
    verdict : Verdict
        What became of the sample.
    known : pair of float
        The part of ``rolled`` up to the last repeat [rad], where the rest was rolled differently.

    Examples
    --------
    See :func:`update_motion`.

    """

    motion: WheelMotion
    rolled: WheelPair
    verdict: Verdict
    known: WheelPair = ZERO


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


def baseline(sample: WheelSample) -> WheelMotion:
    """
    Return the motion that starts with a sample: its positions are only a baseline.

    Parameters
    ----------
    sample : WheelSample
        The first one.

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
        sample.stamp_ns, sample.stamp_ns, sample.rates or ZERO, sample.positions or ZERO,
        holds=sample.rates is not None, source=sample.source,
        counted=bool(sample.positions) or is_run(sample.source))


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
    return motion._replace(
        anchor_ns=motion.anchor_ns + step_ns, last_ns=motion.last_ns + step_ns)


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


def update_motion(
        motion: WheelMotion, sample: WheelSample, *, now_ns: int,
        timeout_ns: Optional[int], max_rate: float = math.inf, usual_ns: int = 0) -> Received:
    """
    Return what the wheels did up to a sample, and the motion that follows it.

    A publisher whose clock is ahead for good makes one step, and its later stamps follow on each
    other.

    Parameters
    ----------
    motion : WheelMotion
        What the wheels do, by the samples before.
    sample : WheelSample
        The new one.
    now_ns : int
        Time [ns] that only serves to notice stamps from the future (a step of the clock).
    timeout_ns : int or None
        Silence after which the wheels stop [ns]; None: they never stop by themselves.
    max_rate : float
        Mean rate [rad/s] since the message before above which positions jumped, where messages
        are at least the usual interval apart; inf: they do not jump.
    usual_ns : int
        The usual interval [ns]; stamps may be closer than what they are the stamps of.

    Returns
    -------
    Received
        The motion that follows, what was rolled, and what became of the sample.

    Examples
    --------
    >>> motion = baseline(WheelSample(0, rates=(1.0, 2.0), positions=(7.0, 8.0)))
    >>> sample = WheelSample(500_000_000, rates=(0.0, 0.0), positions=(7.5, 9.0))
    >>> result = update_motion(motion, sample, now_ns=500_000_000, timeout_ns=None)
    >>> result.rolled, result.verdict is Verdict.MOVED
    ((0.5, 1.0), True)

    """
    tolerance = step_tolerance(timeout_ns)
    stamp = sample.stamp_ns
    if stamp < motion.anchor_ns - tolerance or stamp > max(now_ns, motion.last_ns) + tolerance:
        return _stepped(motion, sample, timeout_ns)
    if stamp <= motion.anchor_ns:
        if stamp <= motion.last_ns:
            if _begins_at_the_anchor(sample, motion):
                return Received(baseline(sample), ZERO, Verdict.MOVED)
            again = _is_the_anchor(sample, motion)
            return Received(motion, ZERO, Verdict.REPEATED if again else Verdict.OUT_OF_ORDER)
        stamp = motion.anchor_ns + 1  # it was on its way while the settings changed
    held = rolled(motion, stamp, timeout_ns)
    same_source = sample.source == motion.source
    counts = same_source and sample.positions is not None and motion.counted
    travelled = _increment(motion, sample) if counts else held
    if counts and _jumps(motion, travelled, stamp, max_rate, usual_ns):
        return Received(_motion_from(sample, stamp), held, Verdict.JUMPED)
    begins = sample.positions is not None and not motion.counted
    as_held = not counts or _same(held, travelled, motion, sample)
    silent = (timeout_ns is not None and stamp > motion.last_ns + timeout_ns
              and motion.rates != ZERO)  # wheels at rest do not stop
    if (sample.rates == motion.rates and motion.holds and same_source and as_held
            and not silent and not begins):
        if stamp < motion.last_ns - tolerance:
            return _stepped(motion, sample, timeout_ns)
        return Received(_renewed(motion, sample, held), ZERO, Verdict.REPEATED)
    following = _motion_from(sample, stamp)
    if sample.rates is None:
        seconds = (stamp - motion.anchor_ns) / NANOSECONDS
        following = following._replace(
            rates=(travelled[0] / seconds, travelled[1] / seconds))
    known = ZERO if as_held or stamp <= motion.last_ns else rolled(
        motion, motion.last_ns, timeout_ns)
    return Received(following, travelled, Verdict.MOVED, known)


def _is_the_anchor(sample: WheelSample, motion: WheelMotion) -> bool:
    """Tell whether a sample is the one at the anchor, come a second time."""
    return (sample.stamp_ns == motion.anchor_ns and sample.source == motion.source
            and sample.rates in (None, motion.rates)
            and sample.positions in (None, motion.reference))


def _begins_at_the_anchor(sample: WheelSample, motion: WheelMotion) -> bool:
    """Tell whether wheels that have never turned do so from the time of the anchor on."""
    return (sample.stamp_ns == motion.anchor_ns == motion.last_ns
            and sample.source == motion.source and sample.rates not in (None, ZERO)
            and motion.rates == motion.reference == sample.positions == ZERO)


def _motion_from(sample: WheelSample, anchor_ns: int) -> WheelMotion:
    """Return the motion that starts with a sample, which may be older than its anchor."""
    motion = baseline(sample)
    return motion if sample.stamp_ns == anchor_ns else motion._replace(anchor_ns=anchor_ns)


def _renewed(motion: WheelMotion, repeat: WheelSample, held: WheelPair) -> WheelMotion:
    """Return the motion after a repeat; one without positions is where they begin to count."""
    if repeat.stamp_ns < motion.last_ns:
        return motion
    reference = motion.reference if repeat.positions else (-held[0], -held[1])
    return motion._replace(last_ns=repeat.stamp_ns, reference=reference,
                           counted=bool(repeat.positions) or is_run(repeat.source))


def _stepped(
        motion: WheelMotion, sample: WheelSample, timeout_ns: Optional[int]) -> Received:
    """Begin anew after a step of the clock, with what is known up to the last stamp."""
    known = rolled(motion, motion.last_ns, timeout_ns)
    return Received(baseline(sample), known, Verdict.CLOCK_STEP)


def _increment(motion: WheelMotion, sample: WheelSample) -> WheelPair:
    left, right = sample.positions or motion.reference
    return left - motion.reference[0], right - motion.reference[1]


def _jumps(
        motion: WheelMotion, travelled: WheelPair, stamp: int, max_rate: float,
        usual_ns: int) -> bool:
    """Tell whether positions went further since the message before than wheels can."""
    if max_rate == math.inf:
        return False
    since = motion.last_ns if motion.last_ns < stamp else motion.anchor_ns
    before = rolled(motion, since, None)
    reach = max_rate * max(stamp - since, usual_ns) / NANOSECONDS
    return any(abs(a - b) > reach + math.ulp(a) for a, b in zip(travelled, before))


def _same(held: WheelPair, travelled: WheelPair, motion: WheelMotion, sample: WheelSample) -> bool:
    """Tell whether the positions, if any, say what the held rates say, to their last digits."""
    positions, reference = sample.positions, motion.reference
    return positions is None or (
        _close(held[0], travelled[0], positions[0], reference[0])
        and _close(held[1], travelled[1], positions[1], reference[1]))


def _close(held: float, travelled: float, position: float, reference: float) -> bool:
    """Tell whether two angles differ by what rounding of the positions makes."""
    return abs(held - travelled) <= 4.0 * math.ulp(max(abs(position), abs(reference)))
