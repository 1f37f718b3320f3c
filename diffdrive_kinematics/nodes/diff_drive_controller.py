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

"""``diff_drive_controller``: velocity commands in, wheel rates out, within limits."""

import time
from typing import Any, Mapping, NamedTuple, Sequence

from diffdrive_kinematics.core.commands import Drive, DriveSettings, STILL, WheelCommand
from diffdrive_kinematics.core.odometry import ClockStep
from diffdrive_kinematics.ros.inputs.command_intake import (
    Backlog, CommandIntake, CommandType, LATE_NS)
from diffdrive_kinematics.ros.inputs.emergency_stop import EmergencyStop
from diffdrive_kinematics.ros.inputs.publisher_watch import PublisherWatch
from diffdrive_kinematics.ros.parameters.drive_from_values import drive_settings
from diffdrive_kinematics.ros.parameters.from_values import check_sides, check_wiring
from diffdrive_kinematics.ros.parameters.tables import DIFF_DRIVE_CONTROLLER
from diffdrive_kinematics.ros.publishers.wheel_commands import WheelCommandPublisher
from diffdrive_kinematics.ros.runtime.diagnostics import OK, RateSample, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo, UNKNOWN
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.ros.runtime.runtime import OneShotTimer
from rclpy.publisher import Publisher

REST = (0.0, 0.0)
MOST_WATCHDOG_CALLS = 1000.0  # [Hz]


class Config(NamedTuple):
    """What the controller is set to."""

    drive: DriveSettings
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    check_wiring(values, 'cmd_vel_topic', (
        'wheel_rates_topic', 'cmd_vel_out_topic', 'wheel_commands_topic', 'emergency_stop_topic'))
    check_sides(values)
    return Config(drive_settings(values), values)


