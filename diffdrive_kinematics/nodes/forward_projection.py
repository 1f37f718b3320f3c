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

"""``forward_projection``: odometry and wheel rates in, where the robot may soon be out."""

import math
from typing import Any, List, Mapping, NamedTuple, Optional, Tuple, Union

from diffdrive_kinematics.core.kinematics import Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, Projected, projected, unit_bound, WheelSlip
import diffdrive_kinematics.core.odometry as core
from diffdrive_kinematics.ros.inputs.other_clock import StampWatch
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch
from diffdrive_kinematics.ros.messages.codec import encode_polygon, encode_poses
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader
from diffdrive_kinematics.ros.parameters.from_values import (
    body_slip, check_sides, check_wiring, wheel_geometry, wheel_slips)
from diffdrive_kinematics.ros.parameters.tables import FORWARD_PROJECTION
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample, stamp_values, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.ros.runtime.worker import InPlace, Worker
from geometry_msgs.msg import PolygonStamped, PoseArray
from nav_msgs.msg import Odometry
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

WAITING_REPORT_PERIOD_S = 10.0


class Config(NamedTuple):
    """What the projection is set to."""

    geometry: WheelGeometry
    timeout_ns: Optional[int]
    slips: Tuple[WheelSlip, WheelSlip]
    body: BodySlip
    values: Mapping[str, Any]

    def bounded(self) -> bool:
        """Return whether the slip has bounds, so that what can be reached has."""
        return math.isfinite(unit_bound(self.body.distribution)) or not (
            self.body or any(slip.variance for slip in self.slips))


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    for source in ('odom_topic', 'wheel_motion_topic'):
        check_wiring(values, source, ('poses_topic', 'boundary_topic'))
    check_sides(values)
    return Config(
        wheel_geometry(values), core.timeout_from_seconds(values['command_timeout']),
        wheel_slips(values), body_slip(values), values)


def _has_subscribers(publisher: Optional[Publisher]) -> bool:
    return publisher is not None and publisher.get_subscription_count() > 0


