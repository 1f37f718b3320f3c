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
How messages, settings and clocks change what is known of the wheels.

Samples are placed on the clock of their sender, and the motion is kept in its time.
"""

import math
from typing import Optional, Tuple

from diffdrive_kinematics.core.kinematics import RunningSum
from diffdrive_kinematics.core.odometry.motion_update import update_motion
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock
from diffdrive_kinematics.core.odometry.timeouts import tolerance_of
from diffdrive_kinematics.core.odometry.wheel_motion import anchored, baseline, is_silent, rates_at
from diffdrive_kinematics.core.odometry.wheel_sample import (
    is_run, Verdict, WheelPair, WheelSample, ZERO)
from diffdrive_kinematics.core.odometry.wheel_state import WheelState

Arcs = Tuple[WheelPair, ...]
NO_ARCS: Arcs = ()
FIRST, REPEATED, OUT_OF_ORDER, CLOCK_STEP = (  # an enum is slow to look up
    Verdict.FIRST, Verdict.REPEATED, Verdict.OUT_OF_ORDER, Verdict.CLOCK_STEP)


class WheelTrack(WheelState):
    """
    The wheels followed over time; a value: :meth:`update` returns a new one.

    Parameters
    ----------
    timeout_ns, max_rate, unmeasured, measured, left, right, motion, clock : as there
        Fields of :class:`.WheelState`.

    Examples
    --------
    >>> wheels = WheelTrack(timeout_ns=None)
    >>> wheels, _, _ = wheels.update(WheelSample(0, rates=(1.0, 2.0)), now_ns=0)
    >>> wheels, angles, _ = wheels.update(WheelSample(500_000_000, (3.0, 3.0)), 500_000_000)
    >>> angles, wheels.left.value, wheels.state_at(1_500_000_000)
    (((0.5, 1.0),), 0.5, ((3.0, 3.0), (3.0, 3.0)))

    """

    __slots__ = ()

    def update(self, sample: WheelSample, now_ns: int) -> Tuple['WheelTrack', Arcs, Verdict]:
        """
        Return the track after a sample, how the anchor has moved, and what became of the sample.

        Parameters
        ----------
        sample : WheelSample
            What a message says of the wheels.
        now_ns : int
            When it came [ns], on the own clock.

        Returns
        -------
        track : WheelTrack
            The track after it.
        arcs : tuple of pair of float
            Angles (left, right) [rad] between the old anchor and the new one, one pair for each
            time over which the rates were constant.
        verdict : Verdict
            What became of the sample.

        Examples
        --------
        See :class:`WheelTrack`.

        """
        if sample.positions is not None and not is_run(sample.source):
            return self._update_measured(sample, now_ns)
        track = self if self.measured is None else self._without_positions()
        return track._update(sample, now_ns)

    def _update(
            self, sample: WheelSample, now_ns: int, max_rate: float = math.inf,
            usual_ns: int = 0) -> Tuple['WheelTrack', Arcs, Verdict]:
        """Return what :meth:`update` does, for a sample that means what it says."""
        track, arcs, clock, theirs_ns = self, NO_ARCS, self.clock, now_ns
        if not clock.low_ns <= now_ns - sample.stamp_ns <= clock.high_ns:
            theirs_ns, clock = clock.theirs_ns(now_ns), clock.observed(sample.stamp_ns, now_ns)
            if clock.apart and self._goes_back(clock, sample, theirs_ns):
                track, arcs = self._anchored_at(theirs_ns)
        motion = track.motion
        if motion is None:
            return track._replace(motion=baseline(sample), clock=clock), arcs, FIRST
        motion, angle, verdict, known = update_motion(
            motion, sample, now_ns=theirs_ns, timeout_ns=self.timeout_ns, max_rate=max_rate,
            usual_ns=usual_ns)
        if verdict is REPEATED or verdict is OUT_OF_ORDER:
            return WheelTrack(*track[:6], motion, clock), arcs, verdict
        if verdict is CLOCK_STEP:
            clock = clock.begun(sample.stamp_ns, now_ns)
        if known != ZERO:
            track, arcs = track._rolled(known), (*arcs, known)
            angle = angle[0] - known[0], angle[1] - known[1]
        return WheelTrack(  # twice as fast as _replace
            *track[:4], track.left.plus(angle[0]), track.right.plus(angle[1]), motion, clock
        ), (*arcs, angle), verdict

    def _rolled(self, angle: WheelPair) -> 'WheelTrack':
        return self._replace(left=self.left.plus(angle[0]), right=self.right.plus(angle[1]))

    def _goes_back(self, clock: SenderClock, sample: WheelSample, theirs_ns: int) -> bool:
        """
        Tell whether the time of wheels that turn by rates alone goes back with another clock.

        They wait for it where they are: nobody sees them turn back.
        """
        motion, back_ns = self.motion, clock.offset_ns - self.clock.offset_ns
        return (motion is not None and motion.holds and sample.positions is None
                and clock.tolerance_ns < 2 * back_ns <= 4 * clock.tolerance_ns
                and sample.stamp_ns > motion.last_ns and theirs_ns > motion.anchor_ns
                and not is_silent(motion, theirs_ns, self.timeout_ns))

    def _anchored_at(self, time_ns: int) -> Tuple['WheelTrack', Arcs]:
        """Return the track with its anchor at a time [ns] of the sender, and the arc to there."""
        motion = self.motion
        if motion is None:
            return self, NO_ARCS
        angle = self._angle(motion, time_ns)
        return self._rolled(angle)._replace(motion=anchored(
            motion, time_ns, rates_at(motion, time_ns, self.timeout_ns), angle)), (angle,)

    def _without_positions(self) -> 'WheelTrack':
        """Return the track that takes rates as they are: positions are lacking."""
        measured, motion = self.measured, self.motion
        if measured is None or motion is None:
            return self
        return self._replace(measured=None, motion=motion._replace(
            rates=measured.fallback_rates(), holds=True))

    def _update_measured(
            self, sample: WheelSample, now_ns: int) -> Tuple['WheelTrack', Arcs, Verdict]:
        """Return what :meth:`update` does, for positions of somebody else's driver."""
        measured = self.measured or self.unmeasured
        track, arcs, verdict = self._update(
            WheelSample(sample.stamp_ns, None, sample.positions, sample.source), now_ns,
            self.max_rate, measured.window.usual_ns)
        if verdict is REPEATED or verdict is OUT_OF_ORDER or track.motion is None:
            return track, arcs, verdict
        angles, theirs_ns = (track.left.value, track.right.value), self.clock.theirs_ns(now_ns)
        if verdict is CLOCK_STEP or self.motion is None:
            measured = measured.begun(sample.stamp_ns, angles, sample.rates)
        elif self.measured is None:  # up to now rates were taken as they are
            measured = measured.begun(sample.stamp_ns, angles, sample.rates, sample.rates or (
                rates_at(self.motion, theirs_ns, self.timeout_ns)))
        else:
            left, right = self._angle(self.motion, theirs_ns)
            measured = measured.followed(sample.stamp_ns, angles, sample.rates, (
                self.left.value_with(left) - angles[0], self.right.value_with(right) - angles[1]))
        held = measured.held_rates()
        motion = track.motion._replace(rates=held or ZERO, holds=held is not None)
        return track._replace(motion=motion, measured=measured), arcs, verdict

    def configured(self, timeout_ns: Optional[int], now_ns: int) -> Tuple['WheelTrack', Arcs]:
        """
        Return the track with another timeout from a time on, and how the anchor has moved.

        Parameters
        ----------
        timeout_ns : int or None
            Silence [ns] after which the wheels stop; None = never.
        now_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        track : WheelTrack
            The track under it, with its anchor at the time where rates are held.
        arcs : tuple of pair of float
            As :meth:`update` returns.

        Examples
        --------
        >>> wheels, _, _ = WheelTrack(timeout_ns=None).update(WheelSample(0, (1.0, 2.0)), now_ns=0)
        >>> wheels.configured(timeout_ns=500_000_000, now_ns=500_000_000)[1]
        ((0.5, 1.0),)

        """
        track, arcs, time_ns = self, NO_ARCS, self.clock.theirs_ns(now_ns)
        if self.motion is not None and self.motion.holds and time_ns > self.motion.anchor_ns:
            track, arcs = self._anchored_at(time_ns)
            track = track._replace(measured=self.measured and self.measured._replace(lead=ZERO))
        return track._replace(
            timeout_ns=timeout_ns, clock=self.clock.tolerating(tolerance_of(timeout_ns))), arcs

    def stopped(self, now_ns: int, *, keep_angles: bool) -> 'WheelTrack':
        """
        Return the track of wheels that stand from a time on until the next sample.

        Parameters
        ----------
        now_ns : int
            The time [ns], on the own clock.
        keep_angles : bool
            Whether the angles stay what they are, rather than 0.

        Returns
        -------
        WheelTrack
            The track, with its anchor at the time.

        Examples
        --------
        >>> wheels, _, _ = WheelTrack(timeout_ns=None).update(WheelSample(0, (1.0, 2.0)), now_ns=0)
        >>> wheels.stopped(500_000_000, keep_angles=True).left.value
        0.5

        """
        angle, motion = ZERO, self.motion
        if motion is not None:
            time_ns = max(self.clock.theirs_ns(now_ns), motion.anchor_ns) \
                if motion.holds else motion.anchor_ns
            angle = self._angle(motion, time_ns)
            motion = anchored(motion, time_ns, ZERO, angle)
        track, gone = self._rolled(angle), ZERO
        if not keep_angles:
            gone = -track.left.value, -track.right.value
            track = track._replace(left=RunningSum(0.0), right=RunningSum(0.0))
        return track._replace(motion=motion, measured=self.measured and self.measured.rested(gone))
