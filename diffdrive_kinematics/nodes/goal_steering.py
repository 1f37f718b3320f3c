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

"""``goal_steering``: odometry and goals or paths in, velocity commands out."""

import math
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Union

from diffdrive_kinematics.core.commands import (
    HeadingRegulator, Law, PointForward, PoseController, Progress, PurePursuit, SteeringCommand,
    SteeringLimits, Waypoints, waypoints_from_poses)
from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.odometry import ClockStep
from diffdrive_kinematics.ros.messages.codec import TwistCodec
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from diffdrive_kinematics.ros.parameters.from_values import goals_from
from diffdrive_kinematics.ros.parameters.tables import GOAL_STEERING
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample, Status
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.running import main_of
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry, Path
from rclpy.publisher import Publisher

WAITING_REPORT_PERIOD_S = 5.0


class Config(NamedTuple):
    """What steers, and how."""

    law: Law
    pursuit: PurePursuit
    goals: Sequence[Pose]
    values: Mapping[str, Any]


class Task(NamedTuple):
    """Where to go, in a frame; an empty one is that of the odometry."""

    target: Union[Pose, Waypoints]
    frame_id: str

    def __str__(self) -> str:
        """Return it in words."""
        if isinstance(self.target, Waypoints):
            return f'the path of {len(self.target.points)} points'
        return 'the goal x {:.3f} m, y {:.3f} m, yaw {:.3f} rad'.format(*self.target)


class Seen(NamedTuple):
    """What odometry said last: pose, frame and stamp [ns]."""

    pose: Pose
    frame_id: str
    stamp_ns: int


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    limits = SteeringLimits(*(values[name] for name in (
        'max_speed', 'max_yaw_rate', 'distance_tolerance', 'yaw_tolerance')))
    distance_gain, heading_gain = values['distance_gain'], values['heading_gain']
    law: Law = {
        'heading': lambda: HeadingRegulator(heading_gain, distance_gain, limits),
        'point': lambda: PointForward(values['point_offset'], distance_gain, limits),
        'pose': lambda: PoseController(
            distance_gain, heading_gain, values['yaw_weight'], limits)}[values['law']]()
    return Config(law, PurePursuit(values['lookahead'], heading_gain, distance_gain, limits),
                  goals_from(values['goals']), values)


