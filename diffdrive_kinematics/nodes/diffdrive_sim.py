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

"""``diffdrive_sim``: the nodes of the package in one process, on one executor."""

from importlib import import_module
import sys
import time
from typing import Any, Dict, List, Mapping, NamedTuple, Tuple, Type

from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.from_values import Member, members_of
from diffdrive_kinematics.ros.parameters.tables import DIFFDRIVE_SIM
from diffdrive_kinematics.ros.runtime.alone import check_alone, Disturbed
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers, SteppedClock
from diffdrive_kinematics.ros.runtime.command_line import run_or_demo
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.lasting import Lasting
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.output import exit_status, report, show
from diffdrive_kinematics.ros.runtime.running import finish, make_executor, spin, Stop
from diffdrive_kinematics.tools.keeping import Keeping
from diffdrive_kinematics.tools.progress import LiveLine
from diffdrive_kinematics.tools.robots import (
    drift_table, moments_of, pose_line, progress_line, Robot, robots_of)
from diffdrive_kinematics.tools.square_notes import square_calibration, Squares
from rclpy.logging import get_logger

CLASSES = {  # imported where they are composed: a robot of two nodes starts without the others
    'diff_drive_controller': 'DiffDriveController', 'wheel_noise': 'WheelNoise',
    'simulated_base': 'SimulatedBase', 'wheel_odometry': 'WheelOdometry',
    'command_sequence': 'CommandSequence', 'forward_projection': 'ForwardProjection',
    'goal_steering': 'GoalSteering', 'robot_description': 'RobotDescription',
    'web_view': 'WebView'}
BASES = 'simulated_base', 'wheel_odometry'
DISTURBED = 1  # exit status
FAREWELL_S = 0.5
PROGRESS_LINES = 10
REST_TIMEOUT_NS = 5_000_000_000


class Config(NamedTuple):
    """What the composition is set to."""

    members: Tuple[Member, ...]
    clock_step_ns: int
    real_time_factor: float


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    members = members_of(values['nodes'], CLASSES)
    if values['calibration'] and not values['square_runs']:
        raise ValueError(
            f"calibration is {values['calibration']!r} and square_runs is not set, expected the "
            'CSV file of the runs to calibrate by')
    return Config(members, round(values['clock_step'] * 1e9), values['real_time_factor'])


def node_class(kind: str) -> Type[DiffDriveNode]:
    """Return the class of a node by the name of its executable."""
    return getattr(import_module(f'diffdrive_kinematics.nodes.{kind}'), CLASSES[kind])


