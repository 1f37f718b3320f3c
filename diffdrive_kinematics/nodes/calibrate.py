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

"""``calibrate``: a robot's systematic errors and slip, from files or live topics, into a YAML."""

from contextlib import nullcontext
from dataclasses import replace
import signal
import sys
from typing import Any, List, Mapping, NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader
from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.from_values import check_sides, wheel_geometry
from diffdrive_kinematics.ros.parameters.tables import CALIBRATE
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
from diffdrive_kinematics.ros.runtime.final_command import HEARTBEAT_S
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.output import exit_status, report
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.running import Interrupted, run, spin_node, Stop
from diffdrive_kinematics.tools.calibration import Calibration, table
from diffdrive_kinematics.tools.calibration_file import rendered
from diffdrive_kinematics.tools.calibration_response import of_recordings
from diffdrive_kinematics.tools.collection import Collection
from diffdrive_kinematics.tools.output_files import check_writable, write_files
from diffdrive_kinematics.tools.progress import Progress
from diffdrive_kinematics.tools.recording_sources import read_drives
from diffdrive_kinematics.tools.square_notes import calibration_of_runs
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

PROGRESS_RATE, FAREWELL_S = 0.5, HEARTBEAT_S + 1.0  # DDS can take that long for the answer
INTERRUPTED = 'interrupted: nothing is written'
MOST_SEPARATIONS = 200.0  # of a square's side; UMBmark is for 12, millimetres make it thousands


class Config(NamedTuple):
    """What to calibrate, and from what."""

    geometry: WheelGeometry
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    check_sides(values)
    squares, recordings = values['square_runs'], values['recordings']
    if squares and recordings:
        raise ValueError(
            f'square_runs is {squares!r} and recordings is {list(recordings)!r}, expected one of '
            'them, or none for live topics')
    side, separation = values['square_side'], values['wheel_separation']
    if squares and not 0.0 < side <= MOST_SEPARATIONS * separation:
        raise ValueError(
            f'square_side is {side!r}, expected the side [m] of the square of square_runs, at '
            f'most {MOST_SEPARATIONS:g} times wheel_separation, which is {separation!r}')
    for name in ('output', 'picture'):
        if values[name]:
            check_writable(values[name], name=name, overwrite=values['overwrite'],
                           regular=name == 'picture')
    if values['output'] == values['picture']:
        raise ValueError(f"picture is {values['picture']!r}, expected another file than output")
    return Config(wheel_geometry(values), values)