class GoalSteering(DiffDriveNode[Config]):
    """
    Drives to goals and along paths, and is silent where there are none.

    A new goal or path takes the place of all before it.  The robot is told to stand while
    odometry is silent, and drives on when it comes again.
    """

    def __init__(self, name: str = 'goal_steering', **composition: Any) -> None:
        super().__init__(name, GOAL_STEERING, build, **composition)
        values = self.config.values
        self._tasks = [Task(goal, '') for goal in self.config.goals]
        self._along = 0.0
        self._seen: Optional[Seen] = None
        self._standing = False
        self._progress = Progress(math.inf, math.inf, 0)
        self._message = TwistCodec.of(values)
        self._publisher = self.runtime.publish(self._message.message_type, values['cmd_vel_topic'])
        self.runtime.listen(Odometry, values['odom_topic'], self._on_odometry)
        if values['goal_topic']:
            self.runtime.listen(
                PoseStamped, values['goal_topic'], self._on_goal, needs_wakeup=False)
        if values['plan_topic']:
            self.runtime.listen(Path, values['plan_topic'], self._on_plan, needs_wakeup=False)
        self._timer = self.runtime.every(values['publish_rate'], self._tick)
        self.parameters.on_change(self._configure)

    def _on_odometry(self, message: Odometry) -> None:
        pose, stamp_ns = pose_in_plane(message.pose.pose), nanoseconds(message.header.stamp)
        if self._seen and stamp_ns == self._seen.stamp_ns != 0:
            return  # a repetition is no newer
        self._seen = Seen(pose, message.header.frame_id, stamp_ns)
        self.health.statistics.note(self.synchronised_now(), stamp_ns)

    def _on_goal(self, message: PoseStamped) -> None:
        self._begin(Task(pose_in_plane(message.pose), self._frame_of(message)))

    def _on_plan(self, message: Path) -> None:
        if not message.poses:
            if self._tasks:
                self._end(self.synchronised_now(),
                          f'cancelled {self._tasks[0]}: an empty path came', arrived=True)
            return
        frame_id = self._frame_of(message)
        poses = [pose_in_plane(each.pose) for each in message.poses]
        self._begin(Task(waypoints_from_poses(poses), frame_id))

    def _frame_of(self, message: Union[PoseStamped, Path]) -> str:
        """Return the frame of a goal, or raise ``ValueError`` where it is not the odometry's."""
        frame_id = message.header.frame_id
        expected = self._seen.frame_id if self._seen else 'that of the odometry'
        if not frame_id or (self._seen and frame_id != expected):
            raise ValueError(f'frame_id is {frame_id!r}, expected {expected!r}')
        return frame_id

    def _begin(self, task: Task) -> None:
        self._tasks = [task]
        self._set_out(self.synchronised_now())
        self.get_logger().info(f'driving to {task}')

    def _set_out(self, now_ns: int) -> None:
        """Forget what was of the task before."""
        self._along, self._progress = 0.0, Progress(math.inf, math.inf, now_ns)

    def _tick(self) -> None:
        now_ns = self.synchronised_now()
        if not self._tasks:
            return
        if self._is_blind(now_ns):
            self._progress = self._progress._replace(since_ns=now_ns)  # that time does not count
            self._send(now_ns, 0.0, 0.0)
            return
        task, seen = self._tasks[0], self._seen
        if task.frame_id not in ('', seen.frame_id):
            self._end(now_ns, f"gave up {task}: it is in frame '{task.frame_id}', odometry in "
                              f"'{seen.frame_id}'")
            return
        steered = self._steered(task.target, seen.pose)
        self._progress = self._progress.updated(steered, now_ns)
        patience = self.config.values['patience']
        if steered.arrived:
            self._arrive(now_ns, task, steered)
        elif now_ns - self._progress.since_ns > patience * 1e9:
            self._end(now_ns, f'gave up {task}: no progress for {patience:g} s, '
                              f'{steered.distance:.3f} m away from it')
        else:
            self._send(now_ns, *steered.twist)

    def _steered(self, target: Union[Pose, Waypoints], pose: Pose) -> SteeringCommand:
        if isinstance(target, Pose):
            return self.config.law.steer(pose, target)
        steered, self._along = self.config.pursuit.follow(pose, target, self._along)
        return steered

    def _is_blind(self, now_ns: int) -> bool:
        """Say when odometry falls silent and when it comes again; return whether it is silent."""
        age, timeout = self.health.statistics.age(now_ns), self.config.values['odom_timeout']
        topic = self.resolve_topic_name(self.config.values['odom_topic'])
        if age is None:
            self.get_logger().info(
                f"waiting for odometry on '{topic}'",
                throttle_duration_sec=WAITING_REPORT_PERIOD_S, skip_first=True)
            return True
        blind = age > timeout
        if blind and not self._standing:
            self.counts['odometry timeouts'] += 1
            self.get_logger().warning(
                f"no odometry on '{topic}' for {timeout:g} s: the robot is stopped")
        elif self._standing and not blind:
            self.get_logger().info('odometry has resumed: driving on')
        self._standing = blind
        return blind

    def _arrive(self, now_ns: int, task: Task, steered: SteeringCommand) -> None:
        self.counts['arrivals'] += 1
        turn = f' and {abs(steered.turn):.3f} rad' if steered.turn else ''
        text = f'arrived at {task}: {1000.0 * steered.distance:.0f} mm{turn} off'
        if len(self._tasks) == 1:
            self._end(now_ns, text, arrived=True)
            return
        self.get_logger().info(text)
        del self._tasks[0]
        self._set_out(now_ns)
        self._send(now_ns, 0.0, 0.0)

    def _end(self, now_ns: int, text: str, *, arrived: bool = False) -> None:
        """Let the robot stand, and say why."""
        self._tasks = []
        self._send(now_ns, 0.0, 0.0)
        if arrived:
            self.get_logger().info(text)
        else:
            self.counts['given up'] += 1
            self.get_logger().error(text)
        self.done = bool(self.config.goals)

    def _send(self, now_ns: int, v: float, w: float) -> None:
        self.health.sent += 1
        self._publisher.publish(self._message.encode(now_ns, v, w))

    def on_clock_step(self, step: ClockStep) -> None:
        """Move along since when there was no progress."""
        self._progress = self._progress._replace(since_ns=self._progress.since_ns + step.step_ns)

    def status(self, sample: RateSample) -> Status:
        """Return where the robot is going and how odometry comes in."""
        values = self.config.values
        topic = self.resolve_topic_name(values['odom_topic'])
        return Status({
            'state': f'driving to {self._tasks[0]}' if self._tasks else 'without a goal',
            'distance left [m]': self._progress.distance if self._tasks else 0.0,
            'arrivals': self.counts['arrivals'], 'given up': self.counts['given up'],
            'odometry timeouts': self.counts['odometry timeouts'],
            **self.health.statistics.values(sample.now_ns, 'odometry')},
            self.health.statistics.problems(sample.now_ns, values['odom_timeout'], topic))

    def final_command(self) -> Sequence[Publisher]:
        """Leave the robot with the command to stand still, where it was driven."""
        if not self.health.sent:
            return ()
        self._send(self.runtime.now_ns(), 0.0, 0.0)
        return [self._publisher]

    def _configure(self, config: Config) -> None:
        self._timer = self.runtime.retimed(self._timer, config.values['publish_rate'], self._tick)


main = main_of(GoalSteering)
