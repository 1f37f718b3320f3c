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

"""``wheel_noise``: wheel motion in, biased and slipping wheel motion out."""

from dataclasses import replace
import math
from typing import Any, Mapping, NamedTuple, Optional

from diffdrive_kinematics.core.commands import Twist
from diffdrive_kinematics.core.kinematics import (
    NANOSECONDS, twist_from_wheel_rates, wheel_rates_from_twist)
from diffdrive_kinematics.core.noise import draw_session, session_generator
from diffdrive_kinematics.core.odometry import (
    AnsweredMotion, ClockStep, SlipStream, timeout_from_seconds, WheelPair, WheelSample)
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader, WheelWriter
from diffdrive_kinematics.ros.parameters.drive_from_values import command_response
from diffdrive_kinematics.ros.parameters.from_values import (
    body_slip, check_sides, check_wiring, session_spread, wheel_geometry, wheel_radii,
    wheel_slips)
from diffdrive_kinematics.ros.parameters.tables import WHEEL_NOISE
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample, stamp_values, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.running import main_of
import numpy as np
from sensor_msgs.msg import JointState


class Config(NamedTuple):
    """What the noise is set to."""

    stream: SlipStream
    response: Optional[AnsweredMotion]
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    check_wiring(values, 'input_topic', ('output_topic',))
    check_sides(values)
    spread = session_spread(values)
    separation = values['wheel_separation'] * values['wheel_separation_multiplier']
    for name in ('session_curvature_stddev', 'turn_slip_variance', 'heading_slip_variance',
                 'response_max_speed'):
        if values[name] and math.isnan(separation):
            raise ValueError(
                f'wheel_separation is nan, expected the distance [m] between the wheels, as '
                f'{name} is {values[name]!r}')
    return Config(
        SlipStream(
            wheel_radii(values), *wheel_slips(values),
            timeout_from_seconds(values['command_timeout']),
            separation=0.0 if math.isnan(separation) else separation,
            session=draw_session(spread, session_generator(values['seed'])) if spread else None,
            body=body_slip(values)),
        _response(values), values)


def _response(values: Mapping[str, Any]) -> Optional[AnsweredMotion]:
    """Return how the robot follows its commands; None where it does what they say."""
    given = command_response(values)
    if given is None:
        return None
    geometry = wheel_geometry(values)

    def answer(rates: WheelPair) -> WheelPair:
        motion = given.motion_of(Twist(*twist_from_wheel_rates(geometry, *rates)))
        return wheel_rates_from_twist(geometry, *motion)

    return AnsweredMotion(answer, round(given.delay * NANOSECONDS))


class WheelNoise(DiffDriveNode[Config]):
    """Perturbs the travel between the stamps of two messages, whenever they come."""

    def __init__(self, name: str = 'wheel_noise', **composition: Any) -> None:
        super().__init__(name, WHEEL_NOISE, build, **composition)
        values = self.config.values
        self.wheel_reader = WheelReader.of(values)
        self._wheel_watch = WheelWatch(self, self.wheel_reader, values['input_topic'])
        self._wheels = WheelWriter(wheel_joints(values), self.source())
        self._stream, self._response = self.config.stream, self.config.response
        self._seed = values['seed']
        self._generator = np.random.default_rng(self._seed)
        self._publisher = self.runtime.publish(JointState, values['output_topic'])
        self.runtime.listen(
            JointState, values['input_topic'], self._on_wheels, raw=True, informed=True)
        self.parameters.on_change(self._configure)

    def _on_wheels(self, message: bytes, info: MessageInfo) -> None:
        if self.time.waits_for_clock():
            return
        now_ns = self.synchronised_now()
        sample = self.wheel_reader.read(message, lambda: now_ns, info.number)
        if sample is None:
            return
        self.health.statistics.note(now_ns, sample.stamp_ns)
        if self._response is None:
            self._pass_on(sample)
            return
        self._response, due = self._response.update(sample)
        for each in due:
            self._pass_on(each)

    def _pass_on(self, sample: WheelSample) -> None:
        self._stream, noisy, verdict = self._stream.apply(sample, self._generator)
        self.rejections.judge(verdict, self.config.values['input_topic'])
        if noisy is not None:
            self.health.sent += 1
            self._publisher.publish(self._wheels.encode(
                noisy.stamp_ns, noisy.rates, noisy.positions))

    def on_clock_step(self, step: ClockStep) -> None:
        """Move what is known along where simulated time was set back."""
        if self.time.is_shared:
            self._stream = self._stream.clock_stepped(step)
            self._response = self._response and self._response.clock_stepped(step)

    def status(self, sample: RateSample) -> Status:
        """Return how wheel motion passes through."""
        values, motion = self.config.values, self._stream.motion
        topic = self.resolve_topic_name(values['input_topic'])
        return Status({
            **self.health.statistics.values(sample.now_ns, 'wheel motion'),
            'sent': self.health.sent, **stamp_values(self.counts), **self._wheel_watch.values()}, [
                *self._wheel_watch.problems(),
                *self.health.statistics.problems(
                    sample.now_ns, values['command_timeout'], topic,
                    at_rest=motion is not None and motion.rates == (0.0, 0.0))])

    def _configure(self, config: Config) -> None:
        new, response = config.stream, config.response
        if response is not None and self._response is not None:
            response = self._response.configured(response)
        self._response = response
        self._stream = replace(
            self._stream, radii=new.radii, left_slip=new.left_slip, right_slip=new.right_slip,
            timeout_ns=new.timeout_ns, session=new.session, separation=new.separation,
            body=new.body)
        if config.values['seed'] != self._seed:
            self._seed = config.values['seed']
            self._generator = np.random.default_rng(self._seed)


main = main_of(WheelNoise)
