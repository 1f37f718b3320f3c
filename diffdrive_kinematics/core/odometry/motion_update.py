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
What a sample says of the wheels: the angle rolled up to it, and the motion from there on.

* Where two samples carry positions, the increment is the truth (a lost sample costs nothing);
  otherwise the rates of the anchor are held.
* Up to ``last_ns`` the rates are known to have been held: an increment that says otherwise is
  about the time since then, so a lost change of the rates costs one message's arc, no more.
* A sample without positions is the baseline, 0, from which the positions of its publisher
  count, where it says who it is; of an unknown one it is the first positions after it, up to
  which the rates are held.  The first sample of all, and the first of another source (a
  publisher that was restarted, or a second one), is a baseline whatever it carries: up to it
  the rates are held.  So is one whose positions would need a wheel rate above ``max_rate``:
  encoders that started again elsewhere.
"""

import math
from typing import Callable, NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.motion_evidence import Evidence, evidence_of
from diffdrive_kinematics.core.odometry.timeouts import step_tolerance
from diffdrive_kinematics.core.odometry.wheel_motion import baseline, rolled, WheelMotion
from diffdrive_kinematics.core.odometry.wheel_sample import (
    is_run, Verdict, WheelPair, WheelSample, ZERO)

MOVED, REPEATED = Verdict.MOVED, Verdict.REPEATED  # an enum is slow to look up


class MotionUpdate(NamedTuple):
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


_Case = Callable[[WheelMotion, WheelSample, Evidence], MotionUpdate]


def update_motion(
        motion: WheelMotion, sample: WheelSample, *, now_ns: int,
        timeout_ns: Optional[int], max_rate: float = math.inf, usual_ns: int = 0) -> MotionUpdate:
    """
    Return what the wheels did up to a sample, and the motion that follows it.

    The first case that applies, of those below.  A publisher whose clock is ahead for good makes
    one step, and its later stamps follow on each other.

    ==============  ======================================  =================================
    case            the sample                              what follows
    ==============  ======================================  =================================
    `_clock_step`   is stamped far before the anchor, or    known up to ``last_ns``, then a
                    far ahead of the time and all before    new baseline
    `_first_turn`   is stamped as the anchor, where wheels  a new baseline: a publisher says
                    stood that have never turned            that they stand, then turn
    `_duplicate`    is the one at the anchor, once more     nothing
    `_late`         is another at the anchor, or before it  nothing: it is dropped
    `_jump`         has positions that no wheel reaches     rates held up to it, then a new
                                                            baseline
    `_clock_step`   is a repeat, far before ``last_ns``     as above
    `_repeat`       says what the held rates say            ``last_ns`` is renewed
    `_change`       is any other                            the angle is rolled, and it is
                                                            the new anchor
    ==============  ======================================  =================================

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
    MotionUpdate
        The motion that follows, what was rolled, and what became of the sample.

    Examples
    --------
    >>> motion = baseline(WheelSample(0, rates=(1.0, 2.0), positions=(7.0, 8.0)))
    >>> sample = WheelSample(500_000_000, rates=(0.0, 0.0), positions=(7.5, 9.0))
    >>> result = update_motion(motion, sample, now_ns=500_000_000, timeout_ns=None)
    >>> result.rolled, result.verdict is Verdict.MOVED
    ((0.5, 1.0), True)

    """
    evidence = evidence_of(motion, sample, timeout_ns)
    case = _case_of(motion, sample, evidence, now_ns, max_rate, usual_ns)
    return case(motion, sample, evidence)


def _case_of(
        motion: WheelMotion, sample: WheelSample, evidence: Evidence, now_ns: int,
        max_rate: float, usual_ns: int) -> _Case:
    """Return the case that a sample is, as in the table of :func:`update_motion`."""
    stamp_ns, anchor_ns, last_ns = sample.stamp_ns, motion.anchor_ns, motion.last_ns
    tolerance_ns = step_tolerance(evidence.timeout_ns)
    if stamp_ns < anchor_ns - tolerance_ns or (
            stamp_ns > now_ns + tolerance_ns and stamp_ns > last_ns + tolerance_ns):
        return _clock_step
    if stamp_ns <= anchor_ns and stamp_ns <= last_ns:
        if _begins_at_the_anchor(motion, sample):
            return _first_turn
        return _duplicate if _is_the_anchor(motion, sample) else _late
    if evidence.counts and _is_out_of_reach(motion, evidence, max_rate, usual_ns):
        return _jump
    if _is_repeat(motion, sample, evidence):
        return _repeat if stamp_ns >= last_ns - tolerance_ns else _clock_step
    return _change


def _clock_step(motion: WheelMotion, sample: WheelSample, evidence: Evidence) -> MotionUpdate:
    known = rolled(motion, motion.last_ns, evidence.timeout_ns)
    return MotionUpdate(baseline(sample), known, Verdict.CLOCK_STEP)


def _first_turn(motion: WheelMotion, sample: WheelSample, _: Evidence) -> MotionUpdate:
    return MotionUpdate(baseline(sample), ZERO, MOVED)


def _duplicate(motion: WheelMotion, _: WheelSample, __: Evidence) -> MotionUpdate:
    return MotionUpdate(motion, ZERO, REPEATED)


def _late(motion: WheelMotion, _: WheelSample, __: Evidence) -> MotionUpdate:
    return MotionUpdate(motion, ZERO, Verdict.OUT_OF_ORDER)


def _jump(_: WheelMotion, sample: WheelSample, evidence: Evidence) -> MotionUpdate:
    return MotionUpdate(baseline(sample, evidence.stamp_ns), evidence.held, Verdict.JUMPED)


def _repeat(motion: WheelMotion, sample: WheelSample, evidence: Evidence) -> MotionUpdate:
    """Renew the last stamp; a repeat without positions is where they begin to count."""
    if sample.stamp_ns >= motion.last_ns:
        motion = WheelMotion(motion.anchor_ns, sample.stamp_ns, *motion[2:])  # as _replace, faster
        if sample.positions is None:
            left, right = evidence.held
            motion = motion._replace(reference=(-left, -right), counted=is_run(sample.source))
    return MotionUpdate(motion, ZERO, REPEATED)


def _change(motion: WheelMotion, sample: WheelSample, evidence: Evidence) -> MotionUpdate:
    timeout_ns, stamp_ns, _, measured, _, agrees = evidence
    following = baseline(sample, stamp_ns)
    if sample.rates is None:
        seconds = (stamp_ns - motion.anchor_ns) / NANOSECONDS
        following = following._replace(rates=(measured[0] / seconds, measured[1] / seconds))
    known = ZERO if agrees or stamp_ns <= motion.last_ns else rolled(
        motion, motion.last_ns, timeout_ns)
    return MotionUpdate(following, measured, MOVED, known)


def _begins_at_the_anchor(motion: WheelMotion, sample: WheelSample) -> bool:
    """Tell whether wheels that have never turned do so from the time of the anchor on."""
    return (sample.stamp_ns == motion.anchor_ns == motion.last_ns
            and sample.source == motion.source and sample.rates not in (None, ZERO)
            and motion.rates == motion.reference == sample.positions == ZERO)


def _is_the_anchor(motion: WheelMotion, sample: WheelSample) -> bool:
    """Tell whether a sample is the one at the anchor, come a second time."""
    return (sample.stamp_ns == motion.anchor_ns and sample.source == motion.source
            and sample.rates in (None, motion.rates)
            and sample.positions in (None, motion.reference))


def _is_out_of_reach(
        motion: WheelMotion, evidence: Evidence, max_rate: float, usual_ns: int) -> bool:
    """Tell whether positions went further since the message before than wheels can."""
    if max_rate == math.inf:
        return False
    stamp_ns = evidence.stamp_ns
    since_ns = motion.last_ns if motion.last_ns < stamp_ns else motion.anchor_ns
    before = rolled(motion, since_ns, None)
    reach = max_rate * max(stamp_ns - since_ns, usual_ns) / NANOSECONDS
    return any(abs(a - b) > reach + math.ulp(a) for a, b in zip(evidence.measured, before))


def _is_repeat(motion: WheelMotion, sample: WheelSample, evidence: Evidence) -> bool:
    """Tell whether a sample says that the rates are held, and were until now."""
    if (sample.rates != motion.rates or not motion.holds or not evidence.agrees
            or sample.source != motion.source):
        return False
    if sample.positions is not None and not motion.counted:
        return False  # positions begin to count
    timeout_ns = evidence.timeout_ns
    return (timeout_ns is None or evidence.stamp_ns <= motion.last_ns + timeout_ns
            or motion.rates == ZERO)  # wheels at rest do not stop
