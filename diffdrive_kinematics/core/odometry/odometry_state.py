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
Where the base is, by the anchor and by what the wheels have rolled since.

The pose at a time is one exact arc from the anchor, so publishing it changes nothing.
"""

from typing import NamedTuple, Optional, Tuple, TypeVar

from diffdrive_kinematics.core.kinematics import (
    displacement, pose_change_from_travel, travel_from_angles, twist_from_wheel_rates,
    WheelGeometry)
from diffdrive_kinematics.core.noise import (
    arc_moments, BodySlip, CERTAIN, followed, NO_BODY_SLIP, NO_COVARIANCE, PoseCovariance,
    PoseMoments, second_moment_after, slip_on_arc)
from diffdrive_kinematics.core.odometry.anchor import Anchor, BaseState
from diffdrive_kinematics.core.odometry.measured_wheels import MeasuredWheels
from diffdrive_kinematics.core.odometry.sender_clock import SenderClock
from diffdrive_kinematics.core.odometry.wheel_motion import WheelMotion
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO
from diffdrive_kinematics.core.odometry.wheel_track import WheelTrack

State = TypeVar('State', bound='OdometryState')


class OdometryState(NamedTuple):
    """
    What is known of a base with wheel geometry.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    slip_variances : pair of float
        Variances k (left, right) [m] of a wheel's travel per metre; 0: the wheels do not slip.
    anchor : Anchor
        Pose at the anchor, and the moments of its error.
    wheels : WheelTrack
        What the wheels have rolled up to the anchor, and since.
    body_slip : BodySlip
        What slips beside the wheels.

    Examples
    --------
    >>> from diffdrive_kinematics.core.kinematics import Pose
    >>> state = OdometryState(
    ...     WheelGeometry(0.5, 0.125), (0.0, 0.0), Anchor.at(Pose(1.0, 2.0, 0.0)),
    ...     WheelTrack(timeout_ns=None))
    >>> state.predict(0).pose, state.at_rest
    (Pose(x=1.0, y=2.0, theta=0.0), False)
    >>> state.moments_at(0) is CERTAIN
    True
    >>> state.with_moments(CERTAIN).clock_stepped(5) == state  # it has heard nothing yet
    True

    """

    geometry: WheelGeometry
    slip_variances: WheelPair
    anchor: Anchor
    wheels: WheelTrack
    body_slip: BodySlip = NO_BODY_SLIP

    @property
    def motion(self) -> Optional[WheelMotion]:
        """Return what the wheels do since the anchor; None until the first sample."""
        return self.wheels.motion

    @property
    def clock(self) -> SenderClock:
        """Return the clock by which samples are stamped."""
        return self.wheels.clock

    @property
    def measured(self) -> Optional[MeasuredWheels]:
        """Return what a driver says of the wheels; None: this package's own publishers."""
        return self.wheels.measured

    @property
    def timeout_ns(self) -> Optional[int]:
        """Return the silence [ns] after which the wheels stop; None = never."""
        return self.wheels.timeout_ns

    @property
    def at_rest(self) -> bool:
        """Return whether the wheels were at rest by the last sample."""
        return self.wheels.at_rest

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
        See :class:`OdometryState`.

        """
        geometry, _, anchor, wheels, _ = self
        (left, right), rates = wheels.state_at(time_ns)
        return BaseState(
            anchor.pose_after(*twist_from_wheel_rates(geometry, left, right)),
            twist_from_wheel_rates(geometry, *rates),
            (wheels.left.value_with(left), wheels.right.value_with(right)), rates)

    def covariance_at(self, time_ns: int) -> PoseCovariance:
        """
        Return the covariance of the pose at a time, in the fixed frame (the axes of x and y).

        It is the second moment of the error about the pose of :meth:`predict`, whose mean is
        that of :meth:`moments_at`; what lasts a run is on top.

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
        After 1 m ahead ``Var theta = (k_l + k_r) |d| / L^2``, and the way is shorter on average:

        >>> from diffdrive_kinematics.core.kinematics import Pose
        >>> from diffdrive_kinematics.core.odometry import WheelSample
        >>> wheels, _, _ = WheelTrack(timeout_ns=None).update(WheelSample(0, (4.0, 4.0)), now_ns=0)
        >>> state = OdometryState(
        ...     WheelGeometry(0.5, 0.125), (1e-4, 1e-4), Anchor.at(Pose(0.0, 0.0, 0.0)), wheels)
        >>> round(state.covariance_at(2_000_000_000).tt, 9)
        0.0008
        >>> f'{state.moments_at(2_000_000_000).mean_error.real:.1e} m'
        '-2.0e-04 m'

        """
        _, _, _, moments, session = anchor = self.anchor
        if moments is CERTAIN and self.slip_variances == ZERO and not (session or self.body_slip):
            return NO_COVARIANCE
        angle, heading = self.wheels.angle_at(time_ns), anchor.heading
        covariance = moments.second_moment() if angle == ZERO else second_moment_after(
            moments, heading, *self._arc(heading, angle, swings=False))
        return covariance if session is None else covariance.plus(
            anchor.session_after(*twist_from_wheel_rates(self.geometry, *angle)))

    def moments_at(self, time_ns: int) -> PoseMoments:
        """
        Return the moments that slip makes of the error of the pose; see ``arc_moments``.

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
        See :class:`OdometryState`.

        """
        return self._moments_after(self.anchor, self.wheels.angle_at(time_ns))

    def with_moments(self: State, moments: PoseMoments) -> State:
        """
        Return the odometry with other moments of the error at the anchor.

        Parameters
        ----------
        moments : PoseMoments
            Of true minus published pose.

        Returns
        -------
        OdometryState
            The odometry with them.

        Examples
        --------
        See :class:`OdometryState`.

        """
        return self._replace(anchor=self.anchor._replace(moments=moments))

    def clock_stepped(self: State, step_ns: int) -> State:
        """
        Return the odometry as it reads after the own clock was stepped, and with it theirs.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        OdometryState
            The odometry with its times moved; those of a clock that is another one stay.

        Examples
        --------
        See :class:`OdometryState`.

        """
        return self._replace(wheels=self.wheels.clock_stepped(step_ns))

    def _moments_after(self, anchor: Anchor, angle: WheelPair) -> PoseMoments:
        """Return the moments after the wheels rolled by an angle [rad] from an anchor."""
        moments = anchor.moments
        if angle == ZERO or moments is CERTAIN and not any((*self.slip_variances, self.body_slip)):
            return moments
        heading = anchor.heading
        return followed(moments, heading, *self._arc(heading, angle, swings=True))

    def _arc(self, heading: float, angle: WheelPair, swings: bool) -> Tuple[complex, PoseMoments]:
        """Return the way that the wheels make from a heading [rad], and its moments."""
        geometry = self.geometry
        d_left, d_right = travel_from_angles(geometry, *angle)
        distance, turn = pose_change_from_travel(geometry, d_left, d_right)
        return complex(*displacement(heading, distance, turn)), arc_moments(
            distance, turn, slip_on_arc(
                geometry, d_left, d_right, *self.slip_variances, self.body_slip), swings=swings)