class DiffDriveSim(DiffDriveNode[Config]):
    """Makes the other nodes, and reports where the robot believes to be and where it is."""

    def __init__(self, name: str = 'diffdrive_sim', **node_options: Any) -> None:
        self._steady = SteadyTimers()
        self.members: List[DiffDriveNode] = []
        super().__init__(name, DIFFDRIVE_SIM, build, **node_options)
        shared: Dict[str, Any] = {'timers': self._steady}
        if self.config.clock_step_ns:
            shared = {'stepped': SteppedClock(), 'in_flight': InFlightMessages()}
        classes = [node_class(member.kind) for member in self.config.members]
        if self.config.clock_step_ns:  # now, so that what comes second does not disturb the first
            check_alone(self, {self.resolve_topic_name('/clock'): []}, patience_s=FAREWELL_S)
        for kind, member in zip(classes, self.config.members):
            self.members.append(kind(
                member.name, **{**node_options, 'namespace': member.namespace},
                neighbours=[each.name for each in self.config.members], **shared))
        self.clock_driver: Any = None
        if self.config.clock_step_ns:
            from diffdrive_kinematics.ros.runtime.sim_clock import SimClockDriver
            self.clock_driver = SimClockDriver(
                self, self.members, step_ns=self.config.clock_step_ns,
                real_time_factor=self.config.real_time_factor, **shared)
        self._sequences = self._of('command_sequence')
        self._courses: List[DiffDriveNode] = [*self._sequences, *(
            node for node in self._of('goal_steering') if node.config.goals)]
        self._shown, self._rest_by_ns, self._rest_lasts = -1, 0, Lasting()
        self.keeping = Keeping(lambda: moments_of(self._bases(), self._now_ns()), self._now_ns)
        self._live, self._began_s = LiveLine(), self._now_ns() / 1e9

    def _of(self, *kinds: str) -> List[Any]:
        return [node for node, member in zip(self.members, self.config.members)
                if member.kind in kinds]

    @refusing()
    def keep(self) -> None:
        """Keep the drive from now on, in what files it is to be kept."""
        self.keeping.begin(self.parameters.values, [
            publisher for node in (self, *self.members) for publisher in node.publishers])
        if path := self.parameters.values['square_runs']:
            self.keeping.note_squares(path, [Squares(
                node.config.runs, node.elapsed_s, node.config.values) for node in self._sequences])

    def kept(self) -> List[str]:
        """Complete what is kept of the drive; return a line on each."""
        return self.keeping.close(
            finished=self.finished(), interrupted=bool(self._courses) and not self.finished(),
            calibrated=self.calibrated)

    def calibrated(self) -> List[str]:
        """Calibrate by the runs that are noted, where they are done; return the report."""
        values = self.parameters.values
        if not (values['calibration'] and self.finished()):
            return []
        geometry = next(base.config.geometry for base, fed in self._bases() if not fed)
        return square_calibration({**self._sequences[0].config.values, **values}, geometry)

    def _now_ns(self) -> int:
        return self.members[0].runtime.now_ns()

    def run(self, stop: Stop) -> None:
        """Run until the sequences are done and the robot rests, or until asked to stop."""
        executor = make_executor([self, *self.members], self.parameters.values['executor'])
        try:
            self._announce()
            if self.clock_driver:
                self.clock_driver.spin(executor, self._finished, stop)
            else:
                spin(executor, self._steady, self._finished, stop,
                     needs_wakeup=any(node.runtime.needs_wakeup for node in self.members))
        finally:
            self._live.clear()
            finish(self.members, executor)

    def destroy_node(self) -> None:
        """Destroy the other nodes, too."""
        for node in self.members:
            node.destroy_node()
        super().destroy_node()

    def finished(self) -> bool:
        """Return whether there was a course, and it is done."""
        return bool(self._courses) and all(node.done for node in self._courses)

    def begun(self) -> bool:
        """Return whether there is a course, and something of it was driven."""
        return self.finished() or any(node.begun() for node in self._sequences)

    def robots(self) -> List[Robot]:
        """Return the belief and the truth of each robot, as they are now."""
        return robots_of(self._bases())

    def _bases(self) -> List[Tuple[Any, bool]]:
        """Return the bases, and whether each is fed with what comes out of a noise node."""
        noisy = {node.resolve_topic_name(node.config.values['output_topic'])
                 for node in self._of('wheel_noise')}
        return [(base, base.resolve_topic_name(base.config.values['wheel_motion_topic']) in noisy)
                for base in self._of(*BASES)]

    def _finished(self) -> bool:
        """Note and show how far it is; return whether the course is done, the robot at rest."""
        if self.keeping.notes:
            with refusing():
                line = self.keeping.note()
            self._show(line)
        self._live(lambda: pose_line(self._now_ns() / 1e9 - self._began_s, self.robots()))
        if self._sequences:
            self._show_progress(max(self._sequences, key=lambda node: node.length_s))
        if not self.finished():
            return False
        now_ns = self._courses[0].runtime.now_ns()
        self._rest_by_ns = self._rest_by_ns or now_ns + REST_TIMEOUT_NS
        rests = all(base.reading().rates == (0.0, 0.0) for base in self._of(*BASES))
        return now_ns > self._rest_by_ns or (
            rests if self.clock_driver else self._rest_lasts(rests))

    def _show_progress(self, course: Any) -> None:
        shown = int(PROGRESS_LINES * course.elapsed_s() / course.length_s)
        if course.begun() and shown != self._shown and shown <= PROGRESS_LINES:
            self._shown = shown
            self._show(progress_line(course.elapsed_s(), course.length_s, self.robots()))

    def _show(self, line: str) -> None:
        if line:
            self._live.clear()
            show(line)

    def _announce(self) -> None:
        """Say how to drive where nothing in this process does."""
        for node in self._of('diff_drive_controller') if not self._courses else ():
            self.get_logger().info(
                f"publish {node.commands.name} on '{node.commands.topic}' to drive; Ctrl-C ends")


def work(stop: Stop) -> int:
    """Compose, run and report; return the exit status."""
    try:
        return _work(stop)
    except Disturbed as error:
        get_logger('diffdrive_sim').fatal(str(error))
        return DISTURBED


def _work(stop: Stop) -> int:
    sim = DiffDriveSim()
    try:
        sim.keep()
        sim.run(stop)
        for line in sim.kept():
            report(line)
        if sim.begun():
            report(drift_table(sim.robots()))
            if sim.finished() and sim.clock_driver and not sim.config.real_time_factor:
                report(f'{sim.clock_driver.rate():.0f} times real time')
        with refusing():
            sim.keeping.check()
    except Disturbed:
        time.sleep(FAREWELL_S)  # still to be seen, or the other one might never know
        raise
    finally:
        sim.keeping.discard()
        sim.destroy_node()
    return exit_status()


def main() -> None:
    """Run ``diffdrive_sim``."""
    sys.exit(run_or_demo(work))
