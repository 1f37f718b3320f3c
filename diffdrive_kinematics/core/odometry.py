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

from diffdrive_kinematics.core.angles import wrap_angle
from diffdrive_kinematics.core.arc import Pose
from diffdrive_kinematics.core.checks import (
    check_finite, check_non_negative, is_sane, LARGEST)
from diffdrive_kinematics.core.compensated import RunningSum
from diffdrive_kinematics.core.covariance import (
    moved_covariance, NO_COVARIANCE, PoseCovariance, slip_covariance)
from diffdrive_kinematics.core.geometry import (
    travel_from_angles, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.wheel_motion import (
    first_motion, Pair, rates_at, reached, receive, rolled, shifted, Verdict, WheelMotion,
    WheelSample)

__all__ = ['BaseReading', 'Odometry']

NO_SLIP: Pair = (0.0, 0.0)
NOTHING: Pair = (0.0, 0.0)


class BaseReading(NamedTuple):
    """
    The base at one time.

    Pose (theta in (-pi, pi]) [m, rad], twist (v, w) [m/s, rad/s] in the robot's frame, wheel
    angles rolled since the start [rad], and wheel rates [rad/s]; pairs are (left, right).
    """

    pose: Pose
    twist: Tuple[float, float]
    angles: Pair
    rates: Pair


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
        k (left, right) [m], the variance of a wheel's travel per metre; 0: the wheels do not
        slip.
    covariance : PoseCovariance
        Of the pose at the anchor, in the fixed frame.
    max_rate : float
        Wheel rate [rad/s] above which an increment of positions is no motion; inf: none is.

    """

    geometry: WheelGeometry
    timeout_ns: Optional[int]
    x: RunningSum = RunningSum(0.0)
    y: RunningSum = RunningSum(0.0)
    theta: RunningSum = RunningSum(0.0)
    left: RunningSum = RunningSum(0.0)
    right: RunningSum = RunningSum(0.0)
    motion: Optional[WheelMotion] = None
    slip_variances: Pair = NO_SLIP
    covariance: PoseCovariance = NO_COVARIANCE
    max_rate: float = math.inf

    @staticmethod
    def starting_at(
            pose: Pose, *, geometry: WheelGeometry, timeout_ns: Optional[int],
            slip_variances: Pair = NO_SLIP, covariance: PoseCovariance = NO_COVARIANCE
    ) -> 'Odometry':
        """
        Return the odometry of a base that stands at ``pose`` (scalars) with wheel angles 0.

        Raises
        ------
        ValueError
            If a coordinate is not finite, or a slip variance is not or is below 0.

        """
        _check_slip(slip_variances)
        for name, value in zip(('x', 'y', 'yaw'), pose):
            check_finite(f'{name} of the pose', float(value))
        return Odometry(
            geometry, timeout_ns, RunningSum(float(pose.x)), RunningSum(float(pose.y)),
            RunningSum(float(pose.theta)), slip_variances=slip_variances, covariance=covariance)

    def received(self, sample: WheelSample, now_ns: int) -> Tuple['Odometry', Verdict]:
        """
        Return the odometry after a sample, and what became of the sample.

        Raises
        ------
        ValueError
            If the sample amounts to an absurd speed or travel of this geometry.

        """
        self._check_sane(sample.rates or (0.0, 0.0), 'velocity')
        if self.motion is None:
            return self._replace(motion=first_motion(sample)), Verdict.FIRST
        result = receive(
            self.motion, sample, now_ns=now_ns, timeout_ns=self.timeout_ns,
            max_rate=self.max_rate)
        if result.verdict in (Verdict.REPEATED, Verdict.OUT_OF_ORDER):
            return self._replace(motion=result.motion), result.verdict
        self._check_sane(result.rolled, 'position')
        odometry, rest = self, result.rolled
        if result.known != NOTHING:
            odometry = self._rolled(result.known, self.motion)
            rest = rest[0] - result.known[0], rest[1] - result.known[1]
        return odometry._rolled(rest, result.motion), result.verdict

    def configured(
            self, geometry: WheelGeometry, timeout_ns: Optional[int], now_ns: int,
            slip_variances: Optional[Pair] = None) -> 'Odometry':
        """
        Return the odometry with what was rolled so far kept and new settings from now on.

        ``slip_variances`` None leaves them as they are.

        Raises
        ------
        ValueError
            If a slip variance is not finite or is below 0.

        """
        slip = _check_slip(self.slip_variances if slip_variances is None else slip_variances)
        if self.motion is not None:
            now_ns = reached(self.motion, now_ns, self.timeout_ns)
        if self.motion is None or not self.motion.holds or now_ns <= self.motion.anchor_ns:
            return self._replace(
                geometry=geometry, timeout_ns=timeout_ns, slip_variances=slip)
        angle = rolled(self.motion, now_ns, self.timeout_ns)
        reference = (self.motion.reference[0] + angle[0], self.motion.reference[1] + angle[1])
        motion = self.motion._replace(
            anchor_ns=now_ns, reference=reference,
            rates=rates_at(self.motion, now_ns, self.timeout_ns))
        return self._rolled(angle, motion)._replace(
            geometry=geometry, timeout_ns=timeout_ns, slip_variances=slip)

    def placed_at(
            self, pose: Pose, covariance: PoseCovariance, now_ns: int, *,
            keep_angles: bool = True) -> 'Odometry':
        """
        Return the odometry of a base that was put at ``pose`` (scalars), where it stands.

        It stands until the next sample.  Positions count on from where they are now: what the
        wheels rolled before moves nothing.  Without ``keep_angles`` the wheel angles are 0.

        Raises
        ------
        ValueError
            If a coordinate is not finite.

        """
        for name, value in zip(('x', 'y', 'yaw'), pose):
            check_finite(f'{name} of the pose', float(value))
        angle, motion = (0.0, 0.0), self.motion
        if motion is not None:
            time_ns = max(reached(motion, now_ns, self.timeout_ns), motion.anchor_ns) \
                if motion.holds else motion.anchor_ns
            angle = rolled(motion, time_ns, self.timeout_ns)
            motion = motion._replace(anchor_ns=time_ns, rates=(0.0, 0.0), reference=(
                motion.reference[0] + angle[0], motion.reference[1] + angle[1]))
        none = RunningSum(0.0)
        return self._replace(
            x=RunningSum(float(pose.x)), y=RunningSum(float(pose.y)),
            theta=RunningSum(float(pose.theta)), motion=motion, covariance=covariance,
            left=self.left.plus(angle[0]) if keep_angles else none,
            right=self.right.plus(angle[1]) if keep_angles else none)

    def clock_stepped(self, step_ns: int) -> 'Odometry':
        """Return the odometry as it reads after the clock itself was stepped."""
        return self._replace(motion=self.motion and shifted(self.motion, step_ns))

    def at(self, time_ns: int, now_ns: Optional[int] = None) -> BaseReading:
        """
        Return the base at a time; before the anchor that is the base at the anchor.

        ``now_ns`` is what the own clock shows, where the time is a past one.
        """
        if self.motion is None:
            return BaseReading(self._pose(0.0, 0.0), (0.0, 0.0),
                               (self.left.value, self.right.value), (0.0, 0.0))
        if now_ns is None or self.is_ahead(now_ns):
            time_ns = reached(self.motion, time_ns, self.timeout_ns)
        left, right = rolled(self.motion, time_ns, self.timeout_ns)
        rates = rates_at(self.motion, time_ns, self.timeout_ns)
        return BaseReading(
            self._pose(left, right), twist_from_wheel_rates(self.geometry, *rates),
            (self.left.value_with(left), self.right.value_with(right)), rates)

    def is_ahead(self, now_ns: int) -> bool:
        """Return whether the clock of the wheels' publisher is ahead, and must be another one."""
        return self.motion is not None and reached(
            self.motion, now_ns, self.timeout_ns) != now_ns

    def covariance_at(self, time_ns: int) -> PoseCovariance:
        """
        Return the covariance of the pose at a time, in the fixed frame (the axes of x and y).

        It is what the slip of the wheels has made of an exactly known start, to first order.
        """
        if self.motion is None or self._is_certain():
            return self.covariance
        time_ns = reached(self.motion, time_ns, self.timeout_ns)
        angle = rolled(self.motion, time_ns, self.timeout_ns)
        return self.covariance if angle == (0.0, 0.0) else self._covariance_after(angle)

    def _is_certain(self) -> bool:
        return self.slip_variances == NO_SLIP and self.covariance == NO_COVARIANCE

    def _covariance_after(self, angle: Pair) -> PoseCovariance:
        """Return the covariance after the wheels rolled by an angle [rad] from the anchor."""
        if self._is_certain():
            return self.covariance
        heading = self._heading()
        d_left, d_right = travel_from_angles(self.geometry, *angle)
        added = slip_covariance(
            self.geometry, heading, float(d_left), float(d_right), *self.slip_variances)
        return moved_covariance(
            self.covariance, Pose(0.0, 0.0, heading), Pose(*self._change(*angle)), added)

    def _check_sane(self, wheels: Pair, name: str) -> None:
        if not is_sane(*twist_from_wheel_rates(self.geometry, *wheels)):
            raise ValueError(
                f'{name} (left, right) is {wheels!r} since the message before, expected wheel '
                f'motion that moves the robot by less than {LARGEST:g} m and rad')

    def _pose(self, left: float, right: float) -> Pose:
        dx, dy, turn = self._change(left, right)
        return Pose(self.x.value_with(dx), self.y.value_with(dy),
                    wrap_angle(self.theta.value_with(turn)))

    def _rolled(self, angle: Pair, motion: Optional[WheelMotion]) -> 'Odometry':
        """Return the odometry with the anchor moved by an angle [rad], and what follows it."""
        left, right = angle
        dx, dy, turn = self._change(left, right)
        return Odometry(
            self.geometry, self.timeout_ns, self.x.plus(dx), self.y.plus(dy),
            self.theta.plus(turn), self.left.plus(left), self.right.plus(right), motion,
            self.slip_variances, self._covariance_after(angle), self.max_rate)

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


def _check_slip(slip_variances: Pair) -> Pair:
    left, right = slip_variances
    return (check_non_negative('left slip variance', left),
            check_non_negative('right slip variance', right))