class Calibrate(DiffDriveNode[Config]):
    """Collects wheel motion and reference poses until it is told to finish."""

    def __init__(
            self, name: str = 'calibrate', *, stop: Optional[Stop] = None, **parts: Any) -> None:
        super().__init__(name, CALIBRATE, build, **parts)
        self._stop = stop
        self.collection = Collection()
        self.written = ''

    def listen(self) -> None:
        """Begin to collect."""
        values = self.config.values
        self._reader = WheelReader.of(values)
        WheelWatch(self, self._reader, values['motion_topic'])
        self.runtime.listen(
            JointState, values['motion_topic'], self._on_wheels, raw=True, informed=True)
        odometry = values['reference_type'] == 'odometry'
        self.runtime.listen(
            Odometry if odometry else PoseStamped, values['reference_topic'],
            self._on_odometry if odometry else self._on_pose, best_effort=True)
        self.runtime.serve(Trigger, '~/finish', self._on_finish)
        self.runtime.every(PROGRESS_RATE, self._report)
        self.get_logger().info(
            f"collecting '{values['motion_topic']}' and '{values['reference_topic']}' until "
            f'{self.get_fully_qualified_name()}/finish is called')

    def _on_wheels(self, message: bytes, info: MessageInfo) -> None:
        if self.written:
            return
        sample = self._reader.read(message, self.runtime.now_ns, info.number)
        if sample is not None:
            self.collection.add_wheels(sample)

    def _on_odometry(self, message: Odometry) -> None:
        self.collection.add_reference(message.header.stamp, message.pose.pose)

    def _on_pose(self, message: PoseStamped) -> None:
        self.collection.add_reference(message.header.stamp, message.pose)

    def _report(self) -> None:
        if not self.written:
            self.get_logger().info(
                '; '.join([self.collection.summary(self.config.geometry), *self._missing()]))

    def _missing(self) -> List[str]:
        """Return what is wrong with topics of which nothing has come."""
        values, (wheels, poses) = self.config.values, self.collection.counts()
        reference = Odometry if values['reference_type'] == 'odometry' else PoseStamped
        return [
            self._silence(topic, kind) for topic, kind, count in (
                (values['motion_topic'], JointState, wheels),
                (values['reference_topic'], reference, poses)) if not count]

    def _silence(self, topic: str, kind: type) -> str:
        """Return why nothing comes on a topic."""
        name = self.resolve_topic_name(topic)
        kinds = {info.topic_type for info in self.get_publishers_info_by_topic(name)}
        if not kinds:
            return f"nobody publishes '{name}'"
        if not any(each.endswith(f'/{kind.__name__}') for each in kinds):
            return f"'{name}' is {', '.join(sorted(kinds))}, expected {kind.__name__}"
        return f"'{name}' is published, but no message of it was usable"

    def _on_finish(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self.written:  # asked again before the end: the answer stays
            self._farewell.reset()
            response.success, response.message = True, self.written
            return response
        try:
            with self._stop.interrupting() if self._stop else nullcontext():
                response.message = self.finish()
        except Interrupted:
            response.message, self.done = INTERRUPTED, True
            return response
        except ValueError as error:
            response.message = f'{error}; still collecting'
            self.get_logger().error(f'cannot finish: {response.message}')
            return response
        response.success = True
        self._farewell = self.runtime.every(1.0 / FAREWELL_S, self._end, steadily=True)
        self._farewell.reset()  # a whole period from now; the first one may be shorter
        return response

    def finish(self) -> str:
        """Calibrate from what there is, write it, and return a line that says so."""
        values, geometry = self.config.values, self.config.geometry
        self.get_logger().info(f'calibrating {self.collection.summary(geometry)}')
        with Progress() as progress:
            progress('fitting', begins=True)
            calibration = of_recordings(
                values, geometry, self.collection.drives(), clock=values['clock'] or 'none',
                progress=progress)
            files = rendered(calibration, values)
        self.written = conclude(calibration, files, values)
        return self.written

    def _end(self) -> None:
        self.done = True


def from_files(config: Config, progress: Progress) -> Calibration:
    """Return the calibration from the files of the parameters; ``ValueError`` if there is none."""
    values, geometry = config.values, config.geometry
    if values['square_runs']:
        return calibration_of_runs(values, geometry)
    drives, commands, remarks = read_drives(values, geometry, progress)
    progress('fitting', begins=True)
    calibration = of_recordings(
        values, geometry, drives, commands=commands,
        clock=values['clock'] or ('delay' if commands else 'auto'), progress=progress)
    return replace(calibration, remarks=(*calibration.remarks, *remarks))


def conclude(
        calibration: Calibration, files: Mapping[str, bytes], values: Mapping[str, Any]) -> str:
    """Print the table, write the files, and return a line that names them."""
    report(table(calibration))
    report(written := f"wrote {', '.join(write_files(files, overwrite=values['overwrite']))}")
    return written


@refusing()
def work(stop: Stop) -> int:
    """Calibrate; return the exit status."""
    node = Calibrate(stop=stop, timers=(timers := SteadyTimers()))
    values = node.config.values
    try:
        if not (values['square_runs'] or values['recordings']):
            return _collect(node, timers, stop)
        with Progress() as progress, stop.interrupting():
            calibration = from_files(node.config, progress)
            files = rendered(calibration, values)
        conclude(calibration, files, values)
        return exit_status()
    except Interrupted as interrupted:
        report(INTERRUPTED)
        return interrupted.status
    finally:
        node.destroy_node()


def _collect(node: Calibrate, timers: SteadyTimers, stop: Stop) -> int:
    """Collect; on Ctrl-C try to finish, as not everybody can call a service."""
    node.listen()
    spin_node(node, timers, stop)
    if stop.number == signal.SIGINT and not (node.written or node.done):
        try:
            with stop.interrupting(after=signal.SIGINT):
                node.finish()
        except ValueError as error:
            report(f'{error}')
    if not node.written:
        report('not finished: nothing is written')
    return exit_status()


def main() -> None:
    """Run ``calibrate``."""
    sys.exit(run(work))
