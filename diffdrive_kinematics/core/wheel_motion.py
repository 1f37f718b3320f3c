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

from dataclasses import dataclass, replace
import enum
import math
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.checks import is_sane, LARGEST

__all__ = [
    'Pair', 'Received', 'Verdict', 'WheelMotion', 'WheelSample', 'ZERO', 'first_motion', 'is_run',
    'is_silent', 'rates_at', 'receive', 'rolled', 'shifted', 'step_tolerance',
    'timeout_from_seconds']

Pair = Tuple[float, float]
ZERO: Pair = (0.0, 0.0)
NANOSECONDS = 1e9
STEP_TOLERANCE_NS = 1_000_000_000


@dataclass(frozen=True)
class WheelSample:
    """
    One message about the wheels: rates [rad/s], positions [rad], or both; None where absent.

    ``source`` tells one publisher from another, where it is known; see :func:`is_run`.

    Raises
    ------
    ValueError
        If both are absent, or a value is not finite or is absurdly large.

    """

    stamp_ns: int
    rates: Optional[Pair]
    positions: Optional[Pair] = None
    source: str = ''

    def __post_init__(self) -> None:
        rates, positions = self.rates, self.positions
        if rates is None and positions is None:
            raise ValueError('velocity and position are absent, expected at least one of them')
        if rates is not None and not is_sane(*rates):
            raise _absurd('velocity', rates)
        if positions is not None and not is_sane(*positions):
            raise _absurd('position', positions)


def _absurd(name: str, pair: Pair) -> ValueError:
    return ValueError(
        f'{name} (left, right) is {pair!r}, expected finite numbers within +-{LARGEST:g}')


def is_run(source: str) -> bool:
    """
    Tell whether a source is one run of a publisher of this package.

    They have a ``#`` in it; anything else is what somebody else's driver takes for a frame.  Its
    positions count from anywhere, and its rates are what it makes of them.
    """
    return '#' in source


class WheelMotion(NamedTuple):
    """
    What is known about the wheels since the anchor.

    ``holds`` is False where only positions are known: nothing is extrapolated from them, and
    ``rates`` is what the last increment amounts to.  ``reference`` is what the publisher's
    positions [rad] are, or would be, at the anchor, where they are ``counted``; ``source`` is that
    publisher.
    """

    anchor_ns: int
    last_ns: int
    rates: Pair
    reference: Pair
    holds: bool
    source: str = ''
    counted: bool = True


class Verdict(enum.Enum):
    """What became of a sample."""

    FIRST = 'first'
    MOVED = 'moved'
    REPEATED = 'repeated'
    JUMPED = 'jump'
    OUT_OF_ORDER = 'out of order'
    CLOCK_STEP = 'clock step'


class Received(NamedTuple):
    """
    The motion after a sample, and the angle [rad] rolled between the two anchors.

    ``known`` is the part of it up to the last repeat, where the rest was rolled differently.
    """

    motion: WheelMotion
    rolled: Pair
    verdict: Verdict
    known: Pair = ZERO


def timeout_from_seconds(seconds: float) -> Optional[int]:
    """Return a timeout [ns] from seconds; 0 means none."""
    return round(seconds * NANOSECONDS) if seconds else None


def step_tolerance(timeout_ns: Optional[int]) -> int:
    """Return how far [ns] a stamp may be off before it is taken for a step of the clock."""
    return max(timeout_ns or 0, STEP_TOLERANCE_NS)


def first_motion(sample: WheelSample) -> WheelMotion:
    """Return the motion that starts with ``sample``: its positions are only a baseline."""
    return WheelMotion(
        sample.stamp_ns, sample.stamp_ns, sample.rates or ZERO, sample.positions or ZERO,
        holds=sample.rates is not None, source=sample.source,
        counted=bool(sample.positions) or is_run(sample.source))


def shifted(motion: WheelMotion, step_ns: int) -> WheelMotion:
    """Return the motion as it reads after the clock itself was stepped by ``step_ns``."""
    return motion._replace(
        anchor_ns=motion.anchor_ns + step_ns, last_ns=motion.last_ns + step_ns)


