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

Messages, settings and poses that are set move the anchor; looking at it changes nothing.
"""

import math
from typing import Optional, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_non_negative, is_sane, LARGEST, Pose, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    BodySlip, gaussian_moments, NO_BODY_SLIP, NO_COVARIANCE, PoseCovariance)
from diffdrive_kinematics.core.odometry.anchor import Anchor
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.odometry_state import OdometryState
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock
from diffdrive_kinematics.core.odometry.timeouts import tolerance_of
from diffdrive_kinematics.core.odometry.wheel_sample import Verdict, WheelPair, WheelSample, ZERO
from diffdrive_kinematics.core.odometry.wheel_track import WheelTrack

REPEATED, OUT_OF_ORDER = Verdict.REPEATED, Verdict.OUT_OF_ORDER  # an enum is slow to look up


class Odometry(OdometryState):
    """
    Odometry of a base with wheel geometry; a value: every method returns a new one.

    Parameters
    ----------
    geometry, slip_variances, anchor, wheels, body_slip : as there
        The fields of :class:`.OdometryState`.

    Examples
    --------
    Wheels of radius 0.125 m that turn at 4 rad/s cover 0.5 m/s:

    >>> odometry = Odometry.starting_at(
    ...     Pose(1.0, 0.0, 0.0), geometry=WheelGeometry(0.5, 0.125), timeout_ns=None)
    >>> odometry, verdict = odometry.update(WheelSample(0, rates=(4.0, 4.0)), now_ns=0)
    >>> state = odometry.predict(2_000_000_000)
    >>> state.pose, state.twist, state.angles
    (Pose(x=2.0, y=0.0, theta=0.0), (0.5, 0.0), (8.0, 8.0))

    Half a second later it gets wheels of twice the size, and at 3 s it is put elsewhere:

    >>> odometry = odometry.configured(WheelGeometry(0.5, 0.25), None, now_ns=2_500_000_000)
    >>> odometry = odometry.set_pose(Pose(0.0, 3.0, 0.0), NO_COVARIANCE, now_ns=3_000_000_000)
    >>> state = odometry.predict(4_000_000_000)
    >>> state.pose, state.angles
    (Pose(x=0.0, y=3.0, theta=0.0), (12.0, 12.0))

    """

    __slots__ = ()

    @staticmethod
    def starting_at(
            pose: Pose, *, geometry: WheelGeometry, timeout_ns: Optional[int],
            slip_variances: WheelPair = ZERO, covariance: PoseCovariance = NO_COVARIANCE,
            max_rate: float = math.inf, unmeasured: MeasuredWheels = MeasuredWheels(),
            body_slip: BodySlip = NO_BODY_SLIP) -> 'Odometry':
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
        max_rate : float
            Wheel rate [rad/s] above which an increment of a driver's positions is no motion.
        unmeasured : MeasuredWheels
            How positions of a driver are followed.
        body_slip : BodySlip
            What slips beside the wheels.

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
        slip, anchor = _check_slip(slip_variances), Anchor.at(pose, gaussian_moments(covariance))
        clock = SenderClock(tolerance_of(timeout_ns))
        wheels = WheelTrack(timeout_ns, max_rate, unmeasured, clock=clock)
        return Odometry(geometry, slip, anchor, wheels, body_slip)

    def update(self, sample: WheelSample, now_ns: int) -> Tuple['Odometry', Verdict]:
        """
        Return the odometry after a sample, and what became of the sample.

        Parameters
        ----------
        sample : WheelSample
            What a message says of the wheels.
        now_ns : int
            When it came [ns], on the own clock.

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
        geometry, anchor = self.geometry, self.anchor
        wheels, arcs, verdict = self.wheels.update(sample, now_ns)
        if sample.rates is not None and (wheels.measured is not None or (
                verdict is not REPEATED and verdict is not OUT_OF_ORDER)):
            if not is_sane(*twist_from_wheel_rates(geometry, *sample.rates)):
                raise _absurd('velocity', sample.rates)
        for angle in arcs:
            distance, turn = twist_from_wheel_rates(geometry, *angle)  # times 1 s
            if not is_sane(distance, turn):
                raise _absurd('position', angle)
            anchor = anchor.moved(distance, turn, self._moments_after(anchor, angle))
        return Odometry(geometry, self.slip_variances, anchor, wheels, self.body_slip), verdict

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
        See :class:`Odometry`.

        """
        slip = _check_slip(self.slip_variances if slip_variances is None else slip_variances)
        anchor, (wheels, arcs) = self.anchor, self.wheels.configured(timeout_ns, now_ns)
        for angle in arcs:
            anchor = anchor.moved(*twist_from_wheel_rates(self.geometry, *angle),
                                  self._moments_after(anchor, angle))
        return Odometry(geometry, slip, anchor, wheels, self.body_slip)

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
        See :class:`Odometry`.

        """
        return self._replace(
            anchor=Anchor.at(pose, gaussian_moments(covariance), self.anchor.session),
            wheels=self.wheels.stopped(now_ns, keep_angles=keep_angles))


def _absurd(name: str, wheels: WheelPair) -> ValueError:
    return ValueError(
        f'{name} (left, right) is {wheels!r} since the message before, expected wheel motion that '
        f'moves the robot by less than {LARGEST:g} m and rad')


def _check_slip(slip_variances: WheelPair) -> WheelPair:
    return (check_non_negative('left slip variance', slip_variances[0]),
            check_non_negative('right slip variance', slip_variances[1]))
