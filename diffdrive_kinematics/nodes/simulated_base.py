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

"""``simulated_base``: wheel motion in, odometry, joint states and tf out."""

from typing import Any, Mapping, NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import NO_COVARIANCE, PoseCovariance, PoseMoments
import diffdrive_kinematics.core.odometry as core
from diffdrive_kinematics.ros.inputs.driver_watch import DriverWatch
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch
from diffdrive_kinematics.ros.messages.messages import given_pose
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader, WheelWriter
from diffdrive_kinematics.ros.parameters.from_values import (
    check_frames, check_sides, check_wiring, configured_odometry, initial_odometry,
    initial_pose, wheel_geometry)
from diffdrive_kinematics.ros.parameters.tables import SIMULATED_BASE
from diffdrive_kinematics.ros.publishers.lean_base import LeanBase
from diffdrive_kinematics.ros.publishers.odometry import (
    BeliefCorrection, OdometryPublisher, PathPublisher)
from diffdrive_kinematics.ros.publishers.tf import transforms
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample, stamp_values, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.running import main_of
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

WAITING_REPORT_PERIOD_S = 10.0


class Config(NamedTuple):
    """What the base is set to."""

    geometry: WheelGeometry
    timeout_ns: Optional[int]
    slip_variances: core.WheelPair
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    check_wiring(values, 'wheel_motion_topic', ('odom_topic', 'joint_states_topic', 'path_topic'))
    check_sides(values)
    check_frames(values)
    slips = values['left_slip_variance'], values['right_slip_variance']
    return Config(
        wheel_geometry(values), core.timeout_from_seconds(values['command_timeout']),
        slips if values['slip_model'] == 'travel' else (0.0, 0.0), values)


