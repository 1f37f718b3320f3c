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
Odometry: the pose that wheel motion amounts to, evaluated from an anchor at any time.

The pose at the anchor is kept with compensated sums; the pose at a time is one exact arc from
there, so publishing neither accumulates nor changes anything.  The covariance of the pose lives
at the anchor too.
"""

import math
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_finite, check_non_negative, is_sane, LARGEST, Pose, RunningSum, travel_from_angles,
    twist_from_wheel_rates, WheelGeometry, wrap_angle)
from diffdrive_kinematics.core.noise import (
    arc_moments, CERTAIN, followed, gaussian_moments, NO_COVARIANCE, PoseCovariance, PoseMoments,
    slip_on_arc)
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock, tolerance_of
from diffdrive_kinematics.core.odometry.wheel_motion import (
    baseline, is_run, is_silent, rates_at, rolled, shifted, update_motion, Verdict,
    WheelMotion, WheelPair, WheelSample)

__all__ = ['BaseState', 'Odometry']

NO_SLIP: WheelPair = (0.0, 0.0)
NOTHING: WheelPair = (0.0, 0.0)
REPEATED, OUT_OF_ORDER, CLOCK_STEP = (  # an enum is slow to look up
    Verdict.REPEATED, Verdict.OUT_OF_ORDER, Verdict.CLOCK_STEP)


class BaseState(NamedTuple):
    """
    The base at one time.

    Parameters
    ----------
    pose : Pose
        Where it is [m, m, rad]; theta in (-pi, pi].
    twist : pair of float
        Forward speed v [m/s] and yaw rate w [rad/s].
    angles : pair of float
        Wheel angles (left, right) rolled since the start [rad].
    rates : pair of float
        Wheel rates (left, right) [rad/s].

    Examples
    --------
    >>> reading = BaseState(Pose(1.0, 0.0, 0.0), (0.5, 0.0), angles=(8.0, 8.0), rates=(4.0, 4.0))
    >>> reading.pose.x
    1.0

    """

    pose: Pose
    twist: Tuple[float, float]
    angles: WheelPair
    rates: WheelPair


class Odometry(NamedTuple):
    """
    Odometry of a base with wheel geometry; a value: every method returns a new one.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    timeout_ns : int or None
        Silence [ns] after which the wheels stop, at the last stamp plus this; None = never.
    x, y, theta : RunningSum
        Pose at the anchor [m, m, rad]; theta is not wrapped.
    left, right : RunningSum
        Angles rolled up to the anchor [rad].
    motion : WheelMotion or None
        What the wheels do since the anchor; None until the first sample.
    slip_variances : pair of float
        Variances k (left, right) [m] of a wheel's travel per metre; 0: the wheels do not slip.
    moments : PoseMoments
        Of the error of the pose at the anchor, in the fixed frame.
    max_rate : float
        Wheel rate [rad/s] above which an increment of a driver's positions is no motion; inf:
        none is.
    clock : SenderClock
        By which samples are stamped; the motion is kept in its time.
    measured : MeasuredWheels or None
        What a driver of somebody else says of the wheels; None: this package's own publishers.
    unmeasured : MeasuredWheels
        What that starts from.

    Examples
    --------
    Wheels of radius 0.125 m that turn at 4 rad/s cover 0.5 m/s:

    >>> odometry = Odometry.starting_at(
    ...     Pose(1.0, 0.0, 0.0), geometry=WheelGeometry(0.5, 0.125), timeout_ns=None)
    >>> odometry, verdict = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
    >>> reading = odometry.predict(2_000_000_000)
    >>> reading.pose, reading.twist, reading.angles
    (Pose(x=2.0, y=0.0, theta=0.0), (0.5, 0.0), (8.0, 8.0))

    """

    geometry: WheelGeometry
    timeout_ns: Optional[int]
    x: RunningSum = RunningSum(0.0)
    y: RunningSum = RunningSum(0.0)
    theta: RunningSum = RunningSum(0.0)
    left: RunningSum = RunningSum(0.0)
    right: RunningSum = RunningSum(0.0)
    motion: Optional[WheelMotion] = None
    slip_variances: WheelPair = NO_SLIP
    moments: PoseMoments = CERTAIN
    max_rate: float = math.inf
    clock: SenderClock = SenderClock(tolerance_of(None))
    measured: Optional[MeasuredWheels] = None
    unmeasured: MeasuredWheels = MeasuredWheels()

    @staticmethod
    def starting_at(
            pose: Pose, *, geometry: WheelGeometry, timeout_ns: Optional[int],
            slip_variances: WheelPair = NO_SLIP, covariance: PoseCovariance = NO_COVARIANCE
    ) -> 'Odometry':
        """
        Return the odometry of a base that stands at a pose with wheel angles 0.

        Parameters
        ----------
        pose : Pose
            Where it stands; scalars.
        geometry : WheelGeometry
            Size and spacing of the wheels.
        timeout_ns : int or None
            Silence [ns] after which the wheels stop; None = never.
        slip_variances : pair of float
            Variances k (left, right) [m] of a wheel's travel per metre.
        covariance : PoseCovariance
            Of the pose, in the fixed frame; its error is Gaussian.

        Returns
        -------
        Odometry
            The odometry before its first sample.

        Raises
        ------
        ValueError
            If a coordinate is not finite, or a slip variance is not or is below 0.

        Examples
        --------
        See :class:`Odometry`.

        """
        _check_slip(slip_variances)
        for name, value in zip(('x', 'y', 'yaw'), pose):
            check_finite(f'{name} of the pose', float(value))
        return Odometry(
            geometry, timeout_ns, RunningSum(float(pose.x)), RunningSum(float(pose.y)),
            RunningSum(float(pose.theta)), slip_variances=slip_variances,
            moments=gaussian_moments(covariance), clock=SenderClock(tolerance_of(timeout_ns)))

    def update(self, sample: WheelSample, now_ns: int) -> Tuple['Odometry', Verdict]:
        """
        Return the odometry after a sample, and what became of the sample.

        Parameters
        ----------
        sample : WheelSample
            What was heard of the wheels.
        now_ns : int
            When it was heard [ns], on the own clock.

        Returns
        -------
        odometry : Odometry
            The odometry after it.
        verdict : Verdict
            What became of it.

        Raises
        ------
        ValueError
            If the sample amounts to an absurd speed or travel of this geometry.

        Examples
        --------
        See :class:`Odometry`.

        """
        if sample.positions is not None and not is_run(sample.source):
            return self._measuring(sample, now_ns)
        own = self if self.measured is None else self._unmeasured()
        return own._received(sample, now_ns)

    def _received(
            self, sample: WheelSample, now_ns: int, max_rate: float = math.inf,
            usual_ns: int = 0) -> Tuple['Odometry', Verdict]:
        """Return the odometry after a sample that means what it says."""
        odometry, motion = self, self.motion
        clock, theirs_ns = self.clock, now_ns
        if not clock.low_ns <= now_ns - sample.stamp_ns <= clock.high_ns:
            theirs_ns, clock = clock.theirs_ns(now_ns), clock.observed(sample.stamp_ns, now_ns)
            if clock.apart and self._goes_back(clock, sample, theirs_ns):
                odometry = self._anchored_at(theirs_ns)
                motion = odometry.motion
        if motion is None:
            self._check_sane(sample.rates or NOTHING, 'velocity')
            return self._replace(motion=baseline(sample), clock=clock), Verdict.FIRST
        result = update_motion(
            motion, sample, now_ns=theirs_ns, timeout_ns=self.timeout_ns, max_rate=max_rate,
            usual_ns=usual_ns)
        verdict = result.verdict
        if verdict is REPEATED or verdict is OUT_OF_ORDER:
            return Odometry(
                self.geometry, self.timeout_ns, odometry.x, odometry.y, odometry.theta,
                odometry.left, odometry.right, result.motion, self.slip_variances,
                odometry.moments, self.max_rate, clock, self.measured, self.unmeasured), verdict
        self._check_sane(sample.rates or NOTHING, 'velocity')
        self._check_sane(result.rolled, 'position')
        if verdict is CLOCK_STEP:
            clock = clock.begun(sample.stamp_ns, now_ns)
        rest = result.rolled
        if result.known != NOTHING:
            odometry = odometry._rolled(result.known, motion, clock)
            rest = rest[0] - result.known[0], rest[1] - result.known[1]
        return odometry._rolled(rest, result.motion, clock), verdict

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

    def _anchored_at(self, time_ns: int) -> 'Odometry':
        """Return the odometry with its anchor at a time [ns] on the samples' clock."""
        motion = self.motion
        if motion is None:
            return self
        angle = self._angle_at(motion, time_ns)
        return self._rolled(angle, motion._replace(
            anchor_ns=time_ns, rates=rates_at(motion, time_ns, self.timeout_ns), reference=(
                motion.reference[0] + angle[0], motion.reference[1] + angle[1])), self.clock)

    def _unmeasured(self) -> 'Odometry':
        """Return the odometry that takes rates at their word: positions are lacking."""
        measured, motion = self.measured, self.motion
        if measured is None or motion is None:
            return self
        return self._replace(measured=None, motion=motion._replace(
            rates=measured.told_rates(), holds=True))

    def _measuring(self, sample: WheelSample, now_ns: int) -> Tuple['Odometry', Verdict]:
        """Return the odometry after positions of somebody else's driver."""
        self._check_sane(sample.rates or NOTHING, 'velocity')
        measured = self.measured or self.unmeasured
        odometry, verdict = self._received(
            WheelSample(sample.stamp_ns, None, sample.positions, sample.source), now_ns,
            self.max_rate, measured.window.usual_ns)
        if verdict in (REPEATED, OUT_OF_ORDER) or odometry.motion is None:
            return odometry, verdict
        angles = odometry.left.value, odometry.right.value
        if verdict is CLOCK_STEP or self.motion is None:
            measured = measured.begun(sample.stamp_ns, angles, sample.rates)
        elif self.measured is None:  # up to now rates were taken at their word
            measured = measured.begun(sample.stamp_ns, angles, sample.rates, sample.rates or (
                rates_at(self.motion, self._theirs(now_ns), self.timeout_ns)))
        else:
            told = self._angle_at(self.motion, self._theirs(now_ns))
            measured = measured.followed(sample.stamp_ns, angles, sample.rates, (
                self.left.value_with(told[0]) - angles[0],
                self.right.value_with(told[1]) - angles[1]))
        held = measured.held_rates()
        motion = odometry.motion._replace(rates=held or NOTHING, holds=held is not None)
        return odometry._replace(motion=motion, measured=measured), verdict

    def configured(
            self, geometry: WheelGeometry, timeout_ns: Optional[int], now_ns: int,
            slip_variances: Optional[WheelPair] = None) -> 'Odometry':
        """
        Return the odometry with what was rolled so far kept and new settings from now on.

        Parameters
        ----------
        geometry : WheelGeometry
            Size and spacing of the wheels.
        timeout_ns : int or None
            Silence [ns] after which the wheels stop; None = never.
        now_ns : int
            Time from which the settings hold [ns], on the own clock.
        slip_variances : pair of float or None
            Variances k (left, right) [m] of a wheel's travel per metre; None: as they are.

        Returns
        -------
        Odometry
            The odometry under them.

        Raises
        ------
        ValueError
            If a slip variance is not finite or is below 0.

        Examples
        --------
        A second at 0.5 m/s, and another with wheels of twice the size:

        >>> odometry = Odometry(WheelGeometry(0.5, wheel_radius=0.125), timeout_ns=None)
        >>> odometry, _ = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
        >>> odometry = odometry.configured(
        ...     WheelGeometry(0.5, wheel_radius=0.25), timeout_ns=None, now_ns=1_000_000_000)
        >>> odometry.predict(2_000_000_000).pose.x
        1.5

        """
        slip = _check_slip(self.slip_variances if slip_variances is None else slip_variances)
        now_ns, clock = self._theirs(now_ns), self.clock.tolerating(
            tolerance_of(timeout_ns))
        if self.motion is None or not self.motion.holds or now_ns <= self.motion.anchor_ns:
            return self._replace(
                geometry=geometry, timeout_ns=timeout_ns, slip_variances=slip, clock=clock)
        return self._anchored_at(now_ns)._replace(
            geometry=geometry, timeout_ns=timeout_ns, slip_variances=slip, clock=clock,
            measured=self.measured and self.measured._replace(lead=NOTHING))

    def set_pose(
            self, pose: Pose, covariance: PoseCovariance, now_ns: int, *,
            keep_angles: bool = True) -> 'Odometry':
        """
        Return the odometry of a base that was put at a pose, where it stands.

        It stands until the next sample.  Positions count on from where they are now: what the
        wheels rolled before moves nothing.

        Parameters
        ----------
        pose : Pose
            Where it was put; scalars.
        covariance : PoseCovariance
            Of the pose, in the fixed frame; its error is Gaussian.
        now_ns : int
            When it was put there [ns], on the own clock.
        keep_angles : bool
            Whether the wheel angles stay what they are, rather than 0.

        Returns
        -------
        Odometry
            The odometry of the base there.

        Raises
        ------
        ValueError
            If a coordinate is not finite.

        Examples
        --------
        >>> odometry = Odometry(WheelGeometry(0.5, 0.125), timeout_ns=None)
        >>> odometry, _ = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
        >>> odometry = odometry.set_pose(Pose(0.0, 3.0, 0.0), NO_COVARIANCE, now_ns=1_000_000_000)
        >>> reading = odometry.predict(2_000_000_000)
        >>> reading.pose, reading.angles
        (Pose(x=0.0, y=3.0, theta=0.0), (4.0, 4.0))

        """
        for name, value in zip(('x', 'y', 'yaw'), pose):
            check_finite(f'{name} of the pose', float(value))
        angle, motion = NOTHING, self.motion
        if motion is not None:
            time_ns = max(self._theirs(now_ns), motion.anchor_ns) \
                if motion.holds else motion.anchor_ns
            angle = self._angle_at(motion, time_ns)
            motion = motion._replace(anchor_ns=time_ns, rates=NOTHING, reference=(
                motion.reference[0] + angle[0], motion.reference[1] + angle[1]))
        none = RunningSum(0.0)
        left = self.left.plus(angle[0]) if keep_angles else none
        right = self.right.plus(angle[1]) if keep_angles else none
        gone = (0.0, 0.0) if keep_angles else (
            -self.left.value_with(angle[0]), -self.right.value_with(angle[1]))
        return self._replace(
            x=RunningSum(float(pose.x)), y=RunningSum(float(pose.y)),
            theta=RunningSum(float(pose.theta)), motion=motion,
            moments=gaussian_moments(covariance), left=left, right=right,
            measured=self.measured and self.measured.rested(gone))

    def clock_stepped(self, step_ns: int) -> 'Odometry':
        """
        Return the odometry as it reads after the own clock was stepped, and with it theirs.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        Odometry
            The odometry with its times moved; those of a clock that is another one stay.

        Examples
        --------
        >>> odometry = Odometry(WheelGeometry(0.5, 0.125), timeout_ns=None)
        >>> odometry, _ = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
        >>> odometry.clock_stepped(5_000_000_000).predict(7_000_000_000).pose.x
        1.0

        """
        clock = self.clock.clock_stepped(step_ns)
        if self.clock.apart:  # theirs is another one
            return self._replace(clock=clock)
        return self._replace(
            clock=clock, motion=self.motion and shifted(self.motion, step_ns),
            measured=self.measured and self.measured.clock_stepped(step_ns))

    @property
    def at_rest(self) -> bool:
        """Return whether the wheels are known to have been at rest when they were heard last."""
        if self.motion is None:
            return False
        return (self.motion if self.measured is None else self.measured).rates == NOTHING

    def predict(self, time_ns: int) -> BaseState:
        """
        Return the base at a time; before the anchor that is the base at the anchor.

        Parameters
        ----------
        time_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        BaseState
            Pose, twist, wheel angles and rates.

        Examples
        --------
        See :class:`Odometry`.

        """
        if self.motion is None:
            return BaseState(self._pose(0.0, 0.0), (0.0, 0.0),
                             (self.left.value, self.right.value), (0.0, 0.0))
        time_ns = self._theirs(time_ns)
        if self.measured is None:
            left, right = rolled(self.motion, time_ns, self.timeout_ns)
            rates = rates_at(self.motion, time_ns, self.timeout_ns)
        else:
            left, right = self._angle_at(self.motion, time_ns)
            rates = NOTHING if is_silent(
                self.motion, time_ns, self.timeout_ns) else self.measured.rates
        return BaseState(
            self._pose(left, right), twist_from_wheel_rates(self.geometry, *rates),
            (self.left.value_with(left), self.right.value_with(right)), rates)

    def _theirs(self, time_ns: int) -> int:
        """Return the time [ns] on the clock of the samples when the own one shows ``time_ns``."""
        return self.clock.theirs_ns(time_ns) if self.clock.apart else time_ns

    def _angle_at(self, motion: WheelMotion, time_ns: int) -> WheelPair:
        """Return the angle [rad] rolled from the anchor to a time on the samples' clock."""
        if self.measured is None:
            return rolled(motion, time_ns, self.timeout_ns)
        return self.measured.led(
            rolled(motion, time_ns, self.measured.reach_ns(self.timeout_ns)))

    def covariance_at(self, time_ns: int) -> PoseCovariance:
        """
        Return the covariance of the pose at a time, in the fixed frame (the axes of x and y).

        It is the second moment of the error about the pose of :meth:`predict`, whose mean is
        that of :meth:`moments_at`.

        Parameters
        ----------
        time_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        PoseCovariance
            Of x, y and theta.

        Examples
        --------
        After 1 m straight ahead ``Var theta = (k_l + k_r) |d| / L^2``:

        >>> odometry = Odometry(WheelGeometry(0.5, 0.125), None, slip_variances=(1e-4, 1e-4))
        >>> odometry, _ = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
        >>> round(odometry.covariance_at(2_000_000_000).tt, 9)
        0.0008

        """
        if self._is_certain():
            return NO_COVARIANCE
        return self.moments_at(time_ns).second_moment()

    def moments_at(self, time_ns: int) -> PoseMoments:
        """
        Return the moments of the error of the pose at a time, in the fixed frame.

        They are what slip makes of the start, exactly; the equations stand in ``arc_moments``.

        Parameters
        ----------
        time_ns : int
            The time [ns], on the own clock.

        Returns
        -------
        PoseMoments
            Of true minus published pose.

        Examples
        --------
        A heading that is not known shortens the way on average:

        >>> odometry = Odometry(WheelGeometry(0.5, 0.125), None, slip_variances=(1e-4, 1e-4))
        >>> odometry, _ = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
        >>> f'{odometry.moments_at(2_000_000_000).mean_error.real:.1e} m'
        '-2.0e-04 m'

        """
        if self.motion is None:
            return self.moments
        return self._moments_after(self._angle_at(self.motion, self._theirs(time_ns)))

    def _is_certain(self) -> bool:
        return self.slip_variances == NO_SLIP and self.moments is CERTAIN

    def _moments_after(self, angle: WheelPair) -> PoseMoments:
        """Return the moments after the wheels rolled by an angle [rad] from the anchor."""
        if angle == NOTHING or self._is_certain():
            return self.moments
        d_left, d_right = travel_from_angles(self.geometry, *angle)
        dx, dy, turn = self._change(*angle)
        slip = slip_on_arc(self.geometry, d_left, d_right, *self.slip_variances)
        return followed(
            self.moments, self._heading(), complex(dx, dy),
            arc_moments(0.5 * (d_left + d_right), turn, slip))

    def _check_sane(self, wheels: WheelPair, name: str) -> None:
        if not is_sane(*twist_from_wheel_rates(self.geometry, *wheels)):
            raise ValueError(
                f'{name} (left, right) is {wheels!r} since the message before, expected wheel '
                f'motion that moves the robot by less than {LARGEST:g} m and rad')

    def _pose(self, left: float, right: float) -> Pose:
        dx, dy, turn = self._change(left, right)
        return Pose(self.x.value_with(dx), self.y.value_with(dy),
                    wrap_angle(self.theta.value_with(turn)))

    def _rolled(
            self, angle: WheelPair, motion: Optional[WheelMotion], clock: SenderClock
    ) -> 'Odometry':
        """Return the odometry with the anchor moved by an angle [rad], and what follows it."""
        left, right = angle
        dx, dy, turn = self._change(left, right)
        return Odometry(
            self.geometry, self.timeout_ns, self.x.plus(dx), self.y.plus(dy),
            self.theta.plus(turn), self.left.plus(left), self.right.plus(right), motion,
            self.slip_variances, self._moments_after(angle), self.max_rate, clock,
            self.measured, self.unmeasured)

    def _change(self, left: float, right: float) -> Tuple[float, float, float]:
        """
        Return the change of the pose [m, m, rad] in the fixed frame for wheel angles [rad].

        It is ``arc.advance`` from the origin, written out for floats: every odometry that is
        published comes through here.
        """
        geometry = self.geometry
        d_left, d_right = geometry.left_radius * left, geometry.right_radius * right
        turn = (d_right - d_left) / geometry.separation
        half = 0.5 * turn
        chord = 0.5 * (d_left + d_right) * (math.sin(half) / half if half else 1.0)
        direction = self._heading() + half
        return chord * math.cos(direction), chord * math.sin(direction), turn

    def _heading(self) -> float:
        """Return the heading [rad] at the anchor, within a turn."""
        return math.remainder(self.theta.high, math.tau) + self.theta.low


def _check_slip(slip_variances: WheelPair) -> WheelPair:
    left, right = slip_variances
    return (check_non_negative('left slip variance', left),
            check_non_negative('right slip variance', right))