class ForwardProjection(DiffDriveNode[Config]):
    """
    Projects the last odometry forward as if the wheel rates were held for the horizon.

    Each odometry is projected once at most: where none comes, nothing is published.  What nobody
    listens to is not computed.  Computing takes up to half a second, so a worker does it, and
    where time is stepped, time waits for it.
    """

    def __init__(self, name: str = 'forward_projection', **composition: Any) -> None:
        super().__init__(name, FORWARD_PROJECTION, build, **composition)
        values = self.config.values
        self.wheel_reader = WheelReader.of(values)
        self._wheel_watch = WheelWatch(self, self.wheel_reader, values['wheel_motion_topic'])
        self._wheels = core.Odometry.starting_at(  # for its account of the rates alone
            Pose(0.0, 0.0, 0.0), geometry=self.config.geometry, timeout_ns=self.config.timeout_ns)
        self._odometry: Optional[Tuple[Odometry, Pose]] = None
        self._clocks = {
            name: StampWatch(self, values[name]) for name in ('odom_topic', 'wheel_motion_topic')}
        self._worker: Union[InPlace, Worker] = (
            InPlace(self._publish) if self.runtime.is_stepped else Worker(self._come_back))
        publish = self.runtime.publish_unless_off
        self._poses_publisher = publish(PoseArray, values['poses_topic'])
        self._boundary_publisher = publish(PolygonStamped, values['boundary_topic'])
        self.runtime.listen(Odometry, values['odom_topic'], self._on_odometry)
        self.runtime.listen(
            JointState, values['wheel_motion_topic'], self._on_wheels, raw=True, informed=True)
        self._timer = self.runtime.every(values['publish_rate'], self._tick)
        self.parameters.on_change(self._configure)
        self._report_bounds()

    def _on_odometry(self, message: Odometry) -> None:
        self._odometry = message, pose_in_plane(message.pose.pose)
        now_ns = self.synchronised_now()
        stamp_ns = nanoseconds(message.header.stamp) or now_ns
        self._clocks['odom_topic'].note(stamp_ns, now_ns)
        self.health.statistics.note(now_ns, stamp_ns)

    def _on_wheels(self, message: bytes, info: MessageInfo) -> None:
        if self.time.waits_for_clock():
            return
        now_ns = self.synchronised_now()
        sample = self.wheel_reader.read(message, lambda: now_ns, info.number)
        if sample is None:
            return
        self._clocks['wheel_motion_topic'].note(sample.stamp_ns, now_ns)
        self._wheels, verdict = self._wheels.update(sample, now_ns)
        self.rejections.judge(verdict, self.config.values['wheel_motion_topic'])

    def _tick(self) -> None:
        now_ns = self.synchronised_now()
        if self._odometry is None or self._wheels.motion is None:
            self.get_logger().info(
                'waiting for odometry and wheel motion',
                throttle_duration_sec=WAITING_REPORT_PERIOD_S, skip_first=True)
            return
        samples = self.config.values['samples'] if _has_subscribers(self._poses_publisher) else 0
        bounded = _has_subscribers(self._boundary_publisher) and self.config.bounded()
        if not samples and not bounded:
            return
        (odometry, pose), self._odometry = self._odometry, None
        try:
            commands = self._commands(now_ns)
        except ValueError as error:
            self.rejections.refuse(f'to project: {error}')
            return
        self._worker.ask(
            odometry.header, projected, pose, commands, self.config.geometry, self.config.slips,
            samples, self.config.values['seed'], bounded, self.config.body)

    def _commands(self, now_ns: int) -> List[Command]:
        """Return the twist of the wheels, held for the horizon, stage by stage."""
        v, w = self._wheels.predict(now_ns).twist
        stages = self.config.values['stages']
        return [Command(v, w, self.config.values['horizon'] / stages)] * stages

    def _come_back(self, header: Header, result: Optional[Projected], error: str) -> None:
        """Go on with a result in the loop of the node, not in the worker's thread."""
        executor = self.executor
        if executor:
            executor.create_task(self._publish, header, result, error)

    def _publish(self, header: Header, result: Optional[Projected], error: str) -> None:
        if result is None:
            self.rejections.refuse(f'to project: {error}')
            return
        self.health.sent += 1
        if self._poses_publisher and result.rows is not None:
            self._poses_publisher.publish(encode_poses(header, result.rows))
        if self._boundary_publisher and result.boundary is not None:
            self._boundary_publisher.publish(encode_polygon(header, *result.boundary))

    def close(self) -> None:
        """End what is still being computed."""
        self._worker.close()
        super().close()

    def status(self, sample: RateSample) -> Status:
        """Return how odometry comes in and projections go out."""
        values = self.config.values
        topic = self.resolve_topic_name(values['odom_topic'])
        return Status({
            **self.health.statistics.values(sample.now_ns, 'odometry'),
            'achieved projection rate [Hz]': sample.rate,
            'projections skipped': self._worker.skipped, **stamp_values(self.counts),
            **self._wheel_watch.values()}, [
                *self._wheel_watch.problems(),
                *self.health.statistics.problems(
                    sample.now_ns, values['command_timeout'], topic),
                *(problem for clock in self._clocks.values() for problem in clock.problems())])

    def on_clock_step(self, step: core.ClockStep) -> None:
        """Move along what is known of the wheels, and of the clocks of stamps."""
        self._wheels = self._wheels.clock_stepped(step.step_ns)
        for clock in self._clocks.values():
            clock.clock_stepped(step.step_ns)

    def _report_bounds(self) -> None:
        if self._boundary_publisher and not self.config.bounded():
            distribution = self.config.values['slip_distribution']
            self.get_logger().info(
                f"no boundary is published: slip_distribution is '{distribution}', which has no "
                'bounds')

    def _configure(self, config: Config) -> None:
        self._wheels = self._wheels.configured(
            config.geometry, config.timeout_ns, self.synchronised_now())
        self._timer = self.runtime.retimed(self._timer, config.values['publish_rate'], self._tick)
        self._report_bounds()


main = main_of(ForwardProjection)