class SimulatedBase(DiffDriveNode[Config]):
    """
    Integrates wheel motion, and publishes at a rate that has no influence on the result.

    It publishes from the first wheel motion on: odometry means that the wheels are heard.
    """

    TABLE = SIMULATED_BASE

    def __init__(self, name: str = 'simulated_base', **composition: Any) -> None:
        super().__init__(name, self.TABLE, build, **composition)
        values, runtime = self.config.values, self.runtime
        encoder = core.Encoder(values['encoder_range'], values['encoder_resolution'])
        odometry = initial_odometry(
            values, self.config.geometry, self.config.timeout_ns, self.config.slip_variances)
        self.wheel_reader = WheelReader.of(values)
        motion_topic = values['wheel_motion_topic']
        self._driver = DriverWatch(self, motion_topic)
        self._wheel_watch = WheelWatch(self, self.wheel_reader, motion_topic)
        self._wheel_motion = runtime.poll(JointState, motion_topic, self._on_wheels)
        self._wheel_motion.set_poll_rate(values['publish_rate'])
        self._out = OdometryPublisher(self, values)
        self._wheels = WheelWriter(wheel_joints(values), self.source(), encoder)
        self._joints = runtime.publish_unless_off(JointState, values['joint_states_topic'])
        self._transform = transforms(self, 'enable_odom_tf')
        transform = transforms(self, 'publish_map_odom_tf')
        self._correction = BeliefCorrection(
            self._out.frames, transform, odometry) if transform else None
        if self._correction:
            runtime.listen(Odometry, values['belief_topic'], self._on_belief)
        self._path = PathPublisher(
            self, values, self._out.frames[0]) if values['path_topic'] else None
        if topic := values['set_pose_topic']:
            runtime.listen(PoseWithCovarianceStamped, topic, self._on_pose, needs_wakeup=False)
        runtime.serve(Trigger, '~/reset', self._on_reset)
        self._lean = LeanBase(
            odometry, self.wheel_reader, self._wheel_motion, self.health, self._out, self._wheels,
            self._joints, self._publish_beside, now=self.synchronised_now, tick=self._tick)
        self._on_timer = self._lean.tick if (
            values['lean_path'] and self._wheel_motion.waits and not transform) else self._tick
        self._timer = runtime.every(values['publish_rate'], self._on_timer)
        self.parameters.on_change(self._configure)

    _odometry = property(lambda self: self._lean.odometry)

    def reading(self) -> core.BaseState:
        """Return the base as it is now."""
        now_ns = self._updated_now()  # which may change the odometry
        return self._odometry.predict(now_ns)

    def covariance(self) -> PoseCovariance:
        """Return the covariance of the pose now, as it is published."""
        now_ns = self._updated_now()
        return self._odometry.covariance_at(now_ns)

    def moments(self) -> PoseMoments:
        """Return what is known of the error of the pose now."""
        now_ns = self._updated_now()
        return self._odometry.moments_at(now_ns)

    def _on_wheels(self, message: bytes, info: MessageInfo) -> None:
        now_ns = self.synchronised_now()
        if not now_ns and self.time.waits_for_clock():
            return
        self._lean.leave()
        now_ns = min(now_ns, info.received_ns or now_ns)
        sample = self.wheel_reader.read(message, lambda: now_ns, info.number)
        if sample is None:
            return
        self.health.statistics.note(now_ns, sample.stamp_ns)
        before = self._odometry
        odometry, verdict = before.update(sample, now_ns)
        self._lean.odometry = odometry
        if odometry.clock is not before.clock or odometry.measured is not before.measured:
            self._driver.look(odometry)
        self.rejections.judge(verdict, self.config.values['wheel_motion_topic'])
        if self._correction:
            self._correction.follow(odometry)

    def _on_belief(self, belief: Odometry) -> None:
        self._updated_now()
        self._correction.publish(belief)

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        pose, covariance = given_pose(message, self._out.frames[0])
        now_ns = self._updated_now()
        self._place(self._odometry.set_pose(pose, covariance, now_ns))
        self._report_place(f"set on '{self.config.values['set_pose_topic']}'")

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        pose, moments = initial_pose(self.config.values)
        now_ns = self._updated_now()
        self._place(self._odometry.set_pose(
            pose, NO_COVARIANCE, now_ns, keep_angles=False).with_moments(moments))
        response.success, response.message = True, self._report_place('reset')
        return response

    def _place(self, odometry: core.Odometry) -> None:
        self._begin_anew(odometry)
        if self._path:
            self._path.begin_anew()

    def _report_place(self, how: str) -> str:
        """Log the pose that was set, and return what was logged."""
        pose = self.reading().pose
        report = (f'pose {how}: x {pose.x:.3f} m, y {pose.y:.3f} m, yaw {pose.theta:.4f} rad '
                  f"in '{self._out.frames[0]}'")
        self.get_logger().info(report)
        return report

    def _tick(self) -> None:
        now_ns = self._updated_now()
        if self._odometry.motion is None:
            self.get_logger().info(
                'waiting for wheel motion of our joints on '
                f"'{self.config.values['wheel_motion_topic']}'",
                throttle_duration_sec=WAITING_REPORT_PERIOD_S, skip_first=True)
            return
        self.health.sent += 1
        reading = self._odometry.predict(now_ns)
        self._out.publish(now_ns, reading, self._odometry)
        if self._joints:
            self._joints.publish(self._wheels.encode(now_ns, reading.rates, reading.angles))
        self._publish_beside(now_ns, reading.pose)

    def _publish_beside(self, now_ns: int, pose: Pose) -> None:
        if self._transform:
            self._transform.publish(now_ns, self._out.frames, pose)
        if self._path:
            self._path.add(now_ns, pose)

    def status(self, sample: RateSample) -> Status:
        """Return how wheel motion comes in and odometry goes out."""
        values, received = self.config.values, self.health.statistics
        topic = self.resolve_topic_name(values['wheel_motion_topic'])
        return Status({
            **received.values(sample.now_ns, 'wheel motion'),
            'achieved odometry rate [Hz]': sample.rate, **stamp_values(self.counts),
            'position jumps': self.counts[core.Verdict.JUMPED.value],
            'last now - stamp [s]': received.skew_ns / 1e9,
            'largest now - stamp [s]': received.largest_skew_ns / 1e9,
            **self._wheel_watch.values(), **self._driver.values(self._odometry)}, [
                *self._wheel_watch.problems(), *self._driver.problems(),
                *received.problems(sample.now_ns, values['command_timeout'], topic,
                                   at_rest=self._odometry.at_rest),
                *sample.problems(values['publish_rate'])])

    def _updated_now(self) -> int:
        """Return the time, after all wheel motion that has come up to then."""
        self._wheel_motion.take()
        return self.synchronised_now()

    def on_clock_step(self, step: core.ClockStep) -> None:
        """Move the odometry along."""
        self._begin_anew(self._odometry.clock_stepped(step.step_ns))

    def _begin_anew(self, odometry: core.Odometry) -> None:
        self._lean.odometry = odometry
        if self._correction:
            self._correction.begin_anew(odometry)

    def _configure(self, config: Config) -> None:
        now_ns = self._updated_now()
        self._lean.odometry = configured_odometry(
            self._odometry, config.geometry, config.timeout_ns, config.slip_variances,
            config.values, now_ns)
        if self._correction:
            self._correction.follow(self._odometry)
        self._out.configure(config.values)
        self._timer = self.runtime.retimed(
            self._timer, config.values['publish_rate'], self._on_timer)
        self._wheel_motion.set_poll_rate(config.values['publish_rate'])


main = main_of(SimulatedBase)
