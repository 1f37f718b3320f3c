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
Noise on a stream of wheel motion: nominal samples in, biased and slipping samples out.

The travel between the stamps of two samples is perturbed, so the statistics are exact whatever
the message rate, and no clock is read.  The positions carry the noise exactly; the velocity is
the rate just asked for, times what the interval just past made of its travel.
"""

from dataclasses import dataclass, replace
import math
from typing import Optional, Tuple

from diffdrive_kinematics.core.kinematics import RunningSum
from diffdrive_kinematics.core.noise import (
    body_variances, BodySlip, draw_unit, effective_ratio, NO_BODY_SLIP, sample_travel,
    SessionError, travel_in_session, WheelSlip)
from diffdrive_kinematics.core.odometry.motion_update import update_motion
from diffdrive_kinematics.core.odometry.timeouts import ClockStep, step_tolerance
from diffdrive_kinematics.core.odometry.wheel_motion import baseline, rolled, shifted, WheelMotion
from diffdrive_kinematics.core.odometry.wheel_sample import Verdict, WheelPair, WheelSample, ZERO
import numpy as np


@dataclass(frozen=True)
class SlipStream:
    """
    The state between two samples.

    Parameters
    ----------
    radii : pair of float
        Effective radii [m] that relate angle and travel.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.
    timeout_ns : int or None
        Longest silence [ns] over which rates are held, as in the base; None = any.
    motion : WheelMotion or None
        The nominal motion; None until the first sample.
    last_out_ns : int
        Stamp of the last sample that was put out [ns].
    ahead : pair of float
        Nominal angle [rad] that was put out already, beyond the anchor of ``motion``.
    left, right : RunningSum
        Effective angles [rad] that were put out.
    session : SessionError or None
        What this run has from its start to its end; bias and slip come on top.
    separation : float
        Distance of the wheels [m], which only the curvature of a session and a body that turns
        too much ask for.
    body : BodySlip
        What slips beside the wheels, and moves both.

    Examples
    --------
    A left wheel that travels 50 % farther than it should:

    >>> stream = SlipStream((0.125, 0.125), WheelSlip(bias=0.5), WheelSlip(), timeout_ns=None)
    >>> generator = np.random.default_rng(1)
    >>> stream, _, _ = stream.apply(WheelSample(0, (8.0, 8.0)), generator)
    >>> stream, out, _ = stream.apply(WheelSample(1_000_000_000, (8.0, 8.0)), generator)
    >>> out.rates, out.positions
    ((12.0, 8.0), (12.0, 8.0))

    """

    radii: WheelPair
    left_slip: WheelSlip
    right_slip: WheelSlip
    timeout_ns: Optional[int]
    motion: Optional[WheelMotion] = None
    last_out_ns: int = 0
    ahead: WheelPair = ZERO
    left: RunningSum = RunningSum(0.0)
    right: RunningSum = RunningSum(0.0)
    session: Optional[SessionError] = None
    separation: float = 0.0
    body: BodySlip = NO_BODY_SLIP

    def apply(
            self, sample: WheelSample, generator: 'np.random.Generator'
    ) -> Tuple['SlipStream', Optional[WheelSample], Verdict]:
        """
        Return the stream after a sample, and what to put out.

        Parameters
        ----------
        sample : WheelSample
            Nominal motion of the wheels.
        generator : numpy.random.Generator
            Source of randomness.

        Returns
        -------
        stream : SlipStream
            The state after the sample.
        out : WheelSample or None
            Biased and slipping motion; None: drop the sample.  The first one put out has no
            positions: it is the baseline from which they count.
        verdict : Verdict
            What became of the sample.

        Examples
        --------
        See :class:`SlipStream`.

        """
        if self.motion is None:
            motion = baseline(sample)
            stream = replace(self, motion=motion, last_out_ns=sample.stamp_ns)
            return stream, self._out(sample, motion, ratios=None), Verdict.FIRST
        result = update_motion(
            self.motion, sample, now_ns=sample.stamp_ns, timeout_ns=self.timeout_ns)
        late = result.verdict is Verdict.REPEATED and sample.stamp_ns <= self.last_out_ns
        if late or result.verdict is Verdict.OUT_OF_ORDER:
            return self, None, result.verdict
        if result.verdict is Verdict.CLOCK_STEP:
            stream = replace(self, motion=result.motion, last_out_ns=sample.stamp_ns, ahead=ZERO)
            return stream, stream._out(sample, result.motion, ratios=None), result.verdict
        return *self._perturbed(sample, result.motion, result.rolled, generator), result.verdict

    def clock_stepped(self, step: ClockStep) -> 'SlipStream':
        """
        Return the stream as it reads after the clock of the stamps was stepped.

        Parameters
        ----------
        step : ClockStep
            By how much, and when.

        Returns
        -------
        SlipStream
            The stream with its times moved, where they are of before.

        Examples
        --------
        >>> stream = SlipStream((0.1, 0.1), WheelSlip(), WheelSlip(), timeout_ns=None)
        >>> stream, _, _ = stream.apply(WheelSample(5, (1.0, 1.0)), np.random.default_rng(1))
        >>> stream.clock_stepped(ClockStep(-2, now_ns=4)).last_out_ns
        3

        """
        if self.motion is None or not step.is_after(
                self.last_out_ns, step_tolerance(self.timeout_ns)):
            return self
        return replace(self, motion=shifted(self.motion, step.step_ns),
                       last_out_ns=self.last_out_ns + step.step_ns)

    def _perturbed(
            self, sample: WheelSample, motion: WheelMotion, anchor_moved: WheelPair,
            generator: 'np.random.Generator') -> Tuple['SlipStream', WheelSample]:
        """Perturb the nominal angle between the sample put out last and this one."""
        last_out_ns = max(sample.stamp_ns, self.last_out_ns + 1)
        held = rolled(motion, last_out_ns, self.timeout_ns)
        nominal = (anchor_moved[0] + held[0] - self.ahead[0],
                   anchor_moved[1] + held[1] - self.ahead[1])
        if self.session is not None:
            nominal = self._in_session(self.session, nominal)
        errors, variance = ZERO, 0.0
        if self.body and nominal != ZERO:
            errors, variance = self._of_body(nominal, generator)
        left, left_ratio = _slip(
            self.left_slip, nominal[0], self.radii[0], generator, errors[0], variance)
        right, right_ratio = _slip(
            self.right_slip, nominal[1], self.radii[1], generator, errors[1], variance)
        stream = replace(
            self, motion=motion, ahead=held, last_out_ns=last_out_ns,
            left=self.left.plus(left), right=self.right.plus(right))
        return stream, stream._out(sample, motion, ratios=(left_ratio, right_ratio))

    def _out(
            self, sample: WheelSample, motion: WheelMotion, ratios: Optional[WheelPair]
    ) -> WheelSample:
        """Return the sample to put out; its positions are left away while nothing counts yet."""
        first = self.motion is None
        left, right = ratios or (1.0 + self.left_slip.bias, 1.0 + self.right_slip.bias)
        held = motion.rates
        if self.session is not None:
            held = self._in_session(self.session, held)
        rates = (held[0] * left, held[1] * right) if motion.holds else None
        if first:
            return WheelSample(sample.stamp_ns, rates or ZERO)
        return WheelSample(self.last_out_ns, rates, (self.left.value, self.right.value))

    def _of_body(
            self, nominal: WheelPair, generator: 'np.random.Generator'
    ) -> Tuple[WheelPair, float]:
        """Return what the body adds to the travel of the wheels [m], and the variance of that."""
        left, right = (
            (1.0 + slip.bias) * radius * angle for slip, radius, angle in zip(
                (self.left_slip, self.right_slip), self.radii, nominal))
        half = 0.5 * self.separation
        along, heading = body_variances(
            self.body, 0.5 * (left + right), 0.5 * (right - left) / half if half else 0.0)
        distance, turn = (
            math.sqrt(variance) * float(draw_unit(self.body.distribution, generator))
            for variance in (along, heading))
        return (distance - half * turn, distance + half * turn), along + half * half * heading

    def _in_session(self, session: SessionError, wheels: WheelPair) -> WheelPair:
        """Return angles or rates of the wheels as they are in this session."""
        left, right = self.radii
        d_left, d_right = travel_in_session(
            session, self.separation, left * wheels[0], right * wheels[1])
        return float(d_left) / left, float(d_right) / right


def _slip(
        slip: WheelSlip, angle: float, radius: float, generator: 'np.random.Generator',
        of_body: float, variance: float) -> Tuple[float, float]:
    """
    Return (effective angle [rad], effective over nominal travel) of a nominal angle.

    To its travel the slip of the body adds ``of_body`` [m], of a variance [m^2].  A wheel at rest
    draws nothing: how long it rests does not change what its next metre does.
    """
    if angle == 0.0:
        return of_body / radius, 1.0 + slip.bias
    travel = angle * radius
    effective = float(sample_travel(slip, travel, generator)) + of_body
    return effective / radius, effective_ratio(slip, travel, effective, variance)
