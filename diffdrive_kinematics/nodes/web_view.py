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

"""``web_view``: a page in the browser on which a robot is watched and driven."""

import math
import time
from typing import Any, List, Mapping, Tuple

from diagnostic_msgs.msg import DiagnosticArray
from diffdrive_kinematics.core.commands import Helm
from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.ros.inputs.other_nodes import RemoteParameters, RemoteTriggers
from diffdrive_kinematics.ros.messages.codec import TwistCodec
from diffdrive_kinematics.ros.messages.plain import header_of, pose_message
from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.tables import WEB_VIEW
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.tools.page_frame import check_numbers, PageFrame
from diffdrive_kinematics.tools.same_origin import LOOPBACK
from geometry_msgs.msg import PolygonStamped, PoseArray, PoseStamped
from nav_msgs.msg import Odometry, Path
from rclpy.publisher import Publisher

SILENCE_S = 0.3  # of a viewer who drives, after which the robot stands
NOISE = (  # what is set in the noise node: label, range, step
    ('left_bias', 'left bias', -0.05, 0.05, 0.001),
    ('right_bias', 'right bias', -0.05, 0.05, 0.001),
    ('left_slip_variance', 'left slip [m]', 0.0, 1e-4, 1e-6),
    ('right_slip_variance', 'right slip [m]', 0.0, 1e-4, 1e-6))