class DiffDriveController(DiffDriveNode[Config]):
    """Answers each command at once; a timer repeats the rates, ramps and times out."""

    def __init__(self, name: str = 'diff_drive_controller', **composition: Any) -> None:
        super().__init__(name, DIFF_DRIVE_CONTROLLER, build, **composition)
        values, runtime = self.config.values, self.runtime
        self._drive = Drive(self.config.drive, runtime.now_ns())
        self._sent_by_tick = self._command_steady_ns = 0
        self._out = WheelCommandPublisher(self, values)
        self.commands = CommandType(self, values)
        self._intake = CommandIntake(self, self.commands.stamped, self.commands.topic, values)
        self._watchdog = self._command_watch = self._backlog = None  # until there is one
        self._stop = EmergencyStop(
            self, values['emergency_stop_topic'], self._on_stop, self._on_release, self._listen)
        self._timer = runtime.every(values['publish_rate'], self._tick)
        self._step_timer = OneShotTimer(runtime, self._step)
        self._set_watchdog(self.config.drive.cmd_vel_timeout)
        self.parameters.on_change(self._configure)
        if values['use_response']:
            self.get_logger().info(
                'use_response is true: odometry needs the output of a wheel_noise with the same '
                'response_* and no slip')

    def _listen(self) -> None:
        """Hear commands; until then a course finds nobody to begin for."""
        topic = self.config.values['cmd_vel_topic']
        subscription = self.runtime.listen(
            self.commands.message_type, topic, self._on_command, raw=True, informed=True)
        self._command_watch = PublisherWatch(
            self, topic, subscription,
            'the robot obeys whoever published last; put twist_mux between them')
        if not self.runtime.is_stepped:  # else all that was sent has come before the time goes on
            self._backlog = Backlog(subscription)

    def _on_command(self, message: bytes, info: MessageInfo = UNKNOWN) -> None:
        now_ns = self.synchronised_now()
        self.health.statistics.note(now_ns, now_ns)
        if self._stop.engaged:
            self._stop.ignore()
            return
        alive = self._intake.alive(message, now_ns, info.sent_ns)
        if alive is None:
            return
        twist, stamp_ns, age_ns = alive
        if not now_ns and self.time.waits_for_clock():
            if twist == STILL:
                self._halt()
            return
        if self._watchdog:
            self._watchdog.reset()
        if self._is_over(now_ns - LATE_NS):
            self._drive = self._drive.resumed(now_ns)  # nobody was told that it ended
        try:
            self._carry_out(*self._drive.commanded(twist, stamp_ns))
        except ValueError:
            self._carry_out(*self._drive.commanded(STILL, now_ns))
            raise
        if age_ns > LATE_NS:
            timeout_ns = round(self.config.drive.cmd_vel_timeout * 1e9)  # since it was sent
            self._drive = self._drive.ended_by(now_ns - age_ns + timeout_ns)
        if self.time.is_simulated:
            self._command_steady_ns = time.monotonic_ns()
            self._obey_without_clock()

    def _carry_out(self, drive: Drive, changes: Sequence[WheelCommand]) -> None:
        self._drive = drive
        self._out.publish(changes)
        self._step_timer.set_to(drive.step_ns)

    def _step(self) -> int:
        """Take the steps of a ramp that are due, and return the time [ns]."""
        now_ns = self.synchronised_now()
        if self._is_over(now_ns):
            self._take_backlog()
            now_ns = self.synchronised_now()
        self._carry_out(*self._drive.advanced(now_ns))
        return now_ns

    def _tick(self) -> None:
        if self._intake.awaits_older(self._timer.timer_period_ns):
            return
        now_ns = self._step()
        passed_ns = max(now_ns, self._drive.since_ns) - self._out.last_ns
        said = self.health.sent > self._sent_by_tick
        if passed_ns and not (said and passed_ns < self._timer.timer_period_ns):
            self._out.publish([self._drive.command_at(now_ns)])
        self._sent_by_tick = self.health.sent
        if not self.health.statistics.count:
            self.commands.look_for_others(now_ns)

    def _is_over(self, time_ns: int) -> bool:
        """Return whether the last command had ended at a time and could not be ended in time."""
        end_ns = self._drive.deadline_ns
        return end_ns is not None and end_ns <= time_ns and self._backlog is not None

    def _take_backlog(self) -> None:
        """Take the commands that have come already: the process may have been held up."""
        if self._backlog:
            end_ns = self._drive.deadline_ns
            self._backlog.hand_on(
                lambda: self._drive.deadline_ns != end_ns,
                wait=self._is_over(self.runtime.now_ns() - LATE_NS))

    def _set_watchdog(self, timeout: float) -> None:
        if self._watchdog:
            self.runtime.stop_timer(self._watchdog)
        rate = min(1.0 / timeout, MOST_WATCHDOG_CALLS) if timeout else 0.0
        self._watchdog = self.runtime.every(rate, self._on_silence) if rate else None
        if self._watchdog:
            self._watchdog.reset()  # timers of one rate are in step, and fire earlier at first

    def _on_silence(self) -> None:
        """End the command that no other has followed, however rarely the rates are repeated."""
        deadline_ns = self._drive.deadline_ns
        self._take_backlog()
        if self._drive.deadline_ns != deadline_ns:
            return
        now_ns = self.synchronised_now()
        self._carry_out(*self._drive.ended_by(now_ns).advanced(now_ns))

    def on_clock_look(self, stood_s: float) -> None:
        """Bring the wheels to rest where a clock that stands does not."""
        drive = self._drive
        timeout = drive.settings.cmd_vel_timeout
        silent_s = (time.monotonic_ns() - self._command_steady_ns) / 1e9
        if 0.0 < timeout < min(stood_s, silent_s) and drive.target != STILL:
            self._drive = drive._replace(timeouts=drive.timeouts + 1)
            self._halt()
        elif drive.rates == REST and self._out.last_ns >= 0 and self.time.clock_stands():
            # ticks do not repeat it
            self._out.publish([drive.command_at(self.synchronised_now())])
        else:
            self._obey_without_clock()

    def _obey_without_clock(self) -> None:
        """Bring wheels that are faster than asked to rest where the clock, so a ramp, stands."""
        asked = self._drive.settings.command_for(self._drive.target).command
        if self._drive.twist.exceeds(asked) and self.time.clock_stands():
            self._halt()

    def _on_stop(self) -> None:
        self._halt()
        self._intake.none_before(self.runtime.now_ns())

    def _on_release(self) -> None:
        """Have what was commanded up to now behind, whenever it comes."""
        self._take_backlog()
        self._intake.none_before(self.synchronised_now())

    def _halt(self) -> None:
        """Bring the wheels to rest at once, whatever the limits and the clock."""
        now_ns = self.synchronised_now()
        if now_ns or self._drive.rates != REST:
            self._drive = self._drive.halted(max(now_ns, self._out.last_ns + 1))
        self._out.publish([self._drive.command_at(now_ns)])

    def on_clock_step(self, step: ClockStep) -> None:
        """Move the drive along."""
        self._drive = self._drive.clock_stepped(step.step_ns)
        self._out.clock_stepped(step.step_ns)
        self._intake.clock_stepped(step.step_ns, wall=not self.time.is_simulated)

    def _configure(self, config: Config) -> None:
        timeout = self._drive.settings.cmd_vel_timeout
        self._intake.configure(config.values)
        self._carry_out(*self._drive.configured(config.drive, self.synchronised_now()))
        self._timer = self.runtime.retimed(self._timer, config.values['publish_rate'], self._tick)
        if timeout != config.drive.cmd_vel_timeout:  # else what is silent goes on to be
            self._set_watchdog(config.drive.cmd_vel_timeout)

    def status(self, sample: RateSample) -> Status:
        """Return how commands come in and rates go out."""
        values, drive, topic = self.config.values, self._drive, self.commands.topic
        return Status({
            **self.health.statistics.values(sample.now_ns, 'command'),
            'achieved publish rate [Hz]': sample.rate, 'saturated': drive.saturated,
            'limited': drive.limited, 'timeouts': drive.timeouts,
            'old commands': self.counts['old commands'], **self._stop.values(),
            'publishers of commands': watch.count if (watch := self._command_watch) else 0}, [
                *self._stop.problems(), *(watch.problems() if watch else ()),
                *self._intake.problems(),
                *self.health.statistics.problems(
                    sample.now_ns, values['cmd_vel_timeout'], topic, at_rest=drive.rates == REST,
                    none_yet=OK),
                *sample.problems(values['publish_rate'])])

    def final_command(self) -> Sequence[Publisher]:
        """Leave the wheels with the command to stand still."""
        self._halt()
        return self._out.publishers()


main = main_of(DiffDriveController)