def rolled(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> Pair:
    """
    Return the angle [rad] rolled from the anchor to ``time_ns`` while the rates are held.

    ``timeout_ns`` None means that the wheels never stop by themselves.
    """
    if timeout_ns is not None and time_ns > motion.last_ns + timeout_ns:
        time_ns = motion.last_ns + timeout_ns
    if not motion.holds or time_ns <= motion.anchor_ns:
        return ZERO
    seconds = (time_ns - motion.anchor_ns) / NANOSECONDS
    return motion.rates[0] * seconds, motion.rates[1] * seconds


def rates_at(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> Pair:
    """Return the wheel rates [rad/s] at ``time_ns``: 0 from the timeout on."""
    return ZERO if is_silent(motion, time_ns, timeout_ns) else motion.rates


def is_silent(motion: WheelMotion, time_ns: int, timeout_ns: Optional[int]) -> bool:
    """Tell whether at ``time_ns`` nothing has been heard for the timeout."""
    return timeout_ns is not None and time_ns >= motion.last_ns + timeout_ns


def receive(
        motion: WheelMotion, sample: WheelSample, *, now_ns: int,
        timeout_ns: Optional[int], max_rate: float = math.inf, usual_ns: int = 0) -> Received:
    """
    Return what the wheels did up to ``sample``, and the motion that follows it.

    ``now_ns`` only serves to notice stamps from the future (a step of the clock).  A publisher
    whose clock is ahead for good makes one step, and its later stamps follow on each other.
    ``max_rate`` [rad/s] is the mean rate since the message before above which positions jumped,
    where messages are at least the usual interval apart; stamps may be closer than what they are
    the stamps of.
    """
    tolerance = step_tolerance(timeout_ns)
    stamp = sample.stamp_ns
    if stamp < motion.anchor_ns - tolerance or stamp > max(now_ns, motion.last_ns) + tolerance:
        return _stepped(motion, sample, timeout_ns)
    if stamp <= motion.anchor_ns:
        if stamp <= motion.last_ns:
            if _begins_at_the_anchor(sample, motion):
                return Received(first_motion(sample), ZERO, Verdict.MOVED)
            again = _is_the_anchor(sample, motion)
            return Received(motion, ZERO, Verdict.REPEATED if again else Verdict.OUT_OF_ORDER)
        stamp = motion.anchor_ns + 1  # it was on its way while the settings changed
        sample = replace(sample, stamp_ns=stamp)
    held = rolled(motion, stamp, timeout_ns)
    same_source = sample.source == motion.source
    counts = same_source and sample.positions is not None and motion.counted
    travelled = _increment(motion, sample) if counts else held
    if counts and _jumps(motion, travelled, stamp, max_rate, usual_ns):
        return Received(first_motion(sample), held, Verdict.JUMPED)
    begins = sample.positions is not None and not motion.counted
    as_held = not counts or _same(held, travelled, motion, sample)
    silent = (timeout_ns is not None and stamp > motion.last_ns + timeout_ns
              and motion.rates != ZERO)  # wheels at rest do not stop
    if (sample.rates == motion.rates and motion.holds and same_source and as_held
            and not silent and not begins):
        if stamp < motion.last_ns - tolerance:
            return _stepped(motion, sample, timeout_ns)
        return Received(_renewed(motion, sample, held), ZERO, Verdict.REPEATED)
    following = first_motion(sample)
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


def _renewed(motion: WheelMotion, repeat: WheelSample, held: Pair) -> WheelMotion:
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
    return Received(first_motion(sample), known, Verdict.CLOCK_STEP)


def _increment(motion: WheelMotion, sample: WheelSample) -> Pair:
    left, right = sample.positions or motion.reference
    return left - motion.reference[0], right - motion.reference[1]


def _jumps(
        motion: WheelMotion, travelled: Pair, stamp: int, max_rate: float,
        usual_ns: int) -> bool:
    """Tell whether positions went further since the message before than wheels can."""
    if max_rate == math.inf:
        return False
    since = motion.last_ns if motion.last_ns < stamp else motion.anchor_ns
    before = rolled(motion, since, None)
    reach = max_rate * max(stamp - since, usual_ns) / NANOSECONDS
    return any(abs(a - b) > reach + math.ulp(a) for a, b in zip(travelled, before))


def _same(held: Pair, travelled: Pair, motion: WheelMotion, sample: WheelSample) -> bool:
    """Tell whether the positions, if any, say what the held rates say, to their last digits."""
    positions, reference = sample.positions, motion.reference
    return positions is None or (
        _close(held[0], travelled[0], positions[0], reference[0])
        and _close(held[1], travelled[1], positions[1], reference[1]))


def _close(held: float, travelled: float, position: float, reference: float) -> bool:
    """Tell whether two angles differ by what rounding of the positions makes."""
    return abs(held - travelled) <= 4.0 * math.ulp(max(abs(position), abs(reference)))