class WebView(DiffDriveNode[Mapping[str, Any]]):
    """
    Serves the page; it subscribes to nothing while nobody looks.

    What viewers do is taken up at the rate of the page.
    """

    def __init__(self, name: str = 'web_view', **composition: Any) -> None:
        super().__init__(name, WEB_VIEW, dict, **composition)
        values = self.config
        self._shown = PageFrame(values['wheel_separation'])
        self._helm, self._drove = Helm(SILENCE_S), False
        self._message = TwistCodec.of(values)
        self._commands = self.runtime.publish(self._message.message_type, values['cmd_vel_topic'])
        if values['autonomous_cmd_vel_topic']:
            self.runtime.listen(
                self._message.message_type, values['autonomous_cmd_vel_topic'], self._pass_on)
        self._goals = self.runtime.publish(PoseStamped, values['goal_topic'])
        self._plans = self.runtime.publish(Path, values['plan_topic'])
        self._triggers = RemoteTriggers(self, {
            'reset': [f'{node}/reset' for node in values['base_nodes']],
            'stop': [f"{values['controller_node']}/stop"],
            'resume': [f"{values['controller_node']}/resume"]}, self._complain)
        self._noise = RemoteParameters(
            self, values['noise_node'], [each[0] for each in NOISE],
            lambda numbers: self._page.show(numbers)) if values['noise_node'] else None
        self._sources: List[Any] = []
        self._stopped = False  # by a viewer, whatever the controller says
        self._actions = {
            'drive': self._do_drive, 'goal': self._do_goal, 'set': self._do_set,
            'reset': self._do_reset, 'stop': self._do_stop, 'resume': self._do_resume,
            'joined': self._do_joined, 'left': self._do_left}
        with refusing(self.get_fully_qualified_name()):
            self._page = self._served(values)
        self.runtime.every(values['frame_rate'], self._tick, steadily=True)

    def _served(self, values: Mapping[str, Any]) -> Any:
        """Return the page, or raise ``ValueError`` where it cannot be served."""
        host, port = values['host'], values['port']
        try:
            from diffdrive_kinematics.tools.web_page import Slider, WebPage
            page = WebPage(
                f'{self.get_fully_qualified_name()}', host, port,
                [Slider(*each) for each in NOISE] if self._noise else [],
                {'separation': values['wheel_separation'], 'radius': values['wheel_radius']})
        except ImportError as error:
            raise ValueError(
                f"{error.name} is missing, expected NiceGUI: pip install '.[web]' in a clone of "
                'this package, or pip install nicegui') from error
        except OSError as error:
            raise ValueError(
                f'host is {host!r} and port is {port}, expected an address to listen on '
                f'({error.strerror})') from error
        if host not in LOOPBACK:
            self.get_logger().warning(
                f'host is {host!r}: anybody who can reach this address can drive the robot')
        shown = f'[{host}]' if ':' in host else host
        self.get_logger().info(f'open http://{shown}:{page.port} in a browser')
        return page

    # What comes in from ROS, while somebody looks.

    def _listen(self) -> None:
        values = self.config
        self._sources = [
            self.runtime.listen(message_type, values[name], callback, needs_wakeup=False)
            for message_type, name, callback in (
                (Odometry, 'odom_topic', self._shown.take_belief),
                (Odometry, 'truth_topic', self._shown.take_truth),
                (PoseArray, 'poses_topic', self._shown.take_poses),
                (PolygonStamped, 'boundary_topic', self._shown.take_boundary))
            if values[name]]
        self._sources.append(self.runtime.listen_beside(  # the node publishes there, too
            DiagnosticArray, '/diagnostics', self._shown.take_diagnostics))

    def _ignore(self) -> None:
        for subscription in self._sources:
            self.runtime.unlisten(subscription)
        self._sources = []

    def _pass_on(self, message: Any) -> None:
        if not (self._helm.viewer or self._stopped or self.time.waits_for_clock()):
            self._commands.publish(message)

    # What viewers do.

    def _tick(self) -> None:
        page = self._page
        while page.actions:
            action = page.actions.popleft()
            try:
                self._actions[action.name](action.viewer, action.value)
            except (KeyError, OverflowError, TypeError, ValueError) as error:
                self.rejections.refuse(f'{action.name} of a viewer: {error!r}')
        self._drive()
        if bool(page.viewers) != bool(self._sources):
            self._listen() if page.viewers else self._ignore()
        if page.viewers:
            if self._noise:
                self._noise.look()
            self.health.sent += 1
            self._shown.show('driver', self._helm.viewer)
            page.send(self._shown.taken())

    def _drive(self) -> None:
        """Publish what the viewer at the helm asks for, and rest once it ends."""
        self._helm = self._helm.at(time.monotonic())
        driving = bool(self._helm.viewer) and not (
            self._stopped or self.time.waits_for_clock())
        if driving and not self._drove:  # who takes the helm ends what goal_steering does
            self._plans.publish(Path())
        if driving or self._drove or self._stopped:
            self._send(self._helm.command if driving else (0.0, 0.0))
        self._drove = driving

    def _send(self, command: Tuple[float, float]) -> None:
        self._commands.publish(self._message.encode(self.runtime.now_ns(), *command))

    def _do_drive(self, viewer: int, value: Any) -> None:
        v, w = (max(-1.0, min(1.0, float(part))) for part in value)
        check_numbers((v, w))
        values = self.config
        self._helm = self._helm.asked(
            viewer, (v * values['max_speed'], w * values['max_yaw_rate']), time.monotonic())

    def _do_goal(self, viewer: int, value: Any) -> None:
        x, y = map(float, value)
        check_numbers((x, y))
        belief = self._shown.belief
        if belief is None:
            raise ValueError('no odometry has been received yet')
        yaw = math.atan2(y - belief.y, x - belief.x)
        self._goals.publish(PoseStamped(
            header=header_of(self._shown.frame_id, self.runtime.now_ns()),
            pose=pose_message(Pose(x, y, yaw))))
        self._shown.show('goal', [x, y])

    def _do_set(self, _: int, value: Any) -> None:
        if self._noise is None:
            raise ValueError(f'{value!r}, and noise_node is empty')
        self._noise.set(*value)

    def _do_joined(self, viewer: int, value: Any) -> None:
        self._page.send({'fresh': True})
        self._shown.again()
        if self._noise:
            self._noise.ask()

    def _do_left(self, viewer: int, value: Any) -> None:
        self._helm = self._helm.left(viewer)

    def _do_stop(self, viewer: int, value: Any) -> None:
        self._stopped = True
        self._helm = self._helm.left(self._helm.viewer)
        self._drive()
        self._plans.publish(Path())
        self._trigger('stop')

    def _do_resume(self, viewer: int, value: Any) -> None:
        self._stopped = False
        self._trigger('resume')

    def _do_reset(self, viewer: int, value: Any) -> None:
        self._shown.begin_anew()
        self._page.send({'fresh': True, 'goal': None})
        self._trigger('reset')

    def _trigger(self, name: str) -> None:
        self._shown.show('notice', '')
        self._triggers.call(name)

    def _complain(self, text: str) -> None:
        self.get_logger().error(text)
        self._shown.show('notice', text)

    def status(self, sample: RateSample) -> Status:
        """Return who looks and who drives."""
        return Status({'viewers': self._page.viewers, 'driver': self._helm.viewer,
                       'frame rate [Hz]': sample.rate}, [])

    def final_command(self) -> Tuple[Publisher, ...]:
        """Leave the robot at rest where a viewer drove it."""
        if driven := bool(self._helm.viewer):
            self._send((0.0, 0.0))
        self._page.close()
        return (self._commands,) if driven else ()


main = main_of(WebView)
