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
The lean path of a base: what nearly every message and tick is, in one flat function each.

In place, with caches cold, a tick costs some thirty times what it costs in a loop: what counts is
how many functions and objects it touches.  So the usual message and the usual tick have a path of
their own, over slots; anything else is left to the plain path, which is the one to read.  Both
publish the same bytes.

The usual message is laid out as the one before, the next one of the only publisher of both
wheels, later than the one before by less than the timeout, from a clock that agrees with ours.
Its rates are finite, and so are its positions, which agree with the rates held; where it has some,
its publisher is of this package.  The usual tick comes after one, within the timeout.  The joints
are two, not inverted, and no encoder reads them; nothing lasts a run.  The parameter ``lean_path``
turns it off.
"""

import math
from typing import Any, Callable, Mapping, Optional

from diffdrive_kinematics.core.kinematics import (
    displacement, is_sane, LARGEST, NANOSECONDS, Pose, twist_from_wheel_rates, wrap_angle)
from diffdrive_kinematics.core.noise import (
    arc_moments, CERTAIN, followed, NO_COVARIANCE, PoseCovariance, PoseMoments,
    second_moment_after, slip_on_arc)
from diffdrive_kinematics.core.odometry import (
    agree_within_rounding, Anchor, is_run, Odometry, WheelMotion, WheelTrack, ZERO)
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader, WheelWriter
from diffdrive_kinematics.ros.publishers.odometry import OdometryPublisher
from diffdrive_kinematics.ros.runtime.diagnostics import Health
from diffdrive_kinematics.ros.runtime.polling import Poll, QUEUE_DEPTH
from diffdrive_kinematics.ros.runtime.rclpy_private import hand_on, NUMBER, RECEIVED
from rclpy.publisher import Publisher


class LeanBase:
    """
    Holds the odometry of a base: as a value, and in slots while what comes is usual.

    Parameters
    ----------
    odometry : Odometry
        At the start.
    reader, poll, health :
        How wheel motion is read, where it waits, and what counts it.
    out, wheels, joints :
        What publishes odometry, and writes and publishes joint states; None: nothing does.
    beside : callable
        Publishes the pose of a tick, and its time [ns], in other forms.
    now, tick : callable
        The time [ns], up to which the odometry has followed all steps of the clock; and the tick
        of the plain path.

    """

    def __init__(
            self, odometry: Odometry, reader: WheelReader, poll: Poll, health: Health,
            out: OdometryPublisher, wheels: WheelWriter, joints: Optional[Publisher],
            beside: Callable[[int, Pose], None], *, now: Callable[[], int],
            tick: Callable[[], None]) -> None:
        self._odometry, self._live, self._fresh = odometry, False, False
        self._reader, self._poll, self._health = reader, poll, health
        self._out, self._beside = out, beside
        self._joints = joints
        self._encode_joints = wheels.encode_two
        self._now, self._plain_tick = now, tick

    @property
    def odometry(self) -> Odometry:
        """Return the odometry as it is now."""
        if self._fresh:
            self._fresh = False
            self._reader.caught_up(self._number - 1, self._positions, self._rates, self._heard_ns)
            before, wheels = self._odometry, self._odometry.wheels
            motion = WheelMotion(
                self._anchor_ns, self._last_ns, self._held, self._reference, True, self._source,
                self._counted)
            self._odometry = Odometry(
                before.geometry, before.slip_variances, self._anchor, WheelTrack(
                    *wheels[:4], self._left, self._right, motion, wheels.clock), before.body_slip)
        return self._odometry

    @odometry.setter
    def odometry(self, odometry: Odometry) -> None:
        self.leave()
        self._odometry = odometry

    def leave(self) -> None:
        """Take no message for the usual one until the plain path has heard one."""
        _, self._live = self.odometry, False

    def _enter(self, data: bytes) -> None:
        """Take what is like a message, which the plain path has heard, for the usual one."""
        usual, odometry = self._reader.usual(data), self._odometry
        motion, anchor, wheels = odometry.motion, odometry.anchor, odometry.wheels
        if not usual or motion is None or not motion.holds or odometry.measured or (
                wheels.clock.apart or anchor.session
                or self._joints and not self._encode_joints):
            return
        self._number, self._source, shape, self._rates_at, self._positions_at, self._gear = usual
        if motion.source != self._source or self._positions_at and not motion.counted:
            return
        self._size, self._unpack, self._texts, self._known = (
            len(data), shape.unpack, shape.texts, shape.known)
        self._anchor_ns, self._last_ns, self._held, self._reference, *_, self._counted = motion
        self._is_run = is_run(self._source)
        self._timeout_ns = math.inf if odometry.timeout_ns is None else odometry.timeout_ns
        self._clock, self._geometry = wheels.clock, odometry.geometry
        self._left, self._right = wheels.left, wheels.right
        self._anchor: Anchor = anchor
        self._at_rest: Optional[PoseCovariance] = None
        self._slips = *odometry.slip_variances, odometry.body_slip
        self._certain = anchor.moments is CERTAIN and not any(self._slips)
        self._twist = twist_from_wheel_rates(self._geometry, *self._held)
        self._live = self._new_rates = True

    def _hear(self, data: bytes, info: Mapping[str, Any], now_ns: int) -> bool:
        """Follow the usual message; False: it is another one, and nothing was done."""
        if info.get(NUMBER) != self._number or len(data) != self._size:
            return False
        fields = self._unpack(data)
        sec, nanosec = fields[1:3]
        stamp_ns, last_ns, clock = sec * NANOSECONDS + nanosec, self._last_ns, self._clock
        heard_ns = min(now_ns, info.get(RECEIVED) or now_ns)
        if self._texts(fields) != self._known or nanosec >= NANOSECONDS \
                or not 0 < stamp_ns - last_ns <= self._timeout_ns \
                or stamp_ns <= self._anchor_ns \
                or not clock.low_ns <= heard_ns - stamp_ns <= clock.high_ns:
            return False
        left, right = self._rates_at
        left_rate, right_rate = 0.0 + fields[left] / self._gear, 0.0 + fields[right] / self._gear
        if not (-LARGEST <= left_rate <= LARGEST and -LARGEST <= right_rate <= LARGEST):
            return False
        seconds = (stamp_ns - self._anchor_ns) / NANOSECONDS
        left_angle, right_angle = self._held[0] * seconds, self._held[1] * seconds
        held, positions = (left_angle, right_angle), ()
        if self._positions_at:
            left, right = self._positions_at
            positions = left, right = (
                0.0 + fields[left] / self._gear, 0.0 + fields[right] / self._gear)
            left_from, right_from = self._reference
            left_angle, right_angle = left - left_from, right - right_from
            if not (agree_within_rounding(held[0], left_angle, left, left_from)
                    and agree_within_rounding(held[1], right_angle, right, right_from)
                    and -LARGEST <= left <= LARGEST and -LARGEST <= right <= LARGEST):
                return False
        rates = left_rate, right_rate
        if rates != self._held:
            geometry, anchor = self._geometry, self._anchor
            distance, turn = twist_from_wheel_rates(geometry, left_angle, right_angle)
            twist = twist_from_wheel_rates(geometry, *rates)
            if not is_sane(distance, turn, *twist):
                return False
            x, y, theta, moments, _ = anchor
            heading = anchor.heading
            dx, dy = displacement(heading, distance, turn)
            if not self._certain and (left_angle or right_angle):
                moments = followed(moments, heading, complex(dx, dy), self._arc_moments(
                    left_angle, right_angle, swings=True))
            self._anchor = Anchor(x.plus(dx), y.plus(dy), theta.plus(turn), moments)
            self._at_rest, self._new_rates = None, True
            self._left, self._right = self._left.plus(left_angle), self._right.plus(right_angle)
            self._anchor_ns, self._held, self._twist = stamp_ns, rates, twist
            self._reference, self._counted = positions or ZERO, bool(positions) or self._is_run
        elif not positions:
            self._reference, self._counted = (-held[0], -held[1]), self._is_run
        self._last_ns, self._number, self._fresh = stamp_ns, self._number + 1, True
        self._positions, self._rates, self._heard_ns = positions, rates, heard_ns
        self._health.statistics.note(heard_ns, stamp_ns)
        return True

    def _arc_moments(self, left_angle: float, right_angle: float, *, swings: bool) -> PoseMoments:
        """Return the moments that wheels make which roll by angles [rad]."""
        geometry = self._geometry
        d_left, d_right = geometry.left_radius * left_angle, geometry.right_radius * right_angle
        return arc_moments(
            0.5 * (d_left + d_right), (d_right - d_left) / geometry.separation,
            slip_on_arc(geometry, d_left, d_right, *self._slips), swings=swings)

    def tick(self) -> None:
        """Follow what has come, and publish where the base is now."""
        now_ns, take = self._now(), self._poll.taken
        for _ in range(QUEUE_DEPTH):  # more cannot have come; a flood would never end
            taken = take()
            if not taken:
                break
            if not (self._live and self._hear(*taken, now_ns)):
                hand_on(taken, self._poll.callback)
                self._enter(taken[0])
        if not self._live or not self._anchor_ns < now_ns < self._last_ns + self._timeout_ns:
            self._new_rates = True  # the plain path publishes others
            self._plain_tick()
            return
        seconds, out = (now_ns - self._anchor_ns) / NANOSECONDS, self._out
        left_rate, right_rate = self._held
        left_angle, right_angle = left_rate * seconds, right_rate * seconds
        distance, turn = twist_from_wheel_rates(self._geometry, left_angle, right_angle)
        x, y, theta, moments, _ = self._anchor
        heading = self._anchor.heading
        dx, dy = displacement(heading, distance, turn)
        pose = x.value_with(dx), y.value_with(dy), wrap_angle(theta.value_with(turn))
        self._health.sent += 1
        if out.publisher:
            if out.pose_slips:
                if self._certain:
                    covariance = NO_COVARIANCE
                elif left_angle or right_angle:
                    covariance = second_moment_after(
                        moments, heading, complex(dx, dy),
                        self._arc_moments(left_angle, right_angle, swings=False))
                else:
                    covariance = self._at_rest = self._at_rest or moments.second_moment()
                out.codec.set_pose_covariance(covariance, out.floor)
            if self._new_rates:
                self._new_rates = False
                out.set_twist_covariance(self._held, self._odometry)
            out.publisher.publish(out.codec.encoded(now_ns, *pose, *self._twist))
        if self._joints:
            gear = self._gear
            self._joints.publish(self._encode_joints(
                now_ns, gear * self._left.value_with(left_angle),
                gear * self._right.value_with(right_angle), gear * left_rate, gear * right_rate))
        self._beside(now_ns, Pose(*pose))
